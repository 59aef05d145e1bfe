//! Assessment files: the config of `stead assess`.

use super::milling::milling_from;
use super::printed::printed_from;
use super::reader::{Field, NamedFile, Table};
use super::robot::robot_from;
use super::source::{Source, sha256};
use super::tables::spindle_from;
use crate::assessment::benchmark::{Benchmark, LimitsAt, Plane, StiffnessModel, Turning};
use crate::assessment::map::Grid;
use crate::assessment::printed::Printed;
use crate::assessment::ranking::Selection;
use crate::assessment::study::{ElbowNames, Study};
use crate::cutting::Course;
use crate::input::{InputError, InputFile};
use crate::robot::{Compliance, Pose, Robot, point_from_tool};
use crate::task::{PathPoint, Wrench};
use nalgebra::{Matrix3, Vector3};
use std::path::Path;

/// An assessment file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct AssessRun {
    /// What is to be assessed.
    pub study: Study,
    /// The cutting forces behind the load, where the file computes them.
    pub course: Option<Course>,
    /// Published tables to set beside ours.
    pub printed: Option<Printed>,
    /// The files that were read: config, robots, reference.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<String>,
}

/// Reads an assessment file and the robot files that it names. Top-level keys: `robots` (paths relative to the folder of
/// the file), `[benchmark]`, `[map]` and `[zones]`; optionally `[plane]`, `[spindle]`, `[milling]`, `[stiffness]`, `[load]`,
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
    let spindle = spindle.optional(|field| spindle_from(&field.table()?))?;
    let cut = milling.optional(|field| milling_from(&field.table()?))?;
    let course = cut.map(|(tool, engagement)| Course::new(&tool, &engagement));
    let yields = stiffness.optional(|field| yield_from(&field.table()?))?.unwrap_or_default();
    let flange_from_tool = spindle.map_or(Pose::identity(), |spindle| spindle.flange_from_tool);
    let setting = Setting { plane, flange_from_tool, yields, course: course.as_ref(), milling: &milling };
    let (benchmark, elbow_names) = benchmark_from(&benchmark.table()?, &setting)?;
    let grid = grid_from(&map.table()?)?;
    let zones = zones_from(&zones.table()?, &grid)?;
    let (rated_share, gravity) = load.optional(|field| load_from(&field.table()?))?.unwrap_or((RATED, GRAVITY));
    let selection = selection.optional(|field| selection_from(&field.table()?, gravity))?;
    let selection =
        selection.unwrap_or(Selection { accuracies: vec![], forces: vec![], remaining_share: 1.0, gravity });

    let mut inputs = vec![input("config", &file.file_name().unwrap_or_default().to_string_lossy(), source.bytes())];
    let robots = robots_from(&robots, &mut inputs)?;
    let printed = reference.optional(|field| {
        let [tables] = field.table()?.fields(["tables"])?;
        let named = tables.named_file()?;
        inputs.push(input("reference", &named.name, &named.bytes));
        printed_from(&Source::new(&named.file, named.bytes)?)
    })?;
    let notes = range_note(&robots, setting.yields.range_share).into_iter().collect();
    let study =
        Study { robots, benchmark, grid, zones, elbow_names, range_share: yields.range_share, rated_share, selection };
    Ok(AssessRun { study, course, printed, inputs, notes })
}

/// Share of the weight of the payload that makes the rated load, where the file does not say.
const RATED: f64 = 0.8;
/// Standard acceleration of gravity. m/s^2
const GRAVITY: f64 = 9.806_65;

fn input(role: &'static str, name: &str, bytes: &[u8]) -> InputFile {
    InputFile { role, name: name.to_owned(), sha256: sha256(bytes) }
}

fn robots_from(field: &Field<'_>, inputs: &mut Vec<InputFile>) -> Result<Vec<Robot>, InputError> {
    let mut robots: Vec<Robot> = Vec::new();
    for entry in field.list("the paths of one or more robot files, relative to the folder of this file")? {
        let NamedFile { name, file, bytes } = entry.named_file()?;
        inputs.push(input("robot", &name, &bytes));
        let robot = robot_from(&Source::new(&file, bytes)?)?;
        if robots.iter().any(|other| other.name() == robot.name()) {
            let problem = format!("names a second robot called '{}'", robot.name());
            return Err(entry.error(problem, "robot files with different names in them"));
        }
        robots.push(robot);
    }
    Ok(robots)
}

