//! The direction in which the mean score is optimised.

use serde::Serialize;
use std::cmp::Ordering;

/// Whether the mean score is minimised or maximised.
///
/// Over placements, `Min` finds the best placement and `Max` the worst, each valued under its best plan; over the plans of
/// one placement, `Min` finds the best plan and `Max` the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sense {
    /// Minimise.
    Min,
    /// Maximise.
    Max,
}

impl Sense {
    /// Both senses, in this order.
    pub const BOTH: [Self; 2] = [Self::Min, Self::Max];

    /// +1 or -1: values times this are minimised.
    pub fn sign(self) -> f64 {
        match self {
            Self::Min => 1.0,
            Self::Max => -1.0,
        }
    }

    /// The other sense.
    pub fn other(self) -> Self {
        match self {
            Self::Min => Self::Max,
            Self::Max => Self::Min,
        }
    }

    /// Order of two values, better first.
    pub fn compare(self, a: f64, b: f64) -> Ordering {
        match self {
            Self::Min => a.total_cmp(&b),
            Self::Max => b.total_cmp(&a),
        }
    }
}
