//! The JSON documents: what `stead place --json` prints, and `summary.json`.
//!
//! Both have the cases, the refinements and the counts. The printed document adds the plans point by point and how long
//! the computation took; the summary adds inputs and settings and has nothing that differs from run to run.

use super::number::Unit;
use super::{Context, words};
use serde_json::{Map, Value, json};
use stead_format::input::InputFile;
use stead_placement::lookup::Axis;
use stead_placement::outcome::{Case, Outcome, PlanPoint, Refinement, Tabled, Transfer};
use stead_placement::problem::{Interval, Placement, Problem};
use stead_placement::settings::{PostureSearch, Tables};
use stead_placement::symmetry::Unsupported;

/// How long a computation took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Time on the clock. s
    pub wall: f64,
    /// Threads used.
    pub threads: usize,
}

/// What `stead place --json` prints.
pub fn place_json(outcome: &Outcome, context: &Context, timing: &Timing) -> Value {
    let mut document = common(outcome, context, true);
    document.insert("cases".to_owned(), cases(outcome, true));
    document.insert("threads".to_owned(), json!(timing.threads));
    document.insert("wall_s".to_owned(), number(Unit::TIME_S, timing.wall));
    let rate = if timing.wall > 0.0 { json!((outcome.states as f64 / timing.wall).round()) } else { Value::Null };
    document.insert("states_per_second".to_owned(), rate);
    Value::Object(document)
}

/// The content of `summary.json`: byte for byte the same for the same inputs and settings.
pub fn summary_json(problem: &Problem, outcome: &Outcome, context: &Context) -> Value {
    let mut document = common(outcome, context, false);
    document.insert("version".to_owned(), json!(env!("CARGO_PKG_VERSION")));
    document.insert("robot".to_owned(), json!(problem.robot.name()));
    document.insert("seed".to_owned(), json!(context.search.seed));
    document.insert("inputs".to_owned(), inputs(&context.inputs));
    document.insert("search".to_owned(), search(context));
    document.insert("transfer".to_owned(), transfer_settings(context));
    document.insert("cell".to_owned(), cell(problem));
    document.insert("constraints".to_owned(), constraints(problem));
    document.insert("criterion".to_owned(), criterion(problem));
    document.insert("redundancy".to_owned(), redundancy(problem));
    document.insert("task".to_owned(), task(problem));
    document.insert("cases".to_owned(), cases(outcome, false));
    Value::Object(document)
}

/// A document as the bytes of a file or of standard output: indented, with a line break at the end.
pub fn bytes(document: &Value) -> Vec<u8> {
    format!("{document:#}\n").into_bytes()
}

fn common(outcome: &Outcome, context: &Context, with_points: bool) -> Map<String, Value> {
    let reference = context
        .reference
        .as_ref()
        .map_or(Value::Null, |reference| json!({ "source": reference.source, "case_mm": reference.case_mm }));
    let refinements: Vec<Value> = outcome.refinements.iter().map(refinement).collect();
    let mut document = Map::from_iter([
        ("evaluations".to_owned(), json!(outcome.evaluations)),
        ("states".to_owned(), json!(outcome.states)),
        ("table".to_owned(), outcome.tabled.as_ref().map_or(Value::Null, tabled)),
        ("interrupted".to_owned(), json!(outcome.interrupted)),
        ("refinements".to_owned(), Value::Array(refinements)),
        ("reference".to_owned(), reference),
    ]);
    document.extend(context.stability.as_ref().map(|found| ("stability".to_owned(), found.document(with_points))));
    document
}

/// Errors of a table, relative.
const TABLE_ERROR: Unit = Unit { factor: 1.0, decimals: 8 };

/// The table that the search looked through, or why there is none.
fn tabled(tabled: &Result<Tabled, Unsupported>) -> Value {
    match tabled {
        Err(unsuited) => json!({ "used": false, "reason": unsuited.to_string() }),
        Ok(Tabled { shape, accuracy }) => {
            let axis = |axis: &Axis| {
                json!({
                    "first_mm": number(Unit::PLACE_MM, axis.first),
                    "step_mm": number(Unit::PLACE_MM, axis.step),
                    "count": axis.count,
                })
            };
            json!({
                "used": true,
                "radius": axis(&shape.radius),
                "height": axis(&shape.height),
                "headings": shape.headings,
                "states": shape.states(),
                "bytes": shape.bytes(),
                "compared_states": accuracy.states,
                "rms_error": number(TABLE_ERROR, accuracy.rms),
                "largest_error": number(TABLE_ERROR, accuracy.largest),
                "disputed_share": number(TABLE_ERROR, accuracy.disputed),
            })
        }
    }
}

fn cases(outcome: &Outcome, with_plans: bool) -> Value {
    outcome.cases.iter().map(|entry| case(entry, with_plans)).collect()
}

fn case(case: &Case, with_plan: bool) -> Value {
    let mut value = json!({
        "case": case.number,
        "placement": placement(&case.placement),
        "mean_mm": number(Unit::DEFLECTION_MM, case.plan.mean),
        "max_mm": number(Unit::DEFLECTION_MM, case.plan.max),
        "postures": case.plan.postures,
        "cutting_s": number(Unit::TIME_S, case.cycle.cutting),
        "cycle_s": optional(Unit::TIME_S, case.cycle.total()),
        "transfers": case.cycle.transfers.iter().map(transfer).collect::<Vec<_>>(),
    });
    put_deviation(&mut value, "mean_std_mm", Unit::DEFLECTION_MM, case.plan.mean_deviation);
    if with_plan && let Value::Object(map) = &mut value {
        map.insert("plan".to_owned(), case.plan.points.iter().map(plan_point).collect());
    }
    value
}

