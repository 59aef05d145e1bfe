//! Redundancy planning: the free angle beta about the tool axis at every path point, by dynamic programming.
//!
//! Continuity binds only inside a segment, so every segment is planned by itself, in each posture, and the best posture
//! of each segment is found exactly. Within a segment, from one point to the next, beta may change by its rate and the
//! turn of the spindle, each joint by its speed, and the posture not at all.
//!
//! The plan is made in steps:
//! 1. [`transition`]: dynamic programming over the grid of beta in the four posture classes at once, with joint angles
//!    modulo a turn (twice where the two flips of a class yield differently:
//!    [`Flips`](stead_problem::evaluate::batch::Flips)). This leaves out only what a wrist flip or a turn of joint 1, 4
//!    or 6 could still forbid. Where points are closer than a few steps of the grid take, it goes from knot to knot,
//!    with the points between interpolated (`knots`).
//! 2. `joint_turns`: the path found is unwound. If a flip and turns exist that keep every joint inside its limits, it
//!    is the optimum; they cost nothing, so a choice that makes the moves between segments short is taken.
//! 3. `turns_dp`: only where that fails, dynamic programming over beta, the flip and the turns.
//! 4. [`off_grid`]: beta off the grid, by dynamic programming on ever narrower grids around the plan.
//!
//! `SegmentPlanner` plans single segments, [`Planner`] whole paths: schemes of postures, common betas, and what hits.
//! All dynamic programming but the vector kernel goes through `layered`, which asks for the states of a point, the
//! steps between them and what both cost.

#[cfg(test)]
mod axis_path;
mod between;
mod collision_free;
mod common;
mod corridor;
mod follow;
mod forbid;
mod forward_pass;
mod grid;
mod joint_turns;
mod knots;
mod layered;

pub mod motion;
mod objective;
mod obstruction;
pub mod off_grid;
mod rate_limit;
mod record;
#[cfg(test)]
mod reference_dp;
mod segment;
mod segment_planner;
mod state_set;
pub mod transition;
mod turns_dp;
mod unchanging;
mod until_free;

pub use collision_free::Collisions;
pub use collision_free::{Kept, settled_among_free};
pub use common::settled_together;
pub use forbid::BetaRing;
pub use obstruction::Obstruction;
pub use rate_limit::{BetaChange, saved_changes};
pub use state_set::StateSet;
pub use state_set::kinds_left;
pub use until_free::{Lazy, until_free};

use grid::finer;
use off_grid::Spacing;
use rayon::prelude::*;
use segment::Sought;
pub use segment_planner::Workspace;
use segment_planner::{Request, Resolution, SegmentPlanner};
use std::sync::Arc;
use stead_model::robot::Posture;
use stead_numerics::monitor::StopHandle;
use stead_problem::candidate::Objective;
use stead_problem::evaluate::batch::KernelNumber;
use stead_problem::problem::{BetaPlan, Placement, Problem, Redundancy};
pub use stead_problem::segment_plan::SegmentPlan;
use stead_problem::sense::Sense;
use transition::Step;

/// Why a placement has no plan.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoFeasiblePlan {
    /// Path points that have no allowed state in any posture requested.
    pub blocked_points: Vec<usize>,
    /// Segments (from 0) whose points are all allowed but that no posture gets through, with the first point that
    /// cannot be reached from the segment's start by the posture that gets farthest.
    pub broken_segments: Vec<(usize, usize)>,
    /// Pairs of the scene that hit in plans tried, and where.
    pub collisions: Collisions,
}

impl NoFeasiblePlan {
    /// With nothing that fails.
    pub fn empty() -> Self {
        Self { blocked_points: Vec::new(), broken_segments: Vec::new(), collisions: Collisions::new() }
    }
}

/// Numbers that plans are compared in: for each the planner is compiled in this crate, and not again in those that use
/// it.
pub trait PlanNumber: KernelNumber {
    /// [`Planner::objective`].
    fn objective(planner: &Planner<'_>, request: Request<'_>, workspace: &mut Workspace<Self>) -> Objective;
}

