//! What the page asks for, by method and path, and who may ask: only the page itself, which knows the token and comes
//! from this server.

use super::http::{Answer, Head};
use super::pins;
use super::requests::RequestError;
use super::session::Session;
use serde_json::{Value, json};
use std::sync::Arc;

const JSON: &str = "application/json; charset=utf-8";
const HTML: &str = "text/html; charset=utf-8";

impl Answer {
    fn new(status: u16, kind: &'static str, body: Vec<u8>) -> Self {
        Self { status, kind, more: Vec::new(), body }
    }

    fn json(status: u16, value: &Value) -> Self {
        Self::new(status, JSON, value.to_string().into_bytes())
    }

    /// Something that is not done, and why.
    pub fn error(status: u16, message: &str) -> Self {
        Self::json(status, &json!({ "error": message }))
    }
}

/// Who may ask: the page of this server, opened with the token.
#[derive(Debug, Clone)]
pub(super) struct Guard {
    pub port: u16,
    pub token: String,
}

impl Guard {
    /// What a request that may not be answered is told; nothing where it may. The token comes in the cookie that the
    /// first address sets, or in a header, from what is no page.
    pub fn refuses(&self, head: &Head) -> Option<Answer> {
        let own = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let is_own = |host: &str| own.iter().any(|own| own == host);
        let forbidden =
            |what: &str| Some(Answer::error(403, &format!("{what}; allowed: the address that `stead live` has said")));
        if !head.header("host").is_some_and(is_own) {
            return forbidden("the request is for another host");
        }
        let is_foreign = |origin: &str| !origin.strip_prefix("http://").is_some_and(is_own);
        if head.header("origin").is_some_and(is_foreign) {
            return forbidden("the request comes from another page");
        }
        let is_known = |token: &str| is_same(token, &self.token);
        let is_cookie_known = self.cookie_of(head).is_some_and(is_known);
        let is_from_page = head.method == "GET" || head.header("origin").is_some();
        let is_allowed = head.header("x-stead-token").is_some_and(is_known)
            || (is_cookie_known && is_from_page)
            || self.is_opening(head);
        if is_allowed { None } else { forbidden("the token is missing or wrong") }
    }

    /// Whether a request opens the address with the token, which is then kept in a cookie.
    fn is_opening(&self, head: &Head) -> bool {
        let in_address = || query(&head.url, "token").is_some_and(|token| is_same(token, &self.token));
        head.method == "GET" && head.url.starts_with("/?") && in_address()
    }

    /// The name of the cookie: that of another session on this machine has another one.
    fn cookie(&self) -> String {
        format!("stead-{}", self.port)
    }

    fn cookie_of<'h>(&self, head: &'h Head) -> Option<&'h str> {
        let name = self.cookie();
        head.header("cookie")?.split(';').find_map(|part| part.trim().strip_prefix(&name)?.strip_prefix('='))
    }

    /// Leads to the page at an address without the token.
    fn opened(&self) -> Answer {
        let cookie = format!("{}={}; HttpOnly; SameSite=Strict; Path=/", self.cookie(), self.token);
        let more = vec![("Location", "/".to_owned()), ("Set-Cookie", cookie)];
        Answer { more, ..Answer::new(303, "text/plain; charset=utf-8", Vec::new()) }
    }
}

/// Whether two texts are the same, in a time that does not say where they differ.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differing, (a, b)| differing | (a ^ b)) == 0
}

/// The value of a key in the query of an address.
fn query<'a>(url: &'a str, key: &str) -> Option<&'a str> {
    let (_, query) = url.split_once('?')?;
    query.split('&').find_map(|part| part.strip_prefix(key)?.strip_prefix('='))
}

/// Answers a request that may ask.
pub(super) fn answer(session: &Arc<Session>, guard: &Guard, head: &Head, body: &[u8]) -> Answer {
    let path = head.url.split('?').next().unwrap_or_default();
    let done = |result: Result<Value, RequestError>| match result {
        Ok(value) => Answer::json(200, &value),
        Err(error) => Answer::json(400, &json!({ "error": error.to_string(), "field": error.field })),
    };
    match (head.method.as_str(), path) {
        _ if guard.is_opening(head) => guard.opened(),
        ("GET", "/") => match session.page() {
            Ok(page) => Answer::new(200, HTML, page),
            Err(error) => Answer::error(500, &error.to_string()),
        },
        ("GET", "/state") => Answer::json(200, &session.state()),
        ("GET", path) if path.starts_with("/kept/") => kept(session, path),
        ("POST", "/preview") => done(session.preview(body)),
        ("POST", "/whole") => done(session.whole(body)),
        ("POST", "/map") => done(session.map(body)),
        ("POST", "/job") => done(session.begin(body)),
        ("POST", "/stop") => Answer::json(200, &session.stop()),
        ("POST", "/edit") => done(session.edit(body)),
        ("POST", "/save") => done(session.save(body)),
        ("GET" | "POST", _) => Answer::error(404, "there is no such address"),
        _ => Answer::error(405, "the method is none of GET and POST"),
    }
}

