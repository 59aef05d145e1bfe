//! Assessment files: the config of `stead assess`.

mod benchmark;
mod file;
#[cfg(test)]
mod tests;

pub use file::*;

use super::published_tables::published_tables_from;
use benchmark::{Setting, benchmark_from, direction, yields_from};
use nalgebra::Vector3;
use std::path::Path;
use stead_assessment::benchmark::Plane;
use stead_assessment::comparison::Comparison;
use stead_assessment::map::Grid;
use stead_assessment::ranking::Selection;
use stead_disk::input::{InputError, InputFile};
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::robot::robot_from;
use stead_format::shapes::List;
use stead_format::toml_file::TomlFile;
use stead_format::tool::Cutting;
use stead_format::units::{Mm, Positive};
use stead_model::plausibility;
use stead_model::robot::{Compliance, Pose, Robot};
use stead_numerics::message::Note;
use stead_runs::AssessRun;

/// Reads an assessment file, the keys of [`AssessmentFile`], and the robot files that it names.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, two robots of one name, a zone larger than the map, a load without a force in the
/// plane.
pub fn read_assessment(file: &Path) -> Result<AssessRun, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let at = document.root();
    let file: AssessmentFile = document.read()?;
    let plane = file.plane.map(|table| plane_from(&table, &at.key("plane"))).transpose()?.unwrap_or(Plane::XOZ);
    let spindle = file.spindle.map(|table| table.spindle(&at.key("spindle"))).transpose()?;
    let flange_from_tool = spindle.as_ref().map_or(Pose::identity(), |spindle| spindle.flange_from_tool);
    let cutting = Cutting::of(&file.tool, &file.cut, &at)?;
    let of_cut = cutting.as_ref().map(Cutting::notes).unwrap_or_default();
    let cut = cutting.map(|cutting| cutting.engaged_cutter()).transpose()?;
    let force_history = cut.map(|cut| cut.force_history());
    let yields = yields_from(&file.stiffness.unwrap_or_default(), &at.key("stiffness"))?;
    let setting = Setting { plane, flange_from_tool, yields, force_history: force_history.as_ref() };
    let (benchmark, elbow_names) = benchmark_from(&file.benchmark, &at, &setting)?;
    let grid = grid_from(&file.map, &at.key("map"))?;
    let zones = file.zones.map(|table| zones_from(&table.sides_mm, &at.key("zones").key("sides_mm"), &grid));
    let zones = zones.transpose()?.unwrap_or_default();
    let load = file.load.unwrap_or_default();
    let rated_share = load.rated_share.map_or(RATED, Quantity::si);
    let gravity = load.gravity_m_per_s2.map_or(GRAVITY, Quantity::si);
    let selection = match &file.selection {
        Some(table) => selection_from(table, &at.key("selection"), gravity)?,
        None => Selection { accuracies: vec![], forces: vec![], remaining_share: 1.0, gravity },
    };

    let mut inputs = vec![source.as_config()];
    let robots = robots_from(&file.robots, &at.key("robots"), yields.range_share, &mut inputs)?;
    let published = match file.reference {
        Some(_) => {
            let (source, input) = at.key("reference").key("tables").named_toml("reference")?;
            inputs.push(input);
            Some(published_tables_from(&source)?)
        }
        None => None,
    };
    let requested = !selection.forces.is_empty();
    // A benchmark of the arm alone has its tool at the flange.
    let spindle_note = spindle.as_ref().filter(|spindle| spindle.flange_from_tool.translation != Vector3::zeros());
    let joints = spindle.as_ref().and_then(plausibility::joints_alone);
    let odd = robots
        .iter()
        .flat_map(|robot| {
            plausibility::arm(robot).into_iter().map(String::from).chain(plausibility::springs_left_out(robot))
        })
        .chain(full_note(&robots))
        .chain(joints)
        .chain(spindle_note.and_then(plausibility::spindle))
        .chain(spindle.iter().flat_map(plausibility::carried))
        .chain(of_cut)
        .chain(at.radians(""));
    let known = range_note(&robots).into_iter().chain(requested.then(|| payload_note(&robots)).flatten());
    let borrowed = robots.len() > 1 && robots.iter().any(|robot| robot.stiffness_like().is_some());
    let ranked = borrowed.then(|| {
        "some arms have a borrowed stiffness: the order of the robots does not rank how stiff those are".to_owned()
    });
    let notes = known.chain(odd).chain(ranked).map(Note::from).collect();
    let comparison = Comparison { robots, benchmark, grid, zones, elbow_names, rated_share, selection };
    Ok(AssessRun { comparison, range_share: yields.range_share, force_history, published, inputs, notes })
}

