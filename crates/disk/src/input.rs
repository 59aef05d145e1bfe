//! What comes from files: which ones, what they cite, and the one error for anything that they can get wrong.

pub mod csv_table;

use crate::quote;
use sha2::{Digest, Sha256};
use std::fmt::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;

/// A file that was read, so that a result can say what it came from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// What the file is for: `config`, `robot` or `task`.
    pub role: &'static str,
    /// For the config its file name, for the others the path as the config gives it, with forward slashes.
    pub name: String,
    /// SHA-256 digest of the bytes that were read, in hexadecimal.
    pub sha256: String,
}

/// What is wrong in a file, where, what was found and what is allowed.
///
/// Printed as `FILE:LINE: SET BY: FIELD: PROBLEM, found VALUE; allowed: ALLOWED`, leaving out what is not known.
/// Boxed where it keeps a `Result` with this error small.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputError {
    /// The file as the user named it.
    pub file: Box<Path>,
    /// Line in the file, from 1.
    pub line: Option<NonZeroUsize>,
    /// What put the value there, where it is not the file's own: `--set cell.z_mm=[0, 1]`, or the case of a study.
    pub set_by: Option<Box<str>>,
    /// Field: dotted key of a TOML file, or column of a CSV file.
    pub field: Option<Box<str>>,
    /// What is wrong, as a sentence without its full stop.
    pub problem: Box<str>,
    /// The value found, as written.
    pub found: Option<Box<str>>,
    /// What would have been accepted.
    pub allowed: Option<Box<str>>,
    /// Whether nothing is wrong with the input: a file that was to be made did not fit on the disk.
    pub is_of_disk: bool,
}

impl InputError {
    /// A problem with a file as a whole.
    pub fn new(file: &Path, problem: impl Into<String>) -> Self {
        Self {
            file: file.into(),
            line: None,
            set_by: None,
            field: None,
            problem: one_line(problem),
            found: None,
            allowed: None,
            is_of_disk: false,
        }
    }

    /// States that the disk is at fault, and not the input.
    pub(crate) fn of_disk(mut self) -> Self {
        self.is_of_disk = true;
        self
    }

    /// The same place with another problem.
    pub fn because(mut self, problem: impl std::fmt::Display) -> Self {
        self.problem = problem.to_string().into();
        self
    }

    /// Adds the line, from 1.
    pub fn at_line(mut self, line: usize) -> Self {
        self.line = NonZeroUsize::new(line);
        self
    }

    /// Adds what put the value there.
    pub fn set_by(mut self, origin: impl Into<String>) -> Self {
        let origin: String = origin.into();
        self.set_by = Some(origin.into());
        self
    }

    /// Adds the field.
    pub fn in_field(mut self, field: impl Into<String>) -> Self {
        self.field = Some(one_line(field));
        self
    }

    /// Adds the value found.
    pub fn found(mut self, value: impl Into<String>) -> Self {
        self.found = Some(one_line(value));
        self
    }

    /// Adds the value found, if there is one.
    pub fn found_if(mut self, value: Option<String>) -> Self {
        self.found = value.map(one_line);
        self
    }

    /// Adds what would have been accepted.
    pub fn allowed(mut self, allowed: impl Into<String>) -> Self {
        self.allowed = Some(allowed.into().into());
        self
    }
}

/// A text without the line breaks and other controls of the file that it comes from.
fn one_line(text: impl Into<String>) -> Box<str> {
    quote::one_line(&text.into()).into()
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        write!(f, ": ")?;
        if let Some(origin) = &self.set_by {
            write!(f, "{origin}: ")?;
        }
        if let Some(field) = &self.field {
            write!(f, "{field}: ")?;
        }
        write!(f, "{}", self.problem)?;
        if let Some(found) = &self.found {
            write!(f, ", found {found}")?;
        }
        if let Some(allowed) = &self.allowed {
            write!(f, "; allowed: {allowed}")?;
        }
        Ok(())
    }
}

impl std::error::Error for InputError {}

/// A file that was read, by what it is for, its name and its bytes, to say what a result came from.
pub fn input_file(role: &'static str, name: impl Into<String>, bytes: &[u8]) -> InputFile {
    InputFile { role, name: name.into(), sha256: sha256(bytes) }
}

/// The SHA-256 digest of some bytes, in lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(Sha256::digest(bytes).as_slice())
}

/// The same of the text by which values of the program are shown, which states every digit that counts; the text is
/// not held.
pub fn sha256_of(value: &impl std::fmt::Debug) -> String {
    struct Writer(Sha256);
    impl Write for Writer {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            self.0.update(text.as_bytes());
            Ok(())
        }
    }
    let mut writer = Writer(Sha256::new());
    // Writing to a digest cannot fail.
    let _ = write!(writer, "{value:?}");
    hex(writer.0.finalize().as_slice())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(64), |mut hex, byte| {
        // Writing to a string cannot fail.
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digest_is_that_of_the_standard() {
        // FIPS 180-4, the example "abc".
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn prints_what_is_known_and_nothing_else() {
        let bare = InputError::new(Path::new("a.toml"), "cannot be read");
        assert_eq!(bare.to_string(), "a.toml: cannot be read");
        let full = bare.at_line(3).in_field("cell.x_mm").found("[1, 0]").allowed("lower bound below upper bound");
        assert_eq!(
            full.to_string(),
            "a.toml:3: cell.x_mm: cannot be read, found [1, 0]; allowed: lower bound below upper bound"
        );
    }
}
