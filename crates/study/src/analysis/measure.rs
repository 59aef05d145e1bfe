//! A column that layouts are compared by.

use super::AnalysisError;
use crate::cases::{Column, ColumnKind, TableCell};
use stead_problem::sense::Sense;

/// Figures of searches are not distinguished below this, in the unit of their column: means of 1e-6 mm are the same
/// (guide, page `objective`), and figures are written with few more digits.
const NOTHING: f64 = 1e-6;

/// A column of numbers, which of them are better, and which are the same.
#[derive(Debug, Clone, PartialEq)]
pub struct Measure {
    /// Where the column is.
    pub column: usize,
    /// Its name, with the unit.
    pub name: String,
    /// Whether smaller or larger values are better.
    pub sense: Sense,
    /// The relative difference up to which values are ties.
    pub noise: f64,
}

impl Measure {
    /// The column of a name, with `:min` or `:max` behind it or in the direction that is usual for it. Axes and the
    /// data sheet of the robot have no noise.
    pub(super) fn of(columns: &[Column], axes: &[usize], requested: &str, noise: f64) -> Result<Self, AnalysisError> {
        let find = |name: &str| columns.iter().position(|column| column.name == name);
        let (column, sense) = match (find(requested), requested.rsplit_once(':')) {
            (Some(column), _) => (Some(column), None),
            (None, Some((name, "min"))) => (find(name), Some(Sense::Min)),
            (None, Some((name, "max"))) => (find(name), Some(Sense::Max)),
            _ => (None, None),
        };
        let column = column.ok_or_else(|| AnalysisError::Unknown {
            requested: requested.to_owned(),
            kind: "column of study.csv",
            nearest: nearest(requested, columns.iter().map(|column| column.name.as_str())),
            allowed: "a column of study.csv with numbers, and :min or :max behind it".to_owned(),
        })?;
        let name = columns[column].name.clone();
        if columns[column].kind == ColumnKind::Text {
            return Err(AnalysisError::NoNumbers(name));
        }
        let sense = sense.unwrap_or(usual_sense(&name));
        let is_exact = axes.contains(&column) || ["payload_kg", "price_eur"].contains(&name.as_str());
        Ok(Self { column, name, sense, noise: if is_exact { 0.0 } else { noise } })
    }

    /// The value of a row.
    pub fn value(&self, row: &[TableCell]) -> Option<f64> {
        match row.get(self.column)? {
            TableCell::Number(number) => Some(*number),
            TableCell::Count(count) => Some(*count as f64),
            TableCell::None | TableCell::Text(_) => None,
        }
    }

    /// Whether the difference of two values is within the noise.
    pub fn is_tie(&self, a: f64, b: f64) -> bool {
        (a - b).abs() <= (self.noise * a.abs().max(b.abs())).max(self.floor())
    }

    /// Whether a value is nothing but rounding.
    pub fn is_nothing(&self, value: f64) -> bool {
        value.abs() <= self.floor()
    }

    /// The difference up to which values are ties however small they are.
    fn floor(&self) -> f64 {
        if self.noise > 0.0 { NOTHING } else { 0.0 }
    }

    /// Whether the first value is at least as good as the second.
    pub fn is_as_good(&self, a: f64, b: f64) -> bool {
        self.sense.compare(a, b).is_le()
    }

    /// Whether the first value is better than the second by more than the noise.
    pub fn is_clearly_better(&self, a: f64, b: f64) -> bool {
        self.sense.compare(a, b).is_lt() && !self.is_tie(a, b)
    }
}

/// Margins, the feed that is held and the payload are better the larger they are; all else the smaller.
fn usual_sense(name: &str) -> Sense {
    let is_larger_better = name.starts_with("min_") || name.starts_with("max_feed") || name.starts_with("payload");
    if is_larger_better { Sense::Max } else { Sense::Min }
}

/// The nearest of some names.
pub(super) fn nearest<'n>(requested: &str, names: impl Iterator<Item = &'n str>) -> Option<String> {
    names.max_by(|a, b| strsim::jaro(a, requested).total_cmp(&strsim::jaro(b, requested))).map(str::to_owned)
}
