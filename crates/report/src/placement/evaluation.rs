//! Reports of single evaluations: `stead score` and `stead explain`.

use super::case::PlanFigures;
use super::origins::{self, OriginFigures};
use super::setup::{SetupFigures, lines};
use super::sheet::SheetFigures;
use super::text::least_room;
use super::{Context, SummaryLine, score_summary};
use crate::columns::{line, table};
use crate::document::{PlacementExact, PlacementFigures};
use crate::figure::{FineAngleDeg, FineDeflectionMm, Plain, each, some};
use crate::names;
use crate::stability::path::PathStabilityFigures;
use crate::units::fixed;
use serde_json::Value;
use stead_model::robot::Posture;
use stead_placement::outcome::Plan;
use stead_placement::place::{BlockingPair, Infeasible, Preview, Score};
use stead_planning::feasibility::{Explanation, Finding};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::BySense;

records! {
    /// A placement that was evaluated.
    #[derive(Default)]
    pub struct ScoreFigures of (problem: &Problem, score: &Score, context: &Context) {
        let BySense { best, worst } = &score.cycles;
    } with {
        /// The result in a few lines, in the order in which they are to be read.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        summary: Vec<SummaryLine> = score_summary(problem, score, context),
        /// The placement.
        placement: PlacementFigures = (&score.placement).into(),
        /// The placement with every digit.
        placement_exact: PlacementExact = (&score.placement).into(),
        /// Whether the path can be milled there.
        feasible: bool = true,
        /// Whether the evaluation was ended before its time.
        interrupted: bool = score.interrupted,
        /// The best plan; null where nothing is feasible.
        best: Option<PlanFigures> = Some(PlanFigures::of(&score.plans.best, best)),
        /// The worst plan.
        worst: Option<PlanFigures> = Some(PlanFigures::of(&score.plans.worst, worst)),
        #[serde(flatten)] setup: Option<SetupFigures> =
            Some(SetupFigures::of(score.orientation.as_ref(), &score.setup, &score.plans.best.axes)),
        /// What a fitter needs to set it up: the numbers of `setup.svg`, where that is written.
        setup_sheet?: SheetFigures = score.sheet.as_ref().map(Into::into),
        /// Critical depths along both plans, where they were requested.
        stability?: PathStabilityFigures =
            context.stability.as_ref().map(|found| PathStabilityFigures::of(found, true)),
        /// Why nothing is feasible.
        findings?: Vec<FindingFigures> = None,
        /// Pairs of shapes that hit in all plans.
        #[serde(skip_serializing_if = "Vec::is_empty")] collisions: Vec<CollisionFigures> = Vec::new(),
    }

    /// Points of a segment that cannot be milled.
    pub struct FindingFigures of (finding: &Finding) {
        /// The segment, from 1.
        segment: usize = finding.segment,
        /// The first of the points, from 0.
        first_point: usize = finding.points.0,
        /// The last of them.
        last_point: usize = finding.points.1,
        /// Why not.
        message: String = finding.to_string(),
    }

    /// A pair of shapes that hits.
    pub struct CollisionFigures of (pair: &BlockingPair) {
        /// The two.
        pair: [String; 2] = pair.names.clone(),
        /// The path points where they hit, from 0.
        points: Vec<usize> = pair.points.clone(),
    }
}

/// What `stead score --json` prints, with the critical depths along both plans where they were requested.
pub fn score_json(problem: &Problem, score: &Score, context: &Context) -> Value {
    context.document().with(ScoreFigures::of(problem, score, context))
}

/// The same of a placement that is moved about, whose best plan alone is known, on the grid of the run and without the
/// moves between segments.
pub(crate) fn preview_json(placement: &Placement, problem: &Problem, preview: &Preview, context: &Context) -> Value {
    let orientation = problem.orientation().map(|orientation| orientation.name.clone());
    let Preview { plan, cycle } = preview;
    let mut best = PlanFigures::of(plan, cycle);
    best.cycle_s = None;
    context.document().with(ScoreFigures {
        placement: placement.into(),
        placement_exact: placement.into(),
        feasible: true,
        best: Some(best),
        setup: Some(SetupFigures::of(orientation.as_ref(), &problem.setup, &plan.axes)),
        ..ScoreFigures::default()
    })
}

