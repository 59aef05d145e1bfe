//! Typed values out of a TOML tree, each failure with its file, line, field, value found and what is allowed.
//!
//! A table is opened by naming all the keys it may have ([`Table::fields`]): any other key is refused at once, with the
//! nearest known one. Each [`Field`] is then asked for the value it should hold. Rows of arrays are counted from 1, as
//! joints and segments are.
//!
//! ```
//! use stead_format::reader::Table;
//! use stead_format::toml_file::TomlFile;
//! # fn main() -> Result<(), stead_format::input::InputError> {
//! let source = TomlFile::new("cell.toml".as_ref(), b"x_mm = [-300, 300]\nwall = 'lefft'".to_vec())?;
//! let document = source.parse()?;
//! let [x, wall, gap] = Table::root(&document).fields(["x_mm", "wall", "gap_mm"])?;
//! assert_eq!(x.interval()?, [-300.0, 300.0]);
//! assert_eq!(gap.optional(|gap| gap.positive())?, None);
//! let error = wall.one_of(&[("left", true), ("right", false)]).unwrap_err();
//! assert_eq!(error.to_string(), "cell.toml:2: wall: is unknown, found 'lefft'; allowed: \"left\" or \"right\"");
//! # Ok(())
//! # }
//! ```

use super::toml_file::{Document, TomlFile};
use crate::input::InputError;
use crate::place::Place;
use std::ops::RangeInclusive;
use std::sync::OnceLock;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

static EMPTY: OnceLock<DeTable<'static>> = OnceLock::new();

/// A table of a TOML file.
#[derive(Debug, Clone)]
pub struct Table<'a> {
    source: &'a TomlFile,
    entries: &'a DeTable<'a>,
    path: String,
    line: usize,
}

/// A key of a table.
pub type Field<'a> = Place<'a>;
pub use crate::place::NamedFile;

impl<'a> Table<'a> {
    /// The table of a whole document.
    pub fn root(document: &'a Document<'a>) -> Self {
        let root = document.root();
        let empty = Table { source: root.file, entries: EMPTY.get_or_init(DeTable::new), path: String::new(), line: 1 };
        match root.value.map(Spanned::get_ref) {
            Some(DeValue::Table(entries)) => Table { entries, ..empty },
            _ => empty,
        }
    }

    /// Opens the table: its fields for all the keys it may have, in the order asked for.
    ///
    /// # Errors
    /// [`InputError`] for the first key of the file that is not among them, naming the nearest that is.
    pub fn fields<const N: usize>(&self, keys: [&str; N]) -> Result<[Field<'a>; N], InputError> {
        let unknown = self.entries.iter().filter(|(key, _)| !keys.contains(&key.get_ref().as_ref()));
        if let Some((key, value)) = unknown.min_by_key(|(key, _)| key.span().start) {
            let name: &str = key.get_ref();
            let near = |known: &str| strsim::jaro(known, name);
            let nearest = keys.iter().max_by(|a, b| near(a).total_cmp(&near(b)));
            let hint = nearest.map(|known| format!(" (nearest known one: {known})")).unwrap_or_default();
            return Err(InputError::new(self.source.file(), format!("unknown key{hint}"))
                .at_line(self.source.line(key.span().start))
                .in_field(self.path_of(name))
                .found(self.source.quote(value.span()))
                .allowed(keys.join(", ")));
        }
        Ok(keys.map(|key| self.field(key)))
    }

    /// One field, without a check for unknown keys.
    pub fn field(&self, key: &str) -> Field<'a> {
        Field { file: self.source, path: self.path_of(key), parent_line: self.line, value: self.entries.get(key) }
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }
}

impl<'a> Field<'a> {
    /// Reads the value if there is one.
    ///
    /// # Errors
    /// Those of `read`.
    pub fn optional<T>(&self, read: impl FnOnce(&Self) -> Result<T, InputError>) -> Result<Option<T>, InputError> {
        if self.is_given() { read(self).map(Some) } else { Ok(None) }
    }

    /// A finite number that passes a test; `allowed` says which do.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such number.
    pub fn number_where(&self, allowed: &str, test: impl Fn(f64) -> bool) -> Result<f64, InputError> {
        let value = number(self.required(allowed)?).ok_or_else(|| self.error("is not a finite number", allowed))?;
        if test(value) { Ok(value) } else { Err(self.error("is out of range", allowed)) }
    }

    /// A finite number.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no finite number.
    pub fn number(&self) -> Result<f64, InputError> {
        self.number_where("a finite number", |_| true)
    }

    /// A finite number above zero.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such number.
    pub fn positive(&self) -> Result<f64, InputError> {
        self.number_where("a finite number above 0", |value| value > 0.0)
    }

    /// A whole number in a range.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no such number.
    pub fn integer(&self, range: RangeInclusive<u64>) -> Result<u64, InputError> {
        let allowed = format!("a whole number from {} to {}", range.start(), range.end());
        let DeValue::Integer(integer) = self.required(&allowed)? else {
            return Err(self.error("is not a whole number", allowed));
        };
        match u64::from_str_radix(integer.as_str(), integer.radix()) {
            Ok(value) if range.contains(&value) => Ok(value),
            _ => Err(self.error("is out of range", allowed)),
        }
    }

