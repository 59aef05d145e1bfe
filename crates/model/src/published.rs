//! Reference figures from publications, set beside computed ones after a job. No job takes them as an input.

use serde::Serialize;

/// Published figures and where they are from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Published<T> {
    /// Author, year and table.
    pub source: String,
    /// The figures.
    pub figures: T,
}
