//! The path of `stead compensate` in place of that of the plan: `corrected-path.csv`.

use super::CorrectedPath;
use super::motion::Target;
use nalgebra::Vector3;
use std::path::Path;
use stead_disk::input::csv_table::{CsvTable, Row, try_each};
use stead_disk::input::{InputError, InputFile, input_file};
use stead_disk::manifest::{self, Unlisted};
use stead_model::robot::Pose;
use stead_model::robot::angles::wrap;
use stead_numerics::rotation::rotation_from_vector;
use stead_problem::problem::Problem;
use stead_runs::plan;

/// A target of the corrected path may miss that of the plan by this much, which is printed with a tenth of it. m
const TARGET_TOLERANCE: f64 = 1e-6;
/// A joint angle of the corrected path may miss the one of its pose by this much. rad
const JOINT_TOLERANCE: f64 = 1e-6;
/// What the status of a corrected point is.
const CORRECTED: &str = "corrected";

/// Where the columns are.
struct Columns {
    point: usize,
    segment: usize,
    target: [usize; 3],
    corrected: [usize; 3],
    rotation: [usize; 3],
    joints: [usize; 6],
    status: usize,
}

pub(super) const JOINTS: [&str; 6] =
    ["theta1_deg", "theta2_deg", "theta3_deg", "theta4_deg", "theta5_deg", "theta6_deg"];

/// The commands of a corrected path of a plan, how many of them are not corrected, and the file.
///
/// # Errors
/// [`InputError`] with line and column for a path that is not of this plan, and for points that are not corrected
/// unless they may be commanded as planned.
pub(super) fn corrected_targets(
    problem: &Problem,
    planned: &[Target],
    path: CorrectedPath<'_>,
) -> Result<(Vec<Target>, usize, InputFile), InputError> {
    let file = path.file;
    let bytes = plan::read(file, "corrected-path.csv of `stead compensate` for this plan")?;
    manifest::check(file, &bytes, Unlisted::Refused)?;
    let mut table = CsvTable::new(file, &bytes)?;
    let columns = columns(&table)?;
    let (mut targets, mut uncorrected, mut last_line) = (Vec::with_capacity(planned.len()), 0, 1);
    while let Some(row) = table.next_row()? {
        let index = targets.len();
        let Some(target) = planned.get(index) else {
            let allowed = format!("points 0 to {}, those of the plan", planned.len() - 1);
            return Err(row.fail(columns.point, "the corrected path has more points than the plan", &allowed));
        };
        check_place(&row, &columns, index, problem.task.path().segment_of(index) + 1, target)?;
        let status = row.text(columns.status);
        if status == CORRECTED {
            targets.push(command(&row, &columns, problem, target)?);
        } else if path.is_uncorrected_as_planned {
            uncorrected += 1;
            targets.push(*target);
        } else {
            let allowed = "a path all of whose points are corrected, or --uncorrected-as-planned, which commands such points as planned";
            return Err(row.fail(columns.status, "this point could not be corrected", allowed));
        }
        last_line = row.line();
    }
    if targets.len() < planned.len() {
        return Err(InputError::new(file, format!("ends before the plan, which has {} points", planned.len()))
            .at_line(last_line)
            .in_field("point")
            .found(format!("{} points", targets.len()))
            .allowed("the corrected path of this plan"));
    }
    let name = file.to_string_lossy().replace('\\', "/");
    Ok((targets, uncorrected, input_file("corrected", name, &bytes)))
}

fn columns(table: &CsvTable<'_>) -> Result<Columns, InputError> {
    let column = |name: &str| {
        let allowed = "the header that `stead compensate` writes to corrected-path.csv";
        match table.column(name) {
            None => Err(table.fail(name, "missing column", allowed)),
            Some(_) if table.is_doubled(name) => Err(table.fail(name, "this column is there twice", allowed)),
            Some(column) => Ok(column),
        }
    };
    Ok(Columns {
        point: column("point")?,
        segment: column("segment")?,
        target: try_each(["target_x_mm", "target_y_mm", "target_z_mm"], column)?,
        corrected: try_each(["corrected_x_mm", "corrected_y_mm", "corrected_z_mm"], column)?,
        rotation: try_each(["rotation_x_deg", "rotation_y_deg", "rotation_z_deg"], column)?,
        joints: try_each(JOINTS, column)?,
        status: column("status")?,
    })
}

/// Whether a row is of the point of the plan.
fn check_place(
    row: &Row<'_>,
    columns: &Columns,
    point: usize,
    segment: usize,
    planned: &Target,
) -> Result<(), InputError> {
    for (column, expected) in [(columns.point, point), (columns.segment, segment)] {
        if row.text(column).parse() != Ok(expected) {
            return Err(row.fail(column, "is not that of the plan here", &format!("{expected}, as in the plan")));
        }
    }
    let target: Vector3<f64> = row.vector(columns.target)? / 1e3;
    let off = (target - planned.base_from_tool.translation).norm();
    if off > TARGET_TOLERANCE {
        let problem =
            format!("this target is {:.4} mm away from the plan's, so the path is of another plan", off * 1e3);
        return Err(row.fail(columns.target[0], &problem, "the path that `stead compensate` corrected for this plan"));
    }
    Ok(())
}

/// The command of a corrected row.
fn command(row: &Row<'_>, columns: &Columns, problem: &Problem, planned: &Target) -> Result<Target, InputError> {
    let turned: Vector3<f64> = row.vector(columns.rotation)?.map(f64::to_radians);
    let base_from_tool = Pose {
        rotation: rotation_from_vector(&turned) * planned.base_from_tool.rotation,
        translation: row.vector(columns.corrected)? / 1e3,
    };
    let joints = try_each(columns.joints, |column| row.number(column).map(f64::to_radians))?;
    let base_from_flange = base_from_tool.then(&problem.spindle.flange_from_tool.inverse());
    let allowed = "the path that `stead compensate` corrected for this plan";
    let exact = problem.robot.inverse(&base_from_flange, planned.posture).map_err(|error| {
        row.fail(
            columns.corrected[0],
            &format!("the posture of the plan does not reach this command: {error}"),
            allowed,
        )
    })?;
    let off = |j: &usize| wrap(joints[*j] - exact[*j]).abs() > JOINT_TOLERANCE;
    if let Some(j) = (0..6).find(off) {
        return Err(row.fail(columns.joints[j], "is not the joint angle of the command", allowed));
    }
    Ok(Target { base_from_tool, joints, ..*planned })
}

/// A row of the corrected path as it is printed, for the reader of programs, which makes a pose of its own of it.
pub(super) struct PrintedCommand {
    /// Tool centre point in the base frame. mm
    pub position: [f64; 3],
    /// Joint angles. deg
    pub joints: [f64; 6],
    pub is_corrected: bool,
}

/// All rows of a corrected path.
///
/// # Errors
/// [`InputError`] for a file that cannot be read, or without the columns.
pub(super) fn printed_commands(file: &Path) -> Result<Vec<PrintedCommand>, InputError> {
    let bytes = plan::read(file, "corrected-path.csv of `stead compensate` for this plan")?;
    let mut table = CsvTable::new(file, &bytes)?;
    let columns = columns(&table)?;
    let mut rows = Vec::new();
    while let Some(row) = table.next_row()? {
        rows.push(PrintedCommand {
            position: row.vector(columns.corrected)?.into(),
            joints: try_each(columns.joints, |column| row.number(column))?,
            is_corrected: row.text(columns.status) == CORRECTED,
        });
    }
    Ok(rows)
}
