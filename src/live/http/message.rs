//! Requests and answers as they are written in HTTP.

/// The longest body that is read: a placement whose axes move from point to point has megabytes. Bytes
const LONGEST_BODY: usize = 16_000_000;

/// The head of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::live) struct Head {
    /// The method, as it is written.
    pub method: String,
    /// Path and query.
    pub url: String,
    headers: Vec<(String, String)>,
}

/// An answer of the server.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::live) struct Answer {
    pub status: u16,
    pub kind: &'static str,
    /// Headers that other answers do not have.
    pub more: Vec<(&'static str, String)>,
    pub body: Vec<u8>,
}

/// What a connection is told of a request that is none, or that is not read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::live) struct Refused(pub u16, pub &'static str);

impl Head {
    /// The head of a request without the empty line at its end.
    pub fn parse(bytes: &[u8]) -> Result<Self, Refused> {
        let wrong = |what| Refused(400, what);
        let text = std::str::from_utf8(bytes).map_err(|_| wrong("the head is no text"))?;
        let mut lines = text.split("\r\n");
        let first = lines.next().unwrap_or_default();
        let mut words = first.split(' ');
        let (Some(method), Some(url), Some(version), None) = (words.next(), words.next(), words.next(), words.next())
        else {
            return Err(wrong("the first line is no method, address and version"));
        };
        let is_method = !method.is_empty() && method.chars().all(|c| c.is_ascii_uppercase());
        if !is_method || !url.starts_with('/') || !url.chars().all(|c| c.is_ascii_graphic()) {
            return Err(wrong("the first line is no method, address and version"));
        }
        if !["HTTP/1.0", "HTTP/1.1"].contains(&version) {
            return Err(Refused(505, "the version is not HTTP/1.1"));
        }
        let mut headers = Vec::new();
        for line in lines {
            let (name, value) = line.split_once(':').ok_or(wrong("a header has no colon"))?;
            let is_of_name = |c: char| c.is_ascii_alphanumeric() || ['-', '_'].contains(&c);
            let value = value.trim_matches([' ', '\t']);
            if name.is_empty() || !name.chars().all(is_of_name) || value.chars().any(char::is_control) {
                return Err(wrong("a header has other characters than it may"));
            }
            headers.push((name.to_ascii_lowercase(), value.to_owned()));
        }
        let head = Self { method: method.to_owned(), url: url.to_owned(), headers };
        for once in ["host", "origin", "content-length", "x-stead-token"] {
            if head.headers.iter().filter(|(name, _)| name == once).count() > 1 {
                return Err(wrong("a header is there twice"));
            }
        }
        Ok(head)
    }

    /// The value of a header, by its name in small letters.
    pub fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// How long the body is that it announces.
    pub fn body_length(&self) -> Result<usize, Refused> {
        if self.header("transfer-encoding").is_some() {
            return Err(Refused(501, "bodies in chunks are not read; allowed: a body with its length"));
        }
        let Some(length) = self.header("content-length") else { return Ok(0) };
        let is_number = !length.is_empty() && length.chars().all(|c| c.is_ascii_digit());
        if !is_number {
            return Err(Refused(400, "the length of the body is no number"));
        }
        // A number that does not fit is too long as well.
        let length = length.parse().unwrap_or(usize::MAX);
        let too_long = Refused(413, "the body is too long; allowed: 16000000 bytes");
        if length <= LONGEST_BODY { Ok(length) } else { Err(too_long) }
    }

    /// Whether the connection ends with the answer.
    pub fn is_last(&self) -> bool {
        self.header("connection").is_some_and(|value| value.to_ascii_lowercase().contains("close"))
    }
}

impl Answer {
    /// As it goes over the line: in one piece, since in two the second waits some 40 ms until the first is
    /// acknowledged.
    pub fn bytes(self, method: &str, is_last: bool) -> Vec<u8> {
        let Self { status, kind, more, body } = self;
        let reason = REASONS.iter().find(|(known, _)| *known == status).map_or("", |(_, reason)| *reason);
        let mut head =
            format!("HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\n", body.len());
        let own = |name: &str| more.iter().any(|(known, _)| *known == name);
        let common = HEADERS.iter().filter(|(name, _)| !own(name)).map(|(name, value)| (*name, (*value).to_owned()));
        for (name, value) in common.chain(more.iter().cloned()) {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        head.push_str(if is_last { "Connection: close\r\n\r\n" } else { "\r\n" });
        let mut bytes = head.into_bytes();
        if method != "HEAD" {
            bytes.extend(body);
        }
        bytes
    }
}

const REASONS: [(u16, &str); 12] = [
    (200, "OK"),
    (303, "See Other"),
    (400, "Bad Request"),
    (403, "Forbidden"),
    (404, "Not Found"),
    (405, "Method Not Allowed"),
    (408, "Request Timeout"),
    (413, "Content Too Large"),
    (431, "Request Header Fields Too Large"),
    (500, "Internal Server Error"),
    (501, "Not Implemented"),
    (505, "HTTP Version Not Supported"),
];

/// What every answer says: it is for this page alone, and not to be kept. The page itself states what it may load.
pub(super) const HEADERS: [(&str, &str); 6] = [
    ("Cache-Control", "no-store"),
    ("X-Content-Type-Options", "nosniff"),
    ("Referrer-Policy", "no-referrer"),
    ("X-Frame-Options", "DENY"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    ("Content-Security-Policy", "frame-ancestors 'none'"),
];
