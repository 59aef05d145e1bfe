//! What the page asks for, by method and path, and who may ask: only the page itself, which knows the token and comes
//! from this server.

use super::http::{Answer, Head, JSON, answer_of, error, json_of};
use super::pins;
use super::requests::RequestError;
use super::session::Session;
use hyper::StatusCode;
use hyper::header::{CONTENT_SECURITY_POLICY, HeaderValue, LOCATION, SET_COOKIE};
use serde_json::{Value, json};
use std::sync::Arc;

const HTML: &str = "text/html; charset=utf-8";

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
        let forbidden = |what: &str| {
            Some(error(StatusCode::FORBIDDEN, &format!("{what}; allowed: the address that `stead live` has said")))
        };
        if !header(head, "host").is_some_and(is_own) {
            return forbidden("the request is for another host");
        }
        let is_origin =
            |value: &HeaderValue| value.to_str().is_ok_and(|origin| origin.strip_prefix("http://").is_some_and(is_own));
        let mut origins = head.headers.get_all("origin").iter();
        if !origins.all(is_origin) {
            return forbidden("the request comes from another page");
        }
        let is_known = |token: &str| is_same(token, &self.token);
        let is_cookie_known = self.cookie_of(head).is_some_and(is_known);
        let is_from_page = head.method == "GET" || head.headers.contains_key("origin");
        let is_allowed = header(head, "x-stead-token").is_some_and(is_known)
            || (is_cookie_known && is_from_page)
            || self.is_opening(head);
        if is_allowed { None } else { forbidden("the token is missing or wrong") }
    }

    /// Whether a request opens the address with the token, which is then kept in a cookie.
    fn is_opening(&self, head: &Head) -> bool {
        let in_address = || query(head, "token").is_some_and(|token| is_same(token, &self.token));
        head.method == "GET" && head.uri.path() == "/" && in_address()
    }

    /// The name of the cookie: that of another session on this machine has another one.
    fn cookie(&self) -> String {
        format!("stead-{}", self.port)
    }

    fn cookie_of<'h>(&self, head: &'h Head) -> Option<&'h str> {
        let name = self.cookie();
        header(head, "cookie")?.split(';').find_map(|part| part.trim().strip_prefix(&name)?.strip_prefix('='))
    }

    /// Leads to the page at an address without the token.
    fn opened(&self) -> Answer {
        let cookie = format!("{}={}; HttpOnly; SameSite=Strict; Path=/", self.cookie(), self.token);
        let mut answer = answer_of(StatusCode::SEE_OTHER, "text/plain; charset=utf-8", Vec::new());
        answer.headers_mut().insert(LOCATION, HeaderValue::from_static("/"));
        answer.headers_mut().extend(HeaderValue::try_from(cookie).map(|cookie| (SET_COOKIE, cookie)));
        answer
    }
}

/// Whether two texts are the same, in a time that does not say where they differ.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differing, (a, b)| differing | (a ^ b)) == 0
}

/// The value of a header that is there once.
fn header<'h>(head: &'h Head, name: &str) -> Option<&'h str> {
    let mut values = head.headers.get_all(name).iter();
    let value = values.next()?;
    if values.next().is_some() { None } else { value.to_str().ok() }
}

/// The value of a key in the query of an address.
fn query<'h>(head: &'h Head, key: &str) -> Option<&'h str> {
    head.uri.query()?.split('&').find_map(|part| part.strip_prefix(key)?.strip_prefix('='))
}

/// Answers a request that may ask.
pub(super) fn answer(session: &Arc<Session>, guard: &Guard, head: &Head, body: &[u8]) -> Answer {
    let done = |result: Result<Value, RequestError>| match result {
        Ok(value) => json_of(StatusCode::OK, &value),
        Err(error) => json_of(StatusCode::BAD_REQUEST, &json!({ "error": error.to_string(), "field": error.field })),
    };
    match (head.method.as_str(), head.uri.path()) {
        _ if guard.is_opening(head) => guard.opened(),
        ("GET", "/") => match session.page() {
            Ok(page) => answer_of(StatusCode::OK, HTML, page),
            Err(cause) => error(StatusCode::INTERNAL_SERVER_ERROR, &cause.to_string()),
        },
        ("GET", "/state") => json_of(StatusCode::OK, &session.state()),
        ("GET", path) if path.starts_with("/kept/") => kept(session, path),
        ("POST", "/preview") => done(session.preview(body)),
        ("POST", "/whole") => done(session.whole(body)),
        ("POST", "/map") => done(session.map(body)),
        ("POST", "/job") => done(session.begin(body)),
        ("POST", "/stop") => json_of(StatusCode::OK, &session.stop()),
        ("POST", "/edit") => done(session.edit(body)),
        ("POST", "/save") => done(session.save(body)),
        ("GET" | "POST", _) => error(StatusCode::NOT_FOUND, "there is no such address"),
        _ => error(StatusCode::METHOD_NOT_ALLOWED, "the method is none of GET and POST"),
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
    let Some((name, body)) = found else {
        return error(StatusCode::NOT_FOUND, "no placement that is kept has such a file");
    };
    // What somebody else may have put there can do nothing in the session: it is of no origin, and pictures load and
    // run nothing.
    let (kind, policy) = match name.rsplit_once('.').map(|(_, ending)| ending) {
        Some("html") => (HTML, "sandbox allow-scripts allow-downloads; frame-ancestors 'none'"),
        Some("svg") => ("image/svg+xml", "sandbox; default-src 'none'; style-src 'unsafe-inline'"),
        Some("json") => (JSON, "sandbox; default-src 'none'"),
        Some("csv") => ("text/csv; charset=utf-8", "sandbox; default-src 'none'"),
        _ => ("application/octet-stream", "sandbox; default-src 'none'"),
    };
    let mut answer = answer_of(StatusCode::OK, kind, body);
    answer.headers_mut().insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(policy));
    answer
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(method: &str, url: &str, headers: &[(&str, &str)]) -> Head {
        let request = hyper::Request::builder().method(method).uri(url);
        let request = headers.iter().fold(request, |request, (name, value)| request.header(*name, *value));
        request.body(()).unwrap().into_parts().0
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
            assert!(guard.refuses(&allowed).is_none(), "{allowed:?}");
        }
        for foreign in [
            head("POST", "/preview", &[token]),
            head("POST", "/preview", &[host, host, token]),
            head("POST", "/preview", &[host, origin, ("Origin", "http://evil.example"), cookie]),
            head("POST", "/preview", &[host, origin, token, ("X-Stead-Token", "other")]),
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
            assert_eq!(
                guard.refuses(&foreign).map(|answer| answer.status()),
                Some(StatusCode::FORBIDDEN),
                "{foreign:?}"
            );
        }
        let opened = guard.opened();
        assert!(opened.status() == StatusCode::SEE_OTHER && opened.headers()[LOCATION] == "/");
    }
}