/// Share of the weight of the payload that makes the rated load, where the file does not say.
const RATED: f64 = 0.8;
/// Standard acceleration of gravity. m/s^2
const GRAVITY: f64 = 9.806_65;

/// The robots of a list, with one compliance in place of a range where a share of the range is given.
fn robots_from(
    names: &List<String>,
    at: &Place<'_>,
    range_share: Option<f64>,
    inputs: &mut Vec<InputFile>,
) -> Result<Vec<Robot>, InputError> {
    let mut robots: Vec<Robot> = Vec::new();
    for number in 1..=names.0.len() {
        let entry = at.element(number);
        let (source, input) = entry.named_toml("robot")?;
        inputs.push(input);
        let robot = robot_from(&source)?;
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
fn plane_from(table: &PlaneTable, at: &Place<'_>) -> Result<Plane, InputError> {
    let (first, second) = (direction(table.x, &at.key("x"))?, direction(table.y, &at.key("y"))?);
    if first.dot(&second).abs() > 1e-3 {
        let problem = format!("is not normal to x, their dot product is {:.4}", first.dot(&second));
        return Err(at.key("y").error(problem, "a direction normal to x, within 0.001"));
    }
    let origin = table.origin_mm.map_or_else(Vector3::zeros, |origin| origin.vector());
    Ok(Plane { origin, x: first, y: (second - first * first.dot(&second)).normalize() })
}

/// More places than this are refused.
const MAX_NODES: f64 = 4e6;

fn grid_from(table: &MapTable, at: &Place<'_>) -> Result<Grid, InputError> {
    let (across, up, step) = (table.x_mm, table.y_mm, table.step_mm);
    let counts = [across, up].map(|ends| {
        let [from, to] = ends.written();
        ((to - from) / step.written() + 1e-9).floor() + 1.0
    });
    let nodes = counts[0] * counts[1];
    if nodes > MAX_NODES {
        let allowed = format!("a step that makes at most {MAX_NODES} of them");
        return Err(at.key("step_mm").error(format!("makes {nodes} places"), allowed));
    }
    let origin = [across.si()[0], up.si()[0]];
    Ok(Grid { origin, step: step.si(), counts: counts.map(|count| count as usize) })
}

/// Sides of the zones in steps of the grid.
fn zones_from(sides: &List<Mm<Positive>>, at: &Place<'_>, grid: &Grid) -> Result<Vec<usize>, InputError> {
    let step_mm = grid.step * 1e3;
    let most_mm = step_mm * (grid.counts[0].min(grid.counts[1]) - 1) as f64;
    let rule =
        format!("whole multiples of step_mm = {step_mm} above 0 and not above {most_mm}, the shorter side of the map");
    let mut zones = Vec::new();
    for (side, number) in sides.0.iter().zip(1..) {
        let (side, entry) = (side.written(), at.element(number));
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

fn selection_from(table: &SelectionTable, at: &Place<'_>, gravity: f64) -> Result<Selection, InputError> {
    let ascending = |key: &str, numbers: Vec<f64>| {
        if numbers.windows(2).any(|pair| pair[0] >= pair[1]) {
            let rule = "one or more numbers above 0 in ascending order";
            return Err(at.key(key).error("is not in ascending order", rule));
        }
        Ok(numbers)
    };
    Ok(Selection {
        accuracies: ascending("accuracies_mm", table.accuracies_mm.si())?,
        forces: ascending("forces_n", table.forces_n.si())?,
        remaining_share: table.remaining_share.map_or(1.0, Quantity::si),
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

/// Which robots have springs beside those about their axes, where some do: they and others are not compared alike.
fn full_note(robots: &[Robot]) -> Option<String> {
    let (full, others): (Vec<&Robot>, Vec<&Robot>) = robots.iter().partition(|robot| robot.normal_springs().is_some());
    let names = |robots: &[&Robot]| robots.iter().map(|robot| robot.name()).collect::<Vec<_>>().join(", ");
    if full.is_empty() {
        return None;
    }
    let beside = match &others[..] {
        [] => String::new(),
        others => format!(
            "; of the others ({}) those about the axes alone are stated: that is no comparison of like with like",
            names(others)
        ),
    };
    Some(format!(
        "springs normal to the joint axes count as stated ({}), what carries the robot and the spindle do not yield{beside}",
        names(&full)
    ))
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
