//! The text of one TOML file: where its lines are, and how pieces of it are quoted.

use crate::field::{FieldOverride, FieldOverrides};
use crate::shipped::{self, PREFIX};
use crate::sources::Sources;
use std::ops::Range;
use std::path::{Path, PathBuf};
use stead_disk::files;
use stead_disk::input::{InputError, InputFile, input_file};
use stead_disk::manifest::{self, Unlisted};
use stead_disk::quote::shorten;

/// A TOML file read into memory, with its name for messages, and the values that take the place of its own.
#[derive(Debug, Clone)]
pub struct TomlFile {
    file: PathBuf,
    /// The text of the file, and behind it the values that take the place of its own, a line each.
    text: String,
    /// Length of the text of the file.
    own: usize,
    overrides: Vec<(FieldOverride, Range<usize>)>,
    /// Where files that it names come from.
    pub sources: Sources,
}

impl TomlFile {
    /// Reads a file, or the file of a shipped arm for `name:` and its name.
    ///
    /// # Errors
    /// [`InputError`] when the file cannot be read or is not UTF-8 text, or is a result that its manifest does not
    /// vouch for.
    pub fn read(file: &Path) -> Result<Self, InputError> {
        if let Some(text) = shipped::text(file) {
            return Self::new(file, text?.as_bytes().to_vec());
        }
        let bytes = files::read(file).map_err(|e| {
            let name = file.to_string_lossy();
            let allowed = match shipped::by_name(&name) {
                Some(_) => format!("{PREFIX}{name} for the shipped arm of this name"),
                None => "the name of a readable TOML file".to_owned(),
            };
            InputError::new(file, format!("cannot be read: {e}")).allowed(allowed)
        })?;
        manifest::check(file, &bytes, Unlisted::Accepted)?;
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
            error.found_if(rest.first().map(|byte| format!("byte 0x{byte:02x}")))
        })?;
        let own = text.len();
        Ok(Self { file: file.to_owned(), text, own, overrides: Vec::new(), sources: Sources::disk() })
    }

    /// The same file with values that take the place of its own and of those of the files that it names, which come
    /// from here.
    pub fn with_overrides(mut self, overrides: &FieldOverrides, sources: Sources) -> Self {
        for field in &overrides.0 {
            self.text.push_str(&format!("\n{} = ", field.path()));
            let start = self.text.len();
            self.text.push_str(field.value());
            self.overrides.push((field.clone(), start..self.text.len()));
        }
        Self { sources, ..self }
    }

    /// The values that take the place of its own, with where they are in the text.
    pub fn overrides(&self) -> &[(FieldOverride, Range<usize>)] {
        &self.overrides
    }

    /// Whether a value takes the place of one of its own.
    pub fn is_overridden(&self) -> bool {
        !self.overrides.is_empty()
    }

    /// The override whose value is at a byte of the text, if there it is one.
    pub(crate) fn override_at(&self, byte: usize) -> Option<&FieldOverride> {
        self.overrides.iter().find(|(_, value)| value.contains(&byte)).map(|(field, _)| field)
    }

    /// An error at a byte of the text: at its line, or at the value that takes the place of the file's.
    pub(crate) fn locate(&self, error: InputError, byte: usize) -> InputError {
        match self.override_at(byte) {
            Some(field) => error.set_by(format!("--set {field}")),
            None => error.at_line(self.line(byte)),
        }
    }

    /// The file as the user named it.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The text of the file, exactly as read.
    pub fn text(&self) -> &str {
        &self.text[..self.own]
    }

    /// A piece of the text, or of the values behind it.
    pub(crate) fn piece(&self, span: Range<usize>) -> &str {
        self.text.get(span).unwrap_or_default()
    }

    /// The text as bytes, exactly as read, and behind it the values that take the place of its own.
    pub fn bytes(&self) -> &[u8] {
        self.text.as_bytes()
    }

    /// The text without a first line that names its schema (`#:schema PATH`), which is true in the folder of the file
    /// alone.
    pub fn without_schema(&self) -> &str {
        without_schema(self.text())
    }

    /// The entry of a config among the files that a result came from: its name alone, wherever it lies.
    pub fn as_config(&self) -> InputFile {
        input_file("config", self.file.file_name().unwrap_or_default().to_string_lossy(), self.bytes())
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
pub fn without_schema(text: &str) -> &str {
    text.split_once('\n').filter(|(line, _)| line.starts_with("#:schema")).map_or(text, |(_, rest)| rest)
}

/// The line, from 1, that comes after some text.
fn line_after(text: &[u8]) -> usize {
    1 + text.iter().filter(|byte| **byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(bytes: &[u8]) -> Result<TomlFile, InputError> {
        TomlFile::new(Path::new("a.toml"), bytes.to_vec())
    }

    #[test]
    fn bytes_that_are_no_text_are_located() {
        let message = source(b"a = 1\nb = '\xff'\n").unwrap_err().to_string();
        assert_eq!(message, "a.toml:2: is not UTF-8 text, found byte 0xff; allowed: UTF-8 text");
    }
}
