//! The estimates that agree best with the readings where no compliance may be below zero.
//!
//! A compliance that the readings hardly tell may come out below zero by chance, and no robot file can have it so. The
//! nearest estimates with compliances that can be split among the springs at or above their lowest values, in the
//! metric of the covariance, are a least-squares problem with unknowns at or above zero (Lawson and Hanson 1974,
//! chapter 23).

use nalgebra::{DMatrix, DVector};

/// The least `|A x - b|` over `x >= 0`; nothing where it does not come to an end.
pub fn non_negative(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let unknowns = a.ncols();
    // In units in which all columns have length one.
    let lengths = DVector::from_iterator(unknowns, a.column_iter().map(|column| column.norm().max(f64::MIN_POSITIVE)));
    let a = DMatrix::from_fn(a.nrows(), unknowns, |row, k| a[(row, k)] / lengths[k]);
    let mut x = DVector::zeros(unknowns);
    let mut free = vec![false; unknowns];
    for _ in 0..10 * unknowns {
        let gradient = a.tr_mul(&(b - &a * &x));
        let best = (0..unknowns).filter(|k| !free[*k]).max_by(|p, q| gradient[*p].total_cmp(&gradient[*q]));
        let Some(next) = best.filter(|best| gradient[*best] > FLAT * b.norm()) else {
            return Some(x.component_div(&lengths));
        };
        free[next] = true;
        loop {
            let of: Vec<usize> = (0..unknowns).filter(|k| free[*k]).collect();
            let part = a.select_columns(&of);
            let Some(factor) = part.tr_mul(&part).cholesky() else {
                // What it would add is in the others already.
                return Some(x.component_div(&lengths));
            };
            let solved = factor.solve(&part.tr_mul(b));
            let mut target = DVector::zeros(unknowns);
            of.iter().zip(solved.iter()).for_each(|(k, value)| target[*k] = *value);
            let blocked = of.iter().filter(|k| target[**k] <= 0.0);
            let share = blocked.map(|k| x[*k] / (x[*k] - target[*k])).fold(f64::INFINITY, f64::min);
            if share > 1.0 {
                x = target;
                break;
            }
            x += (&target - &x) * share;
            for k in of {
                if x[k] <= SMALL * target.amax() {
                    x[k] = 0.0;
                    free[k] = false;
                }
            }
            if !free.contains(&true) {
                break;
            }
        }
    }
    None
}

/// Below this share of what it is compared with, a number is rounding.
const SMALL: f64 = 1e-12;
/// A gradient of so small a share of the right-hand side leads nowhere.
const FLAT: f64 = 1e-10;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_gradient_leads_further(
            entries in prop::collection::vec(-1.0..1.0_f64, 5 * 7), right in prop::collection::vec(-1.0..1.0_f64, 5)
        ) {
            // More unknowns than equations: dependent columns.
            let (a, b) = (DMatrix::from_vec(5, 7, entries), DVector::from_vec(right));
            let x = non_negative(&a, &b).unwrap();
            let gradient = a.tr_mul(&(&b - &a * &x));
            for k in 0..7 {
                prop_assert!(x[k] >= 0.0 && gradient[k] < 1e-9, "{} {}", x, gradient);
                prop_assert!(x[k] == 0.0 || gradient[k].abs() < 1e-9, "{} {}", x, gradient);
            }
        }
    }
}
