//! What a placement that a subset of a long path allows comes to on the whole path, and which points decide that.

use super::candidate::{Candidate, Objective};
use super::criterion::Aggregate;
use super::evaluate::reference::state;
use super::problem::{Placement, Problem};
use super::redundancy::{NoFeasiblePlan, Planner, SegmentPlan};
use super::sense::Sense;
use stead_model::robot::Posture;

/// Of every stretch of points that decide, so many join a subset.
const STRETCH: usize = 3;
/// Of a placement, at most so many stretches.
const STRETCHES: usize = 12;

/// Where the objective on the coarse grid is farther than this (relative) from that on a subset, the finer grid decides: between
/// dense points a coarse grid may leave a narrow way out that the subset takes.
const AGREEMENT: f64 = 0.05;

/// The whole path on the coarse grid of beta, and on the finer one where that is too coarse.
pub(crate) struct WholePath<'a, 'p> {
    coarse: Planner<'p>,
    finer: &'a Planner<'p>,
}

/// What a placement comes to on the whole path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OnWhole {
    /// The mean score of its best plan. m
    pub mean: f64,
    /// Whether that plan is on the finer grid.
    pub is_fine: bool,
}

impl<'a, 'p> WholePath<'a, 'p> {
    pub fn new(finer: &'a Planner<'p>) -> Self {
        Self { coarse: Planner::new(finer.problem()), finer }
    }

    /// The problem on the whole path.
    pub fn problem(&self) -> &'p Problem {
        self.finer.problem()
    }

    /// The objective of a placement that is `expected` to come to about so much (m), or points that decide against it.
    pub fn objective(
        &self,
        placement: &Placement,
        scheme: Option<&[Posture]>,
        expected: Option<f64>,
    ) -> Result<OnWhole, Vec<usize>> {
        let on = |planner: &Planner<'_>| planner.objective(placement, Sense::Min, scheme, &mut planner.workspace());
        let coarse = on(&self.coarse);
        if let Objective::Feasible(mean) = coarse
            && expected.is_none_or(|expected| (mean - expected).abs() <= AGREEMENT * mean)
        {
            return Ok(OnWhole { mean, is_fine: false });
        }
        let is_blocked = matches!(coarse, Objective::Infeasible { points: 1.., .. });
        let fine = if is_blocked { None } else { on(self.finer).mean() };
        match (fine, coarse) {
            (Some(mean), _) => Ok(OnWhole { mean, is_fine: true }),
            (None, Objective::Feasible(mean)) => Ok(OnWhole { mean, is_fine: false }),
            (None, Objective::Infeasible { .. }) => {
                let plan = self.finer.plan(placement, Sense::Min, scheme, &mut self.finer.workspace());
                Err(plan.err().map(|none| deciding(self.problem(), &none)).unwrap_or_default())
            }
        }
    }

    /// The objective of a candidate of a subset, none where it has no plan, and the points that decide that.
    pub fn check(&self, candidate: &Candidate) -> (Option<f64>, Vec<usize>) {
        let (placement, scheme) = (&candidate.placement, candidate.scheme.as_deref());
        let largest = self.largest(placement, scheme);
        match self.objective(placement, scheme, candidate.objective.mean()) {
            Ok(whole) => (Some(whole.mean), largest.into_iter().collect()),
            Err(points) => (None, points),
        }
    }
}

impl WholePath<'_, '_> {
    /// The point with the largest cost under the best plan of a placement, where that alone is the objective.
    fn largest(&self, placement: &Placement, scheme: Option<&[Posture]>) -> Option<usize> {
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
