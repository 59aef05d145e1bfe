//! The CSV files. One function makes one file; every column carries its unit.

use super::origins::{self, OriginColumns};
use super::plan_row::PlanRow;
use super::setup;
use crate::csv_file::{rows, rows_or};
use crate::document::PlacementFigures;
use crate::figure::{AngleDeg, DeflectionMm, GridDeg, PlaceMm, Plain, ResidualMm, SpeedMmPerS, TimeS, some};
use crate::names;
use crate::output::ReportError;
use stead_cell::Scene;
use stead_model::published::Published;
use stead_model::robot::{Posture, PostureWords};
use stead_model::task::lean::Lean;
use stead_placement::lean_map::{LeanMap, LeanReason, LeanState};
use stead_placement::outcome::{Case, Cases, Generation, Plan, PlanPoint, Refinement};
use stead_planning::feasibility::{DeflectionMap, MapReason};
use stead_planning::transfer::Transfer;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::AxisPath;

/// `best.csv`, `worst.csv` and the like: one plan, a `PlanRow` per path point; behind it the positions of external
/// axes, `e1_mm` or `e1_deg` and so on.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn plan(plan: &Plan, scene: Option<&Scene>) -> Result<Vec<u8>, ReportError> {
    plan_points(&plan.points, &plan.axes, scene)
}

/// The same by its points and the positions of the external axes.
pub(crate) fn plan_points(
    points: &[PlanPoint],
    axes: &[AxisPath],
    scene: Option<&Scene>,
) -> Result<Vec<u8>, ReportError> {
    rows("the table of a plan", points.iter().map(|point| PlanRow::of(point, axes, scene)))
}

records! {
    /// A case. Times are empty where a joint speed is not known.
    pub struct CaseRow of (case: &Case, cases: &Cases, reference: Option<f64>) {
        let (plan, cycle) = (&case.plan, &case.cycle);
        let (figures, total) = (&plan.deflection, cycle.total());
        let words = names::posture_words(std::iter::once(plan));
        let named = |(posture, words): (&Posture, &PostureWords)| format!("{posture} {}", names::posture_cell(*words));
        let posture_words: Vec<String> = words.iter().map(named).collect();
    } with {
        /// 1 to 4: best or worst placement under its best or worst plan.
        case: u8 = case.number(),
        #[serde(flatten)] placement: PlacementFigures = (&case.placement).into(),
        /// Posture of each segment.
        postures: String = names::postures(&plan.postures),
        /// The words of each of them: front or back; elbow up or down; flip or no flip.
        posture_words: String = posture_words.join(" | "),
        /// Mean of the scores, every scored point alike: weights of segments count in `objective_mm` alone.
        mean_mm: DeflectionMm = plan.mean.into(),
        /// Largest score.
        max_mm: DeflectionMm = plan.max.into(),
        /// The mean as a multiple of that of case 1; empty where that is a cancellation.
        ratio_to_case_1: Option<Plain> = some(cases.ratio(case)),
        /// Published mean of the scores, where there is one. mm
        reference_mm: Option<f64> = reference,
        /// Time of the cut.
        cutting_s: TimeS = cycle.cutting.into(),
        /// Time of the moves between segments.
        transfer_s: Option<TimeS> = some(total.map(|total| total - cycle.cutting)),
        /// Time of both.
        cycle_s: Option<TimeS> = some(total),
        /// What was minimised or maximised.
        objective_mm: DeflectionMm = plan.objective.into(),
        /// Mean deflection normal to feed and tool axis.
        mean_wall_mm: DeflectionMm = figures.wall.mean.into(),
        /// The largest.
        max_wall_mm: DeflectionMm = figures.wall.max.into(),
        /// Mean deflection along the tool axis.
        mean_axis_mm: DeflectionMm = figures.axis.mean.into(),
        /// The largest.
        max_axis_mm: DeflectionMm = figures.axis.max.into(),
        /// Mean size of the deflection.
        mean_total_mm: DeflectionMm = figures.total.mean.into(),
        /// The largest.
        max_total_mm: DeflectionMm = figures.total.max.into(),
        /// The highest feed that the plan holds; empty where no limit of the joints is known.
        max_feed_mm_per_s: Option<SpeedMmPerS> = some(cycle.feed.highest().map(|limit| limit.feed)),
        /// What all joints turn in the cut.
        joint_travel_deg: AngleDeg = plan.travel.total.into(),
        /// The largest turn of a joint from a point to the next.
        max_joint_step_deg: AngleDeg = plan.travel.largest_step.into(),
        /// Mean deflection along the normal of the surface, where the task states it.
        mean_surface_mm?: DeflectionMm = some(figures.surface.map(|surface| surface.mean)),
        /// The largest.
        max_surface_mm?: DeflectionMm = some(figures.surface.map(|surface| surface.max)),
        /// Standard deviation of the mean of the scored part, where the robot's uncertainty is known.
        mean_std_mm?: DeflectionMm = some(plan.mean_deviation),
        /// Orientation of the part, where a run has several.
        orientation?: String = case.orientation.clone(),
        #[serde(flatten)] axes: setup::AxisColumns = setup::fixed_positions(&plan.axes),
    }
}

