//! How near to stretched, folded or in line the bound on conditioning lets the elbow and the wrist come.
//!
//! For any joint velocity x, `|N^-1| >= |x| / |N x|` with N the normalised Jacobian, and `|N|^2 >= 6 + r^2 / L^2`. With
//! joints 2 and 3 moving the wrist centre least, and joints 4 and 6 turning against each other,
//! `6 / (|N| |N^-1|) >= min` gives bounds on the sines of the elbow and of the wrist that have no singularities of
//! their own. Joint 2 with a wrist that undoes its turn moves the tool centre point as far as the wrist centre:
//! `|N x| = |S| / L` with S the wrist centre from the shoulder, and `|x|^2 >= 1 + 1 / 2`, since the norm of
//! (z_4, z_5, z_6) is at most the root of 2. So S is never shorter than a length, which folded arms of nearly equal
//! links would come to.

use super::super::number::Number;
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use stead_model::robot::angles::ANGLE_ROUNDING;
use stead_problem::problem::Problem;

/// Squared velocities of a joint that turns by 1 and a wrist that undoes the turn, at least.
pub(super) const UNDONE: f64 = 1.5;
/// Squared sine of elbow and wrist below which too little is known.
const MIN_SINE2: f64 = 1e-4;

/// What the bound on conditioning asks of elbow and wrist by themselves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Needs {
    /// min^2 |N|^2 / 36 as `constant + per_radius2 r^2`.
    constant: f64,
    per_radius2: f64,
    /// (L / (upper arm times forearm))^2, to be multiplied by the squared distance of the wrist centre from the
    /// shoulder.
    pub elbow: f64,
    /// 1 + |lever|^2 / L^2.
    pub wrist: f64,
}

impl Needs {
    /// min^2 |N|^2 / 36, at least, at a squared distance of the tool centre point from axis 1 (m^2).
    #[inline(always)]
    pub fn at<T: Number>(&self, radius2: T) -> T {
        radius2.scale(self.per_radius2).plus(self.constant)
    }
}

/// How near to their singularities constraints let the elbow and the wrist come, anywhere in the cell.
pub(super) struct Limits {
    pub needs: Needs,
    /// Largest cosines of the elbow angle less half a turn, of the elbow angle, and of the angle between axes 4 and 6.
    /// None is below zero: what is continued beyond them is largest, or least, between them.
    pub folded: f64,
    pub stretched: f64,
    pub in_line: f64,
}

impl Limits {
    /// For an inverse condition of at least `min_condition` and radii of the tool centre point from `nearest` (m) on.
    pub fn new(problem: &Problem, min_condition: f64, nearest: f64) -> Self {
        let g = problem.robot.geometry();
        let length = problem.constraints.characteristic_length;
        let needs = Needs {
            constant: min_condition * min_condition / 6.0,
            per_radius2: min_condition * min_condition / (36.0 * length * length),
            elbow: (length / (g.upper_arm * g.forearm)).powi(2),
            wrist: 1.0 + tool_lever(problem).norm_squared() / (length * length),
        };
        let needed = needs.constant + needs.per_radius2 * nearest * nearest;
        let cosine = |sine2: f64| libm::sqrt(1.0 - sine2.clamp(0.0, 0.9));
        // How far joint 3 can fold the arm.
        let joint3 = &problem.robot.joints()[2];
        let (min, max) = (joint3.min + g.forearm_angle, joint3.max + g.forearm_angle);
        let shift = TAU * ((min + max) / (2.0 * TAU)).round();
        let widest = (min - shift).abs().max((max - shift).abs()) + ANGLE_ROUNDING;
        let by_joint = if widest >= PI { 1.0 } else { -libm::cos(widest) };
        // S is no shorter than that.
        let least2 = UNDONE * length * length * needed;
        let by_distance =
            (g.upper_arm * g.upper_arm + g.forearm * g.forearm - least2) / (2.0 * g.upper_arm * g.forearm);
        let at = |distance2: f64| cosine(needed * needs.elbow * distance2);
        Self {
            needs,
            folded: at((g.upper_arm - g.forearm) * (g.upper_arm - g.forearm)).min(by_joint).min(by_distance).max(0.0),
            stretched: at(g.upper_arm * g.upper_arm + g.forearm * g.forearm),
            in_line: cosine(needed / needs.wrist),
        }
    }
}

/// The bound on 1/kappa_F that a certificate needs, where the constraints ask for less: below it, the elbow and the
/// wrist may come so near to their singularities that nothing is known. For radii of the tool centre point from
/// `nearest` (m) on.
pub(in super::super) fn needed_condition(problem: &Problem, nearest: f64) -> Option<f64> {
    let requested = problem.constraints.min_inverse_condition;
    let fits = |min_condition: f64| {
        let limits = Limits::new(problem, min_condition, nearest);
        limits.folded.max(limits.stretched).max(limits.in_line) < libm::sqrt(1.0 - MIN_SINE2)
    };
    if fits(requested) {
        return None;
    }
    let (mut low, mut high) = (requested, 1.0);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if fits(middle) { high = middle } else { low = middle }
    }
    Some((high * 1e3).ceil() / 1e3)
}

/// Tool centre point from the wrist centre, in the flange frame. m
pub(super) fn tool_lever(problem: &Problem) -> Vector3<f64> {
    let mut lever = problem.spindle.flange_from_tool.translation;
    lever.z += problem.robot.geometry().flange;
    lever
}
