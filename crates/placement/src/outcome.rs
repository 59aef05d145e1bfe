//! What the placement job returns: plain data, in SI units and radians, for the reports to read.

use super::lookup::{Accuracy, Shape};
use super::sag::Sag;
use crate::lean_map::LeanMap;
use crate::sensitivity::SpringSlope;
use crate::setup_sheet::SetupSheet;
use nalgebra::Vector3;
use serde::Serialize;
use stead_cell::Clearance;
use stead_model::robot::{Posture, PostureWords};
use stead_model::task::lean::Lean;
use stead_numerics::mean_max::MeanAndMax;
use stead_numerics::message::{Note, Warning};
use stead_numerics::monitor::Monitor;
use stead_planning::collision::PlanClearance;
use stead_planning::criterion::CANCELLATION;
use stead_planning::evaluate::reference::ScoredByOrigin;
use stead_planning::feasibility::{DeflectionMap, deflection_map};
use stead_planning::joint_travel::JointTravel;
use stead_planning::limit::ActiveBound;
use stead_planning::problem::{Placement, Problem};
use stead_planning::sense::{BySense, Sense};
use stead_planning::setup::{AxisPath, Setup, TriedSetup};
use stead_planning::symmetry::Unsupported;

pub use stead_planning::transfer::{Cycle, Transfer};

/// One path point of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanPoint {
    /// Index of the path point, from 0.
    pub point: usize,
    /// Number of its segment, from 1.
    pub segment: usize,
    /// Tool centre point in the robot base frame. m
    pub position: Vector3<f64>,
    /// Free angle about the tool axis, in (-pi, pi]. rad
    pub beta: f64,
    /// Posture, the same all along a segment.
    pub posture: Posture,
    /// The same in words.
    pub posture_words: PostureWords,
    /// Real joint angles, inside the limits, turns included. rad
    pub joints: [f64; 6],
    /// 1/kappa_F.
    pub inverse_condition: f64,
    /// Force on the tool in the robot base frame. N
    pub force: Vector3<f64>,
    /// Deflection of the tool centre point in the robot base frame. m
    pub deflection: Vector3<f64>,
    /// Part of the deflection along the feed. m
    pub feed_part: f64,
    /// Part to the left of the feed, with its sign; its absolute value is c_i. m
    pub normal_part: f64,
    /// Part along the tool axis, positive towards the robot. m
    pub axial_part: f64,
    /// Part along the normal of the surface, where the task states that. m
    pub surface_part: Option<f64>,
    /// The score: the size of the scored part, what force errors can add to it, and what is added for its deviation. m
    pub score: f64,
    /// Standard deviation of the scored part, where the robot's uncertainty is known. m
    pub deviation: Option<f64>,
    /// What each thing that yields adds to the scored part, where more does than the joints about their axes.
    pub by_origin: Option<ScoredByOrigin>,
    /// The pair of shapes with the least room; `None` without a scene, and where nothing is near.
    pub clearance: Option<Clearance>,
    /// How the tool leans from the axis of the path, where it does along this plan.
    pub lean: Option<Lean>,
}

/// How large the deflection is along a path, in each direction and altogether.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DeflectionFigures {
    /// Normal to the wall, axis x feed. m
    pub wall: MeanAndMax,
    /// Normal to the surface, where the task states that. m
    pub surface: Option<MeanAndMax>,
    /// Along the feed. m
    pub feed: MeanAndMax,
    /// Along the tool axis. m
    pub axis: MeanAndMax,
    /// The size of the whole. m
    pub total: MeanAndMax,
}

impl DeflectionFigures {
    /// Those of the points of a plan that are scored.
    pub fn of<'a>(points: impl Iterator<Item = &'a PlanPoint> + Clone) -> Self {
        let figures = |of: &dyn Fn(&PlanPoint) -> f64| MeanAndMax::of(points.clone().map(|point| of(point).abs()));
        let surface: Option<Vec<f64>> = points.clone().map(|point| point.surface_part.map(f64::abs)).collect();
        Self {
            wall: figures(&|point| point.normal_part),
            surface: surface.map(MeanAndMax::of),
            feed: figures(&|point| point.feed_part),
            axis: figures(&|point| point.axial_part),
            total: figures(&|point| point.deflection.norm()),
        }
    }
}

/// A plan at the feed that the arm holds, with the forces of that feed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtHeldFeed {
    /// Number of segments that are cut slower than programmed.
    pub slowed: usize,
    /// Mean of the scores. m
    pub mean: f64,
    /// Largest score. m
    pub max: f64,
    /// The deflection itself.
    pub deflection: DeflectionFigures,
}

