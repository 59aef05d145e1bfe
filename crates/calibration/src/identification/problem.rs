//! Inputs of an identification.

use super::law::Law;
use super::sheet::Sheet;
use super::springs::FitModel;
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::{MeasuredFrom, Robot};

/// Inputs of an identification: the starting arm, the measurements and what is known beside them. SI units, radians.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The arm to start from: geometry, limits, and compliances of about the right size; on a base that yields
    /// ([`Robot::base_compliance`]) where that is known and in the readings, which then do not tell it.
    pub robot: Robot,
    /// Which springs are sought.
    pub model: FitModel,
    /// What the measuring instrument stood on, where that is stated.
    pub measured_from: Option<MeasuredFrom>,
    /// The measurements.
    pub sheet: Sheet,
    /// Where the wrench acts, in the flange frame. m
    pub load_point: Vector3<f64>,
    /// Standard deviation of a coordinate of one reading, if known; always known in sheets with orientations. m
    pub noise: Option<f64>,
    /// Standard deviation of a component of one orientation; used in sheets with orientations. rad
    pub orientation_noise: Option<f64>,
    /// The joint (from 0) with one compliance for each distinct angle, and the law of those.
    pub varying: Option<(usize, Law)>,
    /// Angles of that joint that differ by no more than this count as one. rad
    pub angle_tolerance: f64,
    /// Rotation from the robot base to the tracker's frame to start from; without it, all round.
    pub start: Option<Matrix3<f64>>,
    /// Whether unidentifiable parameters are held at the values of `robot`; else they are refused.
    pub reduce: bool,
    /// Joints whose compliance about their axis is held at that of `robot`, whatever the readings tell of it.
    pub hold: [bool; 6],
    /// The same of the springs about x and y of each joint, where all are sought; rigid where `robot` states none.
    pub hold_normal: [[bool; 2]; 6],
}
