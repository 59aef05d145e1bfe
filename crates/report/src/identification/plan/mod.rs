//! Reports of `stead identify plan`: the sheet to be filled in, what it will tell, the picture, the table for people.

mod json;
mod tables;
mod text;

pub use json::plan_json;
pub use text::plan_text;

use super::super::document as documents;
use super::super::output::{Folder, ReportError};
use super::super::picture;
use crate::names::compliance_name;
use crate::units::{figures, fixed};
use std::path::PathBuf;
use stead_calibration::identification::design::unobservable::{Unobservable, UnobservableReason};
use stead_calibration::identification::design::{Design, Loads};
use stead_calibration::identification::sheet::COLUMNS;
use stead_format::PlanRun;

/// The name of the sheet among the files of a plan.
pub const SHEET: &str = "sheet.csv";

/// Writes `sheet.csv`, `plan.json`, `expected.csv` and `plan.svg` into a folder and returns their paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_plan(folder: &Folder, run: &PlanRun, plan: &Design) -> Result<Vec<PathBuf>, ReportError> {
    let files = [
        (SHEET, plan.sheet.form().into_bytes()),
        ("plan.json", documents::bytes(&plan_json(run, plan))),
        ("expected.csv", tables::expected(plan)?),
        ("plan.svg", picture::measurement_plan(&run.request, plan).into_bytes()),
    ];
    files.iter().map(|(name, bytes)| folder.write(name, bytes)).collect()
}

/// Whether a file is a sheet into which nothing has been filled in yet, so that nothing is lost with it.
pub fn is_form(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let mut lines = text.lines();
    // The places that are read are the last six columns.
    let is_open = |line: &str| line.trim().is_empty() || line.rsplit(',').take(6).all(|field| field.trim().is_empty());
    lines.next() == Some(COLUMNS) && lines.all(is_open)
}

/// What the plan does not show or hardly shows, in sentences without a full stop.
pub fn warnings(run: &PlanRun, plan: &Design) -> Vec<String> {
    let mut warnings: Vec<String> =
        plan.unobservable.iter().map(|unobservable| unidentifiable(run, unobservable)).collect();
    for hardly in &plan.weakly_observed {
        let axis = hardly.joint + 1;
        warnings.push(format!(
            "{} is hardly seen: its expected standard deviation is {} % of it; the load's lever about axis {axis} is {} mm \
             (rms): a longer one or a larger load would help",
            compliance_name(hardly.joint, hardly.angle),
            figures(hardly.share * 100.0),
            fixed(hardly.lever * 1e3, 1)
        ));
    }
    warnings
}

/// Where the plan has no configuration, though it may, in a sentence.
fn left_out(plan: &Design) -> Option<String> {
    let unused: Vec<String> = plan
        .bars
        .iter()
        .filter(|bar| bar.deviation.is_none())
        .map(|bar| compliance_name(bar.joint, bar.angle))
        .collect();
    (!unused.is_empty()).then(|| {
        let names = unused.join(", ");
        format!(
            "the plan has no configuration for {names}: what the other angles tell about the joint is worth more here"
        )
    })
}

fn unidentifiable(run: &PlanRun, unobservable: &Unobservable) -> String {
    let names: Vec<String> =
        unobservable.compliances.iter().map(|(joint, angle)| compliance_name(*joint, *angle)).collect();
    let first = names.first().map_or("", String::as_str);
    let axis = unobservable.compliances.first().map_or(0, |(joint, _)| joint + 1);
    let told = match unobservable.reason {
        UnobservableReason::LoadsAlongAxis if run.request.loads == Loads::Vertical => {
            format!("{first} is not seen: every load is vertical, along axis {axis}")
        }
        UnobservableReason::LoadsAlongAxis => format!("{first} is not seen: every load is along axis {axis}"),
        UnobservableReason::LoadOnAxis => format!("{first} is not seen: the load acts on axis {axis}"),
        UnobservableReason::NoTorque => format!("{first} is not seen: no load turns joint {axis}"),
        UnobservableReason::PointsOnAxis => format!("{first} is not seen: every reference point is on axis {axis}"),
        UnobservableReason::NotApart => format!("{} cannot be told apart, and {first} is given up", names.join(", ")),
    };
    format!("{told}; the plan is for the others, and a fit needs fit.reduce = true to keep the value of the robot file")
}
