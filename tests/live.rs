//! `stead live` from outside: what its server answers, to whom, and what is left when it ends.

use crate::common::{Bench, Ended, RUN};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};

/// A session that runs, ended with the test.
struct Live {
    child: Child,
    port: u16,
    token: String,
}

impl Live {
    fn start(bench: &Bench, more: &[&str]) -> Self {
        let arguments = [&["live", RUN, "--no-open", "--out", "out"], more].concat();
        let mut command = bench.command(&arguments);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        let (_, rest) = line.trim().split_once("http://127.0.0.1:").unwrap_or_else(|| panic!("{line}"));
        let (port, token) = rest.split_once("/?token=").unwrap();
        Self { port: port.parse().unwrap(), token: token.to_owned(), child }
    }

    /// A request with headers of its own; status, headers and body of the answer.
    fn raw(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> (u16, String, String) {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        let headers: String = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
        let length = body.len();
        let head =
            format!("{method} {path} HTTP/1.1\r\n{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n");
        stream.write_all(format!("{head}{body}").as_bytes()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.split(' ').nth(1).unwrap().parse().unwrap(), head.to_owned(), body.to_owned())
    }

    /// As the page asks.
    fn post(&self, path: &str, body: &str) -> (u16, Value) {
        let host = format!("127.0.0.1:{}", self.port);
        let origin = format!("http://{host}");
        let headers = [("Host", host.as_str()), ("Origin", &origin), ("X-Stead-Token", &self.token)];
        let (status, _, body) = self.raw("POST", path, &headers, body);
        (status, serde_json::from_str(&body).unwrap_or(Value::Null))
    }

    fn get(&self, path: &str) -> (u16, String, String) {
        let host = format!("127.0.0.1:{}", self.port);
        self.raw("GET", path, &[("Host", &host), ("X-Stead-Token", &self.token)], "")
    }

    /// Ctrl-C, and what the command said.
    #[cfg(unix)]
    fn interrupted(self) -> Ended {
        self.ended_by("-INT")
    }

    /// A signal, and what the command said.
    #[cfg(unix)]
    fn ended_by(mut self, signal: &str) -> Ended {
        let id = self.child.id().to_string();
        assert!(std::process::Command::new("kill").args([signal, &id]).status().unwrap().success());
        let mut ended = Ended { code: self.child.wait().unwrap().code(), stdout: String::new(), stderr: String::new() };
        self.child.stderr.take().unwrap().read_to_string(&mut ended.stderr).unwrap();
        ended
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        // One that has ended already is no error.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn place(id: usize, y_mm: f64) -> String {
    json!({ "page": "test", "id": id, "x_mm": 0, "y_mm": y_mm, "z_mm": -214, "yaw_deg": 79 }).to_string()
}

#[test]
fn only_who_knows_the_token_and_comes_from_the_page_is_answered() {
    let bench = Bench::new();
    let live = Live::start(&bench, &[]);
    let own = format!("127.0.0.1:{}", live.port);
    let origin = format!("http://{own}");
    let token = live.token.as_str();
    let ask = |headers: &[(&str, &str)]| live.raw("POST", "/whole", headers, &place(1, -1640.0));
    for headers in [
        vec![("Host", own.as_str())],
        vec![("Host", &own), ("X-Stead-Token", "0")],
        vec![("Host", "evil.example"), ("X-Stead-Token", token)],
        vec![("Host", &own), ("Origin", "http://evil.example"), ("X-Stead-Token", token)],
        vec![("Host", &own), ("Origin", "null"), ("X-Stead-Token", token)],
    ] {
        let (status, _, body) = ask(&headers);
        assert!(status == 403 && body.contains("; allowed: the address that"), "{headers:?}: {status} {body}");
    }
    for path in ["/", "/?token=0", "/state", "/kept/placement-1/setup.svg"] {
        assert_eq!(live.raw("GET", path, &[("Host", &own)], "").0, 403, "{path}");
    }
    // Nothing was computed: the place at rest is what is written first.
    assert!(!bench.path("out/live.json").exists());
    assert_eq!(ask(&[("Host", &own), ("Origin", &origin), ("X-Stead-Token", token)]).0, 200);
    assert!(bench.path("out/live.json").exists());
    // The address with the token leads to one without it, and leaves a cookie that no script reads.
    let (status, head, page) = live.raw("GET", &format!("/?token={token}"), &[("Host", &own)], "");
    let cookie = format!("stead-{}={token}", live.port);
    assert!(status == 303 && page.is_empty() && head.contains("location: /\r\n"), "{status} {head}");
    assert!(head.contains(&format!("set-cookie: {cookie}; HttpOnly; SameSite=Strict; Path=/\r\n")), "{head}");
    let (status, head, page) = live.raw("GET", "/", &[("Host", &own), ("Cookie", &cookie)], "");
    assert!(status == 200 && !page.contains(token));
    assert_eq!(ask(&[("Host", &own), ("Cookie", &cookie)]).0, 403);
    assert_eq!(ask(&[("Host", &own), ("Origin", &origin), ("Cookie", &cookie)]).0, 200);
    for part in ["cache-control: no-store", "referrer-policy: no-referrer", "frame-ancestors 'none'"] {
        assert!(head.contains(part), "{part} in {head}");
    }
    assert!(page.contains("default-src 'none'; script-src 'sha256-") && page.contains("connect-src 'self'"));
    for path in
        ["/kept/../run.toml", "/kept/placement-1/..%2Flive.json", "/kept/placement-1/.stead.lock", "/kept//", "/none"]
    {
        assert_eq!(live.get(path).0, 404, "{path}");
    }
    assert_eq!(live.raw("DELETE", "/", &[("Host", &own), ("X-Stead-Token", token)], "").0, 405);
}

#[test]
fn a_body_that_is_wrong_is_refused_with_its_field() {
    let bench = Bench::new();
    let live = Live::start(&bench, &[]);
    for (body, field, part) in [
        ("", "body", "is not readable as JSON"),
        ("{", "body", "is not readable as JSON"),
        ("[]", "body", "is no JSON object"),
        ("{\"page\":\"a\",\"id\":1,\"x_mm\":NaN}", "x_mm", "is not readable as JSON"),
        ("{\"page\":\"a\",\"id\":1,\"x_mm\":1e999}", "x_mm", "out of range"),
        ("{\"page\":\"a\",\"id\":1,\"x_mm\":null}", "x_mm", "is no such number, found null"),
        ("{\"page\":\"a\",\"id\":-1,\"x_mm\":0,\"y_mm\":0,\"z_mm\":0,\"yaw_deg\":0}", "id", "found -1"),
        ("{\"id\":1,\"x_mm\":0,\"y_mm\":0,\"z_mm\":0,\"yaw_deg\":0}", "page", "is no such text"),
        (
            "{\"page\":\"a\\u202eb\",\"id\":1,\"x_mm\":0,\"y_mm\":0,\"z_mm\":0,\"yaw_deg\":0}",
            "page",
            "a mark of writing direction",
        ),
        (
            "{\"page\":\"a\\u0007b\",\"id\":1,\"x_mm\":0,\"y_mm\":0,\"z_mm\":0,\"yaw_deg\":0}",
            "page",
            "a control character",
        ),
    ] {
        let (status, answer) = live.post("/preview", body);
        assert_eq!((status, &answer["field"]), (400, &field.into()), "{body}: {answer}");
        assert!(answer["error"].as_str().unwrap().contains(part), "{answer}");
    }
    let (status, answer) = live.post("/save", &json!({ "name": "run.toml" }).to_string());
    assert!(status == 400 && answer["error"].as_str().unwrap().contains("is there already"), "{answer}");
    assert_eq!(live.post("/preview", &place(1, -1640.0)).0, 200);
}

#[test]
fn a_folder_and_a_port_are_of_one_session() {
    let bench = Bench::new();
    let live = Live::start(&bench, &[]);
    let second = bench.stead(&["live", RUN, "--no-open", "--out", "out"]);
    assert_eq!((second.code, second.stdout.as_str()), (Some(1), ""), "{}", second.stderr);
    second.assert_says(&["out: results cannot be written here: another run of stead"]);
    let port = live.port.to_string();
    let taken = bench.stead(&["live", RUN, "--no-open", "--out", "other", "--port", &port]);
    assert_eq!((taken.code, taken.stdout.as_str()), (Some(2), ""), "{}", taken.stderr);
    taken.assert_says(&[
        &format!("error: --port: port {port} of 127.0.0.1 cannot be used: "),
        "; allowed: a port that is free",
    ]);
    assert!(!bench.path("other").exists());
    let nowhere = bench.stead(&["live", "nowhere.toml", "--no-open"]);
    assert_eq!(nowhere.code, Some(2));
    assert!(!bench.path("results").exists());
}

/// Requests that announce more than there is room for, that stall, and folders that somebody else has made, do nothing
/// to a session; it ends by SIGTERM as by Ctrl-C, whoever is still connected.
#[test]
#[cfg(unix)]
fn nobody_else_stops_a_session_or_reads_beyond_its_folder() {
    let bench = Bench::new();
    let live = Live::start(&bench, &[]);
    let begun = |text: &str| {
        let mut stream = TcpStream::connect(("127.0.0.1", live.port)).unwrap();
        stream.write_all(text.as_bytes()).unwrap();
        stream
    };
    let mut large = begun("POST /job HTTP/1.1\r\nContent-Length: 60000000000\r\n\r\n");
    let mut answer = String::new();
    large.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 413 ") && answer.contains("connection: close"), "{answer}");
    let token = &live.token;
    let slow = format!(
        "POST /whole HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nX-Stead-Token: {token}\r\nContent-Length: 90\r\n\r\n{{",
        live.port
    );
    let _stalled: Vec<TcpStream> = (0..64).map(|number| begun(["GET / HT", &slow][number % 2])).collect();
    assert_eq!(live.get("/state").0, 200);
    let kept = |name: &str| live.get(&format!("/kept/placement-1/{name}"));
    bench.write("out/placement-1/score.json", "{}");
    bench.write("out/placement-1/setup.svg", "<svg/>");
    bench.write("out/placement-1/report.html", "<p>");
    bench.write("secret.csv", "mine");
    std::os::unix::fs::symlink(bench.path("secret.csv"), bench.path("out/placement-1/best.csv")).unwrap();
    std::os::unix::fs::symlink(bench.path("out/placement-1"), bench.path("out/placement-2")).unwrap();
    assert_eq!((kept("best.csv").0, live.get("/kept/placement-2/score.json").0), (404, 404));
    let policy = |name: &str, policy: &str| {
        let (status, head, _) = kept(name);
        let all: Vec<&str> = head.lines().filter(|line| line.starts_with("content-security-policy: ")).collect();
        assert!(status == 200 && all.len() == 1 && all[0].contains(policy), "{name}: {head}");
    };
    policy("score.json", "sandbox; default-src 'none'");
    policy("setup.svg", "sandbox; default-src 'none'");
    policy("report.html", "sandbox allow-scripts");
    let ended = live.ended_by("-TERM");
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
}

#[test]
#[cfg(unix)]
fn a_page_that_goes_away_leaves_its_search_and_ctrl_c_keeps_what_it_has() {
    let bench = Bench::new();
    bench.replace(RUN, "generations = 3", "generations = 100000");
    let live = Live::start(&bench, &[]);
    let mut job: Value = serde_json::from_str(&place(1, -1640.0)).unwrap();
    job["job"] = "search_cell".into();
    assert_eq!(live.post("/job", &job.to_string()).0, 200);
    // Nobody listens; the search goes on, and is seen by the next page.
    let running = (0..200).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(50));
        let state: Value = serde_json::from_str(&live.get("/state").2).unwrap();
        state["jobs"]["running"]["done"].as_u64().filter(|done| *done > 1)
    });
    assert!(running.is_some());
    let ended = live.interrupted();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    // What it had found by then is kept.
    let score: Value = serde_json::from_str(&bench.read("out/placement-1/score.json")).unwrap();
    assert!(score["feasible"] == true && score["best"]["mean_mm"].as_f64().unwrap() > 0.0);
    assert!(!bench.path("out/.stead.lock").exists());
    let again = Live::start(&bench, &[]);
    let state: Value = serde_json::from_str(&again.get("/state").2).unwrap();
    assert_eq!(state["pins"][0]["name"], "placement-1");
}

