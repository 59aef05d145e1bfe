//! The largest score over all errors of the force up to a size.
//!
//! With A the deflection along the scored directions per force (a row each) and d the parts of the deflection without an
//! error, the score under an error e is `|d + A e|`. Its largest square over the ball `|e| <= r` is a trust-region problem: with
//! `B = A^T A` and `b = A^T d`, the maximiser satisfies `(lambda I - B) e = b` with `|e| = r` and lambda not below the
//! largest eigenvalue of B (Moré and Sorensen 1983), and for any such lambda
//! `|d|^2 + lambda r^2 + b . (lambda I - B)^-1 b` is not below it.

use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// The error of the force, of size `size` (N), under which the parts `parts` (m) of a deflection along the scored directions
/// become largest together, where they change by `gain` (m/N, a row for each direction) times the error.
pub fn worst_force_error(gain: &Matrix3<f64>, parts: &Vector3<f64>, size: f64) -> Vector3<f64> {
    let Some(problem) = Scaled::new(gain.tr_mul(gain), gain.tr_mul(parts), size) else { return Vector3::zeros() };
    let multiplier = problem.multiplier();
    let (error, top) = (problem.solve(multiplier), problem.solve_adjugate(multiplier));
    // Where the slope has nothing along the softest direction, what is missing of the size lies along that.
    let missing = 1.0 - error.norm_squared();
    let error = if missing > 1e-9 {
        let along = error.dot(&top);
        let side = if along < 0.0 { -1.0 } else { 1.0 };
        error + top * (side * (libm::sqrt(along * along + missing) - along.abs()))
    } else {
        error
    };
    error * (size / error.norm())
}

/// How much the square of a score can grow by errors of the force of up to `size` (N): `max |d + A e|^2 - |d|^2`, from
/// `A^T A` (m^2/N^2) and `A^T d` (m^2/N). m^2
pub(crate) fn worst_gain(curvature: Matrix3<f64>, slope: Vector3<f64>, size: f64) -> f64 {
    let unit = curvature.trace() * size * size;
    let Some(problem) = Scaled::new(curvature, slope, size) else { return 0.0 };
    let multiplier = problem.multiplier();
    unit * (multiplier + problem.slope.dot(&problem.solve(multiplier)))
}

/// The problem for an error of size 1 and a matrix of trace 1.
struct Scaled {
    curvature: Matrix3<f64>,
    slope: Vector3<f64>,
}

/// Steps of Newton's method at the most; three to five are usual.
const MAX_STEPS: usize = 40;
/// Nearness to the largest eigenvalue at which the slope counts as having nothing along its direction.
const NEAREST: f64 = 1e-11;

impl Scaled {
    /// Nothing where no force moves anything.
    fn new(curvature: Matrix3<f64>, slope: Vector3<f64>, size: f64) -> Option<Self> {
        let trace = curvature.trace();
        (trace > 0.0 && size > 0.0).then(|| Self { curvature: curvature / trace, slope: slope / (trace * size) })
    }

    /// `lambda I - B`, its adjugate and its determinant.
    fn shifted(&self, multiplier: f64) -> (Matrix3<f64>, f64) {
        let m = Matrix3::from_diagonal_element(multiplier) - self.curvature;
        let [x, y, z] = [m.column(0), m.column(1), m.column(2)].map(|column| column.into_owned());
        let adjugate = Matrix3::from_columns(&[y.cross(&z), z.cross(&x), x.cross(&y)]);
        (adjugate, x.dot(&y.cross(&z)))
    }

    /// `(lambda I - B)^-1 b`.
    fn solve(&self, multiplier: f64) -> Vector3<f64> {
        let (adjugate, determinant) = self.shifted(multiplier);
        adjugate * self.slope / determinant
    }

    /// The unit vector along which `lambda I - B` is nearest to singular.
    fn solve_adjugate(&self, multiplier: f64) -> Vector3<f64> {
        let (adjugate, _) = self.shifted(multiplier);
        let largest = (0..3).max_by(|a, b| adjugate.column(*a).norm().total_cmp(&adjugate.column(*b).norm()));
        adjugate.column(largest.unwrap_or(0)).normalize()
    }

    /// The largest eigenvalue, in closed form.
    fn largest_eigenvalue(&self) -> f64 {
        let centred = self.curvature - Matrix3::from_diagonal_element(1.0 / 3.0);
        let spread = libm::sqrt(centred.norm_squared() / 6.0);
        if spread < 1e-15 {
            return 1.0 / 3.0;
        }
        let cosine = (0.5 * (centred / spread).determinant()).clamp(-1.0, 1.0);
        let angle = libm::acos(cosine) / 3.0;
        debug_assert!((0.0..=PI / 3.0 + 1e-12).contains(&angle));
        1.0 / 3.0 + 2.0 * spread * libm::cos(angle)
    }

    /// The multiplier at which the error has size 1: Newton's method on the inverse of its length, which is concave and
    /// rises, from a lower bound, so that every step stays below the root.
    fn multiplier(&self) -> f64 {
        let length = self.slope.norm();
        let along = if length > 0.0 { self.slope.dot(&(self.curvature * self.slope)) / (length * length) } else { 0.0 };
        let floor = self.largest_eigenvalue() + NEAREST;
        let mut multiplier = floor.max(length + along);
        for _ in 0..MAX_STEPS {
            let (adjugate, determinant) = self.shifted(multiplier);
            let error = adjugate * self.slope / determinant;
            let (size2, slope) = (error.norm_squared(), error.dot(&(adjugate * error)) / determinant);
            let size = libm::sqrt(size2);
            let step = (size - 1.0) * size2 / slope;
            // At the floor the error can be too short at once.
            if step.is_nan() || step <= 1e-14 * multiplier {
                break;
            }
            multiplier += step;
        }
        multiplier
    }
}
