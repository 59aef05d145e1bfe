use super::*;
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;

struct Echo;

impl Site for Echo {
    fn refuses(&self, head: &Head) -> Option<Answer> {
        (head.headers.get("x-stead-token").is_none_or(|token| token != "known"))
            .then(|| error(StatusCode::FORBIDDEN, "no"))
    }

    fn answer(&self, head: &Head, body: &[u8]) -> Answer {
        assert_ne!(body, b"panic");
        answer_of(StatusCode::OK, "text/plain", [head.uri.to_string().as_bytes(), b" ", body].concat())
    }
}

/// A server on a port of its own.
struct Started {
    listener: Listener,
    port: u16,
}

fn start() -> Started {
    let bound = Bound::to(0).unwrap();
    Started { port: bound.port, listener: bound.start(Echo).unwrap() }
}

/// What comes back for some bytes, until the connection ends or nothing comes for a while.
fn sent(server: &Started, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", server.port)).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    // The server may have closed it by then.
    let _ = stream.write_all(bytes);
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

const KNOWN: &str = "X-Stead-Token: known\r\n";

#[test]
fn requests_are_answered_one_after_another_on_a_connection() {
    let server = start();
    let last = format!("GET /b HTTP/1.1\r\nconnection: close\r\n{KNOWN}\r\n");
    let found =
        sent(&server, format!("\r\nPOST /a?q HTTP/1.1\r\n{KNOWN}Content-Length: 3\r\n\r\nxyz{last}").as_bytes());
    let answers: Vec<&str> = found.split("HTTP/1.1 ").skip(1).collect();
    let [first, second] = answers[..] else { panic!("{found}") };
    assert!(first.starts_with("200 OK\r\n") && first.ends_with("\r\n\r\n/a?q xyz") && !first.contains("connection"));
    assert!(second.ends_with("\r\n\r\n/b ") && second.contains("connection: close\r\n"));
    assert!(second.contains("content-length: 3\r\n"));
    assert!(HEADERS.iter().all(|(name, value)| first.contains(&format!("{name}: {value}\r\n"))));
    let head = sent(&server, format!("HEAD /b HTTP/1.1\r\nconnection: close\r\n{KNOWN}\r\n").as_bytes());
    assert!(head.starts_with("HTTP/1.1 200 ") && head.ends_with("\r\n\r\n"));
    let post = format!("POST / HTTP/1.1\r\nContent-Length: 5\r\nConnection: close\r\n{KNOWN}\r\npanic");
    assert!(sent(&server, post.as_bytes()).starts_with("HTTP/1.1 500 "));
    server.listener.close(Duration::ZERO);
}

/// Nothing is read behind the head of a request that is refused, however long it says that its body is.
#[test]
fn what_may_not_be_asked_is_refused_before_its_body() {
    let server = start();
    let post = |headers: &str| sent(&server, format!("POST / HTTP/1.1\r\n{headers}\r\n").as_bytes());
    // A head that breaks the rules of HTTP has an answer without text, which the library gives.
    let long = format!("a: {}\r\n{KNOWN}", "x".repeat(20_000));
    let twice = format!("{KNOWN}Content-Length: 1\r\nContent-Length: 2\r\n");
    for (headers, status, has_text) in [
        ("Content-Length: 60000000000\r\n", 413, true),
        ("Content-Length: 99999999999999999999999999\r\n", 400, false),
        (&format!("{KNOWN}Content-Length: 16000001\r\n"), 413, true),
        ("Content-Length: 100\r\n", 403, true),
        (&format!("{KNOWN}Content-Length: -1\r\n"), 400, false),
        (&twice, 400, false),
        (&format!("a b: c\r\n{KNOWN}"), 400, false),
        (&format!("a: \u{1}\r\n{KNOWN}"), 400, false),
        (&format!("folded\r\n{KNOWN}"), 400, false),
        (&long, 431, false),
    ] {
        let found = post(headers);
        let (first, is_last) = (format!("HTTP/1.1 {status} "), found.contains("\r\nconnection: close\r\n"));
        assert!(found.starts_with(&first) && is_last && found.ends_with('}') == has_text, "{headers}: {found}");
    }
    for first in ["GET", "GET  / HTTP/1.1", "GET / HTTP/4", "\u{1} / HTTP/1.1"] {
        let found = sent(&server, format!("{first}\r\n{KNOWN}\r\n").as_bytes());
        assert!(found.starts_with("HTTP/1.1 400 "), "{first}: {found}");
    }
    server.listener.close(Duration::ZERO);
}

/// Random bytes, requests with bytes changed, left out and put in: the server answers or closes, and then answers what
/// is asked.
#[test]
fn raw_bytes_never_stop_the_server() {
    let server = start();
    let good = format!("POST /a HTTP/1.1\r\nHost: here\r\n{KNOWN}Content-Length: 5\r\nConnection: close\r\n\r\nhello")
        .into_bytes();
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    for round in 0..2000 {
        let mut bytes = if round % 4 == 0 { (0..next(300)).map(|_| next(256) as u8).collect() } else { good.clone() };
        for _ in 0..next(4) {
            let at = next(bytes.len() + 1);
            match next(3) {
                0 if at < bytes.len() => bytes[at] = next(256) as u8,
                1 if at < bytes.len() => drop(bytes.drain(at..(at + 1 + next(20)).min(bytes.len()))),
                _ => bytes.insert(at, b"\r\n :0/"[next(6)]),
            }
        }
        let mut stream = TcpStream::connect(("127.0.0.1", server.port)).unwrap();
        let _ = stream.write_all(&bytes);
        drop(stream);
    }
    // Windows refuses connections for a while where it is busy with them.
    let mut attempts = std::iter::repeat_with(|| sent(&server, &good)).take(if cfg!(windows) { 50 } else { 1 });
    assert!(attempts.any(|answer| answer.ends_with("/a hello") || {
        std::thread::sleep(Duration::from_millis(50));
        false
    }));
    server.listener.close(Duration::ZERO);
}

/// Clients that send nothing, or half of a head, or a body slowly, keep no other waiting.
#[test]
fn slow_connections_keep_nobody_waiting_and_do_not_outlive_the_server() {
    let server = start();
    let slow: Vec<TcpStream> = (0..2 * MOST_CONNECTIONS)
        .map(|number| {
            let mut stream = TcpStream::connect(("127.0.0.1", server.port)).unwrap();
            let begun = [
                "",
                "GET / HTT",
                "POST / HTTP/1.1\r\nContent-Length: 5\r\n",
                "POST / HTTP/1.1\r\nX-Stead-Token: known\r\nContent-Length: 5\r\n\r\nhe",
            ];
            // Those that were open longest may have given way.
            let _ = stream.write_all(begun[number % 4].as_bytes());
            stream
        })
        .collect();
    let last = format!("GET /b HTTP/1.1\r\nConnection: close\r\n{KNOWN}\r\n");
    assert!(sent(&server, last.as_bytes()).ends_with("/b "));
    assert!(server.listener.connections.open().len() <= MOST_CONNECTIONS);
    server.listener.close(Duration::ZERO);
    for mut stream in slow {
        // Each has ended: there is an end of it, or it was reset.
        stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        let ended = stream.read_to_end(&mut Vec::new()).map_err(|error| error.kind());
        assert!(!matches!(ended, Err(ErrorKind::WouldBlock | ErrorKind::TimedOut)), "it is still open");
    }
}
