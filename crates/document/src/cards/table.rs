//! Tables that sort and filter.

use serde::{Serialize, Serializer};

/// A table.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Table {
    /// Heading.
    pub title: String,
    /// What is said beside the heading.
    pub detail: String,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows, each with a cell for each column.
    pub rows: Vec<Vec<Cell>>,
    /// Whether rows can be filtered by a word.
    pub can_filter: bool,
}

impl Table {
    /// A table under a heading.
    pub fn new(title: impl Into<String>, columns: Vec<Column>, rows: Vec<Vec<Cell>>) -> Self {
        Self { title: title.into(), columns, rows, ..Self::default() }
    }

    /// With words beside the heading.
    pub fn detailed(self, detail: impl Into<String>) -> Self {
        Self { detail: detail.into(), ..self }
    }

    /// With a field for a word that rows are filtered by.
    pub fn filtered(self) -> Self {
        Self { can_filter: true, ..self }
    }
}

/// A column.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Column {
    /// Heading.
    pub name: String,
    /// Whether its cells are numbers, set to the right.
    pub is_number: bool,
}

impl Column {
    /// A column of numbers.
    pub fn number(name: impl Into<String>) -> Self {
        Self { name: name.into(), is_number: true }
    }

    /// A column of words.
    pub fn text(name: impl Into<String>) -> Self {
        Self { name: name.into(), is_number: false }
    }
}

/// A cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Nothing.
    Empty,
    /// A word.
    Text(String),
    /// A number as it is shown; sorted by what it says.
    Number(String),
    /// A word that leads to another file beside the page.
    Link {
        /// The word.
        text: String,
        /// The path from the folder of the page.
        path: String,
    },
}

impl Cell {
    /// A number as it is shown, or nothing.
    pub fn optional(number: Option<String>) -> Self {
        number.map_or(Self::Empty, Self::Number)
    }
}

impl Serialize for Cell {
    /// Nothing as null, a word and a number as a string, a link as a pair.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Empty => serializer.serialize_none(),
            Self::Text(text) | Self::Number(text) => serializer.serialize_str(text),
            Self::Link { text, path } => [text, path].serialize(serializer),
        }
    }
}
