use super::message::HEADERS;
use super::*;

struct Echo;

impl Site for Echo {
    fn refuses(&self, head: &Head) -> Option<Answer> {
        (head.header("x-stead-token") != Some("known")).then(|| Answer::error(403, "no"))
    }

    fn answer(&self, head: &Head, body: &[u8]) -> Answer {
        Answer { status: 200, kind: "text/plain", more: Vec::new(), body: [head.url.as_bytes(), b" ", body].concat() }
    }
}

fn start() -> Listener {
    Listener::start(TcpListener::bind(("127.0.0.1", 0)).unwrap(), Echo).unwrap()
}

/// What comes back for some bytes, until the connection ends or nothing comes for a while.
fn sent(listener: &Listener, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(listener.address).unwrap();
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
    let listener = start();
    let last = format!("GET /b HTTP/1.1\r\nconnection: close\r\n{KNOWN}\r\n");
    let found =
        sent(&listener, format!("\r\nPOST /a?q HTTP/1.1\r\n{KNOWN}Content-Length: 3\r\n\r\nxyz{last}").as_bytes());
    let answers: Vec<&str> = found.split("HTTP/1.1 ").skip(1).collect();
    let [first, second] = answers[..] else { panic!("{found}") };
    assert!(first.starts_with("200 OK\r\n") && first.ends_with("\r\n\r\n/a?q xyz") && !first.contains("Connection"));
    assert!(second.ends_with("Connection: close\r\n\r\n/b ") && second.contains("Content-Length: 3\r\n"));
    assert!(HEADERS.iter().all(|(name, value)| first.contains(&format!("{name}: {value}\r\n"))));
    let bytes = |method| {
        Answer { status: 200, kind: "text/plain", more: Vec::new(), body: b"no".to_vec() }.bytes(method, false)
    };
    assert!(bytes("GET").ends_with(b"no") && bytes("HEAD").ends_with(b"\r\n\r\n"));
    listener.close(Duration::ZERO);
}

/// Nothing is read behind the head of a request that is refused, however long it says that its body is.
#[test]
fn what_may_not_be_asked_is_refused_before_its_body() {
    let listener = start();
    let post = |headers: &str| sent(&listener, format!("POST / HTTP/1.1\r\n{headers}\r\n").as_bytes());
    for (headers, status) in [
        ("Content-Length: 60000000000\r\n".to_owned(), 413),
        ("Content-Length: 99999999999999999999999999\r\n".to_owned(), 413),
        (format!("{KNOWN}Content-Length: 16000001\r\n"), 413),
        ("Content-Length: 100\r\n".to_owned(), 403),
        (format!("{KNOWN}Content-Length: -1\r\n"), 400),
        (format!("{KNOWN}Content-Length: 1\r\nContent-Length: 1\r\n"), 400),
        (format!("{KNOWN}Transfer-Encoding: chunked\r\n"), 501),
        (format!("a b: c\r\n{KNOWN}"), 400),
        (format!("a: \u{1}\r\n{KNOWN}"), 400),
        (format!("folded\r\n{KNOWN}"), 400),
        (format!("a: {}\r\n{KNOWN}", "x".repeat(20_000)), 431),
    ] {
        let found = post(&headers);
        assert!(
            found.starts_with(&format!("HTTP/1.1 {status} ")) && found.contains("Connection: close"),
            "{headers}: {found}"
        );
    }
    for (first, status) in [
        ("GET", 400),
        ("GET  / HTTP/1.1", 400),
        ("get / HTTP/1.1", 400),
        ("GET / HTTP/2", 505),
        ("GET x HTTP/1.1", 400),
    ] {
        assert!(
            sent(&listener, format!("{first}\r\n{KNOWN}\r\n").as_bytes()).contains(&format!(" {status} ")),
            "{first}"
        );
    }
    listener.close(Duration::ZERO);
}

/// Random bytes, requests with bytes changed, left out and put in: the server answers or closes, and then answers what
/// is asked.
#[test]
fn raw_bytes_never_stop_the_server() {
    let listener = start();
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
        let mut stream = TcpStream::connect(listener.address).unwrap();
        let _ = stream.write_all(&bytes);
        drop(stream);
    }
    assert!(sent(&listener, &good).ends_with("/a hello"));
    listener.close(Duration::ZERO);
}

/// Clients that send nothing, or half of a head, or a body slowly, keep no other waiting.
#[test]
fn slow_connections_keep_nobody_waiting_and_do_not_outlive_the_server() {
    let listener = start();
    let slow: Vec<TcpStream> = (0..2 * MOST_CONNECTIONS)
        .map(|number| {
            let mut stream = TcpStream::connect(listener.address).unwrap();
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
    assert!(sent(&listener, last.as_bytes()).ends_with("/b "));
    assert!(listener.shared.open().len() <= MOST_CONNECTIONS);
    listener.close(Duration::ZERO);
    for mut stream in slow {
        // Each has ended: there is an end of it, or it was reset.
        stream.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        let ended = stream.read_to_end(&mut Vec::new()).map_err(|error| error.kind());
        assert!(!matches!(ended, Err(ErrorKind::WouldBlock | ErrorKind::TimedOut)), "it is still open");
    }
}
