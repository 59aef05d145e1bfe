//! Inverses of symmetric matrices whose rows are in different units.

use nalgebra::{DMatrix, SMatrix};

/// The least pivot of a matrix with a unit diagonal at which its inverse is good.
pub(super) const MIN_PIVOT: f64 = 1e-7;

/// The inverse of a symmetric matrix that is positive definite after scaling its diagonal to one, with no pivot below a
/// least one.
pub(super) fn scaled_inverse(matrix: &DMatrix<f64>, least: f64) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    let scale: Vec<f64> = matrix.diagonal().iter().map(|value| 1.0 / libm::sqrt(*value)).collect();
    let scaled = DMatrix::from_fn(size, size, |a, b| (matrix[(a, b)] + matrix[(b, a)]) / 2.0 * scale[a] * scale[b]);
    if !scaled.iter().all(|value| value.is_finite()) {
        return None;
    }
    let factor = scaled.cholesky()?;
    if factor.l_dirty().diagonal().iter().any(|pivot| *pivot < least) {
        return None;
    }
    let inverse = factor.inverse();
    Some(DMatrix::from_fn(size, size, |a, b| (inverse[(a, b)] + inverse[(b, a)]) / 2.0 * scale[a] * scale[b]))
}

/// The same over the rows and columns that are free, zero elsewhere.
pub(super) fn inverse_over<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
    is_free: impl Fn(usize) -> bool,
    least: f64,
) -> Option<SMatrix<f64, N, N>> {
    let free: Vec<usize> = (0..N).filter(|k| is_free(*k)).collect();
    let part = DMatrix::from_fn(free.len(), free.len(), |a, b| matrix[(free[a], free[b])]);
    let inverse = scaled_inverse(&part, least)?;
    let mut whole = SMatrix::zeros();
    for (a, row) in free.iter().enumerate() {
        free.iter().enumerate().for_each(|(b, column)| whole[(*row, *column)] = inverse[(a, b)]);
    }
    Some(whole)
}
