//! Compliance matrices as files state them: of what carries the robot, of the mount of the spindle, of holder and tool,
//! of the part.
//!
//! A 6x6 answers force and moment (N, N m) by displacement and turn, translations first: its blocks are in um/N,
//! urad/N, urad/N and urad/(N m). A 3x3 answers a force by displacement, in um/N.

use crate::place::Place;
use crate::shapes::{Array, Matrix, SEMIDEFINITE, Vector};
use crate::units::{Mm, Number};
use nalgebra::{Matrix3, Matrix6, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_disk::input::InputError;
use stead_model::robot::BaseCompliance;
use stead_model::stiffness::matrix::{MatrixError, checked};

/// Six rows of six numbers.
pub type WrenchMatrix = Array<Array<Number, 6>, 6>;

/// The numbers of files in SI units.
const MICRO: f64 = 1e-6;

/// How what carries the robot yields: foundation, pedestal, rail, vehicle. It is added to what the joints do, so that
/// their stiffness must not have it in it already (`stiffness_measured_from` of the robot file).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BaseComplianceTable {
    /// The point at which the matrix holds, in the base frame of the robot file; its origin where left out.
    pub point_mm: Option<Vector<Mm>>,
    /// Displacement and turn of the point per force and moment there, in the directions of the base frame, translations
    /// first: um/N, urad/N; urad/N, urad/(N m).
    pub matrix: WrenchMatrix,
}

/// How the part yields at the tool: the same at every point of the path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PartComplianceTable {
    /// Displacement of the part per force on it, in the directions of the workpiece frame, in um/N.
    pub um_per_n: Matrix,
}

impl BaseComplianceTable {
    /// The compliance that the table describes.
    ///
    /// # Errors
    /// [`InputError`] at an entry that makes it none.
    pub fn base_compliance(&self, at: &Place<'_>) -> Result<BaseCompliance, InputError> {
        let point = self.point_mm.map_or_else(Vector3::zeros, Vector::vector);
        let matrix = wrench_matrix(&self.matrix, &at.key("matrix"))?;
        BaseCompliance::new(point, matrix).map_err(|error| located(&at.key("matrix"), &error))
    }
}

impl PartComplianceTable {
    /// The matrix that the table states. m/N
    ///
    /// # Errors
    /// [`InputError`] at an entry that makes it no compliance.
    pub fn matrix(&self, at: &Place<'_>) -> Result<Matrix3<f64>, InputError> {
        force_matrix(&self.um_per_n, &at.key("um_per_n"))
    }
}

/// A 6x6 in SI units.
///
/// # Errors
/// [`InputError`] at an entry that makes it no compliance.
pub(crate) fn wrench_matrix(rows: &WrenchMatrix, at: &Place<'_>) -> Result<Matrix6<f64>, InputError> {
    let matrix = Matrix6::from_fn(|row, column| rows.0[row].0[column].written() * MICRO);
    checked(matrix).map_err(|error| located(at, &error))
}

/// A 3x3 in SI units.
///
/// # Errors
/// [`InputError`] at an entry that makes it no compliance.
pub(crate) fn force_matrix(rows: &Matrix, at: &Place<'_>) -> Result<Matrix3<f64>, InputError> {
    checked(rows.matrix() * MICRO).map_err(|error| located(at, &error))
}

/// A broken rule of a matrix, at its line of the file.
fn located(at: &Place<'_>, error: &MatrixError) -> InputError {
    let entry = |row: usize, column: usize| at.element(row + 1).element(column + 1);
    match *error {
        MatrixError::NotFinite { row, column, value } => {
            entry(row, column).error(format!("is {value} in SI units"), "a number that is finite in SI units")
        }
        MatrixError::NotSymmetric { row, column, .. } => {
            let mirror = entry(column, row);
            let problem = format!("makes the matrix unsymmetric, against {} = {}", mirror.path, mirror.written());
            entry(row, column).error(problem, "the same number on both sides of the diagonal, up to 1e-9 of the trace")
        }
        MatrixError::Negative(eigenvalue) => {
            at.error(format!("has an eigenvalue of {:.3e}", eigenvalue / MICRO), SEMIDEFINITE)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toml_file::TomlFile;
    use std::path::Path;

    const GOOD: &str = "point_mm = [100, 0, -200]
matrix = [
    [0.02, 0, 0, 0, 0.01, 0],
    [0, 0.02, 0, -0.01, 0, 0],
    [0, 0, 0.01, 0, 0, 0],
    [0, -0.01, 0, 0.06, 0, 0],
    [0.01, 0, 0, 0, 0.06, 0],
    [0, 0, 0, 0, 0, 0.05],
]
";

    fn read(text: &str) -> Result<BaseCompliance, InputError> {
        let source = TomlFile::new(Path::new("run.toml"), text.as_bytes().to_vec())?;
        let document = source.parse()?;
        document.read::<BaseComplianceTable>()?.base_compliance(&document.root())
    }

    #[test]
    fn matrices_become_si() {
        let base = read(GOOD).unwrap();
        assert_eq!(*base.point(), Vector3::new(0.1, 0.0, -0.2));
        let matrix = base.matrix();
        assert!((matrix[(0, 0)] - 2e-8).abs() < 1e-22 && (matrix[(1, 3)] + 1e-8).abs() < 1e-22);
        assert_eq!(*read(&GOOD[GOOD.find("matrix").unwrap()..]).unwrap().point(), Vector3::zeros());
    }

    #[test]
    fn what_is_no_compliance_is_refused_at_its_entry() {
        for (from, to, parts) in [
            (
                "[0.01, 0, 0, 0, 0.06, 0]",
                "[0.011, 0, 0, 0, 0.06, 0]",
                ["run.toml:7: matrix[5][1]: ", "unsymmetric, against matrix[1][5] = 0.01", "found 0.011", "1e-9"],
            ),
            (
                "[0, 0, 0.01, 0, 0, 0]",
                "[0, 0, -0.01, 0, 0, 0]",
                ["run.toml:2: matrix: ", "eigenvalue of -1.000e-2", "no eigenvalue below 0", "semidefinite"],
            ),
            ("0.05],\n", "],\n", ["run.toml:8: matrix[6]: ", "5 elements and not 6", "six rows of six", ""]),
            ("0.05],\n", "nan],\n", ["run.toml:8: matrix[6][6]: ", "found nan", "finite numbers", ""]),
            ("point_mm", "points_mm", ["run.toml:1: points_mm: ", "nearest known one: point_mm", "", ""]),
        ] {
            assert!(GOOD.contains(from));
            let message = read(&GOOD.replacen(from, to, 1)).unwrap_err().to_string();
            parts.iter().for_each(|part| assert!(message.contains(part), "{part} in {message}"));
        }
    }
}
