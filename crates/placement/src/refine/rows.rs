//! Matrices of a convex programme, as they are being built.

use super::linearise::Local;
use clarabel::algebra::CscMatrix;
use std::ops::RangeInclusive;
use stead_problem::limit::{Limit, Side};

/// Coefficients of inequalities `row . x <= bound`.
#[derive(Default)]
pub(super) struct Rows {
    pub row: Vec<usize>,
    pub column: Vec<usize>,
    pub value: Vec<f64>,
    pub bound: Vec<f64>,
    /// Which bound of the problem a row is of, and at which point; ascending by row, none behind those of the model.
    pub bounds: Vec<(usize, (Side, usize))>,
}

impl Rows {
    pub fn add(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, bound: f64) {
        let row = self.bound.len();
        for (column, value) in terms {
            self.row.push(row);
            self.column.push(column);
            self.value.push(value);
        }
        self.bound.push(bound);
    }

    /// `low <= terms <= high` at a point, each side only if a change of at most `swing` can reach it.
    pub fn add_between(
        &mut self,
        limit: Limit,
        point: usize,
        terms: &[(usize, f64)],
        range: RangeInclusive<f64>,
        swing: f64,
    ) {
        let (low, high) = range.into_inner();
        if high < swing {
            self.bounds.push((self.bound.len(), (Side { limit, is_upper: true }, point)));
            self.add(terms.iter().copied(), high);
        }
        if -low < swing {
            self.bounds.push((self.bound.len(), (Side { limit, is_upper: false }, point)));
            self.add(terms.iter().map(|(k, v)| (*k, -v)), -low);
        }
    }
}

/// The entries of a symmetric matrix on and above its diagonal.
#[derive(Default)]
pub(super) struct Triplets {
    row: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
}

impl Triplets {
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        self.row.push(row);
        self.column.push(column);
        self.value.push(value);
    }

    pub fn matrix(self, size: usize) -> CscMatrix<f64> {
        CscMatrix::new_from_triplets(size, size, self.row, self.column, self.value)
    }
}

/// The curvature of the objective, each point's by its share of `whole`, its beta and its lead, with tilt behind it,
/// being in the columns given: an arrow of the pose block, its coupling with every beta and lean, and their own.
pub(super) fn curvature(
    locals: &[Local],
    betas: &[usize],
    leans: &[Option<usize>],
    shares: &[f64],
    whole: f64,
) -> Triplets {
    let mut entries = Triplets::default();
    let mut pose = [[0.0; 4]; 4];
    for (i, local) in locals.iter().enumerate() {
        let share = shares[i] / whole;
        let leaning = local.leaning.as_ref().zip(leans[i]);
        let of = |j: usize, k: usize| match leaning {
            Some((leaning, _)) => leaning.curvature[(j, k)] * share,
            None => local.curvature[(j, k)] * share,
        };
        for k in 0..4 {
            for j in 0..=k {
                pose[j][k] += of(j, k);
            }
            entries.add(k, betas[i], of(k, 4));
        }
        entries.add(betas[i], betas[i], of(4, 4));
        let Some((_, column)) = leaning else { continue };
        for (k, column) in [(5, column), (6, column + 1)] {
            (0..4).for_each(|j| entries.add(j, column, of(j, k)));
            entries.add(betas[i], column, of(4, k));
            entries.add(column, column, of(k, k));
        }
        entries.add(column, column + 1, of(5, 6));
    }
    for (j, row) in pose.iter().enumerate() {
        (j..4).for_each(|k| entries.add(j, k, row[k]));
    }
    entries
}
