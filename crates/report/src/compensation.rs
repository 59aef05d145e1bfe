//! Reports of a compensation: `corrected-path.csv`, `summary.json`, `compensation.svg`, `report.html`, and a table for people.

mod page;

use super::output::{Folder, ReportError};
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use crate::columns::aligned;
use crate::csv_file::{table, vector};
use crate::document::{Document, bytes, placement};
use crate::units::{Unit, fixed};
use nalgebra::Vector3;
use serde_json::{Value, json};
use std::path::PathBuf;
use stead_calibration::compensation::{
    CompensatedPath, CompensatedPoint, DeflectionModel, MeanAndMax, NotCompensated, PointError, reduction,
};
use stead_format::CompensateRun;
use stead_format::scalars::Word;

/// Places and deflections, from m to mm, to a tenth of the finest tolerance that is of use.
const PLACE_MM: Unit = Unit { factor: 1e3, decimals: 7 };
/// Joint angles and rotations, from rad to deg: so fine that 3 m away they move nothing by 1e-7 mm.
const ANGLE_DEG: Unit = Unit { factor: 180.0 / std::f64::consts::PI, decimals: 9 };
/// Components of a direction.
const DIRECTION: Unit = Unit { factor: 1.0, decimals: 9 };
/// Shares in per cent.
const PER_CENT: Unit = Unit { factor: 100.0, decimals: 6 };

/// Writes `corrected-path.csv`, `summary.json`, `compensation.svg` and `report.html`. Returns their paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_compensation(
    folder: &Folder,
    run: &CompensateRun,
    outcome: &CompensatedPath,
) -> Result<Vec<PathBuf>, ReportError> {
    let files = compensation_files(run, outcome)?;
    folder.results("compensate", &run.inputs).write(&files)
}

/// The files that [`write_compensation`] writes.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn compensation_files(run: &CompensateRun, outcome: &CompensatedPath) -> Result<Files, ReportError> {
    Ok(named([
        ("corrected-path.csv", corrected_path(outcome)?),
        ("summary.json", bytes(&compensation_json(run, outcome))),
        ("compensation.svg", picture::compensation(outcome).into_bytes()),
        (PAGE, page::page(run, outcome).html()),
    ]))
}

const CORRECTED_PATH: &str = "\
    point,segment,target_x_mm,target_y_mm,target_z_mm,corrected_x_mm,corrected_y_mm,corrected_z_mm,axis_x,axis_y,\
     axis_z,rotation_x_deg,rotation_y_deg,rotation_z_deg,theta1_deg,theta2_deg,theta3_deg,theta4_deg,theta5_deg,\
     theta6_deg,before_x_mm,before_y_mm,before_z_mm,before_normal_mm,after_x_mm,after_y_mm,after_z_mm,\
     after_normal_mm,iterations,status";

/// `corrected-path.csv`: one row for each path point. Places are those of the tool centre point, and all vectors are in the
/// robot base frame: the target, the corrected command with its tool axis (from the workpiece to the robot) and the rotation
/// vector from the target's orientation to the command's, the corrected joint angles, and the deflection before and after
/// with its part normal to the feed, empty where the arm gives way; and whether the point is corrected, or why it keeps its target.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn corrected_path(outcome: &CompensatedPath) -> Result<Vec<u8>, ReportError> {
    table("the table of the corrected path", CORRECTED_PATH.split(','), outcome.points.iter().enumerate().map(row))
}

fn row((index, point): (usize, &CompensatedPoint)) -> Vec<String> {
    // The tool's z axis points out of the spindle.
    let axis: Vector3<f64> = -point.command.rotation.column(2);
    let mut row = vec![index.to_string(), point.segment.to_string()];
    row.extend(vector(PLACE_MM, &point.target.translation));
    row.extend(vector(PLACE_MM, &point.command.translation));
    row.extend(vector(DIRECTION, &axis));
    row.extend(vector(ANGLE_DEG, &point.correction.angular));
    row.extend(point.joints.map(|angle| ANGLE_DEG.text(angle)));
    for deflection in [&point.before, &point.after] {
        match deflection {
            Some(deflection) => {
                row.extend(vector(PLACE_MM, &deflection.linear));
                row.push(PLACE_MM.text(deflection.normal));
            }
            None => row.extend(std::iter::repeat_n(String::new(), 4)),
        }
    }
    row.extend([point.iterations.to_string(), point.status.to_string()]);
    row
}

