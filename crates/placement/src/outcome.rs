//! What the placement job returns: plain data, in SI units and radians, for the reports to read.

use super::lookup::{Accuracy, Shape};
use crate::lean_map::LeanMap;
use crate::setup_sheet::SetupSheet;
use serde::Serialize;
use stead_numerics::message::{Note, Warning};
use stead_numerics::monitor::Monitor;
use stead_planning::feasibility::{DeflectionMap, deflection_map};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::setup::TriedSetup;
use stead_problem::symmetry::Unsupported;

pub use crate::case::{AtHeldFeed, Case, Cases, DeflectionFigures, Plan, PlanPoint};
pub use stead_planning::transfer::{Cycle, Transfer};

/// State of one genetic search after one generation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Generation {
    /// Which search.
    pub sense: Sense,
    /// Number of the generation; 0 is the random start.
    pub generation: usize,
    /// Best mean deflection so far in the sense of the sense; `None` while nothing feasible was found. m
    pub best: Option<f64>,
    /// Mean of the mean deflections of the feasible candidates. m
    pub average: Option<f64>,
    /// Feasible candidates.
    pub feasible: usize,
    /// Candidates.
    pub population: usize,
    /// Placements evaluated so far.
    pub evaluations: usize,
}

/// How one gradient refinement went.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// Which search it finishes.
    pub sense: Sense,
    /// Where it started, from the genetic search.
    pub start: Placement,
    /// Mean deflection at the start. m
    pub start_mean: f64,
    /// Where it ended.
    pub end: Placement,
    /// Mean deflection at the end, never worse than at the start. m
    pub end_mean: f64,
    /// Rounds of refining and planning anew.
    pub rounds: usize,
    /// Convex subproblems solved.
    pub iterations: usize,
    /// Largest violation of the first-order optimality conditions at the end, in m of mean deflection per scaled unit
    /// of the variables (see [`super::refine`]); `None` where the refinement was stopped before its end, and on long
    /// paths for all but the one that was taken.
    pub kkt_residual: Option<f64>,
    /// How each round ended.
    pub statuses: Vec<RefinementStatus>,
}

/// How a round of the gradient refinement ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RefinementStatus {
    /// The mean deflection is below [`CANCELLATION`](stead_problem::criterion::CANCELLATION).
    #[error("converged: the deflection is cancelled")]
    Cancelled,
    /// The linear model promises no gain worth a step: a first-order optimum.
    #[error("converged: no first-order gain")]
    NoFirstOrderGain,
    /// Several steps in a row gained next to nothing.
    #[error("converged: no more gain")]
    NoMoreGain,
    /// No step inside the smallest trust region is allowed and better.
    #[error("converged: no gain in the smallest trust region")]
    SmallestTrustRegion,
    /// The largest number of iterations was reached.
    #[error("stopped at the largest number of iterations")]
    MaxIterations,
    /// The solver of the convex subproblem refused it or found no solution.
    #[error("the subproblem could not be solved")]
    SubproblemFailed,
    /// A state of the solution has no derivatives.
    #[error("a point cannot be linearised")]
    NotLinearised,
    /// The caller stopped it.
    #[error("interrupted")]
    Interrupted,
}

/// The lookup table that the searches used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookupSummary {
    /// What was sampled where.
    pub shape: Shape,
    /// How far it is from the reference evaluator.
    pub accuracy: Accuracy,
}

/// How far the means on a subset of a path are off, measured on placements drawn from the cell.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SubsetAccuracy {
    /// Points of the subset.
    pub points: usize,
    /// Placements that were planned both on the subset and on the whole path, drawn at random.
    pub pairs: usize,
    /// The largest relative error of their means; none where no placement was allowed. It covers the error at the next
    /// placement drawn with probability `pairs / (pairs + 1)`, but for the choice of the subset's size, which the same
    /// placements decide.
    pub error: Option<f64>,
}

/// How a long path was searched: on a subset, refined on a larger one, and planned whole.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PathLevels {
    /// Points of the path.
    pub points: usize,
    /// The subset for the search.
    pub search: SubsetAccuracy,
    /// That for the refinement.
    pub refinement: SubsetAccuracy,
    /// Points that joined the subsets because they decide whether a placement has a plan, or as the largest what it is
    /// worth.
    pub deciding: usize,
    /// Placements planned on the whole path before the last plans.
    pub whole: usize,
}

