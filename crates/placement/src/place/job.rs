//! What the placement job works on, and a placement with its plan as it goes from stage to stage.

use crate::refine::{Solution, planned};
use std::borrow::Cow;
use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::problem::{Placement, Problem};
use stead_problem::settings::SearchSettings;
use stead_problem::settings::TransferSettings;
use stead_problem::setup::Setup;

/// The job with its settings.
pub(super) struct Job<'a> {
    pub problem: &'a Problem,
    /// Placements are compared by their best plans; only what is stated at the end may be worse by the tie.
    pub without_tie_rule: &'a Problem,
    pub settings: &'a SearchSettings,
    pub transfer: &'a TransferSettings,
    pub monitor: &'a Monitor,
}

/// A placement in a setup, with its best plan.
#[derive(Debug, Clone)]
pub(super) struct Planned {
    pub setup: Setup,
    /// Where the external axes of the setup only shift the cell: by how much the placement of the solution, which is
    /// planned without them, is shifted. m
    pub shift: Option<[f64; 3]>,
    /// The postures that it was held to.
    pub scheme: Option<Vec<Posture>>,
    pub solution: Solution,
}

impl Planned {
    /// In the setup of a problem.
    pub fn new(problem: &Problem, solution: Solution, scheme: Option<Vec<Posture>>) -> Self {
        Self { setup: problem.setup.clone(), shift: None, scheme, solution }
    }

    /// The best plan at a placement in a setup.
    pub fn at(problem: &Problem, setup: Setup, placement: &Placement) -> Option<Self> {
        let set_up = problem.in_setup(&setup);
        let planner = Planner::finer(&set_up);
        let solution = planned(&planner, placement, None, &mut planner.workspace())?;
        Some(Self { setup, shift: None, scheme: None, solution })
    }

    /// The placement in the cell of the job.
    pub fn placement(&self) -> Placement {
        shifted_back(&self.solution.placement, self.shift)
    }

    /// Planned with the external axes where they stand, in the cell of the job.
    pub fn with_its_axes(mut self) -> Self {
        self.solution.placement = self.placement();
        self.shift = None;
        self
    }

    /// The better of two.
    pub fn better(self, other: Self) -> Self {
        if other.solution.objective < self.solution.objective { other } else { self }
    }

    /// A problem in the setup and the cell that this was planned in.
    pub fn problem<'a>(&self, problem: &'a Problem) -> Cow<'a, Problem> {
        let set_up = problem.in_setup(&self.setup);
        match self.shift.and_then(|_| set_up.without_shifting_axes()) {
            Some((shifted, _)) => Cow::Owned(shifted),
            None => set_up,
        }
    }
}

/// A placement in a cell that is shifted, in the cell itself.
pub(super) fn shifted_back(placement: &Placement, shift: Option<[f64; 3]>) -> Placement {
    let Placement { x, y, z, yaw } = *placement;
    let by = shift.unwrap_or_default();
    Placement { x: x - by[0], y: y - by[1], z: z - by[2], yaw }
}
