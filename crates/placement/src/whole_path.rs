//! What a placement that a subset of a long path allows comes to on the whole path, and which points decide that.

use super::candidate::Objective;
use super::criterion::Aggregate;
use super::evaluate::reference::state;
use super::evaluator::Evaluator;
use super::problem::{Placement, Problem};
use super::redundancy::{NoFeasiblePlan, Planner, SegmentPlan};
use super::sense::Sense;
use stead_model::robot::Posture;

/// Of every stretch of points that decide, so many join a subset.
const STRETCH: usize = 3;
/// Of a placement, at most so many stretches.
const STRETCHES: usize = 12;

/// The whole path on the coarse grid of beta, and on the finer one where that is too coarse.
pub(crate) struct WholePath<'a, 'p> {
    coarse: Planner<'p>,
    finer: &'a Planner<'p>,
}

impl<'a, 'p> WholePath<'a, 'p> {
    pub fn new(finer: &'a Planner<'p>) -> Self {
        Self { coarse: Planner::new(finer.problem()), finer }
    }

    /// The problem on the whole path.
    pub fn problem(&self) -> &'p Problem {
        self.finer.problem()
    }

    /// The objective of a placement (m), or points that decide against it.
    pub fn objective(&self, placement: &Placement, scheme: Option<&[Posture]>) -> Result<f64, Vec<usize>> {
        let evaluator = Evaluator::new(&self.coarse, None).with_finer_planner(self.finer);
        match evaluator.planned_objective(placement, scheme, &mut evaluator.workspace()) {
            Objective::Feasible(mean) => Ok(mean),
            Objective::Infeasible { .. } => {
                let plan = self.finer.plan(placement, Sense::Min, scheme, &mut self.finer.workspace());
                Err(plan.err().map(|none| deciding(self.problem(), &none)).unwrap_or_default())
            }
        }
    }
}

impl WholePath<'_, '_> {
    /// The point with the largest cost under the best plan of a placement, where that alone is the objective.
    pub fn largest(&self, placement: &Placement, scheme: Option<&[Posture]>) -> Option<usize> {
        let problem = self.problem();
        if problem.criterion.aggregate != Aggregate::Max {
            return None;
        }
        let plans = self.coarse.plan(placement, Sense::Min, scheme, &mut self.coarse.workspace()).ok()?;
        let cost = |plan: &SegmentPlan, point: usize| {
            let beta = plan.betas[point - plan.points.start];
            let state = state(problem, point, placement, beta, plan.posture).ok()?;
            Some((point, problem.point_cost(point, state.score())))
        };
        let costs = plans.iter().flat_map(|plan| plan.points.clone().filter_map(move |point| cost(plan, point)));
        costs.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(point, _)| point)
    }
}

/// Of the points that leave a placement without a plan, some of every stretch.
fn deciding(problem: &Problem, none: &NoFeasiblePlan) -> Vec<usize> {
    let mut points = Vec::new();
    for stretch in none.blocked_points.chunk_by(|a, b| a + 1 == *b).take(STRETCHES) {
        points.extend((0..STRETCH).map(|k| stretch[k * (stretch.len() - 1) / (STRETCH - 1)]));
    }
    for (segment, stuck) in none.broken_segments.iter().take(STRETCHES) {
        // A segment breaks between the points before and the first that cannot be reached.
        let span = &problem.task.segments()[*segment];
        points.extend((stuck.saturating_sub(2)..=stuck + 2).filter(|point| span.contains(point)));
    }
    points
}
