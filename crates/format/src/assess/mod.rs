//! Assessment files: the config of `stead assess`.

mod benchmark;
#[cfg(test)]
mod tests;

use benchmark::{Setting, benchmark_from, direction, yield_from};

use super::milling::milling_from;
use super::printed::printed_from;
use super::reader::{Field, NamedFile, Table};
use super::robot::robot_from;
use super::source::{Source, input_file};
use super::tables::spindle_from;
use crate::input::{InputError, InputFile};
use std::path::Path;
use stead_assessment::benchmark::Plane;
use stead_assessment::comparison::Comparison;
use stead_assessment::map::Grid;
use stead_assessment::published::PublishedTables;
use stead_assessment::ranking::Selection;
use stead_model::cutting::ForceHistory;
use stead_model::published::Published;
use stead_model::robot::{Compliance, Pose, Robot};

/// An assessment file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct AssessRun {
    /// What is to be assessed.
    pub comparison: Comparison,
    /// Where a range of compliance was replaced by one value of it: how far from its smaller to its larger end.
    pub range_share: Option<f64>,
    /// The cutting forces behind the load, where the file computes them.
    pub force_history: Option<ForceHistory>,
    /// Published tables to set beside ours.
    pub published: Option<Published<PublishedTables>>,
    /// The files that were read: config, robots, reference.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<String>,
}

/// Reads an assessment file and the robot files that it names. Top-level keys: `robots` (paths relative to the folder of
/// the file), `[benchmark]` and `[map]`; optionally `[zones]`, `[plane]`, `[spindle]`, `[milling]`, `[stiffness]`, `[load]`,
/// `[selection]` and `[reference]`. The shipped files explain each field.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of the
/// wrong kind or out of range, two robots of one name, a zone larger than the map, a load without a force in the plane.
pub fn read_assessment(file: &Path) -> Result<AssessRun, InputError> {
    let source = Source::read(file)?;
    let document = source.parse()?;
    let [robots, benchmark, plane, spindle, milling, map, zones, stiffness, load, selection, reference] =
        Table::root(&document).fields([
            "robots",
            "benchmark",
            "plane",
            "spindle",
            "milling",
            "map",
            "zones",
            "stiffness",
            "load",
            "selection",
            "reference",
        ])?;
    let plane = plane.optional(|field| plane_from(&field.table()?))?.unwrap_or(Plane::XOZ);
    let mounted = spindle.optional(|field| spindle_from(&field.table()?))?;
    let cut = milling.optional(|field| milling_from(&field.table()?))?;
    let force_history = cut.map(|cut| cut.force_history());
    let yields = stiffness.optional(|field| yield_from(&field.table()?))?.unwrap_or_default();
    let flange_from_tool = mounted.map_or(Pose::identity(), |spindle| spindle.flange_from_tool);
    let setting = Setting {
        plane,
        flange_from_tool,
        yields,
        force_history: force_history.as_ref(),
        milling: &milling,
        spindle: &spindle,
    };
    let (benchmark, elbow_names) = benchmark_from(&benchmark.table()?, &setting)?;
    let grid = grid_from(&map.table()?)?;
    let zones = zones.optional(|field| zones_from(&field.table()?, &grid))?.unwrap_or_default();
    let (rated_share, gravity) = load.optional(|field| load_from(&field.table()?))?.unwrap_or((RATED, GRAVITY));
    let selection = selection.optional(|field| selection_from(&field.table()?, gravity))?;
    let selection =
        selection.unwrap_or(Selection { accuracies: vec![], forces: vec![], remaining_share: 1.0, gravity });

    let mut inputs = vec![source.as_config()];
    let robots = robots_from(&robots, yields.range_share, &mut inputs)?;
    let published = reference.optional(|field| {
        let [tables] = field.table()?.fields(["tables"])?;
        let named = tables.named_file()?;
        inputs.push(input_file("reference", named.name.as_str(), &named.bytes));
        printed_from(&Source::new(&named.file, named.bytes)?)
    })?;
    let asked = !selection.forces.is_empty();
    let notes = range_note(&robots).into_iter().chain(asked.then(|| payload_note(&robots)).flatten()).collect();
    let comparison = Comparison { robots, benchmark, grid, zones, elbow_names, rated_share, selection };
    Ok(AssessRun { comparison, range_share: yields.range_share, force_history, published, inputs, notes })
}

/// Share of the weight of the payload that makes the rated load, where the file does not say.
const RATED: f64 = 0.8;
/// Standard acceleration of gravity. m/s^2
const GRAVITY: f64 = 9.806_65;

/// The robots of a list, with one compliance in place of a range where a share of the range is given.
fn robots_from(
    field: &Field<'_>,
    range_share: Option<f64>,
    inputs: &mut Vec<InputFile>,
) -> Result<Vec<Robot>, InputError> {
    let mut robots: Vec<Robot> = Vec::new();
    for entry in field.list("the paths of one or more robot files, relative to the folder of this file")? {
        let NamedFile { name, file, bytes } = entry.named_file()?;
        inputs.push(input_file("robot", name, &bytes));
        let robot = robot_from(&Source::new(&file, bytes)?)?;
        if robots.iter().any(|other| other.name() == robot.name()) {
            let problem = format!("names a second robot called '{}'", robot.name());
            return Err(entry.error(problem, "robot files with different names in them"));
        }
        robots.push(match range_share {
            Some(share) => robot.with_range_share(share).map_err(|e| {
                entry.error(format!("has a joint without a compliance there: {e}"), "ranges of compliances above 0")
            })?,
            None => robot,
        });
    }
    Ok(robots)
}

