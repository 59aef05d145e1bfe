//! What the page asks for, by method and path, and who may ask: only the page itself, which knows the token and comes
//! from this server.

use super::pins;
use super::requests::RequestError;
use super::session::Session;
use serde_json::{Value, json};
use std::sync::Arc;

/// What is looked at of a request before anything is done.
#[derive(Debug, Clone, Default)]
pub(super) struct Asking {
    pub method: String,
    /// Path and query.
    pub url: String,
    pub host: Option<String>,
    pub origin: Option<String>,
    /// The token of the header.
    pub token: Option<String>,
}

/// An answer of the server.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Answer {
    pub status: u16,
    pub kind: &'static str,
    pub body: Vec<u8>,
}

const JSON: &str = "application/json; charset=utf-8";
const HTML: &str = "text/html; charset=utf-8";

impl Answer {
    fn json(status: u16, value: &Value) -> Self {
        Self { status, kind: JSON, body: value.to_string().into_bytes() }
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
    /// What a request that may not be answered is told; nothing where it may.
    pub fn refuses(&self, asking: &Asking) -> Option<Answer> {
        let own = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let is_own = |host: &str| own.iter().any(|own| own == host);
        let forbidden =
            |what: &str| Some(Answer::error(403, &format!("{what}; allowed: the address that `stead live` has said")));
        if !asking.host.as_deref().is_some_and(is_own) {
            return forbidden("the request is for another host");
        }
        let is_foreign = |origin: &str| !origin.strip_prefix("http://").is_some_and(is_own);
        if asking.origin.as_deref().is_some_and(is_foreign) {
            return forbidden("the request comes from another page");
        }
        let in_address = query(&asking.url, "token");
        let token = asking.token.as_deref().or(in_address.filter(|_| asking.method == "GET"));
        if !token.is_some_and(|token| is_same(token, &self.token)) {
            return forbidden("the token is missing or wrong");
        }
        None
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

/// Whether a request has a body that is read.
pub(super) fn has_body(asking: &Asking) -> bool {
    asking.method == "POST"
}

/// Answers a request that may ask.
pub(super) fn answer(session: &Arc<Session>, guard: &Guard, asking: &Asking, body: &[u8]) -> Answer {
    let path = asking.url.split('?').next().unwrap_or_default();
    let done = |result: Result<Value, RequestError>| match result {
        Ok(value) => Answer::json(200, &value),
        Err(error) => Answer::json(400, &json!({ "error": error.to_string(), "field": error.field })),
    };
    match (asking.method.as_str(), path) {
        ("GET", "/") => match session.page(&guard.token) {
            Ok(page) => Answer { status: 200, kind: HTML, body: page },
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
    let kind = match name.rsplit_once('.').map(|(_, ending)| ending) {
        Some("html") => HTML,
        Some("svg") => "image/svg+xml",
        Some("json") => JSON,
        Some("csv") => "text/csv; charset=utf-8",
        _ => "application/octet-stream",
    };
    Answer { status: 200, kind, body }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_page_of_this_server_may_ask() {
        let guard = Guard { port: 4711, token: "secret".to_owned() };
        let own = Asking {
            method: "POST".to_owned(),
            url: "/preview".to_owned(),
            host: Some("127.0.0.1:4711".to_owned()),
            origin: Some("http://127.0.0.1:4711".to_owned()),
            token: Some("secret".to_owned()),
        };
        assert_eq!(guard.refuses(&own), None);
        assert_eq!(
            guard.refuses(&Asking { host: Some("localhost:4711".to_owned()), origin: None, ..own.clone() }),
            None
        );
        let some = |text: &str| Some(text.to_owned());
        let in_address = |method: &str, url: &str| Asking {
            method: method.to_owned(),
            url: url.to_owned(),
            token: None,
            ..own.clone()
        };
        assert_eq!(guard.refuses(&in_address("GET", "/?a=b&token=secret")), None);
        for foreign in [
            Asking { host: None, ..own.clone() },
            Asking { host: some("127.0.0.1"), ..own.clone() },
            Asking { host: some("evil.example:4711"), ..own.clone() },
            Asking { origin: some("http://evil.example"), ..own.clone() },
            Asking { origin: some("null"), ..own.clone() },
            Asking { origin: some("https://127.0.0.1:4711"), ..own.clone() },
            Asking { origin: some("http://127.0.0.1:4712"), ..own.clone() },
            Asking { token: None, ..own.clone() },
            Asking { token: some("secreT"), ..own.clone() },
            Asking { token: some(""), ..own.clone() },
            Asking { token: some("secret2"), ..own.clone() },
            in_address("GET", "/?token="),
            in_address("GET", "/?tokens=secret"),
            in_address("POST", "/preview?token=secret"),
        ] {
            assert_eq!(guard.refuses(&foreign).map(|answer| answer.status), Some(403), "{foreign:?}");
        }
    }
}