/// A best placement beside the one that would be best if forces were a little off.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceSensitivity {
    /// Relative size of the force error, in any direction.
    pub force_uncertainty: f64,
    /// At the optimum found: the objective, and the objective if it has to cover the errors under the same plan. m
    pub nominal: [f64; 2],
    /// At the placement that is best where scores cover the errors: the same two figures. m
    pub robust: [f64; 2],
    /// That placement.
    pub placement: Placement,
    /// How far it is from the optimum found. m
    pub distance: f64,
    /// How far it is turned from that. rad
    pub turn: f64,
}

/// What one set of compliances makes of a best placement that was found for several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SetOutcome {
    /// The mean score under this set, of the plan found for all. m
    pub mean: f64,
    /// The mean score of the best placement for this set alone, refined from the same basins; `None` where none has a
    /// plan. m
    pub alone: Option<f64>,
}

impl SetOutcome {
    /// How much larger the mean is than it could be for this set alone, relative to that.
    pub fn regret(&self) -> Option<f64> {
        self.alone.filter(|alone| *alone > 0.0).map(|alone| self.mean / alone - 1.0)
    }
}

/// The result of the placement job.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Cases 1 to 4.
    pub cases: Cases,
    /// The setups that were searched, where there are several; searches and refinements below are those of the best
    /// one.
    pub tried_setups: Vec<TriedSetup>,
    /// The lookup table that the searches used, or why there is none; `None` where none was requested.
    pub lookup_summary: Option<Result<LookupSummary, Unsupported>>,
    /// How a long path was searched; `None` for a path short enough to be searched whole.
    pub path_levels: Option<PathLevels>,
    /// Both genetic searches, generation by generation.
    pub convergence: Vec<Generation>,
    /// Refinements from the best distinct basins of both searches.
    pub refinements: Vec<Refinement>,
    /// Deflection maps at the placements ([`Cases::optima`]), where they were made ([`Outcome::map`]).
    pub maps: Option<Vec<DeflectionMap>>,
    /// Deflection over lead and tilt at a point of the best plan, where the tool may lean, made with the maps.
    pub lean_map: Option<LeanMap>,
    /// What a fitter needs to set the best placement up, where it was made ([`Outcome::make_sheet`]).
    pub sheet: Option<SetupSheet>,
    /// Placements evaluated.
    pub evaluations: usize,
    /// States (path point, beta, all postures) evaluated.
    pub states: usize,
    /// Whether the user stopped the search before its end.
    pub interrupted: bool,
    /// What the force errors do to the best placement, where that was requested.
    pub sensitivity: Option<ForceSensitivity>,
    /// What each stiffness set of the criterion makes of the best placement; empty where there are none.
    pub sets: Vec<SetOutcome>,
    /// The refined basins of the best placement, where there are stiffness sets.
    pub set_basins: Vec<SetBasin>,
    /// What should be known about the result though nothing is wrong, in sentences.
    pub notes: Vec<Note>,
    /// Why the result may not be what was wanted.
    pub warnings: Vec<Warning>,
}

impl Outcome {
    /// Makes the deflection maps at the best and, where it was looked for, at the worst placement, and where the tool
    /// may lean the map over lead and tilt. A stop may leave them out, which is then among the warnings.
    pub fn map(&mut self, problem: &Problem, monitor: &Monitor) {
        let map = |case: &Case| deflection_map(&problem.in_setup(&case.setup), &case.placement, monitor);
        self.maps = self.cases.optima().into_iter().map(map).collect();
        if self.maps.is_none() {
            self.warnings.push(Warning::left_out("the deflection maps are"));
            return;
        }
        let (lean_map, left_out) = LeanMap::new(problem, &self.cases.best, monitor);
        self.lean_map = lean_map;
        self.warnings.extend(left_out);
    }

    /// Makes the setup sheet of the best placement. A stop may leave out its tolerances, which is then among the
    /// warnings.
    pub fn make_sheet(&mut self, problem: &Problem, monitor: &Monitor) {
        let sheet = SetupSheet::new(problem, &self.cases.best, monitor);
        self.warnings.extend(sheet.left_out());
        self.sheet = Some(sheet);
    }
}

/// A refined basin of the best placement under several stiffness sets.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SetBasin {
    /// Where it ended.
    pub placement: Placement,
    /// The figure that is minimised. m
    pub objective: f64,
    /// The largest regret over the sets ([`SetOutcome::regret`]).
    pub regret: Option<f64>,
}
