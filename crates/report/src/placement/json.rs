//! The JSON documents: what `stead place --json` prints, and `summary.json`.
//!
//! Both have the cases, the refinements and the counts. The printed document adds the plans point by point and how long
//! the computation took; the summary adds inputs and settings and has nothing that differs from run to run.

use super::case::CaseFigures;
use super::settings::SettingsFigures;
use super::setup::TriedFigures;
use super::sheet::SheetFigures;
use super::{Context, SummaryLine, placement_summary};
use crate::document::{PlacementExact, PlacementFigures, Timing};
use crate::figure::{AngleDeg, DeflectionMm, PlaceMm, Plain, ResidualMm, TableError, TimeS, some};
use crate::names;
use crate::stability::path::PathStabilityFigures;
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use stead_disk::input::InputFile;
use stead_placement::outcome::{
    ForceSensitivity, LookupSummary, Outcome, PathLevels, Refinement, SetBasin, SetOutcome, SubsetAccuracy,
};
use stead_problem::problem::Problem;
use stead_problem::symmetry::Unsupported;

/// What `stead place --json` prints.
pub fn place_json(problem: &Problem, outcome: &Outcome, context: &Context, timing: &Timing) -> Value {
    context.document().with(PlaceFigures::of(problem, outcome, context, timing))
}

/// The content of `summary.json`: byte for byte the same for the same inputs and settings.
pub fn summary_json(problem: &Problem, outcome: &Outcome, context: &Context) -> Value {
    context.document().with(SummaryFigures::of(problem, outcome, context))
}

records! {
    /// The result that `stead place --json` prints.
    pub struct PlaceFigures of (problem: &Problem, outcome: &Outcome, context: &Context, timing: &Timing) {
        #[serde(flatten)] search: SearchFigures = SearchFigures::of(problem, outcome, context, true),
        /// Threads used.
        threads: usize = timing.threads,
        /// Time on the clock.
        wall_s: TimeS = timing.wall.into(),
        /// States of the arm evaluated in a second.
        states_per_second: Option<f64> = (timing.wall > 0.0).then_some((outcome.states as f64 / timing.wall).round()),
    }

    /// The result in `summary.json`.
    pub struct SummaryFigures of (problem: &Problem, outcome: &Outcome, context: &Context) {
        let tried = outcome.tried_setups.iter().map(|tried| TriedFigures::of(problem, tried)).collect::<Vec<_>>();
    } with {
        #[serde(flatten)] search: SearchFigures = SearchFigures::of(problem, outcome, context, false),
        #[serde(flatten)] settings: SettingsFigures = SettingsFigures::of(problem, context),
        /// The setups that were searched, where there are several.
        #[serde(skip_serializing_if = "Vec::is_empty")] setups: Vec<TriedFigures> = tried,
    }

    /// What a search has found.
    pub struct SearchFigures of (problem: &Problem, outcome: &Outcome, context: &Context, with_points: bool) {
        /// The result in a few lines, in the order in which they are to be read.
        summary: Vec<SummaryLine> = placement_summary(problem, outcome, context),
        /// The cases: the best placement under its best and its worst plan, then the worst placement likewise.
        cases: Vec<CaseFigures> =
            outcome.cases.all().into_iter().map(|case| CaseFigures::of(case, with_points)).collect(),
        /// What a fitter needs to set the best placement up: the numbers of `setup.svg`.
        setup_sheet?: SheetFigures = outcome.sheet.as_ref().map(Into::into),
        /// Placements evaluated.
        evaluations: usize = outcome.evaluations,
        /// States of the arm evaluated.
        states: usize = outcome.states,
        /// The lookup table of the search; null where none was wanted.
        table: Option<TableFigures> = outcome.lookup_summary.as_ref().map(Into::into),
        /// Whether the search was ended before its time.
        interrupted: bool = outcome.interrupted,
        /// The gradient refinements.
        refinements: Vec<RefinementFigures> = outcome.refinements.iter().map(Into::into).collect(),
        /// Figures to compare with.
        reference: Option<ReferenceFigures> = context.reference.as_ref().map(ReferenceFigures::of),
        /// How a long path was searched.
        path_levels?: PathLevelFigures = outcome.path_levels.as_ref().map(Into::into),
        /// What each stiffness set makes of the best placement.
        stiffness_sets?: StiffnessSetFigures =
            (!outcome.sets.is_empty()).then(|| StiffnessSetFigures::of(outcome, context)),
        /// How far the best placement moves where scores have to cover errors of the force.
        sensitivity?: SensitivityFigures = outcome.sensitivity.as_ref().map(Into::into),
        /// Critical depths along the plans, where they were requested.
        stability?: PathStabilityFigures =
            context.stability.as_ref().map(|found| PathStabilityFigures::of(found, with_points)),
    }

    /// Published figures of the four cases.
    pub struct ReferenceFigures of (reference: &stead_model::published::Published<[f64; 4]>) {
        /// Where they are from.
        source: String = reference.source.clone(),
        /// Mean of the scores of each case. mm
        case_mm: [f64; 4] = reference.figures,
    }

    /// How a long path was searched.
    pub struct PathLevelFigures from levels: &PathLevels {
        /// Points of the path.
        points: usize = levels.points,
        /// The points of the search.
        search: SubsetFigures = (&levels.search).into(),
        /// The points of the refinement.
        refinement: SubsetFigures = (&levels.refinement).into(),
        /// Points that joined the subsets because they decide whether a placement has a plan, or as the largest what it
        /// is worth.
        deciding_points: usize = levels.deciding,
        /// Placements evaluated on all points.
        placements_on_all_points: usize = levels.whole,
    }

    /// A subset of the points of a path.
    pub struct SubsetFigures from subset: &SubsetAccuracy {
        /// How many points.
        points: usize = subset.points,
        /// Placements compared with those on all points.
        compared_placements: usize = subset.pairs,
        /// Largest relative error of an objective.
        largest_error: Option<TableError> = some(subset.error),
    }
}