/// Adds a standard deviation to an object where the robot's uncertainty is known.
pub(super) fn put_deviation(object: &mut Value, key: &str, unit: Unit, deviation: Option<f64>) {
    if let (Some(deviation), Value::Object(map)) = (deviation, object) {
        map.insert(key.to_owned(), number(unit, deviation));
    }
}

/// A placement as every JSON document states it.
pub fn placement(placement: &Placement) -> Value {
    json!({
        "x_mm": number(Unit::PLACE_MM, placement.x),
        "y_mm": number(Unit::PLACE_MM, placement.y),
        "z_mm": number(Unit::PLACE_MM, placement.z),
        "q4": number(Unit::PLAIN, placement.q4()),
        "yaw_deg": number(Unit::ANGLE_DEG, placement.yaw),
    })
}

fn plan_point(point: &PlanPoint) -> Value {
    let mut value = json!({
        "point": point.point,
        "segment": point.segment,
        "beta_deg": number(Unit::ANGLE_DEG, point.beta),
        "posture": point.posture,
        "joints_deg": point.joints.map(|angle| number(Unit::ANGLE_DEG, angle)),
        "inverse_condition": number(Unit::PLAIN, point.inverse_condition),
        "normal_mm": number(Unit::DEFLECTION_MM, point.normal_part),
        "score_mm": number(Unit::DEFLECTION_MM, point.score),
    });
    put_deviation(&mut value, "std_mm", Unit::DEFLECTION_MM, point.deviation);
    value
}

fn transfer(transfer: &Transfer) -> Value {
    json!({
        "after_segment": transfer.after_segment,
        "duration_s": optional(Unit::TIME_S, transfer.duration),
        "travel_deg": number(Unit::ANGLE_DEG, transfer.travel),
    })
}

fn refinement(refinement: &Refinement) -> Value {
    json!({
        "search": words::goal(refinement.goal),
        "start": placement(&refinement.start),
        "start_mean_mm": number(Unit::DEFLECTION_MM, refinement.start_mean),
        "end": placement(&refinement.end),
        "end_mean_mm": number(Unit::DEFLECTION_MM, refinement.end_mean),
        "rounds": refinement.rounds,
        "iterations": refinement.iterations,
        "kkt_residual_mm": number(Unit::RESIDUAL_MM, refinement.kkt_residual),
        "status": refinement.statuses.join("; "),
    })
}

/// The files that a result depends on, as every JSON document states them.
pub fn inputs(files: &[InputFile]) -> Value {
    files.iter().map(|file| json!({ "role": file.role, "name": file.name, "sha256": file.sha256 })).collect()
}

fn search(context: &Context) -> Value {
    let postures = match context.search.postures {
        PostureSearch::Exact => "exact",
        PostureSearch::Genetic => "genetic",
    };
    let tables = match context.search.tables {
        Tables::Auto => "auto",
        Tables::Always => "always",
        Tables::Never => "never",
    };
    json!({
        "population": context.search.population,
        "generations": context.search.generations,
        "postures": postures,
        "basins": context.search.basins,
        "tables": tables,
    })
}

fn transfer_settings(context: &Context) -> Value {
    json!({
        "acceleration_time_s": number(Unit::TIME_S, context.transfer.acceleration_time),
        "jerk_time_s": number(Unit::TIME_S, context.transfer.jerk_time),
    })
}

fn cell(problem: &Problem) -> Value {
    let [x, y, z] = problem.cell.position.map(|bounds| interval(Unit::PLACE_MM, &bounds));
    json!({ "x_mm": x, "y_mm": y, "z_mm": z, "yaw_deg": interval(Unit::ANGLE_DEG, &problem.cell.yaw) })
}

/// The confidence is stated where there is something to be confident of.
fn criterion(problem: &Problem) -> Value {
    let mut value = json!({ "force_uncertainty": problem.criterion.force_uncertainty });
    if let (Some(_), Value::Object(map)) = (problem.robot.uncertainty(), &mut value) {
        map.insert("confidence".to_owned(), json!(problem.criterion.confidence));
    }
    value
}

fn constraints(problem: &Problem) -> Value {
    json!({
        "min_inverse_condition": problem.constraints.min_inverse_condition,
        "characteristic_length_mm": number(Unit::PLACE_MM, problem.constraints.characteristic_length),
        "max_deflection_mm": optional(Unit::DEFLECTION_MM, problem.constraints.max_deflection),
    })
}

fn redundancy(problem: &Problem) -> Value {
    json!({
        "beta_count": problem.redundancy.beta_count,
        "feed_mm_per_s": number(Unit::SPEED_MM_PER_S, problem.redundancy.feed),
        "max_beta_rate_deg_per_mm": number(Unit::RATE_DEG_PER_MM, problem.redundancy.max_beta_rate),
    })
}

fn task(problem: &Problem) -> Value {
    json!({ "points": problem.task.points().len(), "segments": problem.task.segments().len() })
}

fn interval(unit: Unit, interval: &Interval) -> Value {
    json!([number(unit, interval.min), number(unit, interval.max)])
}

fn number(unit: Unit, value: f64) -> Value {
    json!(unit.number(value))
}

fn optional(unit: Unit, value: Option<f64>) -> Value {
    value.map_or(Value::Null, |value| number(unit, value))
}
