//! Compliance matrices: what of a matrix of numbers can be how something yields.

use nalgebra::{DMatrix, SMatrix, SymmetricEigen};

/// Why a matrix of numbers is no compliance. Rows and columns count from 0.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MatrixError {
    /// An entry is NaN or infinite.
    #[error("entry ({row}, {column}) is {value}, but must be finite")]
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// What was found, in SI units.
        value: f64,
    },
    /// An entry differs from its mirror image by more than rounding.
    #[error("entry ({row}, {column}) is {value}, but its mirror image is {mirrored}")]
    NotSymmetric {
        /// Its row.
        row: usize,
        /// Its column, below the row.
        column: usize,
        /// What was found, in SI units.
        value: f64,
        /// The entry with row and column exchanged, in SI units.
        mirrored: f64,
    },
    /// Some load would be answered against its direction: the smallest eigenvalue, in SI units.
    #[error("the matrix has an eigenvalue of {0}, but none may be below zero")]
    Negative(f64),
}

/// What rounding may do to symmetry and eigenvalues: a share of the trace.
const ROUNDING: f64 = 1e-9;

/// A compliance matrix in SI units, made exactly symmetric.
///
/// # Errors
/// [`MatrixError`] unless it is finite, symmetric and positive semidefinite, the last two up to 1e-9 of its trace.
pub fn checked<const N: usize>(matrix: SMatrix<f64, N, N>) -> Result<SMatrix<f64, N, N>, MatrixError> {
    for row in 0..N {
        for column in 0..N {
            let value = matrix[(row, column)];
            if !value.is_finite() {
                return Err(MatrixError::NotFinite { row, column, value });
            }
        }
    }
    let rounding = ROUNDING * matrix.trace().abs();
    for row in 0..N {
        for column in 0..row {
            let (value, mirrored) = (matrix[(row, column)], matrix[(column, row)]);
            if (value - mirrored).abs() > rounding {
                return Err(MatrixError::NotSymmetric { row, column, value, mirrored });
            }
        }
    }
    let symmetric = (matrix + matrix.transpose()) * 0.5;
    let dynamic = DMatrix::from_fn(N, N, |row, column| symmetric[(row, column)]);
    let eigenvalue = SymmetricEigen::new(dynamic).eigenvalues.min();
    if eigenvalue < -rounding {
        return Err(MatrixError::Negative(eigenvalue));
    }
    Ok(symmetric)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, matrix};

    #[test]
    fn what_is_no_compliance_is_refused() {
        let good = matrix![2.0, 0.5, 0.0; 0.5, 1.0, 0.0; 0.0, 0.0, 0.0];
        assert_eq!(checked(good), Ok(good));
        assert_eq!(checked(Matrix3::<f64>::zeros()), Ok(Matrix3::zeros()));
        let with = |row, column, value| {
            let mut matrix = good;
            matrix[(row, column)] = value;
            checked(matrix).unwrap_err()
        };
        assert!(matches!(with(1, 2, f64::NAN), MatrixError::NotFinite { row: 1, column: 2, .. }));
        assert!(matches!(with(1, 0, 0.5 + 4e-9), MatrixError::NotSymmetric { row: 1, column: 0, mirrored: 0.5, .. }));
        assert!(matches!(with(2, 2, -4e-9), MatrixError::Negative(eigenvalue) if eigenvalue < 0.0));
        // Up to a billionth of the trace it is rounding.
        let mut rounded = good;
        rounded[(1, 0)] += 2e-9;
        let made = checked(rounded).unwrap();
        assert_eq!(made, made.transpose());
        rounded[(2, 2)] = -2e-9;
        assert!(checked(rounded).is_ok());
    }
}
