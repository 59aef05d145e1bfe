//! HTTP as the page of one browser needs it, and no more: requests with a head of limited length, whose body is read
//! once it is known that they may ask, on a limited number of connections, each in a limited time.
//!
//! A client that sends slowly, or nothing, holds a connection and nothing else; where all are held, the one that has
//! waited longest is closed, first among those that were refused, then among those without a request that was allowed,
//! which are left a moment for it.

mod message;

pub(super) use message::{Answer, Head};

use message::Refused;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The longest head that is read. Bytes
const LONGEST_HEAD: usize = 16_384;
/// A request is whole within this time from its first byte, and an answer is taken within it.
const TIME_OF_REQUEST: Duration = Duration::from_secs(10);
/// Connections on which nothing is asked stay open so long.
const IDLE: Duration = Duration::from_secs(60);
/// Connections that are open side by side.
const MOST_CONNECTIONS: usize = 64;
/// One that is new is not closed for another.
const MOMENT: Duration = Duration::from_millis(10);

/// What answers.
pub(super) trait Site: Send + Sync + 'static {
    /// What a request that may not be answered is told, before its body is read.
    fn refuses(&self, head: &Head) -> Option<Answer>;
    /// The answer to a request that may ask.
    fn answer(&self, head: &Head, body: &[u8]) -> Answer;
}

/// A connection that is open.
#[derive(Debug)]
struct Open {
    stream: TcpStream,
    /// Since when it has been waiting for a request.
    since: Instant,
    stage: Stage,
}

/// How far a connection has come; the first are given up first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    /// A request on it was refused, and it only takes what is still sent.
    Refused,
    /// Nothing was allowed on it yet.
    Unknown,
    /// A request on it was allowed.
    Allowed,
    /// It is being answered.
    Answered,
}

/// A listener with its connections.
#[derive(Debug)]
pub(super) struct Listener {
    address: SocketAddr,
    shared: Arc<Shared>,
    accepting: Option<JoinHandle<()>>,
}

#[derive(Debug, Default)]
struct Shared {
    is_closing: AtomicBool,
    open: Mutex<BTreeMap<u64, Open>>,
}

impl Shared {
    fn open(&self) -> MutexGuard<'_, BTreeMap<u64, Open>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes up a connection; where there are too many, one that waits is closed for it, as the module says.
    fn enter(&self, number: u64, stream: &TcpStream) -> bool {
        let Ok(stream) = stream.try_clone() else { return false };
        let is_new = |one: &Open| one.stage == Stage::Unknown && one.since.elapsed() < MOMENT;
        let mut open = self.open();
        while open.len() >= MOST_CONNECTIONS {
            let waiting = open.iter().filter(|(_, one)| one.stage != Stage::Answered);
            let Some((first, one)) = waiting.min_by_key(|(_, one)| (one.stage, one.since)) else { return false };
            if is_new(one) {
                drop(open);
                std::thread::sleep(Duration::from_millis(1));
                open = self.open();
                continue;
            }
            let first = *first;
            if let Some(one) = open.remove(&first) {
                // It is being given up.
                let _ = one.stream.shutdown(Shutdown::Both);
            }
        }
        open.insert(number, Open { stream, since: Instant::now(), stage: Stage::Unknown });
        true
    }

    fn set(&self, number: u64, change: impl FnOnce(&mut Open)) {
        if let Some(one) = self.open().get_mut(&number) {
            change(one);
        }
    }
}

impl Listener {
    /// Answers what comes in.
    ///
    /// # Errors
    /// What the system says.
    pub fn start(listener: TcpListener, site: impl Site) -> io::Result<Self> {
        let address = listener.local_addr()?;
        let (shared, site) = (Arc::<Shared>::default(), Arc::new(site));
        let accepted = Arc::clone(&shared);
        let accept = move || {
            for (stream, number) in listener.incoming().zip(0..) {
                if accepted.is_closing.load(Ordering::SeqCst) {
                    break;
                }
                // A connection that has gone by now, or that is beyond the limit, is left alone.
                let Ok(stream) = stream else {
                    std::thread::sleep(Duration::from_millis(10));
                    continue;
                };
                if !accepted.enter(number, &stream) {
                    continue;
                }
                let (shared, site) = (Arc::clone(&accepted), Arc::clone(&site));
                let work = move || {
                    // It ends with the connection, however that ends.
                    let _ = Connection { stream, shared: &shared, number, rest: Vec::new() }.serve(&*site);
                };
                let started = std::thread::Builder::new().name("connection".to_owned()).spawn(work);
                if started.is_err() {
                    accepted.open().remove(&number);
                }
            }
        };
        let accepting = Some(std::thread::Builder::new().name("connections".to_owned()).spawn(accept)?);
        Ok(Self { address, shared, accepting })
    }