macro_rules! compiled_here {
    ($($number:ty),+) => {
        $(impl PlanNumber for $number {
            fn objective(planner: &Planner<'_>, request: Request<'_>, workspace: &mut Workspace<Self>) -> Objective {
                planner.objective_of(request, workspace)
            }
        })+
    };
}
compiled_here!(f64, f32);

/// The planner of one problem: what does not change from one placement to the next.
#[derive(Debug, Clone)]
pub struct Planner<'a> {
    problem: &'a Problem,
    segments: SegmentPlanner<'a>,
    spacing: Spacing,
    /// On a finer grid, for objectives where this one does not get through.
    finer: Option<Box<Planner<'a>>>,
}

impl<'a> Planner<'a> {
    /// Prepares the planning of a problem on its grid of beta: for the search.
    pub fn new(problem: &'a Problem) -> Self {
        let resolution = if problem.task.path().is_thinned() { Resolution::Subset } else { Resolution::Search };
        Self::with_segments(SegmentPlanner::new(problem, problem.redundancy, resolution))
    }

    /// Prepares the planning on a finer grid of beta, for what is refined and printed: divided until its step is at
    /// most a degree and at most a quarter of the largest change allowed to beta between any two points, but not below
    /// half a degree, or that change where it is less; changes of less than an eighth of a degree do not count.
    pub fn finer(problem: &'a Problem) -> Self {
        Self::with_segments(SegmentPlanner::new(problem, finer(problem, problem.redundancy), Resolution::Final))
    }

    fn with_segments(segments: SegmentPlanner<'a>) -> Self {
        let (problem, grid) = (segments.problem, &segments.grid);
        let spacing = if problem.task.path().is_thinned() { Spacing::rough(grid) } else { Spacing::full(grid) };
        Self { problem, segments, spacing, finer: None }
    }

    /// The same with beta narrowed down otherwise where a plan leaves the grid.
    pub fn with_spacing(self, spacing: Spacing) -> Self {
        Self { spacing, ..self }
    }

    /// The same, whose plans are not wanted any more once a flag is set: planning then ends at once, with no plan, for
    /// which the error has no reason.
    pub fn unwanted_after(mut self, stop: StopHandle) -> Self {
        self.segments.unwanted = stop;
        self
    }

    /// Whether plans are not wanted any more.
    pub fn is_unwanted(&self) -> bool {
        self.segments.unwanted.is_set()
    }

