//! The planning of segments: what does not change from one placement, segment and posture to the next.

use super::knots::{Knots, Place, StepBudget};
use super::rate_limit::{BetaChange, direct_changes};
use super::record::Record;
use super::transition::JointStep;
use super::{StateSet, between};
use std::sync::Arc;
use stead_model::robot::{Posture, PostureClass, turns::Range};
use stead_numerics::monitor::StopHandle;
use stead_numerics::simd::Instructions;
use stead_problem::evaluate::batch::{BatchEvaluator, KernelNumber, StateGrid};
use stead_problem::problem::{Placement, Problem, Redundancy};
use stead_problem::sense::Sense;

/// What plans are made for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Resolution {
    /// To compare placements.
    Search,
    /// The same on subsets of a path, whose rate of beta must not depend on how far their points happen to be apart.
    Subset,
    /// To be printed: the moves between points are checked too.
    Final,
}

impl Resolution {
    /// How many steps of the grid are wanted from point to point and from knot to knot.
    fn budget(self) -> StepBudget {
        match self {
            Self::Search => StepBudget { neighbours: 1.0, knots: 2.0 },
            Self::Subset => StepBudget { neighbours: 2.0, knots: 3.0 },
            Self::Final => StepBudget { neighbours: 6.0, knots: 6.0 },
        }
    }
}

/// What is planned: the workpiece at a placement, the best or the worst plan, with one posture for each segment where
/// they are given.
#[derive(Debug, Clone, Copy)]
pub struct Request<'a> {
    pub placement: &'a Placement,
    pub sense: Sense,
    pub scheme: Option<&'a [Posture]>,
}

impl Request<'_> {
    /// The posture that is given for a segment.
    pub fn posture(&self, segment: usize) -> Option<Posture> {
        self.scheme.map(|postures| postures[segment])
    }
}

/// The planner of the segments of a problem on a grid of beta.
#[derive(Debug, Clone)]
pub(super) struct SegmentPlanner<'a> {
    pub problem: &'a Problem,
    pub grid: Redundancy,
    pub evaluators: Vec<BatchEvaluator<'a>>,
    /// Allowed changes of the beta number from the point before.
    pub changes: Vec<BetaChange>,
    pub knots: Knots,
    pub resolution: Resolution,
    /// By how much each joint may step from the point before. rad
    pub steps: Vec<[f64; 6]>,
    /// The same as the kernel takes it.
    joint_steps: JointSteps,
    /// Ranges of joints with less than a turn; none for joints treated modulo a turn.
    pub ranges: [Option<Range>; 6],
    pub instructions: Instructions,
    /// States in which spindle or holder hit part or fixture, where they were looked at ahead of all plans.
    pub tool_hits: Option<Arc<StateSet>>,
    /// What a radian of joint travel costs.
    travel: f64,
    /// Once it is set, plans are not wanted any more: segments have none.
    pub unwanted: StopHandle,
}

/// What bounds the steps of the joints to each path point: from the point before, and from the knot before.
#[derive(Debug, Clone, Default)]
struct JointSteps {
    direct: Vec<[JointStep; 6]>,
    to_knots: Vec<[JointStep; 6]>,
}

/// Space of one thread to plan in.
#[derive(Debug, Clone)]
pub struct Workspace<E = f64> {
    pub(super) before: StateGrid<E>,
    pub(super) now: StateGrid<E>,
    pub(super) record: Record<E>,
    pub(super) run_costs: between::RunCosts<E>,
    /// States that hit, of the placement that is planned.
    pub(super) forbidden: StateSet,
    /// The number of beta that is planned with, where one for the whole path has been chosen.
    pub(super) only_beta: Option<usize>,
    /// Space to plan on a finer grid.
    pub(super) finer: Option<Box<Self>>,
    /// Space in which single precision proposes plans.
    pub(super) single: Option<Box<Workspace<f32>>>,
}

impl<E: KernelNumber> Workspace<E> {
    /// Space to plan on the grid of a finer planner.
    pub(super) fn on_finer(&mut self, planner: &SegmentPlanner<'_>) -> &mut Self {
        self.finer.get_or_insert_with(|| Box::new(planner.workspace()))
    }
}

impl<'a> SegmentPlanner<'a> {
    /// Prepares the planning of a problem on a grid of beta.
    pub fn new(problem: &'a Problem, grid: Redundancy, resolution: Resolution) -> Self {
        Self::with_budget(problem, grid, resolution, resolution.budget())
    }

    /// The same with other numbers of steps.
    pub fn with_budget(problem: &'a Problem, grid: Redundancy, resolution: Resolution, budget: StepBudget) -> Self {
        let tool_hits = StateSet::of_tool(problem, &grid).map(Arc::new);
        Self::of(problem, grid, resolution, budget, tool_hits)
    }

