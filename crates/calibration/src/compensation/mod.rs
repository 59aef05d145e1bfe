//! Offline compensation of deflections: the path to command so that the loaded tool follows its target path.
//!
//! Under a wrench the tool comes to rest beside the pose that was commanded. For every point of a plan, [`compensate`]
//! looks for the commanded pose t* at which the loaded tool rests at the target t_0 (Klimchik et al. 2017, eq. 26),
//! `t_0 = f(t*)`, by the iteration of eq. 27, `t* <- t* + alpha (t_0 - f(t*))`. Errors of orientation are corrected
//! with those of position, as rotation vectors. f is given by the [`DeflectionModel`]; the wrench keeps its directions
//! in space, and posture and turns are those of the plan.
//!
//! A correction is about as large as the deflection, and over so small a way the deflection hardly changes: with
//! `alpha = 1` each iteration takes another factor of about deflection over arm length off the error. A smaller alpha
//! leaves `1 - alpha` of the error each time, which a very soft arm may need. An iteration that does not converge is
//! never taken for a correction: such a point keeps its target, with the reason.
//!
//! What yields is all that the arm has: springs about the joint axes and normal to them, base, mount of the spindle,
//! holder and tool ([`stead_model::stiffness::elastic`]); a part that yields moves against the force on the tool, and
//! the tool is to rest at the target on the part. With [`Settings::gravity`] the weight of links and spindle, as far as
//! their masses are known, bends the arm too.
//!
//! Then the commands are executed in simulation: on the same arm, or on another one of the same geometry, which stands
//! for reality. There the arm always comes to rest in its exact static equilibrium. The remaining error is the share of
//! the deflection that the model does not predict.

mod iteration;
mod outcome;

#[cfg(test)]
mod tests;

pub use outcome::{CompensatedPath, CompensatedPoint, Deflection, NotCompensated, PointError, Status, reduction};
pub use stead_numerics::mean_max::MeanAndMax;

use nalgebra::Vector3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::robot::{Pose, Posture, Robot, Spindle};
use stead_numerics::monitor::{Monitor, Progress, Stop};

/// Inputs of a compensation. SI units, radians.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensationProblem {
    /// The arm by whose model the corrections are computed.
    pub robot: Robot,
    /// The arm that executes the corrected commands, of the same geometry ([`other_geometry`]).
    pub reality: Robot,
    /// The spindle as mounted.
    pub spindle: Spindle,
    /// The points of the plan, in order.
    pub points: Vec<PathPoint>,
    /// Settings of the iteration.
    pub settings: Settings,
}

/// One point of a plan: where the tool is to be under which wrench.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Number of its segment, from 1.
    pub segment: usize,
    /// The target t_0: the tool frame (7, at the tool centre point) in the base frame.
    pub base_from_tool: Pose<f64>,
    /// The posture of the arm.
    pub posture: Posture,
    /// The joint angles of the plan, which tell the turns. rad
    pub joints: [f64; 6],
    /// Force on the tool at the tool centre point in the base frame. N
    pub force: Vector3<f64>,
    /// Moment on the tool about the tool centre point in the base frame. N m
    pub moment: Vector3<f64>,
    /// What a part that yields adds to the displacement of the tool against it, in the base frame. m
    pub of_part: Vector3<f64>,
    /// Acceleration of free fall in the base frame, which external axes may have turned. m/s^2
    pub free_fall: Vector3<f64>,
    /// The direction in which a deflection spoils the wall, to the left of the feed, of unit length in the base frame.
    pub normal: Vector3<f64>,
}

stead_numerics::worded! {
    /// The deflection model of the corrections.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum DeflectionModel {
        /// The exact static equilibrium ([`stead_model::stiffness::equilibrium`]).
        Equilibrium = "equilibrium",
        /// The displacement linear in the load ([`stead_model::stiffness::whole`]), as in the score of a placement.
        Linear = "linear",
    }
}

/// Settings of the iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Alpha of eq. 27: the share of the error that one iteration corrects, above 0. Up to 1 the corrections approach
    /// the solution from one side; beyond they overshoot, and from 2 on they cannot converge.
    pub alpha: f64,
    /// An error of position up to this counts as none. m
    pub tolerance: f64,
    /// The length by which an error of orientation (rad) is compared with the tolerance. m
    pub characteristic_length: f64,
    /// Iterations at the most.
    pub max_iterations: usize,
    /// The deflection model, f of eq. 26.
    pub model: DeflectionModel,
    /// Whether the weight of links and spindle counts, in the model and in reality.
    pub gravity: bool,
}

impl Default for Settings {
    /// Undamped, to 1e-6 mm, with the exact equilibrium; rotations are weighed by 1 m.
    fn default() -> Self {
        Self {
            alpha: 1.0,
            tolerance: 1e-9,
            characteristic_length: 1.0,
            max_iterations: 50,
            model: DeflectionModel::Equilibrium,
            gravity: false,
        }
    }
}

/// Corrects every point of a path that can be, and executes the commands in simulation; a point that cannot be
/// corrected keeps its target as its command, with the reason. [`CompensatedPath::complete`] asks for all of them. The
/// result does not depend on the number of threads.
///
/// # Errors
/// [`Stop`] when `monitor` asked to stop before the last point: a path that is corrected up to somewhere is of no use.
pub fn compensate(job: &CompensationProblem, monitor: &Monitor) -> Result<CompensatedPath, Stop> {
    let (done, total) = (AtomicUsize::new(0), job.points.len());
    let compensated = |point: &PathPoint| {
        monitor.go_on()?;
        let compensated = iteration::compensated(job, point);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        monitor.report(Progress::Steps { stage: "correcting points", done, total });
        Ok(compensated)
    };
    Ok(CompensatedPath::new(job.points.par_iter().map(compensated).collect::<Result<_, _>>()?))
}

/// The first row entry in which two arms have another geometry.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("joint {joint}: {field} is {found} and not {expected}")]
pub struct OtherGeometry {
    /// Number of the joint, from 1.
    pub joint: usize,
    /// `alpha` (rad), `a` or `d` (m).
    pub field: &'static str,
    /// What the one arm has.
    pub expected: f64,
    /// What the other has.
    pub found: f64,
}

/// Lengths (m) and angles (rad) that differ by no more than this are the same.
const SAME: f64 = 1e-9;

/// Whether `found` has another geometry than `expected`; limits and compliances may differ.
pub fn other_geometry(expected: &Robot, found: &Robot) -> Option<OtherGeometry> {
    let pairs = expected.joints().iter().zip(found.joints()).zip(1..);
    let entries =
        pairs.flat_map(|((a, b), joint)| {
            [("alpha", a.alpha, b.alpha), ("a", a.a, b.a), ("d", a.d, b.d)]
                .map(|(field, expected, found)| OtherGeometry { joint, field, expected, found })
        });
    entries.into_iter().find(|entry| (entry.expected - entry.found).abs() > SAME)
}
