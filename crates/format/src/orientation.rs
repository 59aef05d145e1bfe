//! The keys by which any table of a file states an orientation.

use crate::place::Place;
use crate::shapes::{Array, Matrix, Vector};
use crate::units::{Deg, Number};
use nalgebra::Matrix3;
use stead_disk::input::InputError;
use stead_numerics::rotation::{ROTATION_TOLERANCE, orthonormal, rotation_from_quaternion, rotation_from_zyx};

/// A quaternion `[w, x, y, z]`.
pub type Quaternion = Array<Number, 4>;

/// What a table has under the five keys, of which exactly one is to be there.
#[derive(Debug, Clone, Copy, Default)]
pub struct OrientationKeys {
    /// The rotation matrix, by rows.
    pub rotation: Option<Matrix>,
    /// KUKA's A, B, C.
    pub abc_deg: Option<Vector<Deg>>,
    /// Fanuc's W, P, R.
    pub wpr_deg: Option<Vector<Deg>>,
    /// Roll, pitch, yaw of a URDF.
    pub rpy_deg: Option<Vector<Deg>>,
    /// ABB's q1 to q4.
    pub quaternion_wxyz: Option<Quaternion>,
}

/// The keys of a table with fields of these names.
#[macro_export]
macro_rules! orientation_keys {
    ($table:expr) => {
        $crate::orientation::OrientationKeys {
            rotation: $table.rotation,
            abc_deg: $table.abc_deg,
            wpr_deg: $table.wpr_deg,
            rpy_deg: $table.rpy_deg,
            quaternion_wxyz: $table.quaternion_wxyz,
        }
    };
}
pub use crate::orientation_keys;

/// The five keys with what they stand for.
const KEYS: &str = "exactly one of rotation (matrix, by rows), abc_deg (Rz(A) Ry(B) Rx(C)), wpr_deg (Rz(R) Ry(P) Rx(W)), \
     rpy_deg (Rz(y) Ry(p) Rx(r)), quaternion_wxyz";

impl OrientationKeys {
    /// The keys that the table has.
    fn given(&self) -> Vec<&'static str> {
        [
            ("rotation", self.rotation.is_some()),
            ("abc_deg", self.abc_deg.is_some()),
            ("wpr_deg", self.wpr_deg.is_some()),
            ("rpy_deg", self.rpy_deg.is_some()),
            ("quaternion_wxyz", self.quaternion_wxyz.is_some()),
        ]
        .into_iter()
        .filter_map(|(key, is_given)| is_given.then_some(key))
        .collect()
    }

    /// Whether the table has any of the keys.
    pub fn is_given(&self) -> bool {
        !self.given().is_empty()
    }

    /// The rotation that the table states.
    ///
    /// # Errors
    /// [`InputError`] where none or several of the keys are there, for a matrix that is no rotation, and for a
    /// quaternion whose length is not 1.
    pub fn rotation(&self, at: &Place<'_>) -> Result<Matrix3<f64>, InputError> {
        if let [first, second, ..] = self.given()[..] {
            return Err(at.key(second).error(format!("states an orientation beside {first}"), KEYS));
        }
        if let Some([w, p, r]) = self.wpr_deg.or(self.rpy_deg).map(Array::si) {
            return Ok(rotation_from_zyx([r, p, w]));
        }
        if let Some(angles) = self.abc_deg {
            return Ok(rotation_from_zyx(angles.si()));
        }
        if let Some(quaternion) = self.quaternion_wxyz {
            let numbers = quaternion.0.map(|number| number.written());
            let norm = libm::sqrt(numbers.iter().map(|v| v * v).sum());
            let at = at.key("quaternion_wxyz");
            let no_unit =
                || at.error(format!("has length {norm:.6}"), format!("length 1 within {QUATERNION_TOLERANCE}"));
            let is_unit = (norm - 1.0).abs() <= QUATERNION_TOLERANCE;
            return is_unit.then(|| rotation_from_quaternion(numbers)).flatten().ok_or_else(no_unit);
        }
        let Some(printed) = self.rotation else { return Err(at.key("rotation").missing(KEYS)) };
        orthonormal(&printed.matrix()).map_err(|problem| {
            let rule = format!("a right-handed rotation matrix [row, row, row] within {ROTATION_TOLERANCE}");
            at.key("rotation").error(problem, rule)
        })
    }
}

/// How far a quaternion may be from length 1: five printed digits.
const QUATERNION_TOLERANCE: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spindle::SpindleTable;
    use crate::toml_file::TomlFile;

    fn read(text: &str) -> Result<Matrix3<f64>, String> {
        let source = TomlFile::new("t.toml".as_ref(), format!("xyz_mm = [0, 0, 1]\n{text}").into_bytes()).unwrap();
        let document = source.parse().unwrap();
        let table: SpindleTable = document.read().map_err(|e| e.to_string())?;
        orientation_keys!(table).rotation(&document.root()).map_err(|e| e.to_string())
    }

    /// The same orientation in the conventions of four makers.
    #[test]
    fn every_convention_states_the_same_orientation() {
        let expected = rotation_from_zyx([0.3, -0.4, 0.5].map(f64::to_radians));
        let deg = |v: [f64; 3]| format!("{v:?}");
        let rows: Vec<Vec<f64>> = (0..3).map(|r| (0..3).map(|c| expected[(r, c)]).collect()).collect();
        let quaternion = stead_numerics::rotation::quaternion_from_rotation(&expected);
        for text in [
            format!("abc_deg = {}", deg([0.3, -0.4, 0.5])),
            format!("wpr_deg = {}", deg([0.5, -0.4, 0.3])),
            format!("rpy_deg = {}", deg([0.5, -0.4, 0.3])),
            format!("rotation = {rows:?}"),
            format!("quaternion_wxyz = {quaternion:?}"),
        ] {
            assert!((read(&text).unwrap() - expected).norm() < 1e-15 * 8.0, "{text}");
        }
    }

    #[test]
    fn none_several_and_what_is_no_rotation_are_refused() {
        assert!(read("").unwrap_err().contains("rotation: is missing; allowed: exactly one of rotation"));
        let both = read("abc_deg = [0, 0, 0]\nrpy_deg = [0, 0, 0]").unwrap_err();
        assert!(
            both.starts_with("t.toml:3: rpy_deg: states an orientation beside abc_deg, found [0, 0, 0]; "),
            "{both}"
        );
        let long = read("quaternion_wxyz = [1, 0, 0, 0.1]").unwrap_err();
        assert!(long.contains("has length 1.004988") && long.contains("length 1 within 0.0001"), "{long}");
        assert!(read("quaternion_wxyz = [0, 0, 0, 0]").unwrap_err().contains("has length 0.000000"));
        assert!(read("rotation = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]").unwrap_err().contains("a reflection"));
    }
}
