//! A placement out of the results of `stead place`: the exact one of a case, from `summary.json`.

use crate::Run;
use crate::stated::{Change, changes};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use stead_disk::files;
use stead_disk::input::{InputError, InputFile};
use stead_disk::manifest::{self, Unlisted, interruption_note};
use stead_model::external_axis::{AxisKind, ExternalAxis};
use stead_model::robot::angles::wrap;
use stead_model::task::lean::Lean;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup};

/// The file with the cases.
const SUMMARY: &str = "summary.json";
/// What is requested, where something else is found.
const ALLOWED: &str = "a folder that `stead place` has written from the same run file, robot and task";

/// Reads the exact placement of a case (1 the best, 3 the worst) from a results folder of `stead place`, for a run.
///
/// # Errors
/// [`InputError`] for a folder that is no result of `stead place`, one that its manifest does not vouch for, one of
/// other input files, or one without that case. A run file that has changed since in keys on which a score does not
/// depend is no other file.
pub fn read_placement_of(folder: &Path, case: u8, run: &Run) -> Result<Placement, InputError> {
    read_case(folder, case, &run.inputs, &run.stated).map(|(placement, ..)| placement)
}

/// As [`read_placement_of`], with how part and external axes of the run's problem are set up for the case, and notes
/// where the search was interrupted or the run file has changed.
///
/// # Errors
/// As [`read_placement_of`], and for a setup that is none of the problem.
pub fn read_setup_of(folder: &Path, case: u8, run: &Run) -> Result<(Placement, Setup, Vec<String>), InputError> {
    let (placement, entry, changed) = read_case(folder, case, &run.inputs, &run.stated)?;
    let problem = &run.problem;
    let error = |field: &str| {
        let problem = "is none of the run's".to_owned();
        InputError::new(&folder.join(SUMMARY), problem).in_field(format!("cases.{field}")).allowed(ALLOWED)
    };
    let setup = setup_in(problem, &entry).map_err(error)?;
    let notes = interruption_note(&folder.join(SUMMARY)).into_iter().chain(changed);
    Ok((placement, setup, notes.collect()))
}

/// How part and external axes of a problem are set up as the entry of a result states it.
///
/// # Errors
/// The key of what is none of the problem's.
pub fn setup_in(problem: &Problem, entry: &Value) -> Result<Setup, &'static str> {
    let mut setup = problem.setup.clone();
    if !problem.orientations.is_empty() {
        let found = problem.orientations.iter().position(|known| entry["orientation"] == known.name.as_str());
        setup.orientation = found.ok_or("orientation")?;
    }
    if problem.lean.is_some() && !entry["leans_deg"].is_null() {
        let lean = |row: &Value| match row.as_array()?.as_slice() {
            [lead, tilt] => Some(Lean { lead: lead.as_f64()?.to_radians(), tilt: tilt.as_f64()?.to_radians() }),
            _ => None,
        };
        let rows = entry["leans_deg"].as_array().and_then(|rows| rows.iter().map(lean).collect::<Option<Vec<Lean>>>());
        setup.leans = rows.filter(|rows| rows.len() == problem.task.points().len()).ok_or("leans_deg")?.into();
    }
    if problem.external_axes.is_empty() {
        return Ok(setup);
    }
    let axes = &entry["external_axes"];
    let si = |(value, axis): (&Value, &ExternalAxis)| match axis.kind {
        AxisKind::Rail => value.as_f64().map(|mm| mm / 1e3),
        AxisKind::Turntable => value.as_f64().map(f64::to_radians),
    };
    let row = |row: &Value| -> Option<Vec<f64>> {
        let row = row.as_array().filter(|row| row.len() == problem.external_axes.len())?;
        row.iter().zip(&problem.external_axes).map(si).collect()
    };
    let rows = axes["positions"].as_array().and_then(|rows| rows.iter().map(row).collect::<Option<Vec<_>>>());
    let task = &problem.task;
    let positions = rows.and_then(|rows| match (axes["for_each"].as_str()?, rows.len()) {
        ("path", 1) => rows.into_iter().next().map(AxisPositions::Same),
        ("segment", count) => (count == task.segments().len()).then_some(AxisPositions::PerSegment(rows)),
        ("point", count) => (count == task.points().len()).then_some(AxisPositions::PerPoint(rows)),
        _ => None,
    });
    setup.positions = positions.ok_or("external_axes")?;
    Ok(setup)
}

/// The exact placement of a case, its entry, and a note where the run file has changed since.
fn read_case(
    folder: &Path,
    case: u8,
    inputs: &[InputFile],
    stated: &Value,
) -> Result<(Placement, Value, Option<String>), InputError> {
    let file = folder.join(SUMMARY);
    let error = |problem: String| InputError::new(&file, problem).allowed(ALLOWED);
    let bytes = files::read(&file).map_err(|cause| error(format!("cannot be read: {cause}")))?;
    manifest::check(&file, &bytes, Unlisted::Refused)?;
    let summary: Value = serde_json::from_slice(&bytes).map_err(|cause| {
        let line = cause.line().max(1);
        error(format!("is no JSON document: {cause}")).at_line(line)
    })?;
    let Some(cases) = summary["cases"].as_array() else {
        return Err(error("is missing".to_owned()).in_field("cases"));
    };
    let changed = check_inputs(&summary, inputs, stated, &error)?;
    let found = cases.iter().position(|entry| entry["case"].as_u64() == Some(u64::from(case)));
    let Some(index) = found else {
        return Err(error(format!("there is no case {case}")).in_field("cases"));
    };
    let exact = &cases[index]["placement_exact"];
    let number = |key: &str| {
        exact[key].as_f64().filter(|value| value.is_finite()).ok_or_else(|| {
            error("is missing or no number".to_owned()).in_field(format!("cases[{index}].placement_exact.{key}"))
        })
    };
    let [x, y, z] = [number("x_mm")?, number("y_mm")?, number("z_mm")?].map(|mm| mm / 1e3);
    Ok((Placement { x, y, z, yaw: wrap(number("yaw_deg")?.to_radians()) }, cases[index].clone(), changed))
}

