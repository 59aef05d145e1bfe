//! Poses, rotations and places as the page's script reads them.

use nalgebra::{Matrix3, Vector3};
use stead_model::robot::Pose;

records! {
    /// A pose.
    pub struct PoseData from pose: &Pose<f64> {
        /// Its rotation matrix, by rows.
        rotation: [[f64; 3]; 3] = rows(&pose.rotation),
        /// Its origin. mm
        xyz_mm: [f64; 3] = mm(&pose.translation),
    }
}

/// A rotation matrix by rows.
pub(super) fn rows(rotation: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| rotation[(row, column)]))
}

/// A place. mm
pub(super) fn mm(vector: &Vector3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z].map(|value| value * 1e3)
}
