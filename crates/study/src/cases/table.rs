//! A table of results: typed columns, as CSV.

use super::StudyError;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Texts.
    Text,
    /// Numbers.
    Number,
    /// Whole numbers.
    Count,
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its name, with the unit.
    pub name: String,
    /// What it holds.
    pub kind: ColumnKind,
}

impl Column {
    /// A column of a name.
    pub fn new(name: impl Into<String>, kind: ColumnKind) -> Self {
        Self { name: name.into(), kind }
    }
}

/// One value of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum TableCell {
    /// No value.
    None,
    /// A text.
    Text(String),
    /// A finite number.
    Number(f64),
    /// A whole number.
    Count(i64),
}

impl TableCell {
    /// A number, where there is one that is finite.
    pub fn number(value: Option<f64>) -> Self {
        value.filter(|value| value.is_finite()).map_or(Self::None, Self::Number)
    }

    /// The number that it is, where it is one and no count.
    pub fn as_number(&self) -> Option<f64> {
        if let Self::Number(number) = self { Some(*number) } else { None }
    }

    /// The value as a field of a CSV file: empty where there is none, numbers with as many digits as tell them from all
    /// others.
    pub fn written(&self) -> String {
        match self {
            Self::None => String::new(),
            Self::Text(text) => text.clone(),
            Self::Number(number) => number.to_string(),
            Self::Count(count) => count.to_string(),
        }
    }

    /// The value of a field of a CSV file, in a column of this kind.
    pub fn read(text: &str, kind: ColumnKind) -> Option<Self> {
        Some(match kind {
            _ if text.is_empty() => Self::None,
            ColumnKind::Text => Self::Text(text.to_owned()),
            ColumnKind::Number => Self::Number(text.parse().ok()?),
            ColumnKind::Count => Self::Count(text.parse().ok()?),
        })
    }
}

/// Rows under columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows, each with a value for each column.
    pub rows: Vec<Vec<TableCell>>,
}

impl Table {
    /// The table as CSV.
    ///
    /// # Errors
    /// [`StudyError::Format`] when the writer fails.
    pub fn to_csv(&self) -> Result<Vec<u8>, StudyError> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let fail = |cause: csv::Error| StudyError::format("the table", &cause);
        writer.write_record(self.columns.iter().map(|column| &column.name)).map_err(fail)?;
        for row in &self.rows {
            writer.write_record(row.iter().map(TableCell::written)).map_err(fail)?;
        }
        writer.into_inner().map_err(|cause| StudyError::format("the table", &cause))
    }

    /// Where a column is.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }
}
