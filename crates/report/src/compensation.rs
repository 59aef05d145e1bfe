//! Reports of a compensation: `corrected-path.csv`, `summary.json`, `compensation.svg`, `report.html`, and a table for
//! people.

mod page;

use super::output::ReportError;
use super::page::PAGE;
use super::picture;
use super::{Files, named};
use crate::columns::table;
use crate::csv_file::rows_or;
use crate::document::{Document, PlacementFigures, bytes};
use crate::figure::{DeflectionMm, Direction, FinestAngleDeg, Percent, each, some};
use crate::placement::plan_row::JointColumns;
use crate::units::{figures, fixed};
use crate::word::Word;
use nalgebra::Vector3;
use serde_json::Value;
use stead_calibration::compensation::{
    CompensatedPath, CompensatedPoint, Deflection, DeflectionModel, MeanAndMax, NotCompensated, PointError, reduction,
};
use stead_runs::CompensateRun;

/// `corrected-path.csv`, `summary.json`, `compensation.svg` and `report.html`.
///
/// # Errors
/// [`ReportError::Format`]: a file cannot be made.
pub fn compensation_files(run: &CompensateRun, outcome: &CompensatedPath) -> Result<Files, ReportError> {
    Ok(named([
        ("corrected-path.csv", corrected_path(outcome)?),
        ("summary.json", bytes(&compensation_json(run, outcome))),
        ("compensation.svg", picture::charts(&page::before_and_after(outcome)).into_bytes()),
        (PAGE, page::page(run, outcome).html()),
    ]))
}

records! {
    /// A point of a corrected path. Places are those of the tool centre point, and all vectors are in the robot base
    /// frame.
    #[derive(Default)]
    pub struct CorrectedRow of (index: usize, point: &CompensatedPoint) {
        // The tool's z axis points out of the spindle.
        let axis: Vector3<f64> = -point.command.rotation.column(2);
    } with {
        /// Path point, from 0.
        point: usize = index,
        /// Segment, from 1.
        segment: usize = point.segment,
        /// The target.
        target: Millimetres = point.target.translation.into(),
        /// The corrected command.
        corrected: Millimetres = point.command.translation.into(),
        /// x of the tool axis of the command, from the workpiece to the robot.
        axis_x: Direction = axis.x.into(),
        /// y of it.
        axis_y: Direction = axis.y.into(),
        /// z of it.
        axis_z: Direction = axis.z.into(),
        /// x of the rotation vector from the orientation of the target to that of the command.
        rotation_x_deg: FinestAngleDeg = point.correction.angular.x.into(),
        /// y of it.
        rotation_y_deg: FinestAngleDeg = point.correction.angular.y.into(),
        /// z of it.
        rotation_z_deg: FinestAngleDeg = point.correction.angular.z.into(),
        #[serde(flatten)] joints: JointColumns<FinestAngleDeg> = point.joints.into(),
        /// The deflection without correction; empty where the arm gives way.
        before: DeflectionColumns = (&point.before).into(),
        /// The deflection with it.
        after: DeflectionColumns = (&point.after).into(),
        /// Iterations of the correction.
        iterations: usize = point.iterations,
        /// Whether the point is corrected, or why it keeps its target.
        status: String = point.status.to_string(),
    }

    /// A place in a row.
    #[derive(Copy, Default)]
    struct Millimetres from place: Vector3<f64> {
        /// x.
        x_mm: DeflectionMm = place.x.into(),
        /// y.
        y_mm: DeflectionMm = place.y.into(),
        /// z.
        z_mm: DeflectionMm = place.z.into(),
    }

    /// A deflection in a row.
    #[derive(Copy, Default)]
    struct DeflectionColumns from deflection: &Option<Deflection> {
        let Some(deflection) = deflection else { return Self::default() };
        let [x_mm, y_mm, z_mm] = each(deflection.linear.into()).map(Some);
    } with {
        /// x.
        x_mm: Option<DeflectionMm> = x_mm,
        /// y.
        y_mm: Option<DeflectionMm> = y_mm,
        /// z.
        z_mm: Option<DeflectionMm> = z_mm,
        /// The part normal to the feed.
        normal_mm: Option<DeflectionMm> = Some(deflection.normal.into()),
    }
}

/// `corrected-path.csv`: a [`CorrectedRow`] for each path point.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn corrected_path(outcome: &CompensatedPath) -> Result<Vec<u8>, ReportError> {
    let points = outcome.points.iter().enumerate().map(|(index, point)| CorrectedRow::of(index, point));
    rows_or("the table of the corrected path", &CorrectedRow::default(), points)
}

