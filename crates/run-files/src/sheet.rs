//! Measurement sheets from CSV.

use std::collections::BTreeMap;
use std::path::Path;
use stead_calibration::identification::{Configuration, Reading, Sheet};
use stead_disk::input::InputError;
use stead_disk::input::csv_table::{CsvTable, Row, try_each};
use stead_model::robot::Robot;
use stead_model::robot::angles::ANGLE_ROUNDING;
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};

const THETA: [&str; 6] = ["theta1_deg", "theta2_deg", "theta3_deg", "theta4_deg", "theta5_deg", "theta6_deg"];
const FORCE: [&str; 3] = ["force_x_n", "force_y_n", "force_z_n"];
const MOMENT: [&str; 3] = ["moment_x_nm", "moment_y_nm", "moment_z_nm"];
const UNLOADED: [&str; 3] = ["unloaded_x_mm", "unloaded_y_mm", "unloaded_z_mm"];
const LOADED: [&str; 3] = ["loaded_x_mm", "loaded_y_mm", "loaded_z_mm"];
const UNLOADED_TURN: [&str; 3] = ["unloaded_rx_deg", "unloaded_ry_deg", "unloaded_rz_deg"];
const LOADED_TURN: [&str; 3] = ["loaded_rx_deg", "loaded_ry_deg", "loaded_rz_deg"];
/// What a header must have.
const HEADER: &str = "configuration, theta1_deg to theta6_deg, force_x_n to force_z_n, moment_x_nm to moment_z_nm, point, \
                      unloaded_x_mm to unloaded_z_mm, loaded_x_mm to loaded_z_mm, each once; for full poses also \
                      unloaded_rx_deg to unloaded_rz_deg and loaded_rx_deg to loaded_rz_deg";

/// Where the columns are.
struct Columns {
    configuration: usize,
    theta: [usize; 6],
    force: [usize; 3],
    moment: [usize; 3],
    point: usize,
    unloaded: [usize; 3],
    loaded: [usize; 3],
    turns: Option<[[usize; 3]; 2]>,
}

impl Columns {
    fn new(table: &CsvTable<'_>) -> Result<Self, InputError> {
        let one = |name: &str| match table.is_doubled(name) {
            true => Err(table.fail(name, "this column is there twice", HEADER)),
            false => table.column(name).ok_or_else(|| table.fail(name, "missing column", HEADER)),
        };
        let three = |names: [&str; 3]| try_each(names, one);
        let theta = try_each(THETA, one)?;
        let has_turns = UNLOADED_TURN.iter().chain(&LOADED_TURN).any(|name| table.column(name).is_some());
        let turns = if has_turns { Some([three(UNLOADED_TURN)?, three(LOADED_TURN)?]) } else { None };
        Ok(Self {
            configuration: one("configuration")?,
            theta,
            force: three(FORCE)?,
            moment: three(MOMENT)?,
            point: one("point")?,
            unloaded: three(UNLOADED)?,
            loaded: three(LOADED)?,
            turns,
        })
    }
}

/// The readings of one configuration, before they are put in order.
struct Entry {
    configuration: Configuration,
    line: usize,
    readings: Vec<Reading>,
}