/// `placements.csv`: a [`CaseRow`] for each case; behind it the positions of external axes that are the same along the
/// path.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn placements(cases: &Cases, reference: Option<&Published<[f64; 4]>>) -> Result<Vec<u8>, ReportError> {
    let figure = |index: usize| reference.map(|reference| reference.figures[index]);
    let all = cases.all().into_iter().enumerate();
    rows("the table of placements", all.map(|(index, case)| CaseRow::of(case, cases, figure(index))))
}

records! {
    /// A generation of a genetic search.
    #[derive(Default)]
    pub struct GenerationRow of (state: &Generation) {
        /// `best` or `worst`.
        search: &'static str = names::sense(state.sense),
        /// Its number, from 0.
        generation: usize = state.generation,
        /// Best objective so far; empty while nothing feasible was found.
        best_mm: Option<DeflectionMm> = some(state.best),
        /// Mean objective of the feasible individuals.
        average_mm: Option<DeflectionMm> = some(state.average),
        /// Feasible individuals.
        feasible: usize = state.feasible,
        /// Individuals.
        population: usize = state.population,
        /// Evaluations so far.
        evaluations: usize = state.evaluations,
    }
}

/// `convergence.csv`: both genetic searches, a [`GenerationRow`] for each generation.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn convergence(generations: &[Generation]) -> Result<Vec<u8>, ReportError> {
    rows_or("the table of the convergence", &GenerationRow::default(), generations.iter().map(GenerationRow::of))
}

records! {
    /// A state of the grid over the path points and beta.
    #[derive(Default)]
    pub struct MapRow of (at: (&Problem, &Placement), map: &DeflectionMap, point: usize, k: usize) {
        let cell = &map.rows[point][k];
        let blocked = cell.as_ref().err();
        let problem = at.0;
        let posture = cell.as_ref().ok().map(|cell| cell.posture);
        let pair = |scene: &Scene| blocked.and_then(|blocked| scene.pair(blocked.pair?)).map(ToString::to_string);
    } with {
        /// Path point, from 0.
        point: usize = point,
        /// Segment, from 1.
        segment: usize = problem.task.path().segment_of(point) + 1,
        /// Angle about the tool axis.
        beta_deg: GridDeg = GridDeg(-180.0 + 360.0 * k as f64 / map.beta_count as f64),
        /// The smallest score over the allowed postures; empty where none is allowed.
        score_mm: Option<DeflectionMm> = cell.as_ref().ok().map(|cell| cell.score.into()),
        /// The posture of that score, 1 to 8, whose words are in `posture_words` of `summary.json`.
        #[schemars(with = "Option<u8>")] posture: Option<Posture> = posture,
        /// Why none is allowed.
        reason: Option<String> = blocked.map(|blocked| blocked.kind.code()),
        /// The pair of shapes that hits, among shapes of a cell.
        pair?: String = problem.scene.as_deref().map(|scene| pair(scene).unwrap_or_default()),
        #[serde(flatten)] origins: Option<OriginColumns> =
            origins::of_state(at, point, problem.redundancy.beta(k), posture),
    }
}

/// `deflection-map-*.csv` of a problem in its setup and a placement: a [`MapRow`] for every state of the grid.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn deflection_map(at: (&Problem, &Placement), map: &DeflectionMap) -> Result<Vec<u8>, ReportError> {
    let states = map.rows.iter().enumerate().flat_map(|(point, row)| (0..row.len()).map(move |k| (point, k)));
    let states = states.map(|(point, k)| MapRow::of(at, map, point, k));
    rows("the table of a deflection map", states)
}

records! {
    /// A lead and tilt of the grid at the point of the best plan that deflects most, the rest of the path left out.
    #[derive(Default)]
    pub struct LeanMapRow of (problem: &Problem, map: &LeanMap, lean: &Lean, state: &LeanState) {
        let reason = state.err();
        let pair = |scene: &Scene| match reason {
            Some(LeanReason::State(MapReason { pair: Some(pair), .. })) => scene.pair(pair).map(ToString::to_string),
            _ => None,
        };
    } with {
        /// Path point, from 0.
        point: usize = map.point,
        /// Lead of the tool from the axis of the path.
        lead_deg: AngleDeg = lean.lead.into(),
        /// Tilt of the tool from the axis of the path.
        tilt_deg: AngleDeg = lean.tilt.into(),
        /// The angle about the tool axis with the smallest score; empty where no state is allowed.
        beta_deg: Option<AngleDeg> = state.ok().map(|(beta, _)| beta.into()),
        /// The smallest score over all angles about the tool axis and allowed postures; empty where none is allowed.
        score_mm: Option<DeflectionMm> = state.ok().map(|(_, cell)| cell.score.into()),
        /// The posture of that score, 1 to 8, whose words are in `posture_words` of `summary.json`.
        #[schemars(with = "Option<u8>")] posture: Option<Posture> = state.ok().map(|(_, cell)| cell.posture),
        /// Why none is allowed: `lean` for `max_lean_deg`, `scallop_mm` or `step_over_mm`, or what most angles break.
        reason: Option<String> = reason.map(LeanReason::code),
        /// The pair of shapes that hits, among shapes of a cell.
        pair?: String = problem.scene.as_deref().map(|scene| pair(scene).unwrap_or_default()),
    }
}