    /// A text with something in it.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no text or a blank one.
    pub fn string(&self) -> Result<&'a str, InputError> {
        match self.required("a text in quotes")? {
            DeValue::String(text) if text.trim().is_empty() => Err(self.error("is blank", "a text in quotes")),
            DeValue::String(text) => Ok(text),
            _ => Err(self.error("is not a text", "a text in quotes")),
        }
    }

    /// True or false.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is neither.
    pub fn boolean(&self) -> Result<bool, InputError> {
        match self.required("true or false")? {
            DeValue::Boolean(value) => Ok(*value),
            _ => Err(self.error("is neither true nor false", "true or false")),
        }
    }

    /// What one of some words stands for.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is none of the words.
    pub fn one_of<T: Copy>(&self, words: &[(&str, T)]) -> Result<T, InputError> {
        let allowed = words.iter().map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(" or ");
        let DeValue::String(text) = self.required(&allowed)? else {
            return Err(self.error("is not a text", allowed));
        };
        let meant = words.iter().find(|(word, _)| *word == text.as_ref());
        meant.map(|(_, meaning)| *meaning).ok_or_else(|| self.error("is unknown", allowed))
    }

    /// A sub-table.
    ///
    /// # Errors
    /// [`InputError`] when the key is missing, or its value is no table.
    pub fn table(&self) -> Result<Table<'a>, InputError> {
        let allowed = format!("a table [{}]", self.path);
        match self.required(&allowed)? {
            DeValue::Table(entries) => {
                Ok(Table { source: self.file, entries, path: self.path.clone(), line: self.line() })
            }
            _ => Err(self.error("is not a table", allowed)),
        }
    }

    pub(super) fn required(&self, allowed: &str) -> Result<&'a DeValue<'a>, InputError> {
        self.value.map(Spanned::get_ref).ok_or_else(|| self.error("is missing", allowed))
    }
}

/// The finite number that a value holds, whole or not.
fn number(value: &DeValue<'_>) -> Option<f64> {
    let number = match value {
        DeValue::Float(float) => float.as_str().parse().ok()?,
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok()? as f64,
        _ => return None,
    };
    f64::is_finite(number).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{assert_parts, read_field as read};
    use super::*;

    #[test]
    fn numbers_are_taken_as_written() {
        assert_eq!(read("v = 3", |v| v.number()), Ok(3.0));
        assert_eq!(read("v = -1_000.5e-1", |v| v.number()), Ok(-100.05));
        assert_eq!(read("v = 0x10", |v| v.number()), Ok(16.0));
        assert_eq!(read("v = 9223372036854775807", |v| v.integer(0..=u64::MAX)), Ok(9223372036854775807));
        assert_eq!(read("v = true", |v| v.boolean()), Ok(true));
        assert_eq!(read("w = 1", |v| v.optional(Field::number)), Ok(None));
    }

    #[test]
    fn each_kind_refuses_what_it_is_not() {
        for bad in ["'1'", "nan", "-inf", "1e999", "true", "[1]", "99999999999999999999", "2026-01-01"] {
            let found = format!("found {bad}");
            assert_parts(read(&format!("v = {bad}"), |v| v.number()), "3: a.v", &[&found, "a finite number"]);
        }
        assert_parts(read("v = 0", |v| v.positive()), "3: a.v", &["out of range", "found 0;", "above 0"]);
        assert_parts(read("v = 3.0", |v| v.integer(0..=9)), "3: a.v", &["whole", "found 3.0", "from 0 to 9"]);
        assert_parts(read("v = -3", |v| v.integer(0..=9)), "3: a.v", &["out of range", "found -3", "from 0 to 9"]);
        assert_parts(read("v = 1", |v| v.string().map(drop)), "3: a.v", &["not a text", "found 1;"]);
        assert_parts(read("v = ' '", |v| v.string().map(drop)), "3: a.v", &["blank", "found ' '"]);
        assert_parts(read("v = 0", |v| v.boolean()), "3: a.v", &["found 0;", "true or false"]);
        assert_parts(
            read("v = 'lft'", |v| v.one_of(&[("left", 1)])),
            "3: a.v",
            &["unknown", "found 'lft'", "\"left\""],
        );
        assert_parts(read("v = 7", |v| v.one_of(&[("left", 1)])), "3: a.v", &["not a text", "found 7", "\"left\""]);
        assert_parts(read("v = 2", |v| v.table().map(drop)), "3: a.v", &["not a table", "found 2", "[a.v]"]);
    }

    #[test]
    fn a_missing_key_is_located_at_its_table() {
        assert_parts(read("w = 1", |v| v.number()), "2: a.v", &["is missing", "a finite number"]);
    }

    #[test]
    fn the_first_unknown_key_is_refused_with_the_nearest() {
        let nothing = |_: &Field<'_>| Ok(());
        assert_parts(read("v = 1\nww = 2\na = 3", nothing), "4: a.ww", &["nearest known one: w", "found 2", "v, w"]);
    }

    #[test]
    fn a_named_file_that_is_not_there_is_located_at_the_name() {
        let result = read("v = 'nowhere/x.csv'", |v| v.named_file().map(drop));
        assert_parts(result, "3: a.v", &["nowhere/x.csv", "found 'nowhere/x.csv'", "cannot be read"]);
    }
}