records! {
    /// A compensation.
    pub struct CompensationFigures of (run: &CompensateRun, outcome: &CompensatedPath) {
        let settings = &run.job.settings;
        let Reduction { before, after, reduction_percent } = outcome.deflections().into();
        let not_corrected = outcome.not_corrected().map_or_else(Vec::new, |not| not.failed);
    } with {
        /// Name of the robot.
        robot: String = run.job.robot.name().to_owned(),
        /// Name of the arm that executes the path, where it is another one.
        reality: Option<String> = run.has_reality.then(|| run.job.reality.name().to_owned()),
        /// The model of the deflection.
        model: Word<DeflectionModel> = Word::from(settings.model),
        /// True where the weight of links and spindle is corrected too; left out where it is not.
        gravity?: bool = settings.gravity.then_some(true),
        /// Share of the deflection that each iteration corrects.
        alpha: f64 = settings.alpha,
        /// The iteration ends below this. mm
        tolerance_mm: f64 = settings.tolerance * 1e3,
        /// Most iterations.
        max_iterations: usize = settings.max_iterations,
        /// The placement of the plan.
        placement: PlacementFigures = (&run.placement).into(),
        /// Path points.
        points: usize = outcome.points.len(),
        /// Points corrected.
        corrected: usize = outcome.points.len() - not_corrected.len(),
        /// Points that keep their target.
        not_corrected: Vec<PointReason> = reasons(&not_corrected),
        /// Most iterations of a point.
        iterations: usize = outcome.iterations(),
        /// Size of the deflection without correction.
        before: ErrorFigures = before,
        /// Size of the deflection with it.
        after: ErrorFigures = after,
        /// By how much the mean is less; null where there is no deflection.
        reduction_percent: Option<Percent> = reduction_percent,
        /// The part normal to the feed.
        normal: Reduction = outcome.normal_parts().into(),
        /// The largest correction.
        correction: CorrectionFigures = CorrectionFigures::of(outcome),
    }

    /// A part of the deflection without correction and with it.
    pub struct Reduction from pair: [MeanAndMax; 2] {
        let [before, after] = pair.each_ref().map(Into::into);
    } with {
        /// Without.
        before: ErrorFigures = before,
        /// With.
        after: ErrorFigures = after,
        /// By how much the mean is less.
        reduction_percent: Option<Percent> = some(reduction(pair)),
    }

    /// Mean and largest size of a deflection.
    pub struct ErrorFigures from figures: &MeanAndMax {
        /// Mean.
        mean_mm: DeflectionMm = figures.mean.into(),
        /// Largest.
        max_mm: DeflectionMm = figures.max.into(),
    }

    /// The largest correction of a point.
    pub struct CorrectionFigures of (outcome: &CompensatedPath) {
        /// Of its place.
        max_mm: DeflectionMm = outcome.figures(|point| Some(point.correction.linear.norm())).max.into(),
        /// Of its orientation.
        max_deg: FinestAngleDeg = outcome.figures(|point| Some(point.correction.angular.norm())).max.into(),
    }

    /// A point with why it could not be corrected.
    pub struct PointReason of (point: &usize, reason: &PointError) {
        /// The path point, from 0.
        point: usize = *point,
        /// Why not.
        reason: String = reason.to_string(),
    }

    /// Points that cannot be compensated.
    pub struct NotCompensatedFigures of (failure: &NotCompensated) {
        /// Path points.
        points: usize = failure.of,
        /// Those that cannot.
        failed: Vec<PointReason> = reasons(&failure.failed),
    }
}

/// What `stead compensate --json` prints, and the content of `summary.json`.
pub fn compensation_json(run: &CompensateRun, outcome: &CompensatedPath) -> Value {
    document(run).notes(&outcome.notes).warnings(&outcome.warnings).with(CompensationFigures::of(run, outcome))
}

fn document(run: &CompensateRun) -> Document {
    Document::new(&run.inputs).notes(&run.notes).warnings(&run.warnings)
}

/// What `stead compensate --json` prints where points cannot be compensated.
pub fn not_compensated_json(run: &CompensateRun, failure: &NotCompensated) -> Value {
    document(run).with(NotCompensatedFigures::of(failure))
}

fn reasons(points: &[(usize, PointError)]) -> Vec<PointReason> {
    points.iter().map(|(point, reason)| PointReason::of(point, reason)).collect()
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
    let weight = if run.job.settings.gravity { " with the weight" } else { "" };
    let mut text = format!("{}: {count} points, {which}compensated for {model}{weight}\n", run.job.robot.name());
    let executed = if run.has_reality {
        format!("executed on {} ({})", run.job.reality.name(), run.inputs.last().map_or("", |input| &input.name))
    } else {
        "executed on the same arm".to_owned()
    };
    text.push_str(&format!("{executed}\n\n"));
    let header = ["", "before: mean mm", "max mm", "after: mean mm", "max mm", "reduction %"];
    // Less than the tolerance says where the iteration ended, and nothing of the path.
    let tolerance = run.job.settings.tolerance;
    let remaining = |value: f64| match value {
        value if value < tolerance => format!("< {}", figures(tolerance * 1e3)),
        value => figures(value * 1e3),
    };
    let parts = [("deflection", outcome.deflections()), ("normal to the feed", outcome.normal_parts())];
    let rows = parts.map(|(name, pair)| {
        let mut row = vec![name.to_owned()];
        row.extend(pair.iter().flat_map(|figures| [figures.mean, figures.max]).map(&remaining));
        row.push(reduction(pair).map_or_else(|| "-".to_owned(), |share| fixed(share * 100.0, 1)));
        row
    });
    text.push_str(&table(header, rows, &[0]));
    text.push_str(&format!(
        "\nlargest correction {} mm and {} deg, in at most {} iterations\n",
        fixed(outcome.figures(|point| Some(point.correction.linear.norm())).max * 1e3, 4),
        fixed(outcome.figures(|point| Some(point.correction.angular.norm())).max.to_degrees(), 4),
        outcome.iterations()
    ));
    text.push_str(if run.has_reality {
        "what remains is what the model does not know of this arm\n"
    } else {
        "what remains is that of the iteration: on a real arm it is what the stiffness of the file does not know of it \
         (--reality plays the path on another arm)\n"
    });
    text
}
