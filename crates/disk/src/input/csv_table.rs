//! CSV files: a header of named columns, rows with their lines, numbers that must be finite.

use super::InputError;
use crate::quote::shorten;
use nalgebra::Vector3;
use std::path::Path;

/// No number in a CSV file is larger than this in its unit.
pub const MAX_NUMBER: f64 = 1e9;

/// A CSV file being read, its header already.
pub struct CsvTable<'a> {
    file: &'a Path,
    reader: csv::Reader<&'a [u8]>,
    header: csv::StringRecord,
    record: csv::StringRecord,
    lines: LineCounter<'a>,
}

impl<'a> CsvTable<'a> {
    /// Reads the header; `file` is the name in messages.
    ///
    /// # Errors
    /// [`InputError`] when there is no readable header, or its columns are not separated by commas.
    pub fn new(file: &'a Path, bytes: &'a [u8]) -> Result<Self, InputError> {
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(bytes);
        let mut lines = LineCounter { bytes, at: 0, line: 1 };
        let header = reader.headers().map_err(|e| csv_error(file, &mut lines, &e))?.clone();
        if let (1, Some(name)) = (header.len(), header.get(0))
            && let Some(mark) = [';', '\t', '|'].into_iter().find(|mark| name.contains(*mark))
        {
            return Err(InputError::new(file, "the columns are not separated by commas")
                .at_line(1)
                .found(format!("{mark:?} between them"))
                .allowed("columns separated by commas, and a point in decimal numbers"));
        }
        Ok(Self { file, reader, header, record: csv::StringRecord::new(), lines })
    }

    /// The names of the columns in their order.
    pub fn header(&self) -> impl Iterator<Item = &str> {
        self.header.iter()
    }

    /// Where a column is, from 0.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header().position(|column| column == name)
    }

    /// Whether a column is there more than once.
    pub fn is_doubled(&self, name: &str) -> bool {
        self.header().filter(|column| *column == name).count() > 1
    }

    /// What is wrong with a column of the header.
    pub fn fail(&self, column: &str, problem: &str, allowed: &str) -> InputError {
        InputError::new(self.file, problem).at_line(1).in_field(column).allowed(allowed)
    }

    /// The next row, until there is none.
    ///
    /// # Errors
    /// [`InputError`] at the line of a row that is not readable or does not fit the header.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>, InputError> {
        match self.reader.read_record(&mut self.record) {
            Err(error) => Err(csv_error(self.file, &mut self.lines, &error)),
            Ok(false) => Ok(None),
            Ok(true) => {
                let line = self.lines.of(self.record.position());
                Ok(Some(Row { file: self.file, line, record: &self.record, header: &self.header }))
            }
        }
    }
}

/// One row under its header.
pub struct Row<'a> {
    file: &'a Path,
    line: usize,
    record: &'a csv::StringRecord,
    header: &'a csv::StringRecord,
}

impl Row<'_> {
    /// The line in the file, from 1, as an editor counts.
    pub fn line(&self) -> usize {
        self.line
    }

    /// The text in a column that [`CsvTable::column`] told.
    pub fn text(&self, column: usize) -> &str {
        &self.record[column]
    }

    /// What is wrong in a column of this row.
    pub fn fail(&self, column: usize, problem: &str, allowed: &str) -> InputError {
        InputError::new(self.file, problem)
            .at_line(self.line)
            .in_field(&self.header[column])
            .found(format!("'{}'", shorten(&self.record[column])))
            .allowed(allowed)
    }

    /// The number in a column.
    ///
    /// # Errors
    /// [`InputError`] unless it is finite and within [`MAX_NUMBER`].
    pub fn number(&self, column: usize) -> Result<f64, InputError> {
        match self.record[column].parse::<f64>() {
            Ok(value) if value.abs() <= MAX_NUMBER => Ok(value),
            _ => Err(self.fail(column, "not a finite number", "a finite decimal number of at most 1e9")),
        }
    }

    /// The vector in three columns.
    ///
    /// # Errors
    /// As [`Row::number`].
    pub fn vector(&self, columns: [usize; 3]) -> Result<Vector3<f64>, InputError> {
        try_each(columns, |column| self.number(column)).map(Vector3::from)
    }
}

/// What a function gives for each of some things, or its first error.
pub fn try_each<A, B: Copy + Default, E, const N: usize>(
    things: [A; N],
    mut function: impl FnMut(A) -> Result<B, E>,
) -> Result<[B; N], E> {
    let mut results = [B::default(); N];
    for (result, thing) in results.iter_mut().zip(things) {
        *result = function(thing)?;
    }
    Ok(results)
}

/// Tells the line of a row. The reader's own count takes a row to begin right behind the row before it, so it is early
/// after blank lines, and by one in files whose lines end in carriage return and line feed.
struct LineCounter<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
}

impl LineCounter<'_> {
    /// The line, from 1, of the row that the reader says to begin at a position, which must not go back.
    fn of(&mut self, position: Option<&csv::Position>) -> usize {
        let start = position.map_or(0, |position| position.byte() as usize).min(self.bytes.len());
        let blank = self.bytes[start..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
        while self.at < start + blank {
            let ends = match self.bytes[self.at] {
                b'\n' => true,
                b'\r' => self.bytes.get(self.at + 1) != Some(&b'\n'),
                _ => false,
            };
            self.line += usize::from(ends);
            self.at += 1;
        }
        self.line
    }
}

fn csv_error(file: &Path, line_at: &mut LineCounter<'_>, error: &csv::Error) -> InputError {
    let (problem, allowed) = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => (
            format!("this row does not fit its header, found {len} values"),
            format!("{expected_len} values, one for each column"),
        ),
        csv::ErrorKind::Utf8 { .. } => ("not UTF-8 text".to_owned(), "UTF-8 text".to_owned()),
        _ => (format!("not readable as CSV: {error}"), "a CSV file".to_owned()),
    };
    let located = InputError::new(file, problem).allowed(allowed);
    match error.position() {
        Some(position) => located.at_line(line_at.of(Some(position))),
        None => located,
    }
}
