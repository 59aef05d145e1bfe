//! A compensator's spring: how the stiffness of its joint hangs on its unknowns, and their first estimate.

use super::inverse::{MIN_PIVOT, inverse_over};
use super::normal_equations::{NormalEquations, Solution};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use serde::Serialize;

/// Where the two ends of a compensator's spring are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Geometry {
    /// Distance of the spring's one end from the joint axis. m
    pub a: f64,
    /// Distance of its other end from the joint axis. m
    pub l: f64,
    /// Angle between the two ends, less half a turn, at joint angle zero. rad
    pub alpha: f64,
}

impl Geometry {
    /// Stiffness of the joint per (K_theta, K_GC, s_0 K_GC) at an angle in rad (Klimchik et al. 2017, eq. 22,
    /// corrected).
    pub fn row(&self, angle: f64) -> Vector3<f64> {
        let (sine, cosine) = libm::sincos(angle + self.alpha);
        let product = self.a * self.l;
        let square = self.a * self.a + self.l * self.l + 2.0 * product * cosine;
        let length = libm::sqrt(square);
        Vector3::new(1.0, -product * cosine, product / length * (cosine + product / square * sine * sine))
    }
}

/// Eq. 21 with the inverse of the covariance of the stiffnesses as weights; `joints` says which of the others are free.
pub(super) fn spring_start<const N: usize>(
    normal: &NormalEquations<N>,
    joints: [bool; N],
    by_angle: &Solution<N>,
    rows: &[Vector3<f64>],
) -> Option<Vector3<f64>> {
    let mut matrix = Matrix3::zeros();
    let mut rhs = Vector3::zeros();
    let mut coupling = SMatrix::<f64, 3, N>::zeros();
    let mut coupling_rhs = SVector::<f64, N>::zeros();
    for ((group, row), compliance) in normal.groups.iter().zip(rows).zip(&by_angle.groups) {
        if *compliance <= 0.0 {
            continue;
        }
        // d(compliance) = -compliance^2 d(stiffness).
        let weighted = row * (compliance * compliance);
        matrix += weighted * weighted.transpose() * group.diagonal;
        rhs += weighted * (group.diagonal * compliance);
        coupling += weighted * group.coupling.transpose();
        coupling_rhs += group.coupling * *compliance;
    }
    // What is held is known, as far as the weights go.
    let is_free = |joint: usize| joints[joint] && normal.varying != Some(joint);
    (0..N).filter(|joint| !is_free(*joint)).for_each(|joint| {
        coupling.fill_column(joint, 0.0);
        coupling_rhs[joint] = 0.0;
    });
    let shared = inverse_over(&normal.shared, is_free, MIN_PIVOT)?;
    let matrix = matrix - coupling * shared * coupling.transpose();
    let rhs = rhs - coupling * shared * coupling_rhs;
    Some(inverse_over(&matrix, |_| true, MIN_PIVOT)? * rhs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use stead_model::robot::Compensator;

    proptest! {
        #[test]
        fn rows_give_the_stiffness_of_the_compensator(
            angle in -3.0..3.0_f64, alpha in -3.0..3.0_f64, a in 0.5..1.0_f64, l in 0.1..0.4_f64, free_length in 0.1..1.0_f64
        ) {
            let compensator = Compensator { spring_stiffness: 3e5, a, l, alpha, free_length };
            let row = Geometry { a, l, alpha }.row(angle);
            let unknowns = Vector3::new(2e6, 3e5, 3e5 * free_length);
            let expected = 2e6 + compensator.stiffness(angle);
            prop_assert!((row.dot(&unknowns) - expected).abs() < 1e-9 * 2e6);
        }
    }
}
