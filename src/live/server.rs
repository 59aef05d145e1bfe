//! The server of a session: on the loopback address of this machine alone, for the page that knows the token.

use super::http::{Answer, Bound, Head, Listener, Site};
use super::routes::{Guard, answer};
use super::session::Session;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

/// An answer that is being made when the server ends is waited for so long.
const LAST_ANSWERS: Duration = Duration::from_secs(1);

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
    listener: Listener,
    session: Arc<Session>,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Starts the server of a session on a port of 127.0.0.1, 0 for any that is free.
    ///
    /// # Errors
    /// [`StartError`]: the port cannot be had, or the system gives no random numbers or threads.
    pub fn start(session: Session, port: u16) -> Result<Self, StartError> {
        let taken = |cause: std::io::Error| StartError::Port { port, cause: cause.to_string() };
        let system = |cause: std::io::Error| StartError::System(cause.to_string());
        let bound = Bound::to(port).map_err(taken)?;
        let session = Arc::new(session);
        let guard = Guard { port: bound.port, token: token()? };
        let threads = session.start().map_err(|error| StartError::System(error.to_string()))?;
        let service = Service { session: Arc::clone(&session), guard: guard.clone() };
        let listener = bound.start(service).map_err(system)?;
        Ok(Self { guard, listener, session, threads })
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
        self.listener.close(LAST_ANSWERS);
        // A thread that has failed has nothing left to answer.
        self.threads.into_iter().for_each(|thread| drop(thread.join()));
    }
}

/// A session that answers who may ask.
struct Service {
    session: Arc<Session>,
    guard: Guard,
}

impl Site for Service {
    fn refuses(&self, head: &Head) -> Option<Answer> {
        self.guard.refuses(head)
    }

    fn answer(&self, head: &Head, body: &[u8]) -> Answer {
        answer(&self.session, &self.guard, head, body)
    }
}

/// A token that nobody guesses, in hexadecimal.
fn token() -> Result<String, StartError> {
    let mut bytes = [0; 24];
    getrandom::fill(&mut bytes).map_err(|cause| StartError::System(cause.to_string()))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_long_and_differ() {
        let [one, other] = [token().unwrap(), token().unwrap()];
        assert!(one.len() == 48 && one != other && one.chars().all(|digit| digit.is_ascii_hexdigit()));
    }
}
