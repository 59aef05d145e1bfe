//! Which limits between neighbouring points keep every posture from following a segment whose points are all allowed.
//!
//! The segment is planned again with limits left out: each alone, then two, then all three. What lets a posture past
//! the point that none gets to is what stops it.

use super::grid::finer;
use super::segment::Sought;
use super::segment_planner::Request;
use super::{Resolution, SegmentPlanner};
use stead_model::robot::Posture;
use stead_problem::constraints::ConstraintKind;
use stead_problem::problem::{MAX_JOINT_STEP, Placement, Problem, Redundancy};
use stead_problem::sense::Sense;

/// A grid of beta finer than this tells no more, and takes long where every change of beta is allowed.
const MAX_BETA_COUNT: usize = 180;

/// The limits that are left out, in this order.
const STEPS: [ConstraintKind; 3] = [ConstraintKind::JointStep, ConstraintKind::BetaRate, ConstraintKind::SpindleTurn];

/// The planner of a problem with some limits between neighbouring points left out.
struct Relaxed<'a> {
    kinds: Vec<ConstraintKind>,
    /// Where one gets through, a posture does.
    planners: Vec<SegmentPlanner<'a>>,
}

/// A problem with each set of the limits between neighbouring points left out.
pub struct Obstruction<'a> {
    /// Small sets first.
    relaxed: Vec<Relaxed<'a>>,
}

impl<'a> Obstruction<'a> {
    /// Prepares a problem.
    pub fn new(problem: &'a Problem) -> Self {
        let in_force = problem.constraint_kinds();
        let mut sets: Vec<Vec<ConstraintKind>> = (1..1 << STEPS.len())
            .map(|set: usize| (0..STEPS.len()).filter(|k| set >> k & 1 == 1).map(|k| STEPS[k]).collect())
            .filter(|kinds: &Vec<_>| kinds.iter().all(|kind| in_force.contains(kind)))
            .collect();
        sets.sort_by_key(Vec::len);
        Self { relaxed: sets.into_iter().map(|kinds| Relaxed::new(problem, kinds)).collect() }
    }

    /// The smallest sets of limits of which each, left out, lets a posture (any, or that of a scheme) past a path point
    /// that no posture gets to from the start of its segment (from 0); none where the limits and turns of the joints
    /// stop it.
    pub fn at(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        segment: usize,
        point: usize,
    ) -> Vec<Vec<ConstraintKind>> {
        let request = Request { placement, sense: Sense::Min, scheme };
        let mut found: Vec<Vec<ConstraintKind>> = Vec::new();
        for Relaxed { kinds, planners } in &self.relaxed {
            if found.first().is_some_and(|smallest| smallest.len() < kinds.len()) {
                break;
            }
            let gets_past = |planner: &SegmentPlanner<'_>| {
                let options = planner.segment(segment, request, &mut planner.workspace::<f64>(), Sought::Cost);
                !options.choices.is_empty() || options.farthest > point
            };
            if planners.iter().any(gets_past) {
                found.push(kinds.clone());
            }
        }
        found
    }
}

impl<'a> Relaxed<'a> {
    fn new(problem: &'a Problem, kinds: Vec<ConstraintKind>) -> Self {
        let mut grid = problem.redundancy;
        if kinds.contains(&ConstraintKind::BetaRate) {
            grid.max_beta_rate = None;
        }
        if kinds.contains(&ConstraintKind::SpindleTurn) {
            (grid.max_spindle_turn, grid.max_spindle_speed) = (None, None);
        }
        let mut planners = Vec::new();
        if grid.max_beta_rate.or(grid.max_spindle_turn).or(grid.max_spindle_speed).is_none() {
            let beta_count = grid.beta_count.min(MAX_BETA_COUNT);
            planners.push(SegmentPlanner::new(problem, Redundancy { beta_count, ..grid }, Resolution::Search));
            // Where joints step by less than that grid, it does not hold the spindle still in a corner; a limit in
            // space does.
            grid.max_spindle_turn = problem.redundancy.max_beta_rate;
        }
        if grid.max_spindle_turn.or(grid.max_spindle_speed).or(grid.max_beta_rate).is_some() {
            planners.push(SegmentPlanner::new(problem, finer(problem, grid), Resolution::Search));
        }
        if kinds.contains(&ConstraintKind::JointStep) {
            planners = planners.into_iter().map(|planner| planner.with_joint_steps(MAX_JOINT_STEP)).collect();
        }
        Self { kinds, planners }
    }
}
