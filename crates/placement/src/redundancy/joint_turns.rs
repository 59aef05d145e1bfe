//! Flips and turns: which real joint angles a planned segment can be driven with.

use super::SegmentPlan;
use crate::constraints::{Measured, STEP_ROUNDING, on_joints, on_state};
use crate::evaluate::reference::State;
use crate::problem::{Placement, Problem};
use std::ops::Range as Span;
use stead_model::robot::{
    Posture,
    angles::{ANGLE_ROUNDING, wrap},
    turns::Range,
};

/// A segment's plan with every flip and turn that it can be driven with at the same cost.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SegmentChoice {
    pub points: Span<usize>,
    pub betas: Vec<f64>,
    /// See [`SegmentPlan::cost`].
    pub cost: f64,
    /// At least one.
    pub joint_paths: Vec<JointPath>,
}

impl SegmentChoice {
    /// A plan that can be driven as it is, and in no other way.
    pub fn of(plan: SegmentPlan) -> Self {
        let way = JointPath { posture: plan.posture, joints: plan.joints };
        Self { points: plan.points, betas: plan.betas, cost: plan.cost, joint_paths: vec![way] }
    }
}

/// One way to drive a segment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct JointPath {
    pub posture: Posture,
    /// Real joint angles at each point. rad
    pub joints: Vec<[f64; 6]>,
}

/// Unwinds a path of beta in the given postures; `None` when in none of them every joint can stay inside its limits
/// moving by less than half a turn and its largest step from point to point.
pub(super) fn unwind(
    problem: &Problem,
    span: &Span<usize>,
    placement: &Placement,
    betas: &[f64],
    postures: &[Posture],
    cost: f64,
    steps: &[[f64; 6]],
) -> Option<SegmentChoice> {
    let mut joint_paths = Vec::new();
    for posture in postures {
        let solve = |(point, beta): (usize, &f64)| {
            problem.robot.inverse(&problem.base_from_flange(point, placement, *beta), *posture).ok()
        };
        let Some(wrapped) = span.clone().zip(betas).map(solve).collect::<Option<Vec<[f64; 6]>>>() else { continue };
        let steps = &steps[span.clone()];
        let tracks: [Vec<Vec<f64>>; 6] = std::array::from_fn(|j| {
            let range = Range::of(&problem.robot.joints()[j]);
            let angles: Vec<f64> = wrapped.iter().map(|theta| theta[j]).collect();
            let limits: Vec<f64> = steps.iter().map(|step| step[j]).collect();
            tracks(range, &angles, &limits)
        });
        combine(*posture, &tracks, wrapped.len(), &mut joint_paths);
    }
    if joint_paths.is_empty() {
        None
    } else {
        Some(SegmentChoice { points: span.clone(), betas: betas.to_vec(), cost, joint_paths })
    }
}

/// Every continuous track of one joint that stays in its range; at most one per start.
fn tracks(range: Range, angles: &[f64], limits: &[f64]) -> Vec<Vec<f64>> {
    let inside = |real: f64| real >= range.min - ANGLE_ROUNDING && real <= range.max + ANGLE_ROUNDING;
    range
        .real_angles(angles[0])
        .filter_map(|start| {
            let mut real = start;
            let mut track = vec![start];
            for (pair, limit) in angles.windows(2).zip(&limits[1..]) {
                let step = wrap(pair[1] - pair[0]);
                real += step;
                if step.abs() > limit + STEP_ROUNDING || !inside(real) {
                    return None;
                }
                track.push(real);
            }
            Some(track)
        })
        .collect()
}

/// Every combination of the joints' tracks.
fn combine(posture: Posture, tracks: &[Vec<Vec<f64>>; 6], length: usize, joint_paths: &mut Vec<JointPath>) {
    let mut index = [0; 6];
    if tracks.iter().any(Vec::is_empty) {
        return;
    }
    loop {
        let joints = (0..length).map(|i| std::array::from_fn(|j| tracks[j][index[j]][i])).collect();
        joint_paths.push(JointPath { posture, joints });
        let Some(j) = (0..6).find(|j| index[*j] + 1 < tracks[*j].len()) else { return };
        index[j] += 1;
        index[..j].fill(0);
    }
}

/// Takes one way for each segment, so that the moves between segments are short: the least sum of the moves' lengths, by
/// dynamic programming over the segments. Of equal sums (to a millionth) the first in order is taken: the lowest posture
/// number, then the lowest turns.
pub(super) fn select_joint_paths(problem: &Problem, choices: Vec<SegmentChoice>) -> Vec<SegmentPlan> {
    let mut sums: Vec<i64> = vec![0; choices.first().map_or(0, |c| c.joint_paths.len())];
    let mut back: Vec<Vec<usize>> = Vec::new();
    for pair in choices.windows(2) {
        let mut next = Vec::new();
        let mut from = Vec::new();
        for way in &pair[1].joint_paths {
            let (best, cost) = pair[0]
                .joint_paths
                .iter()
                .zip(&sums)
                .map(|(old, sum)| sum.saturating_add(length(problem, old.joints.last(), way.joints.first())))
                .enumerate()
                .fold((0, i64::MAX), |best, item| if item.1 < best.1 { item } else { best });
            next.push(cost);
            from.push(best);
        }
        sums = next;
        back.push(from);
    }
    let mut pick = (0..sums.len()).fold(0, |best, k| if sums[k] < sums[best] { k } else { best });
    let mut picks = vec![pick; choices.len()];
    for (place, from) in back.iter().enumerate().rev() {
        pick = from[pick];
        picks[place] = pick;
    }
    choices
        .into_iter()
        .zip(picks)
        .map(|(mut choice, pick)| {
            let way = choice.joint_paths.swap_remove(pick);
            SegmentPlan {
                points: choice.points,
                posture: way.posture,
                betas: unwrapped(&choice.betas),
                joints: way.joints,
                cost: choice.cost,
            }
        })
        .collect()
}

/// Length of a joint move in millionths: of a second at full speed of the slowest joint, where every speed is known, else of
/// a radian of the largest travel. Whole numbers, so that rounding does not tell equal moves apart.
fn length(problem: &Problem, from: Option<&[f64; 6]>, to: Option<&[f64; 6]>) -> i64 {
    let (Some(from), Some(to)) = (from, to) else { return 0 };
    let joints = problem.robot.joints();
    let timed = joints.iter().all(|joint| joint.max_speed.is_some());
    let share = |j: usize| {
        let travel = (from[j] - to[j]).abs();
        if timed { travel / joints[j].max_speed.unwrap_or(1.0) } else { travel }
    };
    ((0..6).map(share).fold(0.0, f64::max) * 1e6).round() as i64
}

/// The same angles without jumps of a turn. rad
fn unwrapped(angles: &[f64]) -> Vec<f64> {
    let mut real = angles.first().copied().unwrap_or(0.0);
    angles
        .iter()
        .map(|angle| {
            real += wrap(angle - real);
            real
        })
        .collect()
}

/// The joint angles of a state nearest to given real ones. rad
pub(super) fn nearest_turns(wrapped: &[f64; 6], near: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|j| near[j] + wrap(wrapped[j] - near[j]))
}

/// Whether real joint angles are inside the limits. rad
pub(super) fn inside_limits(problem: &Problem, joints: &[f64; 6]) -> bool {
    on_joints(problem, joints).iter().all(Measured::holds)
}

/// Whether a state satisfies everything but joint limits and steps.
pub(super) fn is_allowed(problem: &Problem, state: &State<f64>) -> bool {
    on_state(problem, state).all(|measured| measured.holds())
}