/// `lean-map.csv`: a [`LeanMapRow`] for every lead and tilt of the grid.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn lean_map(problem: &Problem, map: &LeanMap) -> Result<Vec<u8>, ReportError> {
    let leans = map.leans.iter().map(|(lean, state)| LeanMapRow::of(problem, map, lean, state));
    rows("the map over lead and tilt", leans)
}

records! {
    /// A joint move between two segments.
    #[derive(Default)]
    pub struct TransferRow of (case: u8, transfer: &Transfer, scene: Option<&Scene>) {
        /// The case.
        case: u8 = case,
        /// The segment that it follows, from 1.
        after_segment: usize = transfer.after_segment,
        /// How long it takes; empty where a joint speed is not known.
        duration_s: Option<TimeS> = some(transfer.duration),
        /// What the joint that turns most turns.
        travel_deg: AngleDeg = transfer.travel.into(),
        #[serde(flatten)] path: Option<TransferPathColumns> = scene.map(|_| TransferPathColumns::of(transfer)),
    }

    /// How a move goes round the shapes of a cell.
    #[derive(Default)]
    struct TransferPathColumns of (transfer: &Transfer) {
        let way = transfer.way.as_ref();
        let line = |end: usize| way.and_then(|way| way.short_lines[end].as_ref()).map(|line| line.length.into());
    } with {
        /// Straight moves that keep free, retraction and approach among them.
        moves: usize = way.map_or(1, |way| way.joints.len().saturating_sub(1)),
        /// The pair that hits where no free path was found.
        blocked_by: Option<String> = way.and_then(|way| way.blocked_by.as_deref()).map(|[a, b]| format!("{a} and {b}")),
        /// Length of the line out of the cut where it is shorter than requested.
        line_out_mm: Option<PlaceMm> = line(0),
        /// Length of the line into the cut where it is shorter than requested.
        line_into_mm: Option<PlaceMm> = line(1),
    }
}

/// `transfers.csv`: a [`TransferRow`] for each move between segments.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn transfers(cases: &Cases, scene: Option<&Scene>) -> Result<Vec<u8>, ReportError> {
    let moves = cases.all().into_iter().flat_map(|case| {
        case.cycle.transfers.iter().map(move |transfer| TransferRow::of(case.number(), transfer, scene))
    });
    let blank = TransferRow { path: scene.map(|_| TransferPathColumns::default()), ..TransferRow::default() };
    rows_or("the table of transfers", &blank, moves)
}

records! {
    /// A gradient refinement with its start and end.
    #[derive(Default)]
    pub struct RefinementRow of (refinement: &Refinement) {
        /// `best` or `worst`.
        search: &'static str = names::sense(refinement.sense),
        /// Where it started.
        start: PlaceColumns = (&refinement.start).into(),
        /// Mean of the scores there.
        start_mean_mm: DeflectionMm = refinement.start_mean.into(),
        /// Where it ended.
        end: PlaceColumns = (&refinement.end).into(),
        /// Mean of the scores there.
        end_mean_mm: DeflectionMm = refinement.end_mean.into(),
        /// Rounds of refining and planning anew.
        rounds: usize = refinement.rounds,
        /// Convex subproblems solved.
        iterations: usize = refinement.iterations,
        /// Largest violation of the first-order optimality conditions at the end; empty where it was stopped before,
        /// and on long paths for all but the one that was taken.
        kkt_residual_mm: Option<ResidualMm> = some(refinement.kkt_residual),
        /// How each round ended.
        status: String = names::statuses(&refinement.statuses),
    }

    /// A placement in a row.
    #[derive(Copy, Default)]
    struct PlaceColumns from placement: &Placement {
        let PlacementFigures { x_mm, y_mm, z_mm, yaw_deg, .. } = placement.into();
    } with {
        /// x of the workpiece origin.
        x_mm: PlaceMm = x_mm,
        /// y of the workpiece origin.
        y_mm: PlaceMm = y_mm,
        /// z of the workpiece origin.
        z_mm: PlaceMm = z_mm,
        /// Rotation about z.
        yaw_deg: AngleDeg = yaw_deg,
    }
}

/// `refinements.csv`: a [`RefinementRow`] for each refinement.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn refinements(refinements: &[Refinement]) -> Result<Vec<u8>, ReportError> {
    rows_or("the table of refinements", &RefinementRow::default(), refinements.iter().map(RefinementRow::of))
}
