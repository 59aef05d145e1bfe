//! CSV tables of a results folder, read back for the page: its numbers are those of the files.

use super::PageError;
use super::packed::singles;
use serde_json::{Map, Value, json};

/// A table by its columns.
#[derive(Debug, Clone)]
pub(super) struct Table {
    name: String,
    header: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    /// Reads the bytes of a file of this name.
    pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Self, PageError> {
        let fail = |cause: csv::Error| PageError::file(name, format!("is no table: {cause}"));
        let mut reader = csv::Reader::from_reader(bytes);
        let header = reader.headers().map_err(fail)?.iter().map(str::to_owned).collect();
        let rows = reader.records().collect::<Result<_, _>>().map_err(fail)?;
        Ok(Self { name: name.to_owned(), header, rows })
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// An error in this file.
    pub(super) fn error(&self, problem: &str) -> PageError {
        PageError::file(&self.name, problem)
    }

    fn column(&self, name: &str) -> Result<usize, PageError> {
        let found = self.header.iter().position(|column| column == name);
        found.ok_or_else(|| self.error(&format!("has no column {name}")))
    }

    /// A column of numbers; NaN where a field is empty.
    pub(super) fn numbers(&self, name: &str) -> Result<Vec<f64>, PageError> {
        let column = self.column(name)?;
        let number = |(index, row): (usize, &csv::StringRecord)| match row.get(column).unwrap_or("") {
            "" => Ok(f64::NAN),
            text => text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                let problem = format!("is no finite number in row {} of the column {name}, found '{text}'", index + 1);
                self.error(&problem)
            }),
        };
        self.rows.iter().enumerate().map(number).collect()
    }

    /// A column of words.
    pub(super) fn texts(&self, name: &str) -> Result<Vec<String>, PageError> {
        let column = self.column(name)?;
        Ok(self.rows.iter().map(|row| row.get(column).unwrap_or("").to_owned()).collect())
    }

    /// The columns named, of the rows chosen (all, where none are): numbers as singles, words as they are.
    pub(super) fn content(&self, words: &[&str], chosen: Option<&[usize]>) -> Result<Value, PageError> {
        let mut columns = Map::new();
        for name in &self.header {
            let value = if words.contains(&name.as_str()) {
                json!(pick(&self.texts(name)?, chosen))
            } else {
                json!(singles(pick(&self.numbers(name)?, chosen)))
            };
            columns.insert(name.clone(), value);
        }
        Ok(Value::Object(columns))
    }
}

fn pick<T: Clone>(all: &[T], chosen: Option<&[usize]>) -> Vec<T> {
    match chosen {
        None => all.to_vec(),
        Some(chosen) => chosen.iter().filter_map(|index| all.get(*index).cloned()).collect(),
    }
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
        assert_eq!(table.content(&["b"], Some(&[1])).unwrap()["b"], json!(["y"]));
    }
}
