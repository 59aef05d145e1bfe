//! A placement with its plan, and what a step makes of it.

use rayon::prelude::*;
use stead_model::robot::Posture;
use stead_planning::redundancy::{
    Kept, Planner, SegmentPlan, Workspace, off_grid, settled_among_free, settled_together,
};
use stead_planning::transfer_path::whole_lines;
use stead_problem::evaluate::batch::BatchEvaluator;
use stead_problem::problem::{BetaPlan, Placement, Problem};
use stead_problem::sense::Sense;

/// The unit of position in scaled variables. m
pub const LENGTH_UNIT: f64 = 0.1;
/// Number of variables of one path point: x, y, z (in [`LENGTH_UNIT`]), yaw and its beta (rad).
pub const LOCAL: usize = 5;
/// Their units.
pub const UNITS: [f64; LOCAL] = [LENGTH_UNIT, LENGTH_UNIT, LENGTH_UNIT, 1.0, 1.0];
/// A placement with its best plan, beta off the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// The placement.
    pub placement: Placement,
    /// One entry per segment.
    pub plans: Vec<SegmentPlan>,
    /// The figure that is minimised: by default the mean score. m
    pub objective: f64,
}

impl Solution {
    /// Puts the plans of all segments together.
    pub fn new(problem: &Problem, placement: Placement, plans: Vec<SegmentPlan>) -> Self {
        let objective = problem.objective(plans.iter().map(|plan| plan.cost));
        Self { placement, plans, objective }
    }
}

/// The best plan at a placement, beta refined off the grid; `None` when the placement has none.
pub fn planned(
    planner: &Planner<'_>,
    placement: &Placement,
    scheme: Option<&[Posture]>,
    workspace: &mut Workspace,
) -> Option<Solution> {
    let plans = planner.plan_fine(placement, Sense::Min, scheme, workspace).ok()?;
    Some(Solution::new(planner.problem(), *placement, plans))
}

/// A neighbour that a wall of the cell leaves nearer than this share of the distance requested is not tried.
pub(super) const NEAR: f64 = 0.01;

/// The placements a distance (in scaled variables) before and behind another along x, y, z and yaw, as far as the cell
/// allows.
pub(crate) fn neighbours(problem: &Problem, centre: &Placement, distance: f64) -> Vec<Placement> {
    let along = (0..4).flat_map(|k| [(k, -1.0), (k, 1.0)]);
    let moved = |(k, side): (usize, f64)| {
        let mut placement = *centre;
        placement[k] += side * distance * UNITS[k];
        problem.cell.clamp(&placement)
    };
    along.map(moved).filter(|placement| !is_near(placement, centre, NEAR * distance)).collect()
}

/// Whether two placements differ by no more than this in any scaled variable.
pub(super) fn is_near(a: &Placement, b: &Placement, distance: f64) -> bool {
    (0..4).all(|k| (a[k] - b[k]).abs() <= distance * UNITS[k])
}

/// A solution moved by a step of all variables (placement, then every beta), if there is an allowed one near there.
///
/// Where many |c_i| are held at zero, a straight step leaves them by its square; so at the new placement the betas
/// settle in a narrow spacing around their step (a second-order correction).
pub(super) fn moved(problem: &Problem, solution: &Solution, placement: Placement, betas: &[f64]) -> Option<Solution> {
    let stepped = |plan: &SegmentPlan| {
        let betas = betas[plan.points.clone()].to_vec();
        SegmentPlan { betas, cost: f64::INFINITY, ..plan.clone() }
    };
    if problem.redundancy.beta == BetaPlan::Constant {
        let stepped: Vec<SegmentPlan> = solution.plans.iter().map(stepped).collect();
        let plans = settled_together(problem, &placement, Sense::Min, SETTLING, &stepped)?;
        return problem.is_free(&placement, &plans).then(|| Solution::new(problem, placement, plans));
    }
    let evaluators = BatchEvaluator::all(problem, &problem.redundancy);
    let settled = |plan: &SegmentPlan| {
        let evaluator = BatchEvaluator::of_posture(&evaluators, plan.posture)?;
        let kept = Kept { lines: whole_lines(problem, &solution.placement, plan), moves: false };
        let settled = settled_among_free(evaluator, &placement, Sense::Min, SETTLING, kept, &stepped(plan));
        settled.cost.is_finite().then_some(settled)
    };
    let plans = solution.plans.par_iter().map(settled).collect::<Option<Vec<_>>>()?;
    problem.is_free(&placement, &plans).then(|| Solution::new(problem, placement, plans))
}

/// The spacing in which betas settle after a step. rad
const SETTLING: off_grid::Spacing = off_grid::Spacing { first: 4e-3, last: 1.2e-4 };
