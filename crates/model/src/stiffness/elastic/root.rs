//! A root of a compliance matrix.

use nalgebra::SMatrix;

/// What rounding leaves of a matrix with a diagonal of ones.
const ROUNDING: f64 = 1e-14;

/// S with `S S^T = C` for a symmetric and positive semidefinite C: Cholesky's factor with the largest of what is left
/// first, of C scaled to a diagonal of ones, so that directions in which nothing yields and entries of other units cost
/// no digits.
pub(super) fn of<const N: usize>(matrix: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    let size: [f64; N] = std::array::from_fn(|k| libm::sqrt(matrix[(k, k)].max(0.0)));
    let scaled = |row: usize, column: usize| {
        let product = size[row] * size[column];
        if product > 0.0 { matrix[(row, column)] / product } else { 0.0 }
    };
    let mut left = SMatrix::<f64, N, N>::from_fn(scaled);
    let mut root = SMatrix::<f64, N, N>::zeros();
    for column in 0..N {
        let pivot = (0..N).fold(0, |best, k| if left[(k, k)] > left[(best, best)] { k } else { best });
        if left[(pivot, pivot)] <= ROUNDING {
            break;
        }
        let factor = left.column(pivot) / libm::sqrt(left[(pivot, pivot)]);
        left -= factor * factor.transpose();
        for row in 0..N {
            root[(row, column)] = factor[row] * size[row];
        }
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix6, Vector6};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn its_square_is_the_matrix_whatever_its_rank(
            entries in prop::collection::vec(-1.0..1.0_f64, 36), rank in 0..7_usize, sizes in prop::array::uniform6(0.0..4.0_f64)
        ) {
            let made = Matrix6::from_fn(|row, column| if column < rank { entries[6 * row + column] } else { 0.0 });
            let size = Matrix6::from_diagonal(&Vector6::from(sizes.map(|size| libm::exp10(-4.0 * size))));
            let matrix = size * made * made.transpose() * size;
            let root = of(&matrix);
            let found = root * root.transpose();
            for row in 0..6 {
                for column in 0..6 {
                    let scale = libm::sqrt(matrix[(row, row)] * matrix[(column, column)]);
                    prop_assert!((found[(row, column)] - matrix[(row, column)]).abs() <= 1e-13 * scale);
                }
            }
        }
    }
}
