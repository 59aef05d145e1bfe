//! The JSON documents of an assessment: what `stead assess --json` prints, and `summary.json`.

use super::AssessmentContext;
use crate::document::{Document, Timing, joined};
use crate::units::Unit;
use nalgebra::Vector3;
use serde_json::{Value, json};
use stead_assessment::benchmark::{Benchmark, StiffnessModel};
use stead_assessment::comparison::{Assessment, Comparison, Configuration, MapPoint, RobotResult, Zones};
use stead_assessment::published::Agreement;
use stead_format::scalars::Word;

/// What `stead assess --json` prints.
pub fn assess_json(assessment: &Assessment, context: &AssessmentContext, timing: &Timing) -> Value {
    let timing = json!({ "threads": timing.threads, "wall_s": Unit::TIME_S.number(timing.wall) });
    joined(document(assessment, context), timing)
}

/// The content of `summary.json`: byte for byte the same for the same inputs.
pub fn summary_json(comparison: &Comparison, assessment: &Assessment, context: &AssessmentContext) -> Value {
    joined(document(assessment, context), json!({ "benchmark": benchmark(comparison, context.range_share) }))
}

fn document(assessment: &Assessment, context: &AssessmentContext) -> Value {
    let accuracies = assessment.accuracies.iter().map(|cell| {
        json!({
            "robot": cell.robot,
            "force_n": Unit::FORCE_N.number(cell.force),
            "circularity_mm": optional(cell.circularity),
        })
    });
    let selection = assessment.capable.iter().map(|cell| {
        json!({
            "accuracy_mm": mm(cell.accuracy),
            "force_n": Unit::FORCE_N.number(cell.force),
            "robots": cell.robots,
        })
    });
    let agreement = context.published.as_ref().map(|(published, agreement)| reference(&published.source, agreement));
    Document::new(&context.inputs).notes(&context.notes).warnings(&assessment.warnings).with(json!({
        "robots": assessment.robots.iter().map(robot).collect::<Value>(),
        "order": assessment.order,
        "accuracies": accuracies.collect::<Value>(),
        "selection": selection.collect::<Value>(),
        "reference": agreement,
    }))
}

fn robot(robot: &RobotResult) -> Value {
    let sheet = &robot.data_sheet;
    json!({
        "name": robot.name,
        "payload_kg": sheet.payload,
        "working_radius_mm": Unit::PLACE_MM.number(robot.working_radius),
        "price_eur": sheet.price,
        "configurations": robot.configurations.iter().map(configuration).collect::<Vec<_>>(),
    })
}

fn configuration(configuration: &Configuration) -> Value {
    let value = |spot: Option<MapPoint>| optional(spot.map(|spot| spot.circularity));
    let place = |spot: Option<MapPoint>| spot.map_or(Value::Null, |spot| centre(spot.centre));
    json!({
        "elbow": configuration.elbow.word(),
        "load": configuration.load.word(),
        "force_n": Unit::FORCE_N.number(configuration.force),
        "circles": configuration.circles,
        "circles_too_soft": configuration.too_soft,
        "min_mm": value(configuration.min),
        "min_at": place(configuration.min),
        "max_mm": value(configuration.max),
        "max_at": place(configuration.max),
        "middle_mm": value(configuration.middle),
        "middle_at": place(configuration.middle),
        "zones": configuration.zones.iter().map(zones).collect::<Vec<_>>(),
    })
}

fn zones(zones: &Zones) -> Value {
    json!({
        "size_mm": Unit::PLACE_MM.number(zones.side),
        "optimal_mm": optional(zones.optimal.map(|zone| zone.largest)),
        "optimal_at": zones.optimal.map_or(Value::Null, |zone| centre(zone.centre)),
        "middle_mm": optional(zones.middle.map(|zone| zone.largest)),
        "middle_at": zones.middle.map_or(Value::Null, |zone| centre(zone.centre)),
    })
}

/// A place in the coordinates of the plane.
fn centre([x, y]: [f64; 2]) -> Value {
    json!({ "x_mm": Unit::PLACE_MM.number(x), "y_mm": Unit::PLACE_MM.number(y) })
}

fn reference(source: &str, agreement: &Agreement) -> Value {
    let (cells, same) = agreement.accuracies;
    let (capable, same_capable) = agreement.capable;
    json!({
        "source": source,
        "rms_percent": Unit::PLAIN.number(agreement.rms * 100.0),
        "readings": agreement.readings,
        "readings_on_one_side_only": agreement.one_sided,
        "order": agreement.order,
        "same_best": agreement.same_best,
        "same_worst": agreement.same_worst,
        "same_order": agreement.same_order,
        "accuracy_cells": cells,
        "accuracy_cells_that_round_alike": same,
        "selection_cells": capable,
        "selection_cells_with_the_same_robots": same_capable,
    })
}

fn benchmark(comparison: &Comparison, range_share: Option<f64>) -> Value {
    let Benchmark { plane, radius, points, wrench, turning, base_from_tool, yielding, limits_at, stiffness, .. } =
        &comparison.benchmark;
    let vector = |unit: Unit, v: &Vector3<f64>| [v.x, v.y, v.z].map(|part| unit.number(part));
    let last = comparison.grid.at(comparison.grid.counts.map(|count| (count - 1) as f64));
    let ends = |axis: usize| [comparison.grid.origin[axis], last[axis]].map(|end| Unit::PLACE_MM.number(end));
    let joints: Vec<usize> = (1..=6).filter(|joint| yielding[joint - 1]).collect();
    json!({
        "plane": {
            "origin_mm": vector(Unit::PLACE_MM, &plane.origin),
            "x": vector(Unit::PLAIN, &plane.x),
            "y": vector(Unit::PLAIN, &plane.y),
        },
        "radius_mm": Unit::PLACE_MM.number(*radius),
        "points": points,
        "force_n": vector(Unit::FORCE_N, &wrench.force),
        "moment_nm": vector(Unit::MOMENT_NM, &wrench.moment),
        "force_turns": Word(*turning),
        "traced": if comparison.benchmark.flange_from_tool.is_some() { "tool" } else { "wrist-centre" },
        "tool_axis": vector(Unit::PLAIN, &-base_from_tool.column(2).into_owned()),
        "limits_at": Word(*limits_at),
        "elbow_names": Word(comparison.elbow_names),
        "joints": joints,
        "range_share": range_share,
        "loaded": *stiffness == StiffnessModel::Loaded,
        "rated_share": comparison.rated_share,
        "gravity_m_per_s2": comparison.selection.gravity,
        "remaining_share": comparison.selection.remaining_share,
        "map": {
            "x_mm": ends(0),
            "y_mm": ends(1),
            "step_mm": Unit::PLACE_MM.number(comparison.grid.step),
        },
    })
}

fn mm(value: f64) -> f64 {
    Unit::DEFLECTION_MM.number(value)
}

fn optional(value: Option<f64>) -> Value {
    value.map_or(Value::Null, |value| json!(mm(value)))
}
