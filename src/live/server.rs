//! The server of a session: on the loopback address of this machine alone, for the page that knows the token.

use super::routes::{Answer, Asking, Guard, answer, has_body};
use super::session::Session;
use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;
use tiny_http::{Request, StatusCode};

/// The longest body that is read: a placement whose axes move from point to point has megabytes. Bytes
const LONGEST_BODY: u64 = 16_000_000;
/// Requests that are answered side by side.
const SIDE_BY_SIDE: usize = 12;
/// How often it is looked whether the server ends.
const BETWEEN_LOOKS: Duration = Duration::from_millis(200);

/// Why a server does not start.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// The port cannot be had.
    #[error(
        "--port: port {port} of 127.0.0.1 cannot be used: {cause}; allowed: a port that is free, or 0 for any that is"
    )]
    Port {
        /// The port requested.
        port: u16,
        /// What the system says.
        cause: String,
    },
    /// The system gives no random numbers or threads.
    #[error("the server cannot be started: {0}")]
    System(String),
}

/// A server that answers until it is closed.
#[derive(Debug)]
pub struct Server {
    guard: Guard,
    is_closing: Arc<AtomicBool>,
    session: Arc<Session>,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Starts the server of a session on a port of 127.0.0.1, 0 for any that is free.
    ///
    /// # Errors
    /// [`StartError`]: the port cannot be had, or the system gives no random numbers or threads.
    pub fn start(session: Session, port: u16) -> Result<Self, StartError> {
        let taken = |cause: String| StartError::Port { port, cause };
        let http = tiny_http::Server::http(("127.0.0.1", port)).map_err(|cause| taken(cause.to_string()))?;
        let port = http.server_addr().to_ip().ok_or_else(|| taken("it is no address".to_owned()))?.port();
        let (http, session) = (Arc::new(http), Arc::new(session));
        let guard = Guard { port, token: token()? };
        let is_closing = Arc::<AtomicBool>::default();
        let mut threads = session.start().map_err(|error| StartError::System(error.to_string()))?;
        for _ in 0..SIDE_BY_SIDE {
            let (http, session, guard) = (Arc::clone(&http), Arc::clone(&session), guard.clone());
            let closing = Arc::clone(&is_closing);
            let work = move || {
                while !closing.load(Ordering::SeqCst) {
                    if let Ok(Some(request)) = http.recv_timeout(BETWEEN_LOOKS) {
                        serve(&session, &guard, request);
                    }
                }
            };
            let thread = std::thread::Builder::new().name("requests".to_owned()).spawn(work);
            threads.push(thread.map_err(|cause| StartError::System(cause.to_string()))?);
        }
        Ok(Self { guard, is_closing, session, threads })
    }

    /// The address of the page, with the token in it.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.guard.port, self.guard.token)
    }

    /// The session.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// Ends the server. A job that runs ends with what it has, and keeps it.
    pub fn close(self) {
        self.session.close();
        self.is_closing.store(true, Ordering::SeqCst);
        // A thread that has failed has nothing left to answer.
        self.threads.into_iter().for_each(|thread| drop(thread.join()));
    }
}

/// A token that nobody guesses, in hexadecimal.
fn token() -> Result<String, StartError> {
    let mut bytes = [0; 24];
    getrandom::fill(&mut bytes).map_err(|cause| StartError::System(cause.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

fn serve(session: &Arc<Session>, guard: &Guard, mut request: Request) {
    let header = |name: &'static str| {
        let found = request.headers().iter().find(|header| header.field.equiv(name));
        found.map(|header| header.value.as_str().to_owned())
    };
    let asking = Asking {
        method: request.method().as_str().to_owned(),
        url: request.url().to_owned(),
        host: header("Host"),
        origin: header("Origin"),
        token: header("X-Stead-Token"),
    };
    let answer = match guard.refuses(&asking) {
        Some(refusal) => refusal,
        None => match body_of(&mut request, &asking) {
            Ok(body) => answer(session, guard, &asking, &body),
            Err(refusal) => refusal,
        },
    };
    let bytes = bytes_of(answer, &asking.method);
    // In one piece: in two, the second waits some 40 ms until the first is acknowledged. A page that has gone away is
    // no error.
    let mut out = request.into_writer();
    let _ = out.write_all(&bytes).and_then(|()| out.flush());
}

/// An answer as it goes over the line.
fn bytes_of(Answer { status, kind, body }: Answer, method: &str) -> Vec<u8> {
    let reason = StatusCode(status).default_reason_phrase();
    let mut head = format!("HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len());
    for (name, value) in HEADERS {
        head.push_str(&format!("{name}: {value}\r\n"));
    }
    head.push_str("\r\n");
    let mut bytes = head.into_bytes();
    if method != "HEAD" {
        bytes.extend(body);
    }
    bytes
}

/// What every answer says: it is for this page alone, and not to be kept. The page itself states what it may load.
const HEADERS: [(&str, &str); 6] = [
    ("Cache-Control", "no-store"),
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
    ("X-Frame-Options", "DENY"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("Content-Security-Policy", "frame-ancestors 'none'"),
];

/// The body of a request, where it has one and is not too long.
fn body_of(request: &mut Request, asking: &Asking) -> Result<Vec<u8>, Answer> {
    let mut body = Vec::new();
    if !has_body(asking) {
        return Ok(body);
    }
    let too_long = || Answer::error(413, &format!("the body is too long; allowed: {LONGEST_BODY} bytes"));
    if request.body_length().is_some_and(|length| length as u64 > LONGEST_BODY) {
        return Err(too_long());
    }
    let read = request.as_reader().take(LONGEST_BODY + 1).read_to_end(&mut body);
    read.map_err(|cause| Answer::error(400, &format!("the body cannot be read: {cause}")))?;
    if body.len() as u64 > LONGEST_BODY { Err(too_long()) } else { Ok(body) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_one_piece_with_its_length() {
        let answer = || Answer { status: 403, kind: "text/plain", body: b"no".to_vec() };
        let text = String::from_utf8(bytes_of(answer(), "GET")).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        assert!(head.starts_with("HTTP/1.1 403 Forbidden\r\nContent-Type: text/plain\r\nContent-Length: 2\r\n"));
        assert!(HEADERS.iter().all(|(name, value)| head.contains(&format!("{name}: {value}"))));
        assert_eq!(body, "no");
        assert!(String::from_utf8(bytes_of(answer(), "HEAD")).unwrap().ends_with("\r\n\r\n"));
    }

    #[test]
    fn tokens_are_long_and_differ() {
        let [one, other] = [token().unwrap(), token().unwrap()];
        assert!(one.len() == 48 && one != other && one.chars().all(|digit| digit.is_ascii_hexdigit()));
    }
}