/// The plane of the circle: two directions in the base frame, made exactly normal to each other.
fn plane_from(table: &Table<'_>) -> Result<Plane, InputError> {
    let [origin, x, y] = table.fields(["origin_mm", "x", "y"])?;
    let (first, second) = (direction(&x)?, direction(&y)?);
    if first.dot(&second).abs() > 1e-3 {
        let problem = format!("is not normal to x, their dot product is {:.4}", first.dot(&second));
        return Err(y.error(problem, "a direction normal to x, within 0.001"));
    }
    let origin = origin.optional(Field::vector3)?.unwrap_or_default() / 1e3;
    Ok(Plane { origin, x: first, y: (second - first * first.dot(&second)).normalize() })
}

/// More places than this are refused.
const MOST_NODES: f64 = 4e6;

fn grid_from(table: &Table<'_>) -> Result<Grid, InputError> {
    let [x, y, step] = table.fields(["x_mm", "y_mm", "step_mm"])?;
    let (across, up, step_mm) = (x.interval()?, y.interval()?, step.positive()?);
    let counts = [across, up].map(|[from, to]| ((to - from) / step_mm + 1e-9).floor() + 1.0);
    let nodes = counts[0] * counts[1];
    if nodes > MOST_NODES {
        return Err(
            step.error(format!("makes {nodes} places"), format!("a step that makes at most {MOST_NODES} of them"))
        );
    }
    Ok(Grid { origin: [across[0] / 1e3, up[0] / 1e3], step: step_mm / 1e3, counts: counts.map(|count| count as usize) })
}

/// Sides of the zones in steps of the grid.
fn zones_from(table: &Table<'_>, grid: &Grid) -> Result<Vec<usize>, InputError> {
    let [sides] = table.fields(["sides_mm"])?;
    let step_mm = grid.step * 1e3;
    let most_mm = step_mm * (grid.counts[0].min(grid.counts[1]) - 1) as f64;
    let rule =
        format!("whole multiples of step_mm = {step_mm} above 0 and not above {most_mm}, the shorter side of the map");
    let mut zones = Vec::new();
    for entry in sides.list(&rule)? {
        let side = entry.number_where(&rule, |side| side > 0.0)?;
        if side > most_mm * (1.0 + 1e-9) {
            return Err(entry.error("is larger than the map", rule));
        }
        let intervals = (side / step_mm).round();
        if (intervals * step_mm - side).abs() > 1e-6 * side {
            return Err(entry.error("is no whole multiple of the step of the map", rule));
        }
        if zones.contains(&(intervals as usize)) {
            return Err(entry.error("is there twice", rule));
        }
        zones.push(intervals as usize);
    }
    Ok(zones)
}

fn load_from(table: &Table<'_>) -> Result<(f64, f64), InputError> {
    let [share, gravity] = table.fields(["rated_share", "gravity_m_per_s2"])?;
    let rule = "a number above 0 and not above 10";
    let share = share.optional(|field| field.number_where(rule, |share| share > 0.0 && share <= 10.0))?;
    Ok((share.unwrap_or(RATED), gravity.optional(Field::positive)?.unwrap_or(GRAVITY)))
}

fn selection_from(table: &Table<'_>, gravity: f64) -> Result<Selection, InputError> {
    let [accuracies, forces, share] = table.fields(["accuracies_mm", "forces_n", "remaining_share"])?;
    let rule = "one or more numbers above 0 in ascending order";
    let ascending = |field: &Field<'_>| {
        let numbers = field.numbers(rule, |v| v > 0.0)?;
        if numbers.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(field.error("is not in ascending order", rule));
        }
        Ok(numbers)
    };
    let unit = |field: &Field<'_>| field.number_where("a number above 0 and not above 1", |v| v > 0.0 && v <= 1.0);
    Ok(Selection {
        accuracies: ascending(&accuracies)?.into_iter().map(|mm| mm / 1e3).collect(),
        forces: ascending(&forces)?,
        remaining_share: share.optional(unit)?.unwrap_or(1.0),
        gravity,
    })
}

/// Which robots have a joint whose compliance is a range that is used as such.
fn range_note(robots: &[Robot]) -> Option<String> {
    let ranged = |robot: &&Robot| robot.joints().iter().any(|j| matches!(j.compliance, Compliance::Range { .. }));
    let names: Vec<&str> = robots.iter().filter(ranged).map(Robot::name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "a joint compliance that the robot file gives as a range is taken as linear in the joint angle ({}): an \
             assumption; stiffness.range_share takes one value of the range instead",
            names.join(", ")
        )
    })
}

/// Which robots may be chosen for any force.
fn payload_note(robots: &[Robot]) -> Option<String> {
    let unknown = robots.iter().filter(|robot| robot.data_sheet().payload.is_none());
    let names: Vec<&str> = unknown.map(Robot::name).collect();
    (!names.is_empty()).then(|| {
        format!(
            "no payload_kg in the robot file ({}): no rated load, and the selection takes the robot for any force",
            names.join(", ")
        )
    })
}
