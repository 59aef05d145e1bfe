//! The text of one TOML file: where its lines are, how it parses, what its bytes hash to.

use crate::input::{InputError, InputFile};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::DeTable;

/// A TOML file read into memory, with its name for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    file: PathBuf,
    text: String,
}

/// The parse tree of a [`Source`], every value with its place in the text.
#[derive(Debug, Clone)]
pub struct Document<'a> {
    pub(super) source: &'a Source,
    pub(super) tree: Spanned<DeTable<'a>>,
}

/// Longest piece of a file that is quoted in a message, in characters.
const QUOTE: usize = 80;

impl Source {
    /// Reads a file.
    ///
    /// # Errors
    /// [`InputError`] when the file cannot be read or is not UTF-8 text.
    pub fn read(file: &Path) -> Result<Self, InputError> {
        let bytes = std::fs::read(file).map_err(|e| {
            InputError::new(file, format!("cannot be read: {e}")).allowed("the name of a readable TOML file")
        })?;
        Self::new(file, bytes)
    }

    /// Takes the bytes of a file already read; `file` is its name in messages.
    ///
    /// # Errors
    /// [`InputError`] at the line of the first byte that is not UTF-8 text.
    pub fn new(file: &Path, bytes: Vec<u8>) -> Result<Self, InputError> {
        let text = String::from_utf8(bytes).map_err(|e| {
            let valid = e.utf8_error().valid_up_to();
            let (before, rest) = e.as_bytes().split_at(valid);
            let error = InputError::new(file, "is not UTF-8 text").at_line(line_after(before)).allowed("UTF-8 text");
            match rest.first() {
                Some(byte) => error.found(format!("byte 0x{byte:02x}")),
                None => error,
            }
        })?;
        Ok(Self { file: file.to_owned(), text })
    }

    /// The file as the user named it.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The text as bytes, exactly as read.
    pub fn bytes(&self) -> &[u8] {
        self.text.as_bytes()
    }

    /// The entry of a config among the files that a result came from: its name alone, wherever it lies.
    pub fn as_config(&self) -> InputFile {
        input_file("config", self.file.file_name().unwrap_or_default().to_string_lossy(), self.bytes())
    }

    /// Parses the text.
    ///
    /// # Errors
    /// [`InputError`] at the line where the text stops being TOML.
    pub fn parse(&self) -> Result<Document<'_>, InputError> {
        let tree = DeTable::parse(&self.text).map_err(|e| {
            let span = e.span().unwrap_or(0..0);
            let line = self.line(span.start);
            InputError::new(&self.file, format!("is not readable as TOML: {}", e.message().trim()))
                .at_line(line)
                .found(format!("'{}'", shorten(self.text.lines().nth(line - 1).unwrap_or_default())))
                .allowed("a TOML file")
        })?;
        Ok(Document { source: self, tree })
    }

    /// The line, from 1, in which a byte of the text stands.
    pub(super) fn line(&self, byte: usize) -> usize {
        line_after(&self.bytes()[..byte.min(self.text.len())])
    }

    /// A piece of the text as written, on one line and cut short if need be.
    pub(super) fn quote(&self, span: Range<usize>) -> String {
        shorten(self.text.get(span).unwrap_or_default())
    }
}

/// The line, from 1, that comes after some text.
fn line_after(text: &[u8]) -> usize {
    1 + text.iter().filter(|byte| **byte == b'\n').count()
}

fn shorten(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(QUOTE) {
        Some((end, _)) => format!("{}...", &line[..end]),
        None => line,
    }
}

/// A file that was read, by what it is for, its name and its bytes, to say what a result came from.
pub fn input_file(role: &'static str, name: impl Into<String>, bytes: &[u8]) -> InputFile {
    InputFile { role, name: name.into(), sha256: sha256(bytes) }
}

/// The SHA-256 digest of some bytes, in lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::with_capacity(64), |mut hex, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(bytes: &[u8]) -> Result<Source, InputError> {
        Source::new(Path::new("a.toml"), bytes.to_vec())
    }

    #[test]
    fn digest_is_that_of_the_standard() {
        // FIPS 180-4, the example "abc".
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn text_that_is_no_toml_is_located() {
        for (text, parts) in [
            ("a = 1\nb = = 2\n", [":2:", "TOML", "found 'b = = 2'", "allowed"]),
            ("a = 1\n\na = 2\n", [":3:", "duplicate key", "found 'a = 2'", "allowed"]),
            ("a = [1,\n2\n", [":", "TOML", "found", "allowed"]),
            ("[cell\nx = 1\n", [":1:", "TOML", "found '[cell'", "allowed"]),
        ] {
            let message = source(text.as_bytes()).unwrap().parse().unwrap_err().to_string();
            for part in parts {
                assert!(message.contains(part), "{part} in {message}");
            }
        }
    }

    #[test]
    fn bytes_that_are_no_text_are_located() {
        let message = source(b"a = 1\nb = '\xff'\n").unwrap_err().to_string();
        assert_eq!(message, "a.toml:2: is not UTF-8 text, found byte 0xff; allowed: UTF-8 text");
    }

    #[test]
    fn long_quotes_are_cut_between_characters() {
        let long = "\u{e4}".repeat(200);
        assert_eq!(shorten(&long).chars().count(), QUOTE + 3);
        assert_eq!(shorten("[1,\n   2]"), "[1, 2]");
    }
}