/// What `stead score --json` and `stead place --json` print when nothing is feasible.
pub fn infeasible_json(nothing: &Infeasible, context: &Context) -> Value {
    context.document().with(ScoreFigures {
        placement: (&nothing.placement).into(),
        placement_exact: (&nothing.placement).into(),
        interrupted: nothing.interrupted,
        findings: Some(nothing.findings.iter().map(FindingFigures::of).collect()),
        collisions: nothing.collisions.iter().map(CollisionFigures::of).collect(),
        ..ScoreFigures::default()
    })
}

/// The table of `stead score`; `std mm` is the standard deviation of the mean of c_i, where the robot's uncertainty is
/// known.
pub fn score_text(problem: &Problem, score: &Score, context: &Context) -> String {
    let row = |name: &str, plan: &Plan| {
        let total = plan.deflection.total;
        let mut row = vec![name.to_owned()];
        row.extend([plan.mean, plan.max, total.mean, total.max].map(|value| fixed(value * 1e3, 4)));
        row.extend(plan.mean_deviation.map(|deviation| fixed(deviation * 1e3, 4)));
        row.push(names::postures_within(&plan.postures, 60));
        row
    };
    let mut header = vec!["plan", "mean mm", "max mm", "total mm", "max total"];
    header.extend(score.plans.best.mean_deviation.map(|_| "std mm"));
    header.push("postures");
    let last = header.len() - 1;
    let rows = [row("best", &score.plans.best), row("worst", &score.plans.worst)];
    let stability = context
        .stability
        .as_ref()
        .map(|found| format!("\n{}", crate::stability::path::text(found, ["best plan", "worst plan"])));
    let postures: String = names::posture_lines([&score.plans.best, &score.plans.worst].into_iter())
        .iter()
        .map(|row| format!("{row}\n"))
        .collect();
    let mut feed = String::new();
    origins::of_plan(&score.plans.best).iter().for_each(|row| line(&mut feed, &format!("best plan: {row}")));
    super::text::sag(&score.plans.best).iter().for_each(|row| line(&mut feed, &format!("best plan: {row}")));
    for (plan, name) in [(&score.plans.best, "best plan"), (&score.plans.worst, "worst plan")] {
        least_room(plan, name).iter().for_each(|row| line(&mut feed, row));
    }
    super::text::highest_feed(&score.cycles.best.feed).iter().for_each(|row| line(&mut feed, row));
    super::text::held_feed(&score.plans.best).iter().for_each(|row| line(&mut feed, row));
    line(&mut feed, &super::text::joint_travel(&score.plans.best));
    let feed = format!("\n{feed}");
    let stability = stability.unwrap_or_default();
    let setup: String = lines("this placement", score.orientation.as_ref(), &score.plans.best.axes)
        .iter()
        .map(|row| format!("{row}\n"))
        .collect();
    let setup = if setup.is_empty() { setup } else { format!("\n{setup}") };
    let (place, legend) = (place_text(&score.placement), super::text::legend(problem));
    format!("{place}\n{setup}\n{}{legend}{postures}{feed}{stability}", table(header, rows, &[0, last]))
}