/// A file of a kept placement: `/kept/placement-1/setup.svg`.
fn kept(session: &Session, path: &str) -> Answer {
    let mut parts = path.trim_start_matches("/kept/").split('/');
    let names = (parts.next(), parts.next(), parts.next());
    let found = match names {
        (Some(pin), Some(name), None) => pins::file(session.folder(), pin, name).map(|body| (name, body)),
        _ => None,
    };
    let Some((name, body)) = found else { return Answer::error(404, "no placement that is kept has such a file") };
    // What somebody else may have put there can do nothing in the session: it is of no origin, and pictures load and
    // run nothing.
    let (kind, policy) = match name.rsplit_once('.').map(|(_, ending)| ending) {
        Some("html") => (HTML, "sandbox allow-scripts allow-downloads; frame-ancestors 'none'"),
        Some("svg") => ("image/svg+xml", "sandbox; default-src 'none'; style-src 'unsafe-inline'"),
        Some("json") => (JSON, "sandbox; default-src 'none'"),
        Some("csv") => ("text/csv; charset=utf-8", "sandbox; default-src 'none'"),
        _ => ("application/octet-stream", "sandbox; default-src 'none'"),
    };
    Answer { more: vec![("Content-Security-Policy", policy.to_owned())], ..Answer::new(200, kind, body) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(method: &str, url: &str, headers: &[(&str, &str)]) -> Head {
        let headers: String = headers.iter().map(|(name, value)| format!("\r\n{name}: {value}")).collect();
        Head::parse(format!("{method} {url} HTTP/1.1{headers}").as_bytes()).unwrap()
    }

    #[test]
    fn only_the_page_of_this_server_may_ask() {
        let guard = Guard { port: 4711, token: "secret".to_owned() };
        let (host, origin) = (("Host", "127.0.0.1:4711"), ("Origin", "http://127.0.0.1:4711"));
        let (token, cookie) = (("X-Stead-Token", "secret"), ("Cookie", "a=b; stead-4711=secret"));
        for allowed in [
            head("POST", "/preview", &[host, origin, token]),
            head("POST", "/preview", &[("Host", "localhost:4711"), token]),
            head("POST", "/preview", &[host, origin, cookie]),
            head("GET", "/state", &[host, cookie]),
            head("GET", "/?a=b&token=secret", &[host]),
        ] {
            assert_eq!(guard.refuses(&allowed), None, "{allowed:?}");
        }
        for foreign in [
            head("POST", "/preview", &[token]),
            head("POST", "/preview", &[("Host", "127.0.0.1"), token]),
            head("POST", "/preview", &[("Host", "evil.example:4711"), token]),
            head("POST", "/preview", &[host, ("Origin", "http://evil.example"), token]),
            head("POST", "/preview", &[host, ("Origin", "null"), cookie]),
            head("POST", "/preview", &[host, ("Origin", "https://127.0.0.1:4711"), token]),
            head("POST", "/preview", &[host, ("Origin", "http://127.0.0.1:4712"), cookie]),
            head("POST", "/preview", &[host, cookie]),
            head("POST", "/preview", &[host, origin]),
            head("POST", "/preview", &[host, origin, ("X-Stead-Token", "secreT")]),
            head("POST", "/preview", &[host, origin, ("X-Stead-Token", "")]),
            head("POST", "/preview", &[host, origin, ("Cookie", "stead-4712=secret")]),
            head("POST", "/preview", &[host, origin, ("Cookie", "stead-4711=secret2")]),
            head("GET", "/?token=", &[host]),
            head("GET", "/?tokens=secret", &[host]),
            head("GET", "/state?token=secret", &[host]),
            head("POST", "/?token=secret", &[host, origin]),
        ] {
            assert_eq!(guard.refuses(&foreign).map(|answer| answer.status), Some(403), "{foreign:?}");
        }
        let opened = guard.opened();
        assert!(opened.status == 303 && opened.more.contains(&("Location", "/".to_owned())));
    }
}
