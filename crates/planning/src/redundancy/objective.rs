//! The mean score of a placement on the grid, and on a finer one where the grid does not get through.

use super::segment::Sought;
use super::segment_planner::Request;
use super::{Planner, Workspace};
use stead_model::robot::Posture;
use stead_problem::candidate::{Objective, best_of};
use stead_problem::evaluate::batch::KernelNumber;
use stead_problem::problem::BetaPlan;

impl<'a> Planner<'a> {
    /// The same with a planner on a finer grid for objectives: where every point is allowed but the grid does not get
    /// through a segment, that is planned on the finer one. A coarse plan may propose a placement, but not refuse it.
    pub fn with_finer(mut self, finer: &Planner<'a>) -> Self {
        self.finer = (finer.grid().beta_count > self.grid().beta_count).then(|| Box::new(finer.clone()));
        self
    }

    /// On this grid, and where that does not get through on the finer one.
    pub(super) fn objective_of<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
    ) -> Objective {
        let finer = self.finer.as_deref();
        let is_by_segments = self.problem.redundancy.beta == BetaPlan::Free && self.problem.scene.is_none();
        if is_by_segments && self.problem.unchanging_schemes(request.scheme).is_empty() {
            return self.objective_of_segments(request, workspace, finer);
        }
        match (self.objective_on_grid(request, workspace), finer) {
            (Objective::Infeasible { points: 0, .. }, Some(finer)) => {
                finer.objective_of(request, workspace.on_finer(&finer.segments))
            }
            (found, _) => found,
        }
    }

    /// On this grid alone.
    pub(super) fn objective_on_grid<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
    ) -> Objective {
        let schemes = self.problem.unchanging_schemes(request.scheme);
        if !schemes.is_empty() {
            let of =
                |scheme: Vec<Posture>| self.objective_on_grid(Request { scheme: Some(&scheme), ..request }, workspace);
            return best_of(request.sense, schemes.into_iter().map(of));
        }
        if self.chooses_common_beta(workspace) {
            self.common_objective(request, workspace)
        } else if self.problem.scene.is_some() {
            self.free_objective(request, workspace)
        } else {
            self.objective_of_segments(request, workspace, None)
        }
    }

    /// Of segments planned one by one; those that this grid does not get through by a planner on a finer one.
    fn objective_of_segments<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
        finer: Option<&Self>,
    ) -> Objective {
        let count = self.problem.task.segments().len();
        let mut costs = Vec::with_capacity(count);
        let mut points = 0;
        for segment in 0..count {
            let sought = if points > 0 { Sought::Blocked } else { Sought::Cost };
            let found = self.segments.segment(segment, request, workspace, sought);
            points += found.blocked.len();
            costs.push(found.choices.first().map(|choice| choice.cost));
        }
        if points > 0 {
            return Objective::Infeasible { points, segments: 0 };
        }
        if let Some(finer) = finer {
            for (segment, cost) in costs.iter_mut().enumerate().filter(|(_, cost)| cost.is_none()) {
                let space = workspace.on_finer(&finer.segments);
                let found = finer.segments.segment(segment, request, space, Sought::Cost);
                *cost = found.choices.first().map(|choice| choice.cost);
            }
        }
        match costs.iter().filter(|cost| cost.is_none()).count() {
            0 => Objective::Feasible(self.problem.objective(costs.into_iter().flatten())),
            segments => Objective::Infeasible { points, segments },
        }
    }
}