/// The lookup table that a search used, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum TableFigures {
    /// There is none.
    Unused {
        /// False.
        used: bool,
        /// Why.
        reason: String,
    },
    /// It was used.
    Used {
        /// True.
        used: bool,
        /// Distances of the tool centre point from axis 1.
        radius: TableAxis,
        /// Its heights.
        height: TableAxis,
        /// Headings of the spindle against the azimuth of the point, over a full turn.
        headings: usize,
        /// States in the table.
        states: u64,
        /// Its size in memory.
        bytes: u64,
        /// States compared with exact ones.
        compared_states: usize,
        /// Root of the mean square of the errors of allowed states, relative to that of their scores.
        rms_error: TableError,
        /// Largest error of an allowed state, relative to the root of the mean square of all scores.
        largest_error: TableError,
        /// Share of the states that the one allows and the other does not.
        disputed_share: TableError,
    },
}

records! {
    /// The nodes of an axis of a lookup table.
    pub struct TableAxis from axis: &stead_placement::lookup::TableAxis {
        /// The first node.
        first_mm: PlaceMm = axis.first.into(),
        /// From one to the next.
        step_mm: PlaceMm = axis.step.into(),
        /// How many.
        count: usize = axis.count,
    }
}

impl From<&Result<LookupSummary, Unsupported>> for TableFigures {
    fn from(summary: &Result<LookupSummary, Unsupported>) -> Self {
        match summary {
            Err(unsuited) => Self::Unused { used: false, reason: unsuited.to_string() },
            Ok(LookupSummary { shape, accuracy }) => Self::Used {
                used: true,
                radius: (&shape.radius).into(),
                height: (&shape.height).into(),
                headings: shape.headings,
                states: shape.states(),
                bytes: shape.bytes(),
                compared_states: accuracy.states,
                rms_error: accuracy.rms.into(),
                largest_error: accuracy.largest.into(),
                disputed_share: accuracy.disputed.into(),
            },
        }
    }
}

