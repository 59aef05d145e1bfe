//! The direction in which the mean score is optimised.

use serde::Serialize;
use std::cmp::Ordering;
use std::ops::{Index, IndexMut};

/// Whether the mean score is minimised or maximised.
///
/// Over placements, `Min` finds the best placement and `Max` the worst, each valued under its best plan; over the plans
/// of one placement, `Min` finds the best plan and `Max` the worst.
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

/// One value for either sense: of the best and of the worst placement, or of the best and the worst plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct BySense<T> {
    /// [`Sense::Min`].
    pub best: T,
    /// [`Sense::Max`].
    pub worst: T,
}

impl<T> BySense<T> {
    /// What a function makes of either sense, the best first.
    pub fn from_fn(mut of: impl FnMut(Sense) -> T) -> Self {
        Self { best: of(Sense::Min), worst: of(Sense::Max) }
    }

    /// What a function makes of either value, the best first.
    pub fn map<U>(self, mut of: impl FnMut(T) -> U) -> BySense<U> {
        BySense { best: of(self.best), worst: of(self.worst) }
    }

    /// References to both values.
    pub fn as_ref(&self) -> BySense<&T> {
        BySense { best: &self.best, worst: &self.worst }
    }

    /// Both values with their senses, the best first.
    pub fn iter(&self) -> impl Iterator<Item = (Sense, &T)> {
        [(Sense::Min, &self.best), (Sense::Max, &self.worst)].into_iter()
    }

    /// The same to change them.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = (Sense, &mut T)> {
        [(Sense::Min, &mut self.best), (Sense::Max, &mut self.worst)].into_iter()
    }

    /// Both values, the best first.
    pub fn values(&self) -> [&T; 2] {
        [&self.best, &self.worst]
    }
}

impl<T> Index<Sense> for BySense<T> {
    type Output = T;

    fn index(&self, sense: Sense) -> &T {
        match sense {
            Sense::Min => &self.best,
            Sense::Max => &self.worst,
        }
    }
}

impl<T> IndexMut<Sense> for BySense<T> {
    fn index_mut(&mut self, sense: Sense) -> &mut T {
        match sense {
            Sense::Min => &mut self.best,
            Sense::Max => &mut self.worst,
        }
    }
}
