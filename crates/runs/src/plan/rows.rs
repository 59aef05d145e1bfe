//! The rows of a plan file, as `stead place` writes them: one for each path point.

use nalgebra::Vector3;
use std::path::Path;
use stead_disk::input::InputError;
use stead_disk::input::csv_table::{CsvTable, Row, try_each};
use stead_disk::quote::shorten;
use stead_model::external_axis::{AxisKind, ExternalAxis};
use stead_model::robot::Posture;
use stead_model::task::lean::Lean;
use stead_problem::problem::Problem;

/// One row of a plan, in SI units and radians.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanRow {
    /// Line in the file, from 1.
    pub line: usize,
    /// Tool centre point in the base frame. m
    pub position: Vector3<f64>,
    /// Free angle about the tool axis. rad
    pub beta: f64,
    /// Posture.
    pub posture: Posture,
    /// Joint angles, turns included. rad
    pub joints: [f64; 6],
    /// Force in the base frame. N
    pub force: Vector3<f64>,
    /// Deflection in the base frame, where the file has it. m
    pub deflection: Option<Vector3<f64>>,
    /// Positions of the external axes of the run. m or rad
    pub axes: Vec<f64>,
    /// How the tool leans, where the file says so.
    pub lean: Option<Lean>,
}

/// Where the columns are that a row is read from.
struct Columns {
    point: usize,
    segment: usize,
    position: [usize; 3],
    beta: usize,
    posture: usize,
    joints: [usize; 6],
    force: [usize; 3],
    deflection: Option<[usize; 3]>,
    axes: Vec<(usize, AxisKind)>,
    lean: Option<[usize; 2]>,
}

pub(super) const POSITION: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
pub(super) const JOINTS: [&str; 6] =
    ["theta1_deg", "theta2_deg", "theta3_deg", "theta4_deg", "theta5_deg", "theta6_deg"];
pub(super) const FORCE: [&str; 3] = ["force_x_n", "force_y_n", "force_z_n"];
const LEAN: [&str; 2] = ["lead_deg", "tilt_deg"];
const DEFLECTION: [&str; 3] = ["deflection_x_mm", "deflection_y_mm", "deflection_z_mm"];

/// Reads the rows of a plan for the tool path of a problem; columns that are not needed are passed over.
///
/// # Errors
/// [`InputError`] naming line and column: a missing or doubled column, a value of the wrong kind, points that are not
/// those of the path in their order.
pub fn rows_from(file: &Path, bytes: &[u8], problem: &Problem) -> Result<Vec<PlanRow>, InputError> {
    let path = problem.task.path();
    let mut table = CsvTable::new(file, bytes)?;
    let columns = columns(&table, &problem.external_axes)?;
    let count = path.points().len();
    let mut rows = Vec::with_capacity(count);
    let mut last_line = 1;
    while let Some(row) = table.next_row()? {
        let index = rows.len();
        if index == count {
            let problem = format!("the plan has more points than the {count} of the task");
            return Err(row.fail(columns.point, &problem, &format!("points 0 to {}", count - 1)));
        }
        number_is(&row, columns.point, index)?;
        number_is(&row, columns.segment, path.segment_of(index) + 1)?;
        rows.push(plan_row(&row, &columns)?);
        last_line = row.line();
    }
    if rows.len() < count {
        return Err(InputError::new(file, format!("the plan ends before the task, which has {count} points"))
            .at_line(last_line)
            .in_field("point")
            .found(format!("{} points", rows.len()))
            .allowed(format!("points 0 to {}, those of the task of the run", count - 1)));
    }
    Ok(rows)
}

/// The column of an external axis, from 1.
pub fn axis_column(number: usize, kind: AxisKind) -> String {
    match kind {
        AxisKind::Rail => format!("e{number}_mm"),
        AxisKind::Turntable => format!("e{number}_deg"),
    }
}

fn columns(table: &CsvTable<'_>, axes: &[ExternalAxis]) -> Result<Columns, InputError> {
    let column =
        |name: &str| {
            let allowed = format!(
                "a header with point, segment, beta_deg, posture, {}, {} and {}, each once, as stead place writes it",
                POSITION.join(", "),
                JOINTS.join(", "),
                FORCE.join(", ")
            );
            let fail = |problem: &str| table.fail(name, problem, &allowed);
            match table.column(name) {
                None => Err(fail("missing column")
                    .found(format!("'{}'", shorten(&table.header().collect::<Vec<_>>().join(","))))),
                Some(_) if table.is_doubled(name) => Err(fail("this column is there twice")),
                Some(column) => Ok(column),
            }
        };
    let three = |names: [&str; 3]| try_each(names, column);
    let joints = try_each(JOINTS, column)?;
    let axes = axes.iter().zip(1..);
    let axes = axes.map(|(axis, number)| Ok((column(&axis_column(number, axis.kind))?, axis.kind)));
    let axes = axes.collect::<Result<Vec<_>, InputError>>()?;
    let has_deflection = DEFLECTION.iter().any(|name| table.column(name).is_some());
    Ok(Columns {
        point: column("point")?,
        segment: column("segment")?,
        position: three(POSITION)?,
        beta: column("beta_deg")?,
        posture: column("posture")?,
        joints,
        force: three(FORCE)?,
        deflection: if has_deflection { Some(three(DEFLECTION)?) } else { None },
        axes,
        lean: if LEAN.iter().any(|name| table.column(name).is_some()) { Some(try_each(LEAN, column)?) } else { None },
    })
}

fn number_is(row: &Row<'_>, column: usize, expected: usize) -> Result<(), InputError> {
    if row.text(column).parse() == Ok(expected) {
        return Ok(());
    }
    Err(row.fail(column, "not the number that the task has here", &format!("{expected}, as in the task of the run")))
}

fn plan_row(row: &Row<'_>, columns: &Columns) -> Result<PlanRow, InputError> {
    let joints = try_each(columns.joints, |column| row.number(column).map(f64::to_radians))?;
    let posture = row.text(columns.posture).parse().ok().and_then(Posture::from_number);
    let axis = |(column, kind): &(usize, AxisKind)| {
        let position = row.number(*column)?;
        Ok(if *kind == AxisKind::Rail { position / 1e3 } else { position.to_radians() })
    };
    Ok(PlanRow {
        axes: columns.axes.iter().map(axis).collect::<Result<_, InputError>>()?,
        line: row.line(),
        position: row.vector(columns.position)? / 1e3,
        beta: row.number(columns.beta)?.to_radians(),
        posture: posture.ok_or_else(|| row.fail(columns.posture, "not a posture", "a whole number from 1 to 8"))?,
        joints,
        force: row.vector(columns.force)?,
        lean: match columns.lean {
            Some([lead, tilt]) => {
                Some(Lean { lead: row.number(lead)?.to_radians(), tilt: row.number(tilt)?.to_radians() })
            }
            None => None,
        },
        deflection: columns.deflection.map(|columns| row.vector(columns).map(|mm| mm / 1e3)).transpose()?,
    })
}