/// Reads a sheet: one row for each configuration and reference point, in any order; columns by name, others are passed
/// over. The wrench is in the base frame, positions in the tracker's. Orientations, where given, are rotation vectors
/// (axis times angle) in the tracker's frame, of a body fixed to the flange.
///
/// # Errors
/// [`InputError`] naming line and column: a missing or doubled column, a value that is no finite number, a
/// configuration whose rows differ in joint angles or wrench, a point that is there twice in a configuration, joint
/// angles outside the limits, no load, or a loaded place equal to the unloaded one.
pub(super) fn sheet_from(file: &Path, bytes: &[u8], robot: &Robot) -> Result<Sheet, InputError> {
    let mut table = CsvTable::new(file, bytes)?;
    let columns = Columns::new(&table)?;
    let mut points: Vec<String> = Vec::new();
    let mut point_of: BTreeMap<String, usize> = BTreeMap::new();
    let mut entries: Vec<Entry> = Vec::new();
    let mut entry_of: BTreeMap<String, usize> = BTreeMap::new();
    while let Some(row) = table.next_row()? {
        let configuration = configuration(&row, &columns, robot)?;
        let point = name(&row, columns.point)?;
        let point = *point_of.entry(point.clone()).or_insert_with(|| {
            points.push(point);
            points.len() - 1
        });
        let index = *entry_of.entry(configuration.name.clone()).or_insert(entries.len());
        if index == entries.len() {
            entries.push(Entry { configuration: configuration.clone(), line: row.line(), readings: vec![] });
        }
        let entry = &mut entries[index];
        let (known, now) = (&entry.configuration, &configuration);
        if known.theta != now.theta || known.force != now.force || known.moment != now.moment {
            let problem =
                format!("the configuration of line {} has this name but other joint angles or wrench", entry.line);
            return Err(row.fail(columns.configuration, &problem, "another name, or the same joint angles and wrench"));
        }
        if let Some(other) = entry.readings.iter().find(|reading| reading.point == point) {
            let problem = format!("line {} has this point of this configuration already", other.line);
            return Err(row.fail(columns.point, &problem, "each point once in a configuration"));
        }
        entry.readings.push(reading(&row, &columns, index, point)?);
    }
    if entries.is_empty() {
        return Err(InputError::new(file, "has no measurements")
            .at_line(1)
            .allowed("one or more rows below the header"));
    }
    let mut sheet = Sheet { points, configurations: Vec::with_capacity(entries.len()), readings: Vec::new() };
    for mut entry in entries {
        entry.configuration.readings = sheet.readings.len()..sheet.readings.len() + entry.readings.len();
        sheet.configurations.push(entry.configuration);
        sheet.readings.extend(entry.readings);
    }
    Ok(sheet)
}

fn name(row: &Row<'_>, column: usize) -> Result<String, InputError> {
    match row.text(column) {
        "" => Err(row.fail(column, "is blank", "a name")),
        text => Ok(text.to_owned()),
    }
}

fn configuration(row: &Row<'_>, columns: &Columns, robot: &Robot) -> Result<Configuration, InputError> {
    let mut theta = [0.0; 6];
    for ((slot, column), joint) in theta.iter_mut().zip(columns.theta).zip(robot.joints()) {
        let angle = row.number(column)?.to_radians();
        if angle < joint.min - ANGLE_ROUNDING || angle > joint.max + ANGLE_ROUNDING {
            let limits = format!("{:.4} to {:.4} deg", joint.min.to_degrees(), joint.max.to_degrees());
            return Err(row.fail(column, "is outside the limits of the joint", &limits));
        }
        *slot = angle;
    }
    if let Some(range) = robot.sum_range().filter(|_| robot.beyond_sum(&theta) > ANGLE_ROUNDING) {
        let limits = format!("a sum from {:.4} to {:.4} deg", range.min.to_degrees(), range.max.to_degrees());
        return Err(row.fail(columns.theta[2], "puts the sum of joints 2 and 3 outside its limits", &limits));
    }
    let (force, moment) = (row.vector(columns.force)?, row.vector(columns.moment)?);
    if force.norm() == 0.0 && moment.norm() == 0.0 {
        return Err(row.fail(columns.force[0], "force and moment are all zero", "a load"));
    }
    Ok(Configuration { name: name(row, columns.configuration)?, theta, force, moment, readings: 0..0 })
}

fn reading(row: &Row<'_>, columns: &Columns, configuration: usize, point: usize) -> Result<Reading, InputError> {
    if let Some(column) = columns.unloaded.into_iter().chain(columns.loaded).find(|column| row.text(*column).is_empty())
    {
        return Err(row.fail(
            column,
            "no reading is filled in here",
            "a finite decimal number, the coordinate read in mm",
        ));
    }
    let (unloaded, loaded) = (row.vector(columns.unloaded)? / 1e3, row.vector(columns.loaded)? / 1e3);
    if unloaded == loaded {
        let problem = "the loaded place is the unloaded one, coordinate by coordinate";
        return Err(row.fail(columns.loaded[0], problem, "the place read under load"));
    }
    let turn = match columns.turns {
        None => None,
        Some([before, after]) => {
            let rotation = |columns| row.vector(columns).map(|v| rotation_from_vector(&v.map(f64::to_radians)));
            Some(rotation_vector(&(rotation(after)? * rotation(before)?.transpose())))
        }
    };
    Ok(Reading { line: row.line(), configuration, point, unloaded, loaded, turn })
}
