//! A placement out of the results of `stead place`: the exact one of a case, from `summary.json`.

use crate::files;
use crate::input::{InputError, InputFile};
use crate::manifest::{self, Unlisted, interruption_note};
use serde_json::Value;
use std::path::Path;
use stead_model::external_axis::{AxisKind, ExternalAxis};
use stead_model::robot::angles::wrap;
use stead_placement::problem::{Placement, Problem};
use stead_placement::setup::{AxisPositions, Setup};

/// The file with the cases.
const SUMMARY: &str = "summary.json";
/// What is asked for, where something else is found.
const ALLOWED: &str = "a folder that `stead place` has written from the same run file, robot and task";

/// Reads the exact placement of a case (1 the best, 3 the worst) from a results folder of `stead place`; `inputs` are the files of the
/// run that it is for.
///
/// # Errors
/// [`InputError`] for a folder that is no result of `stead place`, one that its manifest does not vouch for, one of other input files,
/// or one without that case.
pub fn read_placement_of(folder: &Path, case: u8, inputs: &[InputFile]) -> Result<Placement, InputError> {
    read_case(folder, case, inputs).map(|(placement, _)| placement)
}

/// As [`read_placement_of`], with how part and external axes of the run's problem are set up for the case, and a note where the search was
/// interrupted.
///
/// # Errors
/// As [`read_placement_of`], and for a setup that is none of the problem.
pub fn read_setup_of(
    folder: &Path,
    case: u8,
    inputs: &[InputFile],
    problem: &Problem,
) -> Result<(Placement, Setup, Option<String>), InputError> {
    let (placement, entry) = read_case(folder, case, inputs)?;
    let error = |field: &str| {
        let problem = "is none of the run's".to_owned();
        InputError::new(&folder.join(SUMMARY), problem).in_field(format!("cases.{field}")).allowed(ALLOWED)
    };
    let mut setup = problem.setup.clone();
    if !problem.orientations.is_empty() {
        let found = problem.orientations.iter().position(|known| entry["orientation"] == known.name.as_str());
        setup.orientation = found.ok_or_else(|| error("orientation"))?;
    }
    if !problem.external_axes.is_empty() {
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
        setup.positions = positions.ok_or_else(|| error("external_axes"))?;
    }
    let note = interruption_note(&folder.join(SUMMARY));
    Ok((placement, setup, note))
}

/// The exact placement of a case, and its entry.
fn read_case(folder: &Path, case: u8, inputs: &[InputFile]) -> Result<(Placement, Value), InputError> {
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
    check_inputs(&summary, inputs, &error)?;
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
    Ok((Placement { x, y, z, yaw: wrap(number("yaw_deg")?.to_radians()) }, cases[index].clone()))
}

/// Refuses results that were computed from other files.
fn check_inputs(
    summary: &Value,
    inputs: &[InputFile],
    error: &impl Fn(String) -> InputError,
) -> Result<(), InputError> {
    let stated = summary["inputs"].as_array().map_or(&[][..], Vec::as_slice);
    for input in inputs {
        let found = stated.iter().find(|entry| entry["role"] == input.role).and_then(|entry| entry["sha256"].as_str());
        if found != Some(input.sha256.as_str()) {
            let role = if input.role == "config" { "run" } else { input.role };
            return Err(error(format!("comes from another {role} file than {}", input.name))
                .in_field("inputs")
                .found(found.map_or_else(|| "none".to_owned(), |digest| format!("sha256 {digest}"))));
        }
    }
    Ok(())
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
        read_placement_of(folder.path(), case, &inputs()).map_err(|error| error.to_string())
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
        let nothing = read_placement_of(Path::new("nowhere"), 1, &inputs()).unwrap_err().to_string();
        assert!(nothing.contains("cannot be read"), "{nothing}");
    }
}