    /// The same where it is known what spindle and holder hit.
    pub fn with_tool_hits(
        problem: &'a Problem,
        grid: Redundancy,
        resolution: Resolution,
        tool_hits: Option<Arc<StateSet>>,
    ) -> Self {
        Self::of(problem, grid, resolution, resolution.budget(), tool_hits)
    }

    fn of(
        problem: &'a Problem,
        grid: Redundancy,
        resolution: Resolution,
        budget: StepBudget,
        tool_hits: Option<Arc<StateSet>>,
    ) -> Self {
        let starts: Vec<usize> = problem.task.segments().iter().map(|s| s.start).collect();
        let is_start = |point: &usize| starts.binary_search(point).is_ok();
        let ranges = problem.robot.drive_ranges();
        let changes = direct_changes(problem, &grid);
        let step = |p: usize| if is_start(&p) { [f64::INFINITY; 6] } else { problem.joint_steps(p) };
        let steps: Vec<_> = (0..problem.task.points().len()).map(step).collect();
        let planner = Self {
            problem,
            grid,
            evaluators: BatchEvaluator::all(problem, &grid),
            knots: Knots::new(problem, &grid, &steps, &changes, budget),
            resolution,
            changes,
            steps,
            joint_steps: JointSteps::default(),
            // Joints 4 and 6 differ by half a turn between the flips of a class, so within a class only their
            // difference modulo a turn means anything; theta_5, taken as not negative, is never half a turn off.
            ranges: std::array::from_fn(|j| Some(ranges[j]).filter(|range| j < 3 && !range.has_turns())),
            instructions: Instructions::best(),
            tool_hits,
            travel: problem.travel_cost(Sense::Min),
            unwanted: StopHandle::default(),
        };
        planner.with_kernel_steps()
    }

    fn with_kernel_steps(mut self) -> Self {
        let to = |point: usize, points: usize| {
            let limits = self.joint_limits(point, points);
            std::array::from_fn(|j| JointStep::new(limits[j], self.ranges[j]))
        };
        let to_knot = |point: usize| match self.knots.at(point) {
            Place::Knot(knot) => to(point, knot.points),
            Place::Between { .. } => [JointStep::Any; 6],
        };
        let points = 0..self.steps.len();
        let direct = points.clone().map(|point| to(point, 1)).collect();
        self.joint_steps = JointSteps { direct, to_knots: points.map(to_knot).collect() };
        self
    }

    /// What bounds the steps of the joints to a path point from the one before, or from the knot before, for numbers
    /// of some kind.
    pub fn kernel_steps<E: KernelNumber>(&self, point: usize, is_by_knots: bool) -> [JointStep; 6] {
        let JointSteps { direct, to_knots } = &self.joint_steps;
        let steps = if is_by_knots { to_knots[point] } else { direct[point] };
        steps.map(|step| step.with_rounding(E::ROUNDING))
    }

    /// The same with steps of the joints that may be at least so large. rad
    pub fn with_joint_steps(mut self, least: f64) -> Self {
        self.steps.iter_mut().flatten().for_each(|limit| *limit = limit.max(least));
        self.knots = Knots::new(self.problem, &self.grid, &self.steps, &self.changes, self.resolution.budget());
        self.with_kernel_steps()
    }

    /// What a radian of joint travel costs in the plans of a sense.
    pub fn travel_cost(&self, sense: Sense) -> f64 {
        if sense == Sense::Min { self.travel } else { 0.0 }
    }

    /// Whether the moves between the points of plans are checked too.
    pub fn checks_moves(&self) -> bool {
        self.resolution == Resolution::Final
    }

    /// How far states must be continued cyclically for the widest step.
    pub fn pad(&self) -> usize {
        self.changes.iter().copied().map(BetaChange::widest).max().unwrap_or(0).max(self.knots.widest())
    }

    /// Space for one thread, whose numbers are of some kind.
    pub fn workspace<E: KernelNumber>(&self) -> Workspace<E> {
        let count = self.grid.beta_count;
        let longest = self.problem.task.segments().iter().map(|s| s.len()).max().unwrap_or(0);
        let before = StateGrid::new(count, self.pad()).with_angles(self.travel > 0.0);
        let stride = before.scores(PostureClass::ALL[0]).len();
        Workspace {
            now: before.clone(),
            before,
            record: Record::new(longest, count),
            run_costs: between::RunCosts::new(self.knots.most_changes(), stride, self.instructions),
            forbidden: StateSet::default(),
            only_beta: None,
            finer: None,
            single: None,
        }
    }
}