/// A redundancy plan with its posture scheme, for one placement.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// All path points.
    pub points: Vec<PlanPoint>,
    /// Where the external axes stand at every point; empty where there are none.
    pub axes: Vec<AxisPath>,
    /// Posture of each segment.
    pub postures: Vec<Posture>,
    /// The same in words.
    pub posture_words: Vec<PostureWords>,
    /// The figure that is minimised ([`Problem::objective`](stead_planning::problem::Problem::objective)), with what
    /// joint travel counts in it; by default the mean. m
    pub objective: f64,
    /// Mean of the scores: f_MQC (Caro 2013, eq. 13). m
    pub mean: f64,
    /// Largest score. m
    pub max: f64,
    /// How much the joints turn within the cut.
    pub travel: JointTravel,
    /// The scores that half of the points, and 95 of 100, do not exceed. m
    pub percentiles: [f64; 2],
    /// The deflection itself.
    pub deflection: DeflectionFigures,
    /// The same figures at the feed that the arm holds, where it is known how the forces change with the feed: the
    /// others are those of the programmed one.
    pub held: Option<AtHeldFeed>,
    /// Standard deviation of the mean of the scored part, where the robot's uncertainty is known: the points err
    /// together, so that it does not shrink with their number. m
    pub mean_deviation: Option<f64>,
    /// What each thing that yields adds to the scored part, in the mean, where more does than the joints about their
    /// axes.
    pub by_origin: Option<ScoredByOrigin>,
    /// How far the weight of links and spindle moves the tool, which no score counts; where the mass of what the flange
    /// carries is known.
    pub sag: Option<Sag>,
    /// The point with the least room, and its pair; `None` without a scene, and where nothing is near.
    pub clearance: Option<PlanClearance>,
}

/// A placement with one of its plans.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Whether the placement is the best or the worst.
    pub placement_sense: Sense,
    /// Whether the plan is the best or the worst at this placement.
    pub plan_sense: Sense,
    /// The placement.
    pub placement: Placement,
    /// How part and external axes are set up for it.
    pub setup: Setup,
    /// The name of the orientation of the part, where the run says several.
    pub orientation: Option<String>,
    /// The plan.
    pub plan: Plan,
    /// Times of the moves between segments and of the whole cut.
    pub cycle: Cycle,
    /// The bounds that hold the placement, the largest gain first; of cases 1 and 3, which are optima; none where
    /// they are not known.
    pub active_bounds: Option<Vec<ActiveBound>>,
    /// How the objective answers to the stiffness of each spring ([`objective_by_stiffness`]); none where it was not
    /// requested.
    ///
    /// [`objective_by_stiffness`]: super::sensitivity::objective_by_stiffness
    pub objective_by_stiffness: Option<Vec<SpringSlope>>,
}

impl Case {
    /// Its number in Caro 2013, Table III: 1 best placement, best plan; 2 best placement, worst plan; 3 worst
    /// placement, best plan; 4 worst placement, worst plan.
    pub fn number(&self) -> u8 {
        let second = |sense: Sense| u8::from(sense == Sense::Max);
        1 + 2 * second(self.placement_sense) + second(self.plan_sense)
    }
}

/// The four cases of Caro 2013, Table III, or the first two of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Cases {
    /// Best placement, best plan.
    pub best: Case,
    /// Best placement, worst plan.
    pub best_worst_plan: Case,
    /// Worst placement with its best and its worst plan; `None` where it was not looked for
    /// ([`SearchSettings::worst`](super::settings::SearchSettings::worst)).
    pub worst: Option<BySense<Case>>,
}

impl Cases {
    /// All there are, in the order of their numbers.
    pub fn all(&self) -> Vec<&Case> {
        let worst = self.worst.iter().flat_map(BySense::values);
        [&self.best, &self.best_worst_plan].into_iter().chain(worst).collect()
    }

    /// The placements, each with its best plan: the best one, and the worst where it was looked for.
    pub fn optima(&self) -> Vec<&Case> {
        self.all().into_iter().step_by(2).collect()
    }

    /// Mean score of a case over that of the first; `None` where the first is a cancellation.
    pub fn ratio(&self, case: &Case) -> Option<f64> {
        (self.best.plan.mean > CANCELLATION).then(|| case.plan.mean / self.best.plan.mean)
    }
}

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
    /// of the variables (see [`super::refine`]); `None` where the refinement was stopped before its end.
    pub kkt_residual: Option<f64>,
    /// How each round ended.
    pub statuses: Vec<RefinementStatus>,
}

/// How a round of the gradient refinement ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum RefinementStatus {
    /// The mean deflection is below [`CANCELLATION`].
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
            self.warnings.push(left_out("the deflection maps are"));
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

/// The warning that the caller's stop left something out.
pub fn left_out(what: &str) -> Warning {
    Warning::new("interrupted", format!("interrupted: {what} left out"))
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
