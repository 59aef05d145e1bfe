//! The slack between shapes, linearised: what keeps a step of the refinement out of collisions.
//!
//! The distance of two shapes changes as that of the two points in which they are nearest, carried along by the shapes:
//! to first order exactly, unless they are as near elsewhere too. Slopes are differences between the state and states
//! moved a little.

use super::LOCAL;
use super::differentiated::PointState;
use nalgebra::Vector4;
use stead_cell::{Near, PairKind, Poses, Scene};
use stead_model::robot::Posture;
use stead_problem::limit::Limit;
use stead_problem::problem::{Placement, Problem};

/// The slack of one pair of shapes, linearised in scaled variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Slack {
    /// Which limit it is the slack of.
    pub limit: Limit,
    /// Whether the joints matter to it: not where it is of the part and what stands in the cell.
    pub is_of_joints: bool,
    /// How much farther apart than they have to be the two are. m
    pub slack: f64,
    /// Its slopes by x, y, z, yaw and beta. m per scaled unit
    pub slopes: [f64; LOCAL],
    /// Its slopes by lead and tilt, where the tool may lean otherwise. m/rad
    pub lean_slopes: [f64; 2],
}

impl Slack {
    /// How far the linear model may go: a little less than the slack, so that rounding does not end in a hit. m
    pub fn spare(&self) -> f64 {
        (self.slack - KEPT).max(0.0)
    }

    /// The slopes by the placement.
    pub fn pose_slopes(&self) -> Vector4<f64> {
        Vector4::from_fn(|k, _| self.slopes[k])
    }
}

/// Pairs with more slack do not hold a step: where a long one meets them it is found to hit, and a shorter one is
/// taken. m
pub const NEAR_STEPS: f64 = 0.05;
/// The same where the placement stays. m
pub const NEAR_STAYING: f64 = 0.005;
/// How far the states lie apart whose difference is the slope, in scaled variables.
const STEP: f64 = 1e-4;
/// See [`Slack::spare`]. m
const KEPT: f64 = 1e-6;

/// The slacks up to a limit (m) of a state of the arm; those of the part against the cell at the first point at which
/// they stand so. Where the tool may lean otherwise, `leaning` are problems with a step (rad) more in lead and in tilt.
pub(super) fn slacks(
    problem: &Problem,
    leaning: Option<([&Problem; 2], f64)>,
    state: PointState,
    within: f64,
) -> Vec<Slack> {
    let Some(scene) = problem.scene.as_deref() else { return Vec::new() };
    let kinds = if problem.axes_moved_to(state.point) { &PairKind::ALL[..] } else { &PairKind::OF_STATES };
    let poses_in = |problem: &Problem, state: PointState| {
        let (placement, beta) = state.split();
        let flange = problem.at(&placement).base_from_flange(state.point, beta);
        let joints = problem.robot.inverse(&flange, state.posture).ok()?;
        Some(problem.poses(scene, state.point, &placement, &joints))
    };
    let leaned = || match leaning {
        Some((ahead, step)) => ahead.map(|problem| poses_in(problem, state).map(|there| (there, step))),
        None => [None, None],
    };
    linearised(scene, kinds, within, state, |state| poses_in(problem, state), leaned)
}

/// The slacks of the part against what stands in the cell, which depend on the placement alone.
pub(super) fn placement_rooms(problem: &Problem, placement: &Placement) -> Vec<Slack> {
    let Some(scene) = problem.scene.as_deref() else { return Vec::new() };
    let joints = problem.robot.mid_range();
    let at = |point| {
        let at = [placement.x, placement.y, placement.z, placement.yaw, 0.0];
        let state = PointState { point, at, posture: Posture::ALL[0] };
        let poses = |state: PointState| Some(problem.poses(scene, point, &state.split().0, &joints));
        linearised(scene, &[PairKind::WorkpieceCell], NEAR_STEPS, state, poses, || [None, None])
    };
    problem.points_after_axes_moved().flat_map(at).collect()
}

/// The pairs with little slack in a state, with the slopes of that slack.
fn linearised(
    scene: &Scene,
    kinds: &[PairKind],
    within: f64,
    state: PointState,
    poses: impl Fn(PointState) -> Option<Poses>,
    leaned: impl Fn() -> [Option<(Poses, f64)>; 2],
) -> Vec<Slack> {
    let Some(here) = poses(state) else { return Vec::new() };
    let near = scene.near(&here, kinds, within);
    if near.is_empty() {
        return Vec::new();
    }
    let moved = |k: usize, step: f64| poses(state.moved(k, step)).map(|there| (there, step));
    // At the end of the reach there is a state on one side alone.
    let moved: [_; LOCAL] = std::array::from_fn(|k| moved(k, STEP).or_else(|| moved(k, -STEP)));
    let leaned = leaned();
    let slack = |near: &Near| {
        let pair = scene.pair(near.pair)?;
        let slope = |there: &Option<(Poses, f64)>| {
            there.as_ref().map_or(0.0, |(there, step)| scene.room_change(near, &here, there) / step)
        };
        Some(Slack {
            limit: if pair.is_of_zone() { Limit::KeepOut(near.pair) } else { Limit::Clearance(near.pair) },
            is_of_joints: pair.kind != PairKind::WorkpieceCell,
            slack: near.room,
            slopes: std::array::from_fn(|k| slope(&moved[k])),
            lean_slopes: leaned.each_ref().map(slope),
        })
    };
    near.iter().filter_map(slack).collect()
}

#[cfg(test)]
mod tests;
