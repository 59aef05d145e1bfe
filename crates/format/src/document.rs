//! The parse tree of a TOML file, and what is read from it.
//!
//! ```
//! use serde::Deserialize;
//! use stead_format::shapes::Interval;
//! use stead_format::toml_file::TomlFile;
//! use stead_format::units::{Mm, Positive};
//! # fn main() -> Result<(), stead_disk::input::InputError> {
//! #[derive(Deserialize)]
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
//! let expected =
//!     "cell.toml:2: wall_mm: is out of range, found -20; allowed: a finite number above 0 and not above 1e6";
//! assert_eq!(error.as_deref(), Some(expected));
//! # Ok(())
//! # }
//! ```

use crate::deserialize::Node;
use crate::field::{FieldOverride, FieldOverrides, put, shifted};
use crate::file_kind::FileKind;
use crate::mesh::{MESH, MeshUnit};
use crate::place::Place;
use crate::shipped;
use crate::sources::Sources;
use crate::toml_file::TomlFile;
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stead_cell::TriangleMesh;
use stead_disk::files;
use stead_disk::input::{InputError, InputFile, input_file};
use stead_disk::manifest::{self, Unlisted};
use stead_disk::quote::shorten;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The parse tree of a [`TomlFile`], every value with its place in the text.
#[derive(Debug, Clone)]
pub struct Document<'a> {
    file: &'a TomlFile,
    root: Spanned<DeValue<'a>>,
}

/// A file that another one names, read.
#[derive(Debug, Clone)]
pub struct NamedFile {
    /// The name as given in the naming file, with forward slashes.
    pub name: String,
    /// The name with the folder of the naming file before it.
    pub file: PathBuf,
    /// What is in it.
    pub bytes: Arc<[u8]>,
    /// Values that take the place of its own.
    overrides: FieldOverrides,
    /// Where it comes from.
    pub(crate) sources: Sources,
}

impl NamedFile {
    /// The file as TOML, with the values that take the place of its own.
    ///
    /// # Errors
    /// As [`TomlFile::new`].
    pub fn toml(&self) -> Result<TomlFile, InputError> {
        Ok(TomlFile::new(&self.file, self.bytes.to_vec())?.with_overrides(&self.overrides, self.sources.clone()))
    }
}

impl TomlFile {
    /// Parses the text.
    ///
    /// # Errors
    /// [`InputError`] at the line where the text stops being TOML.
    pub fn parse(&self) -> Result<Document<'_>, InputError> {
        let tree = DeTable::parse(self.text()).map_err(|e| {
            if let Some(kind) = FileKind::foreign(self.text().as_bytes()) {
                return kind.refused(self.file());
            }
            let span = e.span().unwrap_or(0..0);
            let line = self.line(span.start);
            let written = self.text().lines().nth(line - 1).unwrap_or_default();
            InputError::new(self.file(), format!("is not readable as TOML: {}", e.message().trim()))
                .at_line(line)
                .found(format!("'{}'", shorten(written)))
                .allowed(toml_like(written))
        })?;
        let span = tree.span();
        let mut root = Spanned::new(span, DeValue::Table(tree.into_inner()));
        for (field, span) in self.overrides() {
            let fail = |problem: &str| InputError::new(self.file(), problem).set_by(format!("--set {field}"));
            let value = DeValue::parse(self.piece(span.clone()));
            let value = value.map_err(|e| fail(&format!("is not readable as TOML: {}", e.message().trim())))?;
            put(&mut root, field.steps(), shifted(value, span.start))
                .map_err(|misfit| fail(&misfit.problem).in_field(misfit.field).allowed(misfit.allowed))?;
        }
        Ok(Document { file: self, root })
    }
}

/// How a file in another folder is named.
const FORWARD_SLASHES: &str = "forward slashes in names of files, as \"parts/arm.toml\"";