/// Refuses results that were computed from other files, or from a run file with another value of a key on which a score
/// depends; a note where the run file has changed in nothing of that kind.
fn check_inputs(
    summary: &Value,
    inputs: &[InputFile],
    stated: &Value,
    error: &impl Fn(String) -> InputError,
) -> Result<Option<String>, InputError> {
    let digests = summary["inputs"].as_array().map_or(&[][..], Vec::as_slice);
    let roles: BTreeSet<&str> = digests
        .iter()
        .filter_map(|entry| entry["role"].as_str())
        .chain(inputs.iter().map(|input| input.role))
        .collect();
    let mut note = None;
    for role in roles {
        // Files of one role are distinguished by their order.
        let before: Vec<&str> =
            digests.iter().filter(|entry| entry["role"] == role).filter_map(|entry| entry["sha256"].as_str()).collect();
        let now: Vec<&InputFile> = inputs.iter().filter(|input| input.role == role).collect();
        let differs = |number: &usize| before.get(*number).copied() != now.get(*number).map(|input| &*input.sha256);
        let Some(number) = (0..before.len().max(now.len())).find(differs) else { continue };
        let (found, input) = (before.get(number), now.get(number));
        let name = input.map_or("none", |input| &input.name);
        if role == "config" && summary["run_file"].is_object() {
            note = Some(check_run_file(&summary["run_file"], stated, name, error)?);
            continue;
        }
        let what = if role == "config" { "run" } else { role };
        return Err(error(format!("comes from another {what} file than {name}"))
            .in_field("inputs")
            .found(found.map_or_else(|| "none".to_owned(), |digest| format!("sha256 {digest}"))));
    }
    Ok(note)
}

/// As [`check_inputs`], of two run files by their keys.
fn check_run_file(
    before: &Value,
    now: &Value,
    name: &str,
    error: &impl Fn(String) -> InputError,
) -> Result<String, InputError> {
    let changes = changes(before, now);
    let written = |value: &Option<Value>| value.as_ref().map_or_else(|| "none".to_owned(), Value::to_string);
    if let Some(change) = changes.iter().find(|change| change.matters()) {
        let problem = format!("comes from a run file with another {}: {name} has {}", change.key, written(&change.now));
        return Err(error(problem).in_field(format!("run_file.{}", change.key)).found(written(&change.before)));
    }
    let keys: Vec<&str> = changes.iter().map(|change: &Change| &*change.key).collect();
    let what = if keys.is_empty() { "its comments and layout".to_owned() } else { keys.join(", ") };
    Ok(format!("{name} is not as it was for these results: {what} changed, which no score of a placement depends on"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn inputs() -> [InputFile; 2] {
        [("config", "run.toml", "a"), ("robot", "arm.toml", "b")].map(|(role, name, digit)| InputFile {
            role,
            name: name.to_owned(),
            sha256: digit.repeat(64),
        })
    }

    fn document() -> Value {
        let exact = json!({ "x_mm": 0.1, "y_mm": -1643.512345678901, "z_mm": -3.0, "yaw_deg": 90.0 });
        json!({
            "inputs": [
                { "role": "config", "name": "run.toml", "sha256": "a".repeat(64) },
                { "role": "robot", "name": "arm.toml", "sha256": "b".repeat(64) },
            ],
            "cases": [{ "case": 1, "placement_exact": exact }],
        })
    }

    fn read(text: &str, case: u8) -> Result<Placement, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(SUMMARY), text).unwrap();
        read_case(folder.path(), case, &inputs(), &json!({}))
            .map(|(placement, ..)| placement)
            .map_err(|e| e.to_string())
    }

    #[test]
    fn a_placement_is_read_with_every_digit() {
        let placement = read(&document().to_string(), 1).unwrap();
        assert_eq!(placement.y, -1643.512345678901 / 1e3);
        assert_eq!(placement.yaw, std::f64::consts::FRAC_PI_2);
    }

    #[test]
    fn what_is_no_result_of_this_problem_is_refused() {
        let assert_refused = |text: &str, case: u8, parts: &[&str]| {
            let message = read(text, case).unwrap_err();
            for part in parts.iter().chain(&["summary.json", "; allowed: a folder that"]) {
                assert!(message.contains(part), "{part} in {message}");
            }
        };
        assert_refused("{", 1, &["summary.json:1: ", "no JSON document"]);
        assert_refused("{}", 1, &["cases: is missing"]);
        assert_refused(&document().to_string(), 3, &["cases: there is no case 3"]);
        let other = document().to_string().replace(&"b".repeat(64), &"c".repeat(64));
        assert_refused(&other, 1, &["inputs: comes from another robot file than arm.toml, found sha256 ccc"]);
        let old = document().to_string().replace("placement_exact", "placement");
        assert_refused(&old, 1, &["cases[0].placement_exact.x_mm: is missing"]);
        let nothing = read_case(Path::new("nowhere"), 1, &inputs(), &json!({})).unwrap_err().to_string();
        assert!(nothing.contains("cannot be read"), "{nothing}");
    }
}
