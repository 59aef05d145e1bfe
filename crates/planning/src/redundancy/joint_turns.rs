//! Flips and turns: which real joint angles a planned segment can be driven with.

use super::{SegmentPlan, SegmentPlanner};
use std::ops::Range as Span;
use stead_model::robot::{
    Posture,
    angles::{ANGLE_ROUNDING, wrap},
    turns::Range,
};
use stead_problem::constraints::{STEP_ROUNDING, joint_steps_hold, on_joints, on_state};
use stead_problem::evaluate::reference::State;
use stead_problem::problem::{MAX_JOINT_STEP, Placement, Problem};
use stead_problem::sense::Sense;

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

impl SegmentPlanner<'_> {
    /// Unwinds a path of beta in the given postures; `None` when in none of them every joint can stay inside its limits
    /// moving by less than half a turn and its largest step from point to point.
    pub(super) fn unwind(
        &self,
        span: &Span<usize>,
        placement: &Placement,
        betas: &[f64],
        postures: &[Posture],
        cost: f64,
    ) -> Option<SegmentChoice> {
        let (robot, at) = (&self.problem.robot, self.problem.at(placement));
        let steps = &self.steps[span.clone()];
        let mut joint_paths = Vec::new();
        for posture in postures {
            let solve = |(point, beta): (usize, &f64)| robot.inverse(&at.base_from_flange(point, *beta), *posture).ok();
            let Some(wrapped) = span.clone().zip(betas).map(solve).collect::<Option<Vec<[f64; 6]>>>() else { continue };
            // On an arm with a linkage a motor turns the sum of joints 2 and 3, and none joint 3 by itself.
            let is_alone = |j: usize| j != 2 || !robot.has_linkage();
            let tracks: [Vec<Vec<f64>>; 6] = std::array::from_fn(|j| {
                let range = Range::of(&robot.joints()[j]);
                let angles: Vec<f64> = wrapped.iter().map(|theta| theta[j]).collect();
                let limits: Vec<f64> =
                    steps.iter().map(|step| if is_alone(j) { step[j] } else { MAX_JOINT_STEP }).collect();
                tracks(range, &angles, &limits)
            });
            let first = joint_paths.len();
            combine(*posture, &tracks, wrapped.len(), &mut joint_paths);
            if robot.has_linkage() {
                let holds = |way: &JointPath| {
                    let pairs = way.joints.windows(2).zip(&steps[1..]);
                    pairs.into_iter().all(|(pair, limits)| joint_steps_hold(robot, &pair[0], &pair[1], limits))
                };
                let kept = joint_paths.split_off(first).into_iter().filter(holds);
                joint_paths.extend(kept.collect::<Vec<_>>());
            }
        }
        let is_driven = !joint_paths.is_empty();
        is_driven.then(|| SegmentChoice { points: span.clone(), betas: betas.to_vec(), cost, joint_paths })
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

/// Takes one plan and one way to drive it for each segment, by dynamic programming over the segments, exact for the
/// plans given (the best of each segment first).
///
/// Of the plans within the tie of a segment's best, those that make the moves between segments short: the least sum of
/// the moves' lengths. With a weight on moves, of all plans those with the least objective and weighed moves. Of equal
/// sums (to a millionth) the first in order is taken: the best plan, then the lowest posture number, then the lowest
/// turns.
pub(super) fn select_joint_paths(
    problem: &Problem,
    sense: Sense,
    choices: Vec<Vec<SegmentChoice>>,
) -> Vec<SegmentPlan> {
    let options: Vec<Vec<SegmentOption>> = choices.into_iter().map(|plans| options(problem, sense, plans)).collect();
    let mut sums: Vec<Sum> =
        options.first().map_or(Vec::new(), |first| first.iter().map(|o| Sum::of(o.cost)).collect());
    let mut back: Vec<Vec<usize>> = Vec::new();
    for pair in options.windows(2) {
        let mut next = Vec::new();
        let mut from = Vec::new();
        for option in &pair[1] {
            let moved = pair[0].iter().zip(&sums).map(|(old, sum)| {
                let length = length(problem, old.way.joints.last(), option.way.joints.first());
                sum.plus(option.cost, length, weight(problem, sense))
            });
            let (best, sum) = first_least(moved);
            next.push(sum);
            from.push(best);
        }
        sums = next;
        back.push(from);
    }
    let (mut pick, _) = first_least(sums.into_iter());
    let mut picks = vec![pick; options.len()];
    for (place, from) in back.iter().enumerate().rev() {
        pick = from[pick];
        picks[place] = pick;
    }
    let picked = options
        .into_iter()
        .zip(picks)
        .filter_map(|(mut options, pick)| (pick < options.len()).then(|| options.swap_remove(pick)));
    picked
        .map(|SegmentOption { points, betas, cost_of_plan, way, .. }| SegmentPlan {
            points,
            posture: way.posture,
            betas: unwrapped(&betas),
            joints: way.joints,
            cost: cost_of_plan,
        })
        .collect()
}

/// Of plans of the whole path the best, or of those within the tie the one with the shortest moves.
pub(super) fn best_of(problem: &Problem, sense: Sense, found: Vec<Vec<SegmentPlan>>) -> Option<Vec<SegmentPlan>> {
    let (sign, weight) = (sense.sign(), weight(problem, sense));
    let judged = found.into_iter().map(|plans| {
        let moved: i64 =
            plans.windows(2).map(|pair| length(problem, pair[0].joints.last(), pair[1].joints.first())).sum();
        let objective = sign * problem.objective(plans.iter().map(|plan| plan.cost)) + weight * moved as f64;
        (objective, moved, plans)
    });
    let mut judged: Vec<_> = judged.collect();
    judged.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = judged.first()?.0;
    let tie = if weight > 0.0 { 0.0 } else { problem.postures.tie };
    judged.retain(|(objective, ..)| *objective <= best + tie * best.abs());
    judged.into_iter().min_by_key(|(_, moved, _)| *moved).map(|(.., plans)| plans)
}

/// What a millionth of a second of moves counts in the objective; nothing where the worst plan is sought. m
fn weight(problem: &Problem, sense: Sense) -> f64 {
    if sense == Sense::Min { problem.postures.move_weight * 1e-6 } else { 0.0 }
}

/// One plan of a segment and one way to drive it.
struct SegmentOption {
    points: Span<usize>,
    betas: Vec<f64>,
    cost_of_plan: f64,
    /// What it counts in the choice. m
    cost: f64,
    way: JointPath,
}

/// The plans of a segment that may be taken, with every way to drive them.
fn options(problem: &Problem, sense: Sense, mut plans: Vec<SegmentChoice>) -> Vec<SegmentOption> {
    let is_weighed = weight(problem, sense) > 0.0;
    if problem.postures.takes_the_best() {
        plans.truncate(1);
    }
    let sign = sense.sign();
    let best = plans.first().map_or(0.0, |best| best.cost * sign);
    plans.retain(|plan| is_weighed || plan.cost * sign <= best + problem.postures.tie * best.abs());
    let share = |cost: f64| if is_weighed { problem.objective([cost]) } else { 0.0 };
    let driven = plans.into_iter().flat_map(|SegmentChoice { points, betas, cost, joint_paths }| {
        joint_paths.into_iter().map(move |way| (points.clone(), betas.clone(), cost, way))
    });
    driven
        .map(|(points, betas, plan, way)| SegmentOption { points, betas, cost_of_plan: plan, cost: share(plan), way })
        .collect()
}

/// The objective and the length of the moves so far.
#[derive(Clone, Copy)]
struct Sum {
    objective: f64,
    length: i64,
}

impl Sum {
    fn of(objective: f64) -> Self {
        Self { objective, length: 0 }
    }

    fn plus(self, objective: f64, length: i64, weight: f64) -> Self {
        let objective = self.objective + objective + weight * length as f64;
        Self { objective, length: self.length.saturating_add(length) }
    }

    fn is_less(&self, other: &Self) -> bool {
        self.objective < other.objective || (self.objective == other.objective && self.length < other.length)
    }
}

/// The first of the least sums, with its number.
fn first_least(sums: impl Iterator<Item = Sum>) -> (usize, Sum) {
    let nothing = Sum { objective: f64::INFINITY, length: i64::MAX };
    sums.enumerate().fold((0, nothing), |best, item| if item.1.is_less(&best.1) { item } else { best })
}

/// Length of a joint move in millionths: of a second at full speed of the slowest joint, where every speed is known,
/// else of a radian of the largest travel. Whole numbers, so that rounding does not tell equal moves apart.
fn length(problem: &Problem, from: Option<&[f64; 6]>, to: Option<&[f64; 6]>) -> i64 {
    let (Some(from), Some(to)) = (from, to) else { return 0 };
    let joints = problem.robot.joints();
    let timed = joints.iter().all(|joint| joint.max_speed.is_some());
    let (from, to) = (problem.robot.drives(from), problem.robot.drives(to));
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

/// Whether real joint angles are inside the limits. rad
pub(super) fn inside_limits(problem: &Problem, joints: &[f64; 6]) -> bool {
    on_joints(problem, joints).all(|measured| measured.holds())
}

/// Whether a state satisfies everything but joint limits and steps.
pub(super) fn is_allowed(problem: &Problem, state: &State<f64>) -> bool {
    on_state(problem, state).all(|measured| measured.holds())
}

#[cfg(test)]
mod tests;
