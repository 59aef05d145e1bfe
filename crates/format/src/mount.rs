//! The table `[mount]`: where the robot stands in its cell.

use crate::orientation::{Quaternion, orientation_keys};
use crate::place::Place;
use crate::shapes::{Matrix, Vector};
use crate::units::{Deg, Mm};
use nalgebra::Matrix3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_disk::input::InputError;
use stead_model::robot::Pose;

/// The base frame of the robot's rows in the cell frame, whose z axis points up: on a pedestal, on a wall, under the
/// ceiling. With this table all that is stated in the base frame (cell, placements, results) is in the cell frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MountTable {
    /// Origin of the base frame in the cell frame.
    pub xyz_mm: Vector<Mm>,
    /// Rotation from base to cell coordinates, by rows; at most one of this and the four keys below, upright where none
    /// is there.
    pub rotation: Option<Matrix>,
    /// The same as KUKA's A, B, C: Rz(A) Ry(B) Rx(C).
    pub abc_deg: Option<Vector<Deg>>,
    /// The same as Fanuc's W, P, R: Rz(R) Ry(P) Rx(W).
    pub wpr_deg: Option<Vector<Deg>>,
    /// The same as roll, pitch, yaw of a URDF: Rz(y) Ry(p) Rx(r).
    pub rpy_deg: Option<Vector<Deg>>,
    /// The same as ABB's quaternion.
    pub quaternion_wxyz: Option<Quaternion>,
}

impl MountTable {
    /// Pose of the base frame in the cell frame.
    ///
    /// # Errors
    /// [`InputError`] for several orientations, and for one that is none.
    pub fn cell_from_base(&self, at: &Place<'_>) -> Result<Pose<f64>, InputError> {
        let keys = orientation_keys!(self);
        let rotation = if keys.is_given() { keys.rotation(at)? } else { Matrix3::identity() };
        Ok(Pose { rotation, translation: self.xyz_mm.vector() })
    }
}
