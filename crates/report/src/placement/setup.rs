//! How part and external axes are set up, in documents, tables and words; nothing where a run has neither orientations nor axes.

use super::PLACES;
use crate::columns::aligned;
use crate::units::{Unit, fixed};
use serde_json::{Value, json};
use stead_model::external_axis::AxisKind;
use stead_placement::outcome::{Case, Outcome};
use stead_placement::problem::Problem;
use stead_placement::setup::{AxisPath, AxisPositions, Setup, TriedSetup};

/// The unit of the positions of an axis.
pub(crate) fn unit(kind: AxisKind) -> Unit {
    match kind {
        AxisKind::Rail => Unit::PLACE_MM,
        AxisKind::Turntable => Unit::ANGLE_DEG,
    }
}

/// The name of that unit.
fn unit_name(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Rail => "mm",
        AxisKind::Turntable => "deg",
    }
}

/// The word for a kind.
pub(crate) fn word(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Rail => "rail",
        AxisKind::Turntable => "turntable",
    }
}

/// The column of the positions of an axis, by its number from 0: `e1_mm`, `e2_deg`.
pub(crate) fn column(number: usize, kind: AxisKind) -> String {
    format!("e{}_{}", number + 1, unit_name(kind))
}

/// The columns of the positions of axes.
pub(super) fn columns(axes: &[AxisPath]) -> Vec<String> {
    axes.iter().enumerate().map(|(number, axis)| column(number, axis.kind)).collect()
}

/// Positions of axes at a path point, as the plan files state them.
pub(super) fn at_point(axes: &[AxisPath], point: usize) -> Vec<String> {
    axes.iter().map(|axis| axis.positions.get(point).map_or_else(String::new, |at| unit(axis.kind).text(*at))).collect()
}

/// The position of each axis that stands still along the path.
pub(super) fn standing(axes: &[AxisPath]) -> Vec<String> {
    axes.iter().map(|axis| one_position(axis).map_or_else(String::new, |at| unit(axis.kind).text(at))).collect()
}

fn one_position(axis: &AxisPath) -> Option<f64> {
    let first = *axis.positions.first()?;
    axis.positions.iter().all(|position| *position == first).then_some(first)
}

/// Adds orientation and axes to an entry, where there are such.
pub(crate) fn put_setup(entry: &mut Value, orientation: Option<&String>, setup: &Setup, axes: &[AxisPath]) {
    let Value::Object(map) = entry else { return };
    if let Some(name) = orientation {
        map.insert("orientation".to_owned(), json!(name));
    }
    if axes.is_empty() {
        return;
    }
    let exact = |position: f64, kind: AxisKind| match kind {
        AxisKind::Rail => position * 1e3,
        AxisKind::Turntable => position.to_degrees(),
    };
    let row = |row: &Vec<f64>| -> Value { row.iter().zip(axes).map(|(at, axis)| exact(*at, axis.kind)).collect() };
    let (each, rows) = match &setup.positions {
        AxisPositions::Same(one) => ("path", json!([row(one)])),
        AxisPositions::PerSegment(all) => ("segment", all.iter().map(row).collect()),
        AxisPositions::PerPoint(all) => ("point", all.iter().map(row).collect()),
    };
    let named = |axis: &AxisPath| json!({ "name": axis.name, "kind": word(axis.kind), "unit": unit_name(axis.kind) });
    let value = json!({ "axes": axes.iter().map(named).collect::<Vec<_>>(), "for_each": each, "positions": rows });
    map.insert("external_axes".to_owned(), value);
}

/// The setups that were searched, with the objectives of their best and worst placements.
pub(super) fn tried(problem: &Problem, outcome: &Outcome) -> Option<Value> {
    let entry = |TriedSetup { setup, objectives }: &TriedSetup| {
        let problem = problem.in_setup(setup);
        let mut value = json!({
            "best_objective_mm": objectives.map(|(best, _)| Unit::DEFLECTION_MM.number(best)),
            "worst_objective_mm": objectives.and_then(|(_, worst)| worst).map(|worst| Unit::DEFLECTION_MM.number(worst)),
        });
        let name = problem.orientation().map(|orientation| orientation.name.clone());
        put_setup(&mut value, name.as_ref(), setup, &problem.axis_paths());
        value
    };
    (!outcome.tried_setups.is_empty()).then(|| outcome.tried_setups.iter().map(entry).collect())
}

/// How part and axes are set up for a case, a line each.
pub(crate) fn lines(of: &str, orientation: Option<&String>, axes: &[AxisPath]) -> Vec<String> {
    let mut lines: Vec<String> = orientation.map(|name| format!("{of} has the part \"{name}\"")).into_iter().collect();
    for axis in axes {
        let (unit, name) = (unit(axis.kind), unit_name(axis.kind));
        let kind = word(axis.kind);
        lines.push(match one_position(axis) {
            Some(at) => format!("{of} has the {kind} \"{}\" at {} {name}", axis.name, unit.text(at)),
            None => {
                let ends = |of: fn(f64, f64) -> f64| axis.positions.iter().copied().reduce(of).unwrap_or(0.0);
                let [least, most] = [ends(f64::min), ends(f64::max)].map(|at| unit.text(at));
                format!("{of} has the {kind} \"{}\" between {least} and {most} {name} along the path", axis.name)
            }
        });
    }
    lines
}

/// The lines of the best and the worst placement, and a table of the setups that were searched.
pub(super) fn text(problem: &Problem, outcome: &Outcome) -> String {
    let cases = PLACES.into_iter().zip(outcome.cases.optima());
    let of = |(name, case): (&str, &Case)| lines(name, case.orientation.as_ref(), &case.plan.axes);
    let all: Vec<String> = cases.flat_map(of).collect();
    let mut text: String = all.iter().map(|line| format!("{line}\n")).collect();
    if outcome.tried_setups.len() > 1 {
        let mut header = vec!["setup".to_owned()];
        header.extend((!problem.orientations.is_empty()).then(|| "orientation".to_owned()));
        header.extend(problem.external_axes.iter().map(|axis| format!("{} {}", axis.name, unit_name(axis.kind))));
        header.extend(["best mm", "worst mm"].map(str::to_owned));
        let mut rows = vec![header];
        for (TriedSetup { setup, objectives }, number) in outcome.tried_setups.iter().zip(1..) {
            let problem = problem.in_setup(setup);
            let mut row = vec![number.to_string()];
            row.extend(problem.orientation().map(|orientation| orientation.name.clone()));
            row.extend(standing(&problem.axis_paths()));
            let figure = |objective: Option<f64>| objective.map_or_else(|| "-".to_owned(), |of| fixed(of * 1e3, 4));
            row.extend([objectives.map(|(best, _)| best), objectives.and_then(|(_, worst)| worst)].map(figure));
            rows.push(row);
        }
        let names = if problem.orientations.is_empty() { vec![] } else { vec![1] };
        text.push('\n');
        text.push_str(&aligned(&rows, &names));
    }
    text
}