    /// The problem that is planned.
    pub fn problem(&self) -> &'a Problem {
        self.problem
    }

    /// The grid of beta that is planned on.
    pub fn grid(&self) -> &Redundancy {
        &self.segments.grid
    }

    /// States in which spindle or holder hit part or fixture, where they were looked at ahead of all plans.
    pub fn tool_hits(&self) -> Option<Arc<StateSet>> {
        self.segments.tool_hits.clone()
    }

    /// Space for one thread.
    pub fn workspace(&self) -> Workspace {
        self.segments.workspace()
    }

    /// The same with numbers of some kind: with `f32` objectives are exact to some 1e-6 of them.
    pub fn workspace_of<E: KernelNumber>(&self) -> Workspace<E> {
        self.segments.workspace()
    }

    /// What the best plan of each segment on the grid adds to the objective at a placement: one row where the posture
    /// may change from segment to segment, else one for each allowed posture; `None` where there is no plan.
    pub fn segment_costs(&self, placement: &Placement, workspace: &mut Workspace) -> Vec<Vec<Option<f64>>> {
        let (rules, count) = (&self.problem.postures, self.problem.task.segments().len());
        let schemes: Vec<Option<Vec<Posture>>> = match rules.may_change {
            true => vec![None],
            false => rules.allowed().map(|posture| Some(vec![posture; count])).collect(),
        };
        let mut costs = |scheme: Option<Vec<Posture>>| {
            let request = Request { placement, sense: Sense::Min, scheme: scheme.as_deref() };
            let cost = |segment: usize| {
                let found = self.segments.segment(segment, request, workspace, Sought::Cost);
                found.choices.first().map(|choice| choice.cost)
            };
            (0..count).map(cost).collect()
        };
        schemes.into_iter().map(&mut costs).collect()
    }

    /// What bounds the step to a path point from the one before.
    pub fn step(&self, point: usize, sense: Sense) -> Step {
        self.segments.step(point, sense)
    }

    /// How far states must be continued cyclically for the widest step.
    pub fn pad(&self) -> usize {
        self.segments.pad()
    }

    /// The mean score of the workpiece at a placement under the best or worst plan on the grid, with
    /// the posture scheme found exactly or given (one posture per segment).
    pub fn objective<E: PlanNumber>(
        &self,
        placement: &Placement,
        sense: Sense,
        scheme: Option<&[Posture]>,
        workspace: &mut Workspace<E>,
    ) -> Objective {
        E::objective(self, Request { placement, sense, scheme }, workspace)
    }

    /// The best or worst plan on the grid of beta, one entry per segment.
    ///
    /// # Errors
    /// [`NoFeasiblePlan`] when some point or segment has none.
    pub fn plan(
        &self,
        placement: &Placement,
        sense: Sense,
        scheme: Option<&[Posture]>,
        workspace: &mut Workspace,
    ) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
        let rules = &self.problem.postures;
        let margin = if sense == Sense::Min && rules.move_weight > 0.0 { f64::INFINITY } else { rules.tie };
        self.unchanging(scheme, sense, |scheme| {
            let request = Request { placement, sense, scheme };
            self.with_common_beta(request, workspace, |workspace| {
                self.collision_free_plans(request, workspace, |workspace, requested| {
                    let choices = self.choices(request, workspace, requested, margin)?;
                    Ok(self.without_hitting_ways(placement, choices))
                })
            })
        })
    }

    /// The best or worst plan with beta off the grid, one entry per segment.
    ///
    /// Beta is refined in every posture class that comes within a fifth of the best one on the grid, so that a coarse
    /// grid does not decide the posture.
    ///
    /// # Errors
    /// [`NoFeasiblePlan`] when some point or segment has no plan on the grid.
    #[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
    pub fn plan_fine(
        &self,
        placement: &Placement,
        sense: Sense,
        scheme: Option<&[Posture]>,
        workspace: &mut Workspace,
    ) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
        if self.problem.redundancy.beta == BetaPlan::Constant {
            let plans = self.plan(placement, sense, scheme, workspace)?;
            return Ok(settled_together(self.problem, placement, sense, self.spacing, &plans).unwrap_or(plans));
        }
        let rules = &self.problem.postures;
        let is_weighed = sense == Sense::Min && rules.move_weight > 0.0;
        let margin = if is_weighed { f64::INFINITY } else { REFINED_EXCESS.max(rules.tie) };
        self.unchanging(scheme, sense, |scheme| {
            let request = Request { placement, sense, scheme };
            self.collision_free_plans(request, workspace, |workspace, requested| {
                let choices = self.proposed_choices(request, workspace, requested, margin)?;
                let choices = self.without_hitting_ways(placement, choices);
                let refined = |(segment, classes): (&usize, Vec<joint_turns::SegmentChoice>)| {
                    if self.is_unwanted() {
                        return Vec::new();
                    }
                    self.refined(request, *segment, classes)
                };
                let refined = match self.is_parallel() {
                    true => requested.par_iter().zip(choices).map(refined).collect(),
                    false => requested.iter().zip(choices).map(refined).collect(),
                };
                if self.is_unwanted() {
                    return Err(NoFeasiblePlan::empty());
                }
                Ok(self.without_hitting_ways(placement, refined))
            })
        })
    }

    /// The plans of a segment's posture classes with beta off the grid, the best first, or the best alone where that is
    /// taken anyway; each in the flips and turns in which it is driven best, or in the posture given.
    fn refined(
        &self,
        request: Request<'_>,
        segment: usize,
        classes: Vec<joint_turns::SegmentChoice>,
    ) -> Vec<joint_turns::SegmentChoice> {
        let Request { placement, sense, .. } = request;
        let (rules, sign) = (&self.problem.postures, sense.sign());
        let refined = classes.into_iter().filter_map(|choice| {
            let mut plan = joint_turns::select_joint_paths(self.problem, sense, vec![vec![choice]]).pop()?;
            self.refine_off_grid(placement, sense, &mut plan);
            Some(plan)
        });
        let mut plans: Vec<SegmentPlan> = refined.collect();
        plans.sort_by(|a, b| (a.cost * sign).total_cmp(&(b.cost * sign)));
        plans.truncate(if rules.takes_the_best() { 1 } else { plans.len() });
        // The refined betas may be driven in other flips and turns just as well.
        let driven = plans.into_iter().map(|plan| {
            let postures = match request.posture(segment) {
                Some(posture) => vec![posture],
                None => self.segments.equivalent_postures(plan.posture),
            };
            let again = self.segments.unwind(&plan.points, placement, &plan.betas, &postures, plan.cost);
            again.unwrap_or_else(|| joint_turns::SegmentChoice::of(plan))
        });
        driven.collect()
    }

    /// For each segment requested, the plans of its posture classes on the grid that cost at most `margin` (relative)
    /// more than the cheapest, cheapest first.
    fn choices<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
        requested: &[usize],
        margin: f64,
    ) -> Result<Vec<Vec<joint_turns::SegmentChoice>>, NoFeasiblePlan> {
        let of = |workspace: &mut Workspace<E>, index: &usize| {
            self.segments.segment(*index, request, workspace, Sought::Plans(margin))
        };
        self.choices_by(workspace, requested, of)
    }

    /// The same as single precision proposes them, with what they cost in double precision: for plans that leave the
    /// grid.
    fn proposed_choices(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace,
        requested: &[usize],
        margin: f64,
    ) -> Result<Vec<Vec<joint_turns::SegmentChoice>>, NoFeasiblePlan> {
        let of = |workspace: &mut Workspace, index: &usize| self.segments.proposed(*index, request, workspace, margin);
        self.choices_by(workspace, requested, of)
    }

    /// What a way of planning a segment comes to for each segment requested.
    fn choices_by<E: KernelNumber>(
        &self,
        workspace: &mut Workspace<E>,
        requested: &[usize],
        of: impl Fn(&mut Workspace<E>, &usize) -> segment::SegmentOptions + Sync,
    ) -> Result<Vec<Vec<joint_turns::SegmentChoice>>, NoFeasiblePlan> {
        let mut failure = NoFeasiblePlan::empty();
        let mut all = Vec::new();
        let options: Vec<segment::SegmentOptions> = match self.is_parallel() {
            true => {
                let (forbidden, only_beta) = (workspace.forbidden.clone(), workspace.only_beta);
                let space = || Workspace { forbidden: forbidden.clone(), only_beta, ..self.segments.workspace() };
                requested.par_iter().map_init(space, &of).collect()
            }
            false => requested.iter().map(|index| of(workspace, index)).collect(),
        };
        for (index, found) in requested.iter().zip(options) {
            if !found.choices.is_empty() {
                all.push(found.choices);
            } else if found.blocked.is_empty() {
                failure.broken_segments.push((*index, found.farthest));
            } else {
                failure.blocked_points.extend(&found.blocked);
            }
        }
        if all.len() == requested.len() { Ok(all) } else { Err(failure) }
    }

    /// Whether the segments of one plan are planned side by side.
    fn is_parallel(&self) -> bool {
        self.problem.task.segments().len() > 1 && self.problem.task.points().len() >= PARALLEL_POINTS
    }
}

/// From so many points on, the segments of one plan are planned side by side.
const PARALLEL_POINTS: usize = 1000;

/// Classes that cost this much (relative) more than the cheapest on the grid are refined beside it.
const REFINED_EXCESS: f64 = 0.2;

#[cfg(test)]
mod tests;
