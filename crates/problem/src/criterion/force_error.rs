//! The largest score over all errors of the force up to a size.
//!
//! With A the deflection along the scored directions per force (a row each) and d the parts of the deflection without
//! an error, the score under an error e is `|d + A e|`. Its largest square over the ball `|e| <= r` is a trust-region
//! problem: with `B = A^T A` and `b = A^T d`, the maximiser satisfies `(lambda I - B) e = b` with `|e| = r` and lambda
//! not below the largest eigenvalue of B (Moré and Sorensen 1983), and for any such lambda
//! `|d|^2 + lambda r^2 + b . (lambda I - B)^-1 b` is not below it.

use nalgebra::{Matrix3, Vector3};
use stead_numerics::simd::{LaneNumber, Lanes, Mask, Simd};

/// The error of the force, of size `size` (N), under which the parts `parts` (m) of a deflection along the scored
/// directions become largest together, where they change by `gain` (m/N, a row for each direction) times the error.
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
#[cfg(test)]
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

/// A step of Newton's method below this share of the multiplier is the last: the gain is stationary at the root, so
/// that what is left of the way to it counts by its square.
const LAST_STEP: f64 = 1e-10;

/// [`worst_gain`] of several states at once: from the entries xx, yy, zz, xy, xz, yz of `A^T A` (m^2/N^2) and `A^T d`
/// (m^2/N). m^2
#[inline(always)]
pub(crate) fn worst_gains<S: Simd>(simd: S, curvature: [Lanes<S>; 6], slope: [Lanes<S>; 3], size: f64) -> Lanes<S> {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let trace = curvature[0] + curvature[1] + curvature[2];
    let moves = zero.less(trace);
    // Of size 1 and trace 1, as in `Scaled`.
    let inverse = one / moves.select(trace, one);
    let curvature = scaled(curvature, inverse);
    let b = scaled(slope, inverse * (1.0 / size));
    let length2 = dot(b, b);
    let has_slope = zero.less(length2);
    let along = has_slope.select(dot(b, times(curvature, b)) / has_slope.select(length2, one), zero);
    // No nearer than numbers of this kind tell.
    let [nearest, last_step] = [NEAREST, LAST_STEP].map(|least| least.max(32.0 * S::Number::EPSILON));
    let mut multiplier = (largest_eigenvalues(simd, curvature) + nearest).max(length2.sqrt() + along);
    let mut open = Mask::splat(simd, true);
    for _ in 0..MAX_STEPS {
        let (adjugate, inverse) = shifted(curvature, multiplier);
        let error = scaled(times(adjugate, b), inverse);
        let size2 = dot(error, error);
        let slope = dot(error, times(adjugate, error)) * inverse;
        let step = (size2.sqrt() - 1.0) * size2 / slope;
        // Of steps that are no number none is taken; at the floor the error can be too short at once.
        open = open & (multiplier * last_step).less(step);
        if !open.any() {
            break;
        }
        multiplier = multiplier + open.select(step, zero);
    }
    let (adjugate, inverse) = shifted(curvature, multiplier);
    let error = scaled(times(adjugate, b), inverse);
    moves.select(trace * (size * size) * (multiplier + dot(b, error)), zero)
}

// Functions rather than closures: only what is inlined always gets the instructions of its caller.

/// The adjugate of `lambda I - B`, and the inverse of its determinant.
#[inline(always)]
fn shifted<S: Simd>([xx, yy, zz, xy, xz, yz]: [Lanes<S>; 6], multiplier: Lanes<S>) -> ([Lanes<S>; 6], Lanes<S>) {
    let (x, y, z) = (multiplier - xx, multiplier - yy, multiplier - zz);
    let adjugate =
        [y * z - yz * yz, x * z - xz * xz, x * y - xy * xy, xy * z + xz * yz, xz * y + xy * yz, yz * x + xy * xz];
    let determinant = x * adjugate[0] - xy * adjugate[3] - xz * adjugate[4];
    (adjugate, multiplier.all(1.0) / determinant)
}

#[inline(always)]
fn scaled<S: Simd, const N: usize>(mut entries: [Lanes<S>; N], factor: Lanes<S>) -> [Lanes<S>; N] {
    for k in 0..N {
        entries[k] = entries[k] * factor;
    }
    entries
}

#[inline(always)]
fn dot<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> Lanes<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A symmetric matrix by its entries xx, yy, zz, xy, xz, yz times a vector.
#[inline(always)]
fn times<S: Simd>([xx, yy, zz, xy, xz, yz]: [Lanes<S>; 6], [x, y, z]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
}

/// The largest eigenvalues of symmetric matrices of trace 1, by their entries xx, yy, zz, xy, xz, yz, in closed form.
#[inline(always)]
fn largest_eigenvalues<S: Simd>(simd: S, [xx, yy, zz, xy, xz, yz]: [Lanes<S>; 6]) -> Lanes<S> {
    let third = 1.0 / 3.0;
    let (x, y, z) = (xx - third, yy - third, zz - third);
    let spread = ((x * x + y * y + z * z + (xy * xy + xz * xz + yz * yz) * 2.0) / 6.0).sqrt();
    let is_spread = Lanes::splat(simd, 1e-15).less(spread);
    let one = Lanes::splat(simd, 1.0);
    let inverse = one / is_spread.select(spread, one);
    let [x, y, z, xy, xz, yz] = scaled([x, y, z, xy, xz, yz], inverse);
    let determinant = x * (y * z - yz * yz) - xy * (xy * z - xz * yz) + xz * (xy * yz - xz * y);
    let half_cosine2 = (determinant * 0.25 + 0.5).max(Lanes::splat(simd, 0.0)).min(one);
    let at = half_cosine2.sqrt() * 2.0 - 1.0;
    let mut cosine = Lanes::splat(simd, THIRD_OF_ANGLE[THIRD_OF_ANGLE.len() - 1]);
    for k in (0..THIRD_OF_ANGLE.len() - 1).rev() {
        cosine = cosine * at + THIRD_OF_ANGLE[k];
    }
    is_spread.select(spread * 2.0 * cosine, Lanes::splat(simd, 0.0)) + third
}

/// `cos(2 acos(u) / 3)` by powers of `2 u - 1`, u being the cosine of half an angle: a Chebyshev fit on 0 <= u <= 1, to
/// 1e-15.
const THIRD_OF_ANGLE: [f64; 17] = [
    0.7660444431189779,
    0.24740906632284013,
    -0.015509188436466538,
    0.002466352815702471,
    -0.0005041246916553286,
    0.00011642544440247494,
    -2.8919930996008654e-05,
    7.541131605350304e-06,
    -2.035896969136149e-06,
    5.639775268445229e-07,
    -1.5946448920768576e-07,
    4.617955473808907e-08,
    -1.3482454942697049e-08,
    3.6016321207210484e-09,
    -1.0522633347918922e-09,
    5.267350653124788e-10,
    -1.6368329253261365e-10,
];

#[cfg(test)]
mod tests;