records! {
    /// How far the best placement moves where scores have to cover errors of the force.
    pub struct SensitivityFigures from found: &ForceSensitivity {
        let figures = |[plain, with_errors]: [f64; 2]| ForceErrorFigures::of(plain, with_errors);
    } with {
        /// Relative size of the force error, in any direction.
        force_uncertainty: f64 = found.force_uncertainty,
        /// At the placement found.
        nominal: ForceErrorFigures = figures(found.nominal),
        /// At the placement that is best where scores cover the errors.
        robust: ForceErrorFigures = figures(found.robust),
        /// That placement.
        robust_placement: PlacementFigures = (&found.placement).into(),
        /// How far it is from the placement found.
        distance_mm: PlaceMm = found.distance.into(),
        /// How far it is turned from that.
        turn_deg: AngleDeg = found.turn.into(),
    }

    /// Objectives of a placement without errors of the force and with them.
    pub struct ForceErrorFigures of (plain: f64, with_errors: f64) {
        /// Without errors.
        objective_mm: DeflectionMm = plain.into(),
        /// Where scores cover them, under the same plan.
        with_force_errors_mm: DeflectionMm = with_errors.into(),
    }

    /// What each stiffness set makes of the best placement.
    pub struct StiffnessSetFigures of (outcome: &Outcome, context: &Context) {
        let set = |(set, file): (&SetOutcome, &InputFile)| SetFigures::of(set, file);
        let largest = |of: fn(&SetOutcome) -> Option<f64>| outcome.sets.iter().filter_map(of).reduce(f64::max);
    } with {
        /// The sets.
        sets: Vec<SetFigures> =
            outcome.sets.iter().zip(context.inputs.iter().filter(|input| input.role == "stiffness")).map(set).collect(),
        /// Largest mean of a set.
        worst_mean_mm: Option<DeflectionMm> = some(largest(|set| Some(set.mean))),
        /// Largest regret of a set.
        largest_regret: Option<Plain> = some(largest(SetOutcome::regret)),
        /// The basins that were refined.
        basins: Vec<BasinFigures> = outcome.set_basins.iter().map(BasinFigures::of).collect(),
    }

    /// A stiffness set at the best placement.
    pub struct SetFigures of (set: &SetOutcome, file: &InputFile) {
        /// Its robot file.
        robot: String = file.name.clone(),
        /// Mean score under this set, of the plan found for all.
        mean_mm: DeflectionMm = set.mean.into(),
        /// Mean score of the best placement for this set alone.
        best_alone_mm: Option<DeflectionMm> = some(set.alone),
        /// By how much the mean is above that, relative.
        regret: Option<Plain> = some(set.regret()),
    }

    /// A basin of the objective over stiffness sets.
    pub struct BasinFigures of (basin: &SetBasin) {
        /// Its best placement.
        placement: PlacementFigures = (&basin.placement).into(),
        /// The objective there.
        objective_mm: DeflectionMm = basin.objective.into(),
        /// The largest regret there.
        regret: Option<Plain> = some(basin.regret),
    }

    /// A gradient refinement from its start to its end.
    pub struct RefinementFigures from refinement: &Refinement {
        /// `best` or `worst`.
        search: &'static str = names::sense(refinement.sense),
        /// Where it started.
        start: PlacementFigures = (&refinement.start).into(),
        /// Mean of the scores there.
        start_mean_mm: DeflectionMm = refinement.start_mean.into(),
        /// Where it ended.
        end: PlacementFigures = (&refinement.end).into(),
        /// The same with every digit.
        end_exact: PlacementExact = (&refinement.end).into(),
        /// Mean of the scores there.
        end_mean_mm: DeflectionMm = refinement.end_mean.into(),
        /// Rounds of refining and planning anew.
        rounds: usize = refinement.rounds,
        /// Convex subproblems solved.
        iterations: usize = refinement.iterations,
        /// Largest violation of the first-order optimality conditions at the end; null where it was stopped before,
        /// and on long paths for all but the one that was taken.
        kkt_residual_mm: Option<ResidualMm> = some(refinement.kkt_residual),
        /// How each round ended.
        status: String = names::statuses(&refinement.statuses),
    }
}
