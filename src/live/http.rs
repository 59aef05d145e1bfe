//! HTTP as the page of one browser needs it, within limits: requests with a head of limited length, whose body is read
//! once it is known that they may ask, on a limited number of connections, each in a limited time.
//!
//! A client that sends slowly, or nothing, holds a connection and nothing else; where all are held, the one that has
//! waited longest is closed, first among those that were refused, then among those without a request that was allowed,
//! which are left a moment for it.

use http_body_util::{BodyExt, Full, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::header::{CONNECTION, CONTENT_TYPE, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::future::poll_fn;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;
use tokio::task::AbortHandle;
use tokio::time::{sleep, timeout};

/// The longest head that is read. Bytes
const LONGEST_HEAD: usize = 16_384;
/// The longest body that is read: a placement whose axes move from point to point has megabytes. Bytes
const LONGEST_BODY: u64 = 16_000_000;
/// Head and body of a request have arrived within this time each; a connection without a request is closed.
const TIME_OF_REQUEST: Duration = Duration::from_secs(10);
/// Connections that are open side by side.
const MOST_CONNECTIONS: usize = 64;
/// One that is new is not closed for another.
const MOMENT: Duration = Duration::from_millis(10);
/// Connections that wait to be taken up: as many as the system allows, since one that finds no place is only tried
/// again a second later.
const MOST_WAITING: u32 = 4096;
/// What is still sent behind the last answer is taken for so long and up to so many bytes, so that the system does not
/// throw away the answer with it.
const LAST: (Duration, u64) = (Duration::from_millis(200), 65_536);

/// The head of a request.
pub(super) type Head = hyper::http::request::Parts;
/// An answer of the server.
pub(super) type Answer = Response<Full<Bytes>>;

pub(super) const JSON: &str = "application/json; charset=utf-8";
/// What every answer says: it is for this page alone, and not to be kept. The page itself states what it may load.
const HEADERS: [(&str, &str); 6] = [
    ("cache-control", "no-store"),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("x-frame-options", "DENY"),
    ("cross-origin-resource-policy", "same-origin"),
    ("content-security-policy", "frame-ancestors 'none'"),
];

/// An answer of one kind of content.
pub(super) fn answer_of(status: StatusCode, kind: &'static str, body: Vec<u8>) -> Answer {
    let mut answer = Response::new(Full::from(body));
    *answer.status_mut() = status;
    let headers = HEADERS.into_iter().chain([(CONTENT_TYPE.as_str(), kind)]);
    answer.headers_mut().extend(
        headers.map(|(name, value)| (hyper::header::HeaderName::from_static(name), HeaderValue::from_static(value))),
    );
    answer
}

pub(super) fn json_of(status: StatusCode, value: &Value) -> Answer {
    answer_of(status, JSON, value.to_string().into_bytes())
}

/// Something that is not done, and why.
pub(super) fn error(status: StatusCode, message: &str) -> Answer {
    json_of(status, &json!({ "error": message }))
}

/// A site behind the server.
pub(super) trait Site: Send + Sync + 'static {
    /// The answer to a request that is not allowed, before its body is read.
    fn refuses(&self, head: &Head) -> Option<Answer>;
    /// The answer to a request that is allowed.
    fn answer(&self, head: &Head, body: &[u8]) -> Answer;
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

/// A connection that is open.
#[derive(Debug)]
struct Open {
    task: AbortHandle,
    /// Since when it has been waiting for a request.
    since: Instant,
    stage: Stage,
}

/// The connections that are open, by number.
#[derive(Debug, Clone, Default)]
struct Connections(Arc<Mutex<BTreeMap<u64, Open>>>);

impl Connections {
    fn open(&self) -> MutexGuard<'_, BTreeMap<u64, Open>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn set(&self, number: u64, stage: Stage) {
        if let Some(one) = self.open().get_mut(&number) {
            (one.stage, one.since) = (stage, Instant::now());
        }
    }

    /// Where there are too many, closes one that waits, as the module says; whether there is a place then.
    fn give_way(&self) -> bool {
        let mut open = self.open();
        if open.len() < MOST_CONNECTIONS {
            return true;
        }
        let waiting = open.iter().filter(|(_, one)| one.stage != Stage::Answered);
        let first = waiting.min_by_key(|(_, one)| (one.stage, one.since));
        let may_go = |one: &Open| one.stage != Stage::Unknown || one.since.elapsed() >= MOMENT;
        let first = first.filter(|(_, one)| may_go(one)).map(|(number, _)| *number);
        let gone = first.and_then(|number| open.remove(&number));
        gone.iter().for_each(|one| one.task.abort());
        gone.is_some()
    }
}

/// A listener with its connections.
#[derive(Debug)]
pub(super) struct Listener {
    closing: watch::Sender<Option<Duration>>,
    thread: JoinHandle<()>,
    #[cfg(test)]
    connections: Connections,
}

/// A port of 127.0.0.1 that is listened to, 0 for any that is free.
pub(super) struct Bound {
    runtime: Runtime,
    listener: TcpListener,
    pub port: u16,
}

impl Bound {
    /// # Errors
    /// What the system says.
    pub fn to(port: u16) -> io::Result<Self> {
        let runtime = Builder::new_current_thread().enable_io().enable_time().build()?;
        let listener = {
            let _entered = runtime.enter();
            let socket = TcpSocket::new_v4()?;
            #[cfg(unix)]
            socket.set_reuseaddr(true)?;
            socket.bind(([127, 0, 0, 1], port).into())?;
            socket.listen(MOST_WAITING)?
        };
        Ok(Self { port: listener.local_addr()?.port(), listener, runtime })
    }

    /// Answers what comes in.
    ///
    /// # Errors
    /// What the system says.
    pub fn start(self, site: impl Site) -> io::Result<Listener> {
        let Self { runtime, listener, .. } = self;
        let (closing, seen) = watch::channel(None);
        let connections = Connections::default();
        let work = {
            let connections = connections.clone();
            move || {
                runtime.block_on(accept(listener, Arc::new(site), connections, seen));
                // Answers that are still being made are not waited for.
                runtime.shutdown_background();
            }
        };
        let thread = std::thread::Builder::new().name("connections".to_owned()).spawn(work)?;
        Ok(Listener {
            closing,
            thread,
            #[cfg(test)]
            connections,
        })
    }
}

impl Listener {
    /// Closes all connections, but for requests that were allowed, which are waited for as long as given.
    pub fn close(self, wait: Duration) {
        self.closing.send_replace(Some(wait));
        // A thread that has failed accepts nothing any more.
        let _ = self.thread.join();
    }
}

/// Takes up connections until the server closes.
async fn accept(
    listener: TcpListener,
    site: Arc<impl Site>,
    connections: Connections,
    closing: watch::Receiver<Option<Duration>>,
) {
    let taking_up = async {
        for number in 0.. {
            // A connection that has gone by now is left alone.
            let Ok((stream, _)) = listener.accept().await else {
                sleep(MOMENT).await;
                continue;
            };
            while !connections.give_way() {
                sleep(MOMENT / 10).await;
            }
            let entry = Entry { number, connections: connections.clone() };
            let task = tokio::spawn(serve(stream, entry, Arc::clone(&site), closing.clone())).abort_handle();
            connections.open().insert(number, Open { task, since: Instant::now(), stage: Stage::Unknown });
        }
    };
    let mut until = closing.clone();
    let wait = tokio::select! {
        wait = until.wait_for(Option::is_some) => wait.ok().and_then(|wait| *wait),
        () = taking_up => None,
    };
    connections.open().values().filter(|one| one.stage < Stage::Allowed).for_each(|one| one.task.abort());
    let ended = async {
        while !connections.open().is_empty() {
            sleep(MOMENT / 10).await;
        }
    };
    // What has not ended by then ends with the runtime.
    let _ = timeout(wait.unwrap_or_default(), ended).await;
}

/// A connection among those that are open: however it ends, it is open no more.
struct Entry {
    number: u64,
    connections: Connections,
}

impl Drop for Entry {
    fn drop(&mut self) {
        self.connections.open().remove(&self.number);
    }
}

/// Answers one request after another.
async fn serve(stream: TcpStream, entry: Entry, site: Arc<impl Site>, mut closing: watch::Receiver<Option<Duration>>) {
    // Otherwise the second packet of an answer waits some 40 ms, until the first is acknowledged.
    let _ = stream.set_nodelay(true);
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(TIME_OF_REQUEST).max_buf_size(LONGEST_HEAD);
    let answers = service_fn(|request| Box::pin(respond(request, &entry, &site)));
    let mut connection = http.serve_connection(TokioIo::new(stream), answers);
    let closes = async { drop(closing.wait_for(Option::is_some).await) };
    tokio::select! {
        _ = poll_fn(|context| connection.poll_without_shutdown(context)) => {}
        () = closes => {
            std::pin::Pin::new(&mut connection).graceful_shutdown();
            let _ = poll_fn(|context| connection.poll_without_shutdown(context)).await;
        }
    }
    let mut stream = connection.into_parts().io.into_inner();
    let _ = stream.shutdown().await;
    let _ = timeout(LAST.0, tokio::io::copy(&mut stream.take(LAST.1), &mut tokio::io::sink())).await;
}

/// The answer to a request. Where it is refused, nothing more can be read of the connection, which ends.
async fn respond(request: Request<Incoming>, entry: &Entry, site: &Arc<impl Site>) -> Result<Answer, Infallible> {
    let set = |stage| entry.connections.set(entry.number, stage);
    let refused = |mut answer: Answer| {
        set(Stage::Refused);
        answer.headers_mut().insert(CONNECTION, HeaderValue::from_static("close"));
        Ok(answer)
    };
    let too_long = || error(StatusCode::PAYLOAD_TOO_LARGE, "the body is too long; allowed: 16000000 bytes");
    let (head, body) = request.into_parts();
    if body.size_hint().lower() > LONGEST_BODY {
        return refused(too_long());
    }
    if let Some(refusal) = site.refuses(&head) {
        return refused(refusal);
    }
    set(Stage::Allowed);
    let body = match timeout(TIME_OF_REQUEST, Limited::new(body, LONGEST_BODY as usize).collect()).await {
        Ok(Ok(body)) => body.to_bytes(),
        Ok(Err(_)) => return refused(too_long()),
        Err(_) => return refused(error(StatusCode::REQUEST_TIMEOUT, "the request took longer than 10 s")),
    };
    set(Stage::Answered);
    let site = Arc::clone(site);
    let made = tokio::task::spawn_blocking(move || site.answer(&head, &body)).await;
    set(Stage::Allowed);
    Ok(made.unwrap_or_else(|_| error(StatusCode::INTERNAL_SERVER_ERROR, "there is no answer to this request")))
}

#[cfg(test)]
mod tests;
