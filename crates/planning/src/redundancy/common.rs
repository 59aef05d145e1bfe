//! Plans with one beta for the whole path.
//!
//! What every segment costs at each beta of the grid at the least, its flips and turns and what hits left aside, is
//! found in one pass. By that the betas are taken in order, each planned by itself, until none that is left can be
//! better than the best found.

use super::forward_pass::Pass;
use super::off_grid::{MIN_GAIN, Spacing, replay};
use super::segment::Sought;
use super::segment_planner::Request;
use super::{NoFeasiblePlan, Planner, SegmentPlan, Workspace};
use crate::compass::CompassSteps;
use stead_model::robot::{Posture, PostureClass};
use stead_numerics::monitor::Monitor;
use stead_problem::candidate::Objective;
use stead_problem::evaluate::batch::KernelNumber;
use stead_problem::problem::{BetaPlan, Placement, Problem};
use stead_problem::sense::Sense;

/// What the whole path comes to at one beta at the least.
struct Bound {
    /// The beta number.
    beta: usize,
    /// Segments that cannot be gone through.
    failed: Vec<usize>,
    /// The least that the others cost, by the sense: the smaller the better.
    cost: f64,
}

impl Planner<'_> {
    /// Whether one beta for the whole path is still to be chosen.
    pub(super) fn chooses_common_beta<E: KernelNumber>(&self, workspace: &Workspace<E>) -> bool {
        self.problem.redundancy.beta == BetaPlan::Constant && workspace.only_beta.is_none()
    }

    /// [`Planner::objective`] where one beta stays all along the path.
    pub(super) fn common_objective<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
    ) -> Objective {
        let sign = request.sense.sign();
        let bounds = self.bounds(request, workspace);
        let mut best: Option<f64> = None;
        for bound in Self::open(&bounds) {
            if best.is_some_and(|best| self.problem.objective([bound.cost * sign]) * sign >= best * sign) {
                break;
            }
            workspace.only_beta = Some(bound.beta);
            let found = self.objective_on_grid(request, workspace).mean();
            best = best.into_iter().chain(found).min_by(|a, b| (a * sign).total_cmp(&(b * sign)));
        }
        workspace.only_beta = None;
        if let Some(best) = best {
            return Objective::Feasible(best);
        }
        let mut blocked =
            |segment: usize| self.segments.segment(segment, request, workspace, Sought::Blocked).blocked.len();
        match (0..self.problem.task.segments().len()).map(&mut blocked).sum() {
            // Where no beta does, the one with the fewest failed segments gives their number.
            0 => {
                let segments = bounds.first().map_or(0, |bound| bound.failed.len()).max(1);
                Objective::Infeasible { points: 0, segments }
            }
            points => Objective::Infeasible { points, segments: 0 },
        }
    }

    /// What `plan` finds, or where one beta stays all along the path, the best of what it finds for each.
    pub(super) fn with_common_beta<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
        mut plan: impl FnMut(&mut Workspace<E>) -> Result<Vec<SegmentPlan>, NoFeasiblePlan>,
    ) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
        if !self.chooses_common_beta(workspace) {
            return plan(workspace);
        }
        let bounds = self.bounds(request, workspace);
        let sense = request.sense;
        let cost = |plans: &[SegmentPlan]| self.signed_cost(sense, plans.iter().map(|plan| plan.cost * sense.sign()));
        let mut best: Option<(f64, Vec<SegmentPlan>)> = None;
        for bound in Self::open(&bounds) {
            if best.as_ref().is_some_and(|(best, _)| bound.cost >= *best) {
                break;
            }
            workspace.only_beta = Some(bound.beta);
            let Ok(found) = plan(workspace) else { continue };
            let cost = cost(&found);
            if best.as_ref().is_none_or(|(best, _)| cost < *best) {
                best = Some((cost, found));
            }
        }
        let found = match best {
            Some((_, found)) => Ok(found),
            None => {
                // Reported are segments that have no plan by themselves, else those that fail at the best beta.
                workspace.only_beta = None;
                plan(workspace).and_then(|_| {
                    let ends = |index: usize| (index, self.problem.task.segments()[index].end - 1);
                    let failed = bounds.first().map_or(Vec::new(), |bound| bound.failed.clone());
                    let all = 0..self.problem.task.segments().len();
                    let broken = if failed.is_empty() { all.collect() } else { failed };
                    let broken_segments = broken.into_iter().map(ends).collect();
                    Err(NoFeasiblePlan { broken_segments, ..NoFeasiblePlan::empty() })
                })
            }
        };
        workspace.only_beta = None;
        found
    }

    /// The betas by which all segments can be gone through.
    fn open(bounds: &[Bound]) -> impl Iterator<Item = &Bound> {
        bounds.iter().take_while(|bound| bound.failed.is_empty())
    }

    fn signed_cost(&self, sense: Sense, costs: impl Iterator<Item = f64>) -> f64 {
        let aggregate = self.problem.criterion.aggregate;
        costs.reduce(|sum, cost| aggregate.join_signed(sense, sum, cost)).unwrap_or(0.0)
    }

    /// All betas of the grid: those by which the most segments can be gone through first, and of these the cheapest.
    fn bounds<E: KernelNumber>(&self, request: Request<'_>, workspace: &mut Workspace<E>) -> Vec<Bound> {
        let Request { placement, sense, .. } = request;
        workspace.forbidden.clear();
        let spans = self.problem.task.segments();
        let mut costs = vec![vec![f64::INFINITY; self.segments.grid.beta_count]; spans.len()];
        for (index, span) in spans.iter().enumerate() {
            for evaluator in &self.segments.evaluators {
                let pass = Pass { evaluator, span, placement, sense, only: request.posture(index), is_by_knots: false };
                if !Posture::ALL.iter().any(|posture| self.segments.is_requested(pass, *posture)) {
                    continue;
                }
                let found = self.segments.forward_pass(pass, workspace, false);
                for class in PostureClass::ALL.into_iter().filter(|class| found.ends[class.index()].is_some()) {
                    let ends = workspace.before.inner_scores(class);
                    costs[index].iter_mut().zip(ends).for_each(|(known, cost)| *known = known.min(cost.get()));
                }
            }
        }
        let bound = |beta: usize| {
            let known = costs.iter().map(|costs| costs[beta]).filter(|cost| cost.is_finite());
            let failed = (0..costs.len()).filter(|segment| !costs[*segment][beta].is_finite()).collect();
            Bound { beta, failed, cost: self.signed_cost(sense, known) }
        };
        let mut bounds: Vec<Bound> = (0..self.segments.grid.beta_count).map(bound).collect();
        bounds.sort_by(|a, b| a.failed.len().cmp(&b.failed.len()).then(a.cost.total_cmp(&b.cost)));
        bounds
    }
}

