//! A judge of results: plain, slow, and of its own.
//!
//! From the input files of a run and the folder of its results it computes everything anew (poses in the frame of the
//! cell, limits, steps, turns, deflections, scores, distances of all pairs of shapes at the points, between them and on
//! the moves between segments, times, and what a controller makes of the exported program) and lists where that differs
//! from what the results state.
//!
//! It shares no code with stead: no crate of it is a dependency. Distances are the plain ones of parry3d.

#![allow(clippy::excessive_nesting, clippy::too_many_arguments, reason = "plain loops, written beside the formulas")]

mod arm;
mod cell;
pub mod cover;
mod lean;
mod moves;
mod path;
mod plan;
mod program;
mod score;
mod solid;
mod values;
mod verdict;
pub mod write;
mod yielding;

pub use verdict::Verdict;

use cell::Cell;
use nalgebra::Vector3;
use plan::Plan;
use serde_json::Value;
use std::path::Path;

/// The files of the four cases.
const CASES: [&str; 4] = ["best.csv", "best-worst-plan.csv", "worst.csv", "worst-worst-plan.csv"];

fn summary(results: &Path) -> Result<Value, String> {
    let file = results.join("summary.json");
    let content = std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    serde_json::from_str(&content).map_err(|error| format!("{}: {error}", file.display()))
}

fn plan<'a>(cell: &'a Cell, results: &Path, case: &Value) -> Result<Plan<'a>, String> {
    let number = case.get("case").and_then(Value::as_u64).ok_or("a case without a number")? as usize;
    let name = CASES.get(number.wrapping_sub(1)).ok_or("a case without a file")?;
    let exact = |key: &str| {
        case.pointer(&format!("/placement_exact/{key}"))
            .and_then(Value::as_f64)
            .ok_or_else(|| format!("no placement_exact.{key}"))
    };
    let place = Vector3::new(exact("x_mm")?, exact("y_mm")?, exact("z_mm")?) * 1e-3;
    let orientation = case.get("orientation").and_then(Value::as_str);
    let placement = cell.placement(place, exact("yaw_deg")?.to_radians(), orientation)?;
    let rows = plan::read(&results.join(name), cell)?;
    let leans: Vec<[f64; 2]> = rows.iter().filter_map(|row| row.lean).collect();
    let points = match leans.len() {
        0 => cell.points.clone(),
        count if count == cell.points.len() => lean::leaned(&cell.points, &cell.run, &leans)
            .ok_or("a tool leans in a run that does not say how, or with forces of the stock")?,
        _ => return Err(format!("{name}: some rows have a lean and others none")),
    };
    Ok(Plan { cell, placement, points, leans, rows, name: (*name).to_owned() })
}

/// Holds the folder of a placement against the files of its run.
///
/// # Errors
/// A sentence where a file cannot be read, or is not as described.
pub fn judge(run: &Path, results: &Path) -> Result<Verdict, String> {
    let cell = Cell::read(run)?;
    let summary = summary(results)?;
    let cases = summary.get("cases").and_then(Value::as_array).ok_or("no cases in the summary")?;
    let mut verdict = Verdict::default();
    let search = cell.run.get("search");
    let is_alone = search.and_then(|search| search.get("worst")).and_then(toml::Value::as_bool) == Some(false);
    let wanted = if is_alone { 2 } else { CASES.len() };
    verdict.holds("number of cases", || format!("{} cases and not {wanted}", cases.len()), cases.len() == wanted);
    let mut objectives = Vec::new();
    for case in cases {
        let plan = plan(&cell, results, case)?;
        plan.judge(&mut verdict, case);
        moves::judge(&mut verdict, &plan, case)?;
        objectives.push(case.get("objective_mm").and_then(Value::as_f64).unwrap_or(f64::NAN));
    }
    for (better, worse) in [(0, 1), (2, 3), (0, 2)] {
        if let (Some(a), Some(b)) = (objectives.get(better), objectives.get(worse)) {
            verdict.holds(
                "order of the cases",
                || format!("case {} {a}, case {} {b}", better + 1, worse + 1),
                *a <= *b * (1.0 + 1e-9),
            );
        }
    }
    Ok(verdict)
}

/// Holds an exported program, by its main file, against the best plan of a folder of results.
///
/// # Errors
/// A sentence where a file cannot be read, or is not as described.
pub fn judge_program(run: &Path, results: &Path, main: &Path) -> Result<Verdict, String> {
    let cell = Cell::read(run)?;
    let summary = summary(results)?;
    let case = summary.pointer("/cases/0").ok_or("no cases in the summary")?;
    let mut verdict = Verdict::default();
    program::judge(&mut verdict, &plan(&cell, results, case)?, main)?;
    Ok(verdict)
}
