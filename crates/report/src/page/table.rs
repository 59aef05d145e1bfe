//! CSV tables of a results folder, read back for the page: its numbers are those of the files.

use super::PageError;
use super::packed::singles;
use serde_json::{Map, Value};

/// A table in the bytes of its file: the rows of a long path are many times as large once they are taken apart, and few
/// of them are shown.
#[derive(Debug, Clone)]
pub(super) struct Table<'a> {
    name: String,
    bytes: &'a [u8],
    header: Vec<String>,
    len: usize,
}

/// The column of the words of postures, which the document has once for all.
const NAMED_IN_THE_DOCUMENT: &str = "posture_words";

impl<'a> Table<'a> {
    /// Reads the bytes of a file of this name.
    pub(super) fn read(name: &str, bytes: &'a [u8]) -> Result<Self, PageError> {
        let mut reader = csv::Reader::from_reader(bytes);
        let header = reader.headers().map_err(|cause| no_table(name, &cause))?.iter().map(str::to_owned).collect();
        let mut table = Self { name: name.to_owned(), bytes, header, len: 0 };
        let mut rows = table.rows();
        while rows.next()? {}
        let len = rows.read;
        table.len = len;
        Ok(table)
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// An error in this file.
    pub(super) fn error(&self, problem: &str) -> PageError {
        PageError::file(&self.name, problem)
    }

    /// Where a column is, from 0.
    pub(super) fn column(&self, name: &str) -> Result<usize, PageError> {
        let found = self.header.iter().position(|column| column == name);
        found.ok_or_else(|| self.error(&format!("has no column {name}")))
    }

    /// Its rows, one after the other.
    pub(super) fn rows(&self) -> Rows<'_> {
        let reader = csv::Reader::from_reader(self.bytes);
        Rows { name: &self.name, header: &self.header, reader, record: csv::StringRecord::new(), read: 0 }
    }

    /// A column of numbers; NaN where a field is empty.
    pub(super) fn numbers(&self, name: &str) -> Result<Vec<f64>, PageError> {
        let column = self.column(name)?;
        self.each(None, |row| row.number(column))
    }

    /// A column of words.
    pub(super) fn texts(&self, name: &str) -> Result<Vec<String>, PageError> {
        let column = self.column(name)?;
        self.each(None, |row| Ok(row.text(column).to_owned()))
    }

    /// The columns named, of the rows chosen, in ascending order (all, where none are): numbers as singles, words as
    /// they are. The words of postures are left out.
    pub(super) fn content(&self, words: &[&str], chosen: Option<&[usize]>) -> Result<Value, PageError> {
        let is_left_out = |name: &str| name == NAMED_IN_THE_DOCUMENT;
        let is_words: Vec<bool> =
            self.header.iter().map(|name| is_left_out(name) || words.contains(&name.as_str())).collect();
        let mut texts = vec![Vec::new(); self.header.len()];
        let mut numbers = vec![Vec::new(); self.header.len()];
        self.each(chosen, |row| {
            for (column, is_word) in is_words.iter().enumerate() {
                match is_word {
                    true => texts[column].push(row.text(column).to_owned()),
                    false => numbers[column].push(row.number(column)?),
                }
            }
            Ok(())
        })?;
        let mut columns = Map::new();
        let values = texts.into_iter().zip(numbers);
        for ((name, is_word), (texts, numbers)) in self.header.iter().zip(is_words).zip(values) {
            if is_left_out(name) {
                continue;
            }
            columns.insert(name.clone(), if is_word { texts.into() } else { singles(numbers).into() });
        }
        Ok(Value::Object(columns))
    }

    /// What a function makes of the rows chosen, in ascending order, or of all.
    fn each<T>(
        &self,
        chosen: Option<&[usize]>,
        mut make: impl FnMut(&Rows<'_>) -> Result<T, PageError>,
    ) -> Result<Vec<T>, PageError> {
        let (mut rows, mut made) = (self.rows(), Vec::new());
        match chosen {
            None => {
                while rows.next()? {
                    made.push(make(&rows)?);
                }
            }
            Some(chosen) => {
                for row in chosen {
                    if rows.go_to(*row)? {
                        made.push(make(&rows)?);
                    }
                }
            }
        }
        Ok(made)
    }
}

/// The rows of a table, of which one is at hand.
pub(super) struct Rows<'a> {
    name: &'a str,
    header: &'a [String],
    reader: csv::Reader<&'a [u8]>,
    record: csv::StringRecord,
    /// How many were read: the last of them is at hand.
    read: usize,
}

impl Rows<'_> {
    /// Moves to the next row; false where there is none.
    fn next(&mut self) -> Result<bool, PageError> {
        let is_there = self.reader.read_record(&mut self.record).map_err(|cause| no_table(self.name, &cause))?;
        self.read += usize::from(is_there);
        Ok(is_there)
    }

    /// Moves to a row, from 0, which must not lie behind; false where there is none.
    pub(super) fn go_to(&mut self, row: usize) -> Result<bool, PageError> {
        while self.read <= row {
            if !self.next()? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The text in a column of the row at hand.
    pub(super) fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or("")
    }

    /// The number in a column of the row at hand; NaN where the field is empty.
    pub(super) fn number(&self, column: usize) -> Result<f64, PageError> {
        match self.text(column) {
            "" => Ok(f64::NAN),
            text => text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                let name = self.header.get(column).map_or("", String::as_str);
                let problem = format!("is no finite number in row {} of the column {name}, found '{text}'", self.read);
                PageError::file(self.name, problem)
            }),
        }
    }
}

fn no_table(name: &str, cause: &csv::Error) -> PageError {
    PageError::file(name, format!("is no table: {cause}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name_and_wrong_numbers_by_row() {
        let table = Table::read("t.csv", b"a,b,c\n1,x,\n2.5,y,3\n").unwrap();
        assert_eq!(table.numbers("a").unwrap(), [1.0, 2.5]);
        assert!(table.numbers("c").unwrap()[0].is_nan());
        assert_eq!(table.texts("b").unwrap(), ["x", "y"]);
        let message = table.numbers("b").unwrap_err().to_string();
        assert_eq!(message, "t.csv: is no finite number in row 1 of the column b, found 'x'");
        assert_eq!(table.numbers("d").unwrap_err().to_string(), "t.csv: has no column d");
        assert_eq!(table.content(&["b"], Some(&[1])).unwrap()["b"], serde_json::json!(["y"]));
    }
}