/// Plans with one beta for all, with that taken off the grid: they can only get better. Those given need not be of this
/// placement exactly: where they are not allowed there, `None`.
pub fn settled_together(
    problem: &Problem,
    placement: &Placement,
    sense: Sense,
    spacing: Spacing,
    plans: &[SegmentPlan],
) -> Option<Vec<SegmentPlan>> {
    let turned = |plans: &[SegmentPlan], by: f64| -> Option<(f64, Vec<SegmentPlan>)> {
        let turned = |plan: &SegmentPlan| {
            let betas = plan.betas.iter().map(|beta| beta + by).collect();
            replay(problem, placement, sense, &SegmentPlan { betas, ..plan.clone() })
        };
        let plans = plans.iter().map(turned).collect::<Option<Vec<_>>>()?;
        Some((problem.objective(plans.iter().map(|plan| plan.cost)) * sense.sign(), plans))
    };
    let start = turned(plans, 0.0)?;
    let is_free = problem.is_free(placement, &start.1);
    let steps = CompassSteps { first: spacing.first, last: spacing.last, shrink: 2.0, rounds: usize::MAX };
    let better = |best: &(f64, Vec<SegmentPlan>), step: f64| {
        let most = best.0 - MIN_GAIN * best.0.abs();
        let found = [-step, step].into_iter().filter_map(|by| turned(&best.1, by)).filter(|found| found.0 < most);
        let found = found.filter(|(_, plans)| !is_free || problem.is_free(placement, plans));
        found.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    Some(steps.search(start, &Monitor::silent(), better).1)
}
