//! What is known of a case once it is done: one row of the table of results.

use super::table::{Column, ColumnKind, TableCell};
use crate::run::{Placed, RunError};
use std::collections::BTreeSet;
use stead_certify::{Certificate, Proof, Status};
use stead_model::robot::Posture;
use stead_model::robot::turns::Range;
use stead_numerics::unit::Unit;
use stead_placement::outcome::{Case, DeflectionFigures, Plan};
use stead_problem::limit::{ActiveBound, Side};
use stead_problem::problem::Problem;

/// Whether a case has a placement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaseStatus {
    /// It has.
    Placed,
    /// No placement satisfies the constraints.
    Infeasible,
    /// The job failed.
    Failed,
}

impl CaseStatus {
    /// The word in the table of results.
    pub fn word(self) -> &'static str {
        match self {
            Self::Placed => "placed",
            Self::Infeasible => "infeasible",
            Self::Failed => "failed",
        }
    }
}

/// Names of the four cases of a placement, in the order of their numbers.
const CASES: [&str; 4] = ["best", "best_worst_plan", "worst", "worst_worst_plan"];

/// Columns of what is found, behind the figures of the four cases.
const FIGURES: [(&str, ColumnKind); 23] = [
    ("objective_mm", ColumnKind::Number),
    ("cycle_s", ColumnKind::Number),
    ("min_inverse_condition", ColumnKind::Number),
    ("min_joint_margin_deg", ColumnKind::Number),
    ("min_base_distance_mm", ColumnKind::Number),
    ("min_clearance_mm", ColumnKind::Number),
    ("nearest_pair", ColumnKind::Text),
    ("max_feed_mm_per_s", ColumnKind::Number),
    ("x_mm", ColumnKind::Number),
    ("y_mm", ColumnKind::Number),
    ("z_mm", ColumnKind::Number),
    ("yaw_deg", ColumnKind::Number),
    ("q4", ColumnKind::Number),
    ("postures", ColumnKind::Count),
    ("active_bounds", ColumnKind::Text),
    ("payload_kg", ColumnKind::Number),
    ("price_eur", ColumnKind::Number),
    ("certificate_best_mm", ColumnKind::Number),
    ("certificate_best_gap_percent", ColumnKind::Number),
    ("certificate_best_status", ColumnKind::Text),
    ("certificate_worst_mm", ColumnKind::Number),
    ("certificate_worst_gap_percent", ColumnKind::Number),
    ("certificate_worst_status", ColumnKind::Text),
];

/// The columns of what is found: status, reason, figures.
pub fn result_columns() -> Vec<Column> {
    let mut columns = vec![Column::new("status", ColumnKind::Text), Column::new("reason", ColumnKind::Text)];
    for case in CASES {
        for part in ["wall", "axis", "total"] {
            columns.extend(["mean", "max"].map(|of| Column::new(format!("{case}_{of}_{part}_mm"), ColumnKind::Number)));
        }
    }
    columns.extend(FIGURES.map(|(name, kind)| Column::new(name, kind)));
    columns
}

/// The row of a case without a placement.
pub(super) fn row_without(error: &RunError) -> Vec<TableCell> {
    let status = match error {
        RunError::Infeasible(_) => CaseStatus::Infeasible,
        RunError::Stability(_) => CaseStatus::Failed,
    };
    let reason = error.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    let mut row = vec![TableCell::Text(status.word().to_owned()), TableCell::Text(reason)];
    row.resize(result_columns().len(), TableCell::None);
    row
}

/// The row of a case with its placement.
pub(super) fn row_of(problem: &Problem, placed: &Placed, certificate: Option<&Certificate>) -> Vec<TableCell> {
    let cases = &placed.outcome.cases;
    let mut row = vec![TableCell::Text(CaseStatus::Placed.word().to_owned()), TableCell::None];
    for case in cases.all() {
        let DeflectionFigures { wall, axis, total, .. } = case.plan.deflection;
        row.extend(
            [wall, axis, total]
                .into_iter()
                .flat_map(|figures| [figures.mean, figures.max].map(|value| number(Unit::DEFLECTION_MM, Some(value)))),
        );
    }
    // Where the worst placement was not looked for there are no figures of it.
    row.resize(result_columns().len() - FIGURES.len(), TableCell::None);
    row.extend(figures(problem, &cases.best));
    row.extend(bound(certificate.map(|certificate| certificate.best.as_ref().map_err(ToString::to_string))));
    row.extend(bound(certificate.map(|certificate| certificate.worst.as_ref().map_err(ToString::to_string))));
    row
}