/// The plane of the circle: two directions in the base frame, made exactly normal to each other.
fn plane_from(table: &Table<'_>) -> Result<Plane, InputError> {
    let [origin, x, y] = table.fields(["origin_mm", "x", "y"])?;
    let direction = |field: &Field<'_>| {
        let vector = field.vector3()?;
        let length = vector.norm();
        if (length - 1.0).abs() <= 1e-3 {
            Ok(vector / length)
        } else {
            Err(field.error(format!("has length {length:.4}"), "a direction of length 1, within 0.001"))
        }
    };
    let (first, second) = (direction(&x)?, direction(&y)?);
    if first.dot(&second).abs() > 1e-3 {
        let problem = format!("is not normal to x, their dot product is {:.4}", first.dot(&second));
        return Err(y.error(problem, "a direction normal to x, within 0.001"));
    }
    let origin = origin.optional(Field::vector3)?.unwrap_or_default() / 1e3;
    Ok(Plane { origin, x: first, y: (second - first * first.dot(&second)).normalize() })
}

/// What `[stiffness]` says.
#[derive(Debug, Clone, Copy)]
struct Yields {
    joints: [bool; 6],
    range_share: Option<f64>,
    model: StiffnessModel,
}

impl Default for Yields {
    fn default() -> Self {
        Self { joints: [true; 6], range_share: None, model: StiffnessModel::Unloaded }
    }
}

fn yield_from(table: &Table<'_>) -> Result<Yields, InputError> {
    let [joints, share, loaded] = table.fields(["joints", "range_share", "loaded"])?;
    let default = Yields::default();
    let rule = "numbers of joints from 1 to 6, each at most once";
    let read = |field: &Field<'_>| {
        let mut yielding = [false; 6];
        for entry in field.list(rule)? {
            let number = entry.integer(1..=6)? as usize;
            if std::mem::replace(&mut yielding[number - 1], true) {
                return Err(entry.error("is there twice", rule));
            }
        }
        Ok(yielding)
    };
    let unit = |field: &Field<'_>| field.number_where("a number from 0 to 1", |share| (0.0..=1.0).contains(&share));
    let is_loaded = loaded.optional(Field::boolean)?.unwrap_or(false);
    Ok(Yields {
        joints: joints.optional(read)?.unwrap_or(default.joints),
        range_share: share.optional(unit)?,
        model: if is_loaded { StiffnessModel::Loaded } else { StiffnessModel::Unloaded },
    })
}

/// What the benchmark takes from the other tables.
struct Setting<'a> {
    plane: Plane,
    flange_from_tool: Pose<f64>,
    yields: Yields,
    course: Option<&'a Course>,
    milling: &'a Field<'a>,
}

fn benchmark_from(table: &Table<'_>, setting: &Setting<'_>) -> Result<(Benchmark, ElbowNames), InputError> {
    let [radius, points, force, moment, turns, traced, axis, beta, limits, names] = table.fields([
        "radius_mm",
        "points",
        "force_n",
        "moment_nm",
        "force_turns",
        "traced",
        "tool_axis",
        "beta_deg",
        "limits_at",
        "elbow_names",
    ])?;
    let normal = setting.plane.normal();
    let tool_axis = axis.optional(|field| unit_axis(field))?.unwrap_or(normal);
    let wrench = match setting.course {
        Some(course) => {
            if let Some(given) = [&force, &moment].into_iter().find(|field| field.is_given()) {
                return Err(given.error("is given beside a table [milling]", "force_n and moment_nm, or [milling]"));
            }
            turning_wrench(&course.mean, &tool_axis, &normal).ok_or_else(|| {
                axis.error(
                    "does not stand on the plane of the circle",
                    "with [milling]: the normal of the plane, or none",
                )
            })?
        }
        None => Wrench { force: force.vector3()?, moment: moment.optional(Field::vector3)?.unwrap_or_default() },
    };
    if libm::hypot(wrench.force.x, wrench.force.y) <= 0.0 {
        let rule = "a force with a part in the plane of the circle: [radial, tangential, normal] with the first two not both 0";
        let field = if setting.course.is_some() { setting.milling } else { &force };
        return Err(field.error("gives no force in the plane", rule));
    }
    let turnings = [("with-tool", Turning::WithTool), ("against-tool", Turning::AgainstTool)];
    let limit_words = [("circle", LimitsAt::Circle), ("centre", LimitsAt::Centre)];
    let name_words = [("geometric", ElbowNames::Geometric), ("swapped", ElbowNames::Swapped)];
    let is_tool = traced.optional(|field| field.one_of(&[("tool", true), ("wrist-centre", false)]))?.unwrap_or(true);
    let beta = beta.optional(Field::number)?.unwrap_or_default().to_radians();
    let benchmark = Benchmark {
        plane: setting.plane,
        radius: radius.positive()? / 1e3,
        points: points.optional(|field| field.integer(8..=100_000))?.unwrap_or(72) as usize,
        wrench,
        turning: turns.optional(|field| field.one_of(&turnings))?.unwrap_or(Turning::WithTool),
        base_from_tool: orientation(&setting.plane, &tool_axis, beta),
        flange_from_tool: is_tool.then_some(setting.flange_from_tool),
        yielding: setting.yields.joints,
        limits_at: limits.optional(|field| field.one_of(&limit_words))?.unwrap_or(LimitsAt::Circle),
        stiffness: setting.yields.model,
    };
    let names = names.optional(|field| field.one_of(&name_words))?.unwrap_or(ElbowNames::Geometric);
    Ok((benchmark, names))
}