#[test]
#[cfg(target_os = "linux")]
fn of_many_requests_the_newest_is_answered_and_memory_stays() {
    let bench = Bench::new();
    let live = Live::start(&bench, &[]);
    let resident = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", live.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS:")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap()
    };
    let flood = |from: usize, count: usize| {
        let answered = std::sync::Mutex::new(Vec::new());
        std::thread::scope(|scope| {
            for worker in 0..8 {
                let (live, answered) = (&live, &answered);
                scope.spawn(move || {
                    for k in (worker..count).step_by(8) {
                        let (status, answer) = live.post("/preview", &place(from + k, -1640.0 - k as f64 / 10.0));
                        assert_eq!(status, 200);
                        let expected = json!(from + k);
                        assert!(answer["is_superseded"] == true || answer["id"] == expected, "{answer}");
                        answered.lock().unwrap().push((from + k, answer["id"].is_number()));
                    }
                });
            }
        });
        answered.into_inner().unwrap()
    };
    flood(0, 400);
    let before = resident();
    let answered = flood(1000, 1200);
    assert_eq!(answered.len(), 1200);
    assert!(answered.iter().any(|(_, is_answered)| *is_answered));
    let after = resident();
    assert!(after < before + 20_000, "{before} kB before, {after} kB after");
}