/// What is found of the best placement with its best plan.
fn figures(problem: &Problem, best: &Case) -> Vec<TableCell> {
    let Case { placement, plan, cycle, .. } = best;
    let postures: BTreeSet<Posture> = plan.postures.iter().copied().collect();
    let bounds = best.active_bounds.iter().flatten().map(|ActiveBound { side, .. }| name_of(*side));
    // Several pairs of shapes can hold it.
    let mut seen = BTreeSet::new();
    let bounds = bounds.filter(|name| seen.insert(name.clone())).collect::<Vec<_>>().join(" ");
    let smallest = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::min);
    let inverse_condition = smallest(&mut plan.points.iter().map(|point| point.inverse_condition));
    let base_distance = smallest(&mut plan.points.iter().map(|point| match problem.robot.is_mounted() {
        true => problem.base_distance(&point.position),
        false => libm::hypot(point.position.x, point.position.y),
    }));
    vec![
        number(Unit::DEFLECTION_MM, Some(plan.objective)),
        number(Unit::TIME_S, cycle.total()),
        number(Unit::PLAIN, inverse_condition),
        number(Unit::ANGLE_DEG, smallest(&mut joint_margins(problem, plan))),
        number(Unit::PLACE_MM, base_distance),
        number(Unit::PLACE_MM, plan.clearance.as_ref().map(|clearance| clearance.distance)),
        plan.clearance.as_ref().map_or(TableCell::None, |clearance| TableCell::Text(clearance.names.join(" and "))),
        number(Unit::SPEED_MM_PER_S, cycle.feed.highest().map(|limit| limit.feed)),
        number(Unit::PLACE_MM, Some(placement.x)),
        number(Unit::PLACE_MM, Some(placement.y)),
        number(Unit::PLACE_MM, Some(placement.z)),
        number(Unit::ANGLE_DEG, Some(placement.yaw)),
        number(Unit::PLAIN, Some(placement.q4())),
        TableCell::Count(postures.len() as i64),
        if bounds.is_empty() { TableCell::None } else { TableCell::Text(bounds) },
        TableCell::number(problem.robot.data_sheet().payload),
        TableCell::number(problem.robot.data_sheet().price),
    ]
}

/// How far each joint, and the sum of joints 2 and 3, is from its nearer limit at each point of a plan, what the run
/// file keeps free included. rad
fn joint_margins<'p>(problem: &'p Problem, plan: &'p Plan) -> impl Iterator<Item = f64> + 'p {
    let (robot, kept) = (&problem.robot, problem.constraints.joint_margin);
    plan.points.iter().flat_map(move |point| {
        let joints = point.joints.into_iter().zip(robot.joints().iter().map(Range::of));
        let sum = robot.sum_range().map(|range| (robot.sum_of(&point.joints), range));
        joints.chain(sum).map(move |(angle, range)| kept + (angle - range.min).min(range.max - angle))
    })
}

/// Bound, gap and status of one side of a certificate.
fn bound(proof: Option<Result<&Proof, String>>) -> [TableCell; 3] {
    match proof {
        None => [TableCell::None, TableCell::None, TableCell::None],
        Some(Err(reason)) => [TableCell::None, TableCell::None, TableCell::Text(reason)],
        Some(Ok(proof)) => [
            TableCell::number(Some(proof.bound_mm())),
            TableCell::number(Some(proof.gap_percent()).filter(|_| proof.is_of_use())),
            TableCell::Text(status_of(proof.bound.status).to_owned()),
        ],
    }
}

/// How a proof ended, in the words of `certificate.json`.
fn status_of(status: Status) -> &'static str {
    match status {
        Status::Reached => "reached",
        Status::Exhausted => "exhausted",
        Status::SegmentsApart => "segments_apart",
        Status::TimeLimit => "time_limit",
        Status::Memory => "memory",
        Status::Interrupted => "interrupted",
    }
}

/// A number in the unit and with the decimals of the results files.
fn number(unit: Unit, value: Option<f64>) -> TableCell {
    TableCell::number(value.map(|value| unit.number(value)))
}

/// The name of a bound: `z_max`, `joint_2_min`.
fn name_of(side: Side) -> String {
    let [_, limit] = side.limit.names();
    format!("{limit}_{}", if side.is_upper { "max" } else { "min" })
}