/// What `stead compensate --json` prints, and the content of `summary.json`.
pub fn compensation_json(run: &CompensateRun, outcome: &CompensatedPath) -> Value {
    let settings = &run.job.settings;
    let (deflections, normal) = (outcome.deflections(), outcome.normal_parts());
    let not_corrected = outcome.not_corrected().map_or_else(Vec::new, |not| not.failed);
    document(run).notes(&outcome.notes).warnings(&outcome.warnings).with(json!({
        "robot": run.job.robot.name(),
        "reality": run.has_reality.then(|| run.job.reality.name()),
        "model": Word(settings.model),
        "alpha": settings.alpha,
        "tolerance_mm": settings.tolerance * 1e3,
        "max_iterations": settings.max_iterations,
        "placement": placement(&run.placement),
        "points": outcome.points.len(),
        "corrected": outcome.points.len() - not_corrected.len(),
        "not_corrected": reasons(&not_corrected),
        "iterations": outcome.iterations(),
        "before": figures(&deflections[0]),
        "after": figures(&deflections[1]),
        "reduction_percent": percent(deflections),
        "normal": {
            "before": figures(&normal[0]),
            "after": figures(&normal[1]),
            "reduction_percent": percent(normal),
        },
        "correction": {
            "max_mm": PLACE_MM.number(outcome.figures(|point| Some(point.correction.linear.norm())).max),
            "max_deg": ANGLE_DEG.number(outcome.figures(|point| Some(point.correction.angular.norm())).max),
        },
    }))
}

fn document(run: &CompensateRun) -> Document {
    Document::new(&run.inputs).notes(&run.notes)
}

/// What `stead compensate --json` prints where points cannot be compensated.
pub fn not_compensated_json(run: &CompensateRun, failure: &NotCompensated) -> Value {
    document(run).with(json!({ "points": failure.of, "failed": reasons(&failure.failed) }))
}

fn reasons(points: &[(usize, PointError)]) -> Value {
    points.iter().map(|(point, reason)| json!({ "point": point, "reason": reason.to_string() })).collect()
}

fn figures(figures: &MeanAndMax) -> Value {
    json!({ "mean_mm": PLACE_MM.number(figures.mean), "max_mm": PLACE_MM.number(figures.max) })
}

fn percent(pair: [MeanAndMax; 2]) -> Value {
    reduction(pair).map_or(Value::Null, |share| json!(PER_CENT.number(share)))
}

/// The table for people.
pub fn compensation_text(run: &CompensateRun, outcome: &CompensatedPath) -> String {
    let model = match run.job.settings.model {
        DeflectionModel::Equilibrium => "the static equilibrium",
        DeflectionModel::Linear => "the linear displacement",
    };
    let count = outcome.points.len();
    let kept = outcome.not_corrected().map_or(0, |not| not.failed.len());
    let which = if kept > 0 { format!("{} of them ", count - kept) } else { String::new() };
    let mut text = format!("{}: {count} points, {which}compensated for {model}\n", run.job.robot.name());
    let executed = if run.has_reality {
        format!("executed on {} ({})", run.job.reality.name(), run.inputs.last().map_or("", |input| &input.name))
    } else {
        "executed on the same arm".to_owned()
    };
    text.push_str(&format!("{executed}\n\n"));
    let header = ["", "before: mean mm", "max mm", "after: mean mm", "max mm", "reduction %"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for (name, pair) in [("deflection", outcome.deflections()), ("normal to the feed", outcome.normal_parts())] {
        let mut row = vec![name.to_owned()];
        row.extend(pair.iter().flat_map(|figures| [figures.mean, figures.max]).map(|value| fixed(value * 1e3, 7)));
        row.push(reduction(pair).map_or_else(|| "-".to_owned(), |share| fixed(share * 100.0, 3)));
        rows.push(row);
    }
    text.push_str(&aligned(&rows, &[0]));
    text.push_str(&format!(
        "\nlargest correction {} mm and {} deg, in at most {} iterations\n",
        fixed(outcome.figures(|point| Some(point.correction.linear.norm())).max * 1e3, 4),
        fixed(outcome.figures(|point| Some(point.correction.angular.norm())).max.to_degrees(), 4),
        outcome.iterations()
    ));
    text
}