/// What a line that is no TOML should be, by what people write.
fn toml_like(line: &str) -> &'static str {
    let code = line.split('#').next().unwrap_or_default();
    let value = code.split_once('=').map_or("", |(_, value)| value.trim());
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let is_decimal_comma = value.trim_start_matches('-').split_once(',').is_some_and(|(a, b)| digits(a) && digits(b));
    if code.contains('"') && code.contains('\\') {
        FORWARD_SLASHES
    } else if is_decimal_comma {
        "a decimal point, as 3.5"
    } else {
        "a TOML file"
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

impl Place<'_> {
    /// What is here, as the type that declares it.
    ///
    /// # Errors
    /// [`InputError`] at the first value that is unknown, missing, of the wrong kind or out of range.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        T::deserialize(Node::new(self.clone())).map_err(|problem| problem.located(self, "another value"))
    }

    /// The TOML file named here, as [`Place::named_file`], and its entry among the files that a result came from.
    ///
    /// # Errors
    /// As [`Place::named_file`] and [`TomlFile::new`].
    pub fn named_toml(&self, role: &'static str) -> Result<(TomlFile, InputFile), InputError> {
        let file = self.named_file()?;
        let source = file.toml()?;
        let input = input_file(role, file.name, source.bytes());
        Ok((source, input))
    }

    /// The mesh of the file named here, as [`Place::named_file`], and its entry among the files that a result came
    /// from.
    ///
    /// # Errors
    /// As [`Place::named_file`], and [`InputError`] for a file that is no mesh.
    pub(crate) fn named_mesh(&self, unit: MeshUnit) -> Result<(Arc<TriangleMesh>, InputFile), InputError> {
        let file = self.named_file()?;
        let mesh = file.sources.mesh(&file.file, &file.bytes, unit)?;
        Ok((mesh, input_file(MESH, file.name, &file.bytes)))
    }

    /// Where a file lies that is named here, relative to the folder of this one or of what put the value there.
    pub(crate) fn path_of(&self, name: &str) -> PathBuf {
        let set = self.value.and_then(|value| self.file.override_at(value.span().start));
        match set.and_then(FieldOverride::folder).or(self.file.file().parent()) {
            Some(folder) => files::below(folder, name),
            None => PathBuf::from(name),
        }
    }

    /// The file named here, by a path relative to the folder of this one, or `name:` and the name of a shipped arm,
    /// read.
    ///
    /// # Errors
    /// [`InputError`] here when there is no name, or the file cannot be read; there when it is a result that its
    /// manifest does not vouch for.
    pub fn named_file(&self) -> Result<NamedFile, InputError> {
        let name: String = self.read()?;
        let sources = self.file.sources.clone();
        let overrides =
            || FieldOverrides(self.file.overrides().iter().filter_map(|(field, _)| field.within(&self.path)).collect());
        if let Some(shipped) = shipped::text(Path::new(&name)) {
            let text =
                shipped.map_err(|error| self.error("names no shipped arm", error.allowed.unwrap_or_default()))?;
            let (file, bytes) = (PathBuf::from(&name), Arc::from(text.as_bytes()));
            return Ok(NamedFile { name, file, bytes, overrides: overrides(), sources });
        }
        let file = self.path_of(&name);
        let bytes = sources.read(&file).map_err(|e| {
            let problem = format!("names a file that cannot be read, {}: {e}", file.display());
            if shipped::by_name(&name).is_some() {
                return self.error(problem, format!("\"name:{name}\" for the shipped arm of this name"));
            }
            if name.contains(|c: char| c == '\\' || c.is_control()) {
                // Behind a backslash TOML reads "parts\table.toml" with a tab.
                return self.error("names a file that cannot be read".to_owned(), FORWARD_SLASHES);
            }
            self.error(problem, "a readable file, its path relative to the folder of the file that names it")
        })?;
        manifest::check(&file, &bytes, Unlisted::Accepted)?;
        Ok(NamedFile { name: name.replace('\\', "/"), file, bytes, overrides: overrides(), sources })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

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
}