    /// Closes all connections, but for answers that are being made, which are waited for as long as given.
    pub fn close(mut self, wait: Duration) {
        self.shared.is_closing.store(true, Ordering::SeqCst);
        // Wakes the thread that waits for connections.
        let _ = TcpStream::connect(self.address);
        if let Some(accepting) = self.accepting.take() {
            // A thread that has failed accepts nothing any more.
            let _ = accepting.join();
        }
        let end = Instant::now() + wait;
        loop {
            let mut open = self.shared.open();
            open.retain(|_, one| one.stage == Stage::Answered || one.stream.shutdown(Shutdown::Both).is_err());
            if open.is_empty() || Instant::now() > end {
                open.values().for_each(|one| drop(one.stream.shutdown(Shutdown::Both)));
                return;
            }
            drop(open);
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// One connection with what was read of it and belongs to no request yet.
struct Connection<'c> {
    stream: TcpStream,
    shared: &'c Shared,
    number: u64,
    rest: Vec<u8>,
}

impl Drop for Connection<'_> {
    /// However it ends, it is open no more.
    fn drop(&mut self) {
        self.shared.open().remove(&self.number);
    }
}

impl Connection<'_> {
    /// Answers one request after another.
    fn serve(mut self, site: &impl Site) -> io::Result<()> {
        self.stream.set_nodelay(true)?;
        self.stream.set_write_timeout(Some(TIME_OF_REQUEST))?;
        while !self.shared.is_closing.load(Ordering::SeqCst) {
            let head = match self.head()? {
                Some(Ok(head)) => head,
                Some(Err(Refused(status, why))) => return self.refuse(Answer::error(status, why)),
                None => return Ok(()),
            };
            let began = Instant::now();
            // Without its body read, nothing more can be read of a connection.
            let length = match head.body_length() {
                Ok(length) => length,
                Err(Refused(status, why)) => return self.refuse(Answer::error(status, why)),
            };
            if let Some(refusal) = site.refuses(&head) {
                return self.refuse(refusal);
            }
            self.shared.set(self.number, |one| one.stage = Stage::Allowed);
            if length > 0 && head.header("expect").is_some_and(|value| value.eq_ignore_ascii_case("100-continue")) {
                self.stream.write_all(b"HTTP/1.1 100 Continue\r\n\r\n")?;
            }
            let Some(body) = self.body(length, began + TIME_OF_REQUEST)? else {
                return self.refuse(Answer::error(408, "the request took longer than 10 s"));
            };
            self.shared.set(self.number, |one| one.stage = Stage::Answered);
            let is_last = head.is_last() || self.shared.is_closing.load(Ordering::SeqCst);
            self.stream.write_all(&site.answer(&head, &body).bytes(&head.method, is_last))?;
            self.shared.set(self.number, |one| (one.stage, one.since) = (Stage::Allowed, Instant::now()));
            if is_last {
                break;
            }
        }
        self.stream.shutdown(Shutdown::Both)
    }

    /// The head of the next request; none where the connection ends, or nothing comes.
    fn head(&mut self) -> io::Result<Option<Result<Head, Refused>>> {
        let mut end = Instant::now() + if self.rest.is_empty() { IDLE } else { TIME_OF_REQUEST };
        loop {
            // Lines that are empty before a request are left out.
            let blank = self.rest.iter().take_while(|byte| [b'\r', b'\n'].contains(byte)).count();
            self.rest.drain(..blank);
            if let Some(at) = self.rest.windows(4).position(|four| four == b"\r\n\r\n").filter(|at| *at <= LONGEST_HEAD)
            {
                let head = Head::parse(&self.rest[..at]);
                self.rest.drain(..at + 4);
                return Ok(Some(head));
            }
            if self.rest.len() > LONGEST_HEAD {
                return Ok(Some(Err(Refused(431, "the head is too long; allowed: 16384 bytes"))));
            }
            let was_empty = self.rest.is_empty();
            match self.more(LONGEST_HEAD, end)? {
                0 if self.rest.is_empty() => return Ok(None),
                0 if Instant::now() >= end => {
                    return Ok(Some(Err(Refused(408, "the request took longer than 10 s"))));
                }
                0 => return Ok(None),
                _ if was_empty => end = Instant::now() + TIME_OF_REQUEST,
                _ => {}
            }
        }
    }

    /// So many bytes of a body, before a time.
    fn body(&mut self, length: usize, end: Instant) -> io::Result<Option<Vec<u8>>> {
        while self.rest.len() < length {
            if self.more(length - self.rest.len(), end)? == 0 {
                return Ok(None);
            }
        }
        let later = self.rest.split_off(length);
        Ok(Some(std::mem::replace(&mut self.rest, later)))
    }

    /// Reads some more bytes, how many: none where the connection has ended or the time is over.
    fn more(&mut self, most: usize, end: Instant) -> io::Result<usize> {
        let mut buffer = [0; 16_384];
        let most = most.clamp(1, buffer.len());
        loop {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(0);
            }
            self.stream.set_read_timeout(Some(left))?;
            match self.stream.read(&mut buffer[..most]) {
                Ok(count) => {
                    self.rest.extend_from_slice(&buffer[..count]);
                    return Ok(count);
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if [ErrorKind::WouldBlock, ErrorKind::TimedOut].contains(&error.kind()) => return Ok(0),
                Err(error) => return Err(error),
            }
        }
    }

    /// Says no, and closes the connection.
    fn refuse(mut self, answer: Answer) -> io::Result<()> {
        self.shared.set(self.number, |one| one.stage = Stage::Refused);
        self.stream.write_all(&answer.bytes("GET", true))?;
        self.stream.shutdown(Shutdown::Write)?;
        // What was sent meanwhile is taken for a moment, so that the system does not throw away the answer with it.
        let end = Instant::now() + Duration::from_millis(200);
        let mut taken = 0;
        while taken < 4 * LONGEST_HEAD {
            self.rest.clear();
            match self.more(LONGEST_HEAD, end)? {
                0 => break,
                count => taken += count,
            }
        }
        self.stream.shutdown(Shutdown::Both)
    }
}

#[cfg(test)]
mod tests;