fn unit_axis(field: &Field<'_>) -> Result<Vector3<f64>, InputError> {
    let vector = field.vector3()?;
    let length = vector.norm();
    if (length - 1.0).abs() > 1e-3 {
        return Err(field.error(format!("has length {length:.4}"), "a direction of length 1, within 0.001"));
    }
    Ok(vector / length)
}

/// The mean wrench of a cut (along feed, left of the feed, tool axis), put to polar angle 0 of a circle that is gone round
/// with growing polar angle: radial, tangential, normal. `None` where the tool does not stand on the plane.
fn turning_wrench(mean: &Wrench, tool_axis: &Vector3<f64>, normal: &Vector3<f64>) -> Option<Wrench> {
    let up = tool_axis.dot(normal);
    if up.abs() < 1.0 - 1e-6 {
        return None;
    }
    let sign = up.signum();
    // The feed is tangential, and left of it is towards the centre where the tool axis is the normal.
    let turned = |v: &Vector3<f64>| Vector3::new(-sign * v.y, v.x, sign * v.z);
    Some(Wrench { force: turned(&mean.force), moment: turned(&mean.moment) })
}

/// Orientation of the tool frame for a tool axis that points from the work to the robot: at beta zero the spindle's x axis
/// lies along the first axis of the plane as far as the tool axis lets it, or along the second where the first is the tool
/// axis (Caro 2013, eq. 10, with that direction for the feed).
fn orientation(plane: &Plane, tool_axis: &Vector3<f64>, beta: f64) -> Matrix3<f64> {
    let along_x = plane.x.cross(tool_axis).norm() > 0.1;
    let point =
        PathPoint { position: Vector3::zeros(), feed: if along_x { plane.x } else { plane.y }, axis: *tool_axis };
    point.workpiece_from_point() * point_from_tool(beta)
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
    let rule = "one or more numbers above 0";
    let unit = |field: &Field<'_>| field.number_where("a number above 0 and not above 1", |v| v > 0.0 && v <= 1.0);
    Ok(Selection {
        accuracies: accuracies.numbers(rule, |v| v > 0.0)?.into_iter().map(|mm| mm / 1e3).collect(),
        forces: forces.numbers(rule, |v| v > 0.0)?,
        remaining_share: share.optional(unit)?.unwrap_or(1.0),
        gravity,
    })
}

/// Which robots have a joint whose compliance is a range, and how it is read.
fn range_note(robots: &[Robot], share: Option<f64>) -> Option<String> {
    let ranged = |robot: &&Robot| robot.joints().iter().any(|j| matches!(j.compliance, Compliance::Range { .. }));
    let names: Vec<&str> = robots.iter().filter(ranged).map(Robot::name).collect();
    (!names.is_empty() && share.is_none()).then(|| {
        format!(
            "a joint compliance that the robot file gives as a range is taken as linear in the joint angle ({}): an \
             assumption; stiffness.range_share takes one value of the range instead",
            names.join(", ")
        )
    })
}
