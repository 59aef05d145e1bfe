//! The text of one TOML file: where its lines are, and how it parses.
//!
//! ```
//! use serde::Deserialize;
//! use stead_format::shapes::Interval;
//! use stead_format::toml_file::TomlFile;
//! use stead_format::units::{Mm, Positive};
//! # fn main() -> Result<(), stead_format::input::InputError> {
//! #[derive(Deserialize)]
//! #[serde(deny_unknown_fields)]
//! struct Cell {
//!     x_mm: Interval<Mm>,
//!     wall_mm: Mm<Positive>,
//!     gap_mm: Option<Mm>,
//! }
//!
//! let source = TomlFile::new("cell.toml".as_ref(), b"x_mm = [-300, 300]\nwall_mm = 20".to_vec())?;
//! let cell: Cell = source.parse()?.read()?;
//! assert_eq!((cell.x_mm.si(), cell.wall_mm.si(), cell.gap_mm), ([-0.3, 0.3], 0.02, None));
//!
//! let source = TomlFile::new("cell.toml".as_ref(), b"x_mm = [-300, 300]\nwall_mm = -20".to_vec())?;
//! let error = source.parse()?.read::<Cell>().err().map(|error| error.to_string());
//! let expected = "cell.toml:2: wall_mm: is out of range, found -20; allowed: a finite number above 0";
//! assert_eq!(error.as_deref(), Some(expected));
//! # Ok(())
//! # }
//! ```

use crate::input::{InputError, InputFile, input_file};
use crate::place::Place;
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A TOML file read into memory, with its name for messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TomlFile {
    file: PathBuf,
    text: String,
}

/// The parse tree of a [`TomlFile`], every value with its place in the text.
#[derive(Debug, Clone)]
pub struct Document<'a> {
    file: &'a TomlFile,
    root: Spanned<DeValue<'a>>,
}

/// Longest piece of a file that is quoted in a message, in characters.
const QUOTE: usize = 80;

impl TomlFile {
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

    /// The text without a first line that names its schema (`#:schema PATH`), which is true in the folder of the file alone.
    pub fn without_schema(&self) -> &str {
        without_schema(&self.text)
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
        let span = tree.span();
        Ok(Document { file: self, root: Spanned::new(span, DeValue::Table(tree.into_inner())) })
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

/// A text without a first line that names its schema.
pub(crate) fn without_schema(text: &str) -> &str {
    text.split_once('\n').filter(|(line, _)| line.starts_with("#:schema")).map_or(text, |(_, rest)| rest)
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

impl<'a> Document<'a> {
    /// What the file says, as the type that declares its keys.
    ///
    /// # Errors
    /// [`InputError`] at the first key that is unknown or missing, or whose value is of the wrong kind or out of range.
    pub fn read<T: DeserializeOwned>(&'a self) -> Result<T, InputError> {
        self.root().read()
    }

    /// The place of a value, for an error there: `cell.x_mm`, `joints[3].min_deg`; array elements are counted from 1.
    pub fn at(&'a self, path: &str) -> Place<'a> {
        path.split(['.', '[']).fold(self.root(), |place, step| match step.strip_suffix(']') {
            Some(number) => place.element(number.parse().unwrap_or(0)),
            None => place.key(step),
        })
    }

    /// The table that the whole file is.
    pub fn root(&'a self) -> Place<'a> {
        Place::root(self.file, &self.root)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(bytes: &[u8]) -> Result<TomlFile, InputError> {
        TomlFile::new(Path::new("a.toml"), bytes.to_vec())
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