records! {
    /// The eight states of a path point.
    pub struct ExplainFigures of (placement: &Placement, point: usize, beta: f64, postures: &[Explanation; 8]) {
        /// The placement.
        placement: PlacementFigures = placement.into(),
        /// The path point, from 0.
        point: usize = point,
        /// Angle about the tool axis.
        beta_deg: FineAngleDeg = beta.into(),
        /// Every posture.
        postures: Vec<ExplainedPosture> = postures.iter().map(Into::into).collect(),
    }

    /// A posture at a path point; its figures are null where it is out of reach.
    pub struct ExplainedPosture from explanation: &Explanation {
        let state = explanation.state.as_ref();
    } with {
        /// The posture, 1 to 8.
        #[schemars(with = "u8")] posture: Posture = explanation.posture,
        /// The same in words.
        posture_words: String = explanation.words.to_string(),
        /// Joint angles.
        joints_deg: Option<[FineAngleDeg; 6]> = state.map(|s| each(s.joints)),
        /// Inverse of the condition number of the Jacobian.
        inverse_condition: Option<Plain> = state.map(|s| s.inverse_condition.into()),
        /// Size of the deflection normal to the wall.
        normal_deflection_mm: Option<FineDeflectionMm> = state.map(|s| s.normal_part.abs().into()),
        /// Size of the deflection.
        total_deflection_mm: Option<FineDeflectionMm> = state.map(|s| s.deflection.norm().into()),
        /// The scored part of the deflection.
        score_mm: Option<FineDeflectionMm> = state.map(|s| s.score().into()),
        /// Standard deviation of the scored part, where the robot's uncertainty is known.
        std_mm?: FineDeflectionMm = some(state.and_then(|s| s.own.deviation)),
        /// What each thing that yields adds to the scored part, where more does than the joints about their axes.
        by_origin_mm?: OriginFigures = explanation.by_origin.as_ref().map(Into::into),
        /// Whether the state is allowed.
        feasible: bool = explanation.is_allowed(),
        /// The constraints that it breaks.
        violations: Vec<String> = explanation.violations.iter().map(ToString::to_string).collect(),
    }
}

/// What `stead explain --json` prints.
pub fn explain_json(
    placement: &Placement,
    point: usize,
    beta: f64,
    postures: &[Explanation; 8],
    context: &Context,
) -> Value {
    context.document().with(ExplainFigures::of(placement, point, beta, postures))
}

/// The table of `stead explain`.
pub fn explain_text(placement: &Placement, point: usize, beta: f64, postures: &[Explanation; 8]) -> String {
    let states = || postures.iter().filter_map(|e| e.state.as_ref());
    let mut header = vec!["no.", "th1 deg", "th2 deg", "th3 deg", "th4 deg", "th5 deg", "th6 deg", "1/kappa", "c mm"];
    header.extend(states().find_map(|s| s.own.deviation).map(|_| "std mm"));
    header.extend(["in words", ""]);
    let last = header.len() - 1;
    let mut rows = Vec::new();
    let mut broken = String::new();
    for e in postures {
        let mut row = vec![e.posture.to_string()];
        match &e.state {
            Some(s) => {
                row.extend(s.joints.map(|angle| fixed(angle.to_degrees(), 3)));
                row.extend([fixed(s.inverse_condition, 4), fixed(s.own.scored.abs() * 1e3, 5)]);
                row.extend(s.own.deviation.map(|deviation| fixed(deviation * 1e3, 5)));
            }
            None => row.extend((1..last - 1).map(|_| "-".to_owned())),
        }
        row.push(e.words.to_string());
        row.push(if e.is_allowed() { "allowed" } else { "refused" }.to_owned());
        rows.push(row);
        for violation in &e.violations {
            broken.push_str(&format!("  posture {}: {violation}\n", e.posture));
        }
    }
    let (place, beta) = (place_text(placement), fixed(beta.to_degrees(), 3));
    let states = table(header, rows, &[last - 1, last]);
    let mut text = format!("{place}, point {point}, beta {beta} deg\n\n{states}");
    if let Some(origins) = origins::of_postures(postures) {
        text.push('\n');
        text.push_str(&origins);
    }
    if !broken.is_empty() {
        text.push_str("\nbroken constraints\n");
        text.push_str(&broken);
    }
    text
}

fn place_text(placement: &Placement) -> String {
    let [x, y, z] = [placement.x, placement.y, placement.z].map(|value| fixed(value * 1e3, 1));
    let (yaw, q4) = (fixed(placement.yaw.to_degrees(), 2), fixed(placement.q4(), 4));
    format!("x {x} mm, y {y} mm, z {z} mm, yaw {yaw} deg (Q4 {q4})")
}
