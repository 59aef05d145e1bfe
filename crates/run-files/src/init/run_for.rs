//! A run file for a robot and a task that are there.

use super::ground::{Ground, ground};
use super::stock::Guess;
use nalgebra::Vector3;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use stead_disk::files::{
    self,
    new::{Existing, write_all_new},
};
use stead_disk::input::{InputError, input_file};
use stead_disk::template::{filled, shown_if};
use stead_format::cam::file_beside;
use stead_format::document::Document;
use stead_format::robot::{read_geometry, says_stiffness};
use stead_format::shipped;
use stead_format::surroundings::mount_of;
use stead_format::task::read_csv;
use stead_format::toml_file::TomlFile;
use stead_format::tool::{CutTable, ToolTable};
use stead_format::written::relative;
use stead_model::robot::{Pose, Robot};
use stead_model::task::ToolPath;

/// Writes a run file for `stead place` that names a robot file, or a shipped arm by `name:`, and a task file. What
/// neither says is filled in by a guess from the reach of the arm, and named in `guesses`: spindle, cell and, for a
/// task without forces, the forces. Shapes of the links beside the robot file (`NAME-cell.toml`) are its surroundings,
/// and a table or a floor among them gives the height of the cell; the cutter beside the task file (`NAME-tool.toml`)
/// is its tool. Where it states no engagement, the forces of a task without any are those of what the path removes of a
/// stock.
///
/// # Errors
/// [`InputError`]: robot or task are wrong, or what is beside them, or the run file is there already and to be kept, or
/// cannot be written.
pub fn init_run(robot: &Path, task: &Path, out: &Path, existing: Existing) -> Result<(), InputError> {
    let arm = read_geometry(robot)?;
    let imported = read_csv(task)?;
    let folder = out.parent().unwrap_or(Path::new(""));
    let quoted = |name: String| toml::Value::from(name).to_string();
    let is_shipped = shipped::text(robot).is_some();
    let reach = arm.geometry().reach();
    let cell = shapes_beside(robot);
    let mount = cell.as_deref().map(mount_of).transpose()?.flatten();
    let area = area(reach, mount.as_ref());
    let stands = mount.map_or_else(Vector3::zeros, |mount| mount.translation);
    let known = Known {
        robot: quoted(if is_shipped { robot.display().to_string() } else { relative(folder, robot) }),
        has_stiffness: says_stiffness(robot)?.unwrap_or(true),
        task: quoted(relative(folder, task)),
        has_forces: imported.wrenches.is_some(),
        surroundings: cell.as_ref().map(|cell| quoted(relative(folder, cell))),
        ground: cell.map(|cell| ground(&cell, area, &stands, reach)).transpose()?.flatten(),
        mount,
        cutter: cutter_beside(task)?,
    };
    let read =
        |file: &Path| files::read(file).ok().map(|bytes| input_file("input", file.display().to_string(), &bytes));
    let inputs: Vec<_> = [robot, task].into_iter().filter_map(read).collect();
    write_all_new(&[(out.to_owned(), text(&arm, &imported.path, area, &known).as_str())], existing, &inputs)
}

/// What is known of a run.
struct Known {
    /// Names of the files as the run file has them, in quotes.
    robot: String,
    task: String,
    surroundings: Option<String>,
    has_stiffness: bool,
    has_forces: bool,
    ground: Option<Ground>,
    /// Where the robot stands, by its surroundings.
    mount: Option<Pose<f64>>,
    cutter: Option<Cutter>,
}

/// The tables of a cutter for a run file.
struct Cutter {
    text: String,
    /// Keys of it whose values are guesses.
    guesses: Vec<String>,
    /// Half its diameter and its corner radius, where it is a table. mm
    sizes: Option<(f64, f64)>,
    /// Whether it states one engagement for the whole path.
    has_engagement: bool,
}

impl Known {
    /// Half the diameter of the cutter and its corner radius (mm) where the forces are to be those of what it removes
    /// of a stock.
    fn removes(&self) -> Option<(f64, f64)> {
        let cutter = self.cutter.as_ref().filter(|cutter| !self.has_forces && !cutter.has_engagement)?;
        cutter.sizes
    }
}

/// What a file of a cutter declares.
#[derive(Deserialize)]
struct CutterFile {
    guesses: Option<Vec<String>>,
    tool: Option<ToolTable>,
    cut: Option<CutTable>,
}

/// The file of the cutter that `stead import path` has written beside a task file.
fn file_of_cutter(task: &Path) -> Result<Option<(TomlFile, CutterFile)>, InputError> {
    let file = file_beside(task);
    if !file.is_file() {
        return Ok(None);
    }
    let source = TomlFile::read(&file)?;
    let read = source.parse().and_then(|document: Document<'_>| document.read())?;
    Ok(Some((source, read)))
}

/// The cutter that is beside a task file, without the comment at the head of its file.
fn cutter_beside(task: &Path) -> Result<Option<Cutter>, InputError> {
    let Some((source, read)) = file_of_cutter(task)? else { return Ok(None) };
    if let (None, Some(_)) = (&read.tool, &read.cut) {
        return Err(InputError::new(source.file(), "has [cut] without [tool]").allowed("a table [tool] beside [cut]"));
    }
    let is_head = |line: &&str| !line.trim_start_matches("# ").starts_with('[');
    let lines: Vec<&str> = source.text().lines().skip_while(is_head).collect();
    Ok(Some(Cutter {
        text: lines.join("\n").trim().to_owned(),
        guesses: read.guesses.unwrap_or_default(),
        sizes: read.tool.map(|tool| {
            let corner = tool.corner_radius_mm.map_or(0.0, |corner| corner.written());
            (tool.cutter_diameter_mm.written() / 2.0, corner)
        }),
        has_engagement: read.cut.is_some_and(|cut| cut.radial_depth_mm.is_some() || cut.engagement.is_some()),
    }))
}

/// The cutter that is beside a task file.
pub(super) fn tool_beside(task: &Path) -> Result<Option<ToolTable>, InputError> {
    Ok(file_of_cutter(task)?.and_then(|(_, read)| read.tool))
}

/// The shapes of the links that `stead import robot --collision` has written beside a robot file.
fn shapes_beside(robot: &Path) -> Option<PathBuf> {
    let cell = robot.with_file_name(format!("{}-cell.toml", robot.file_stem()?.to_string_lossy()));
    (shipped::text(robot).is_none() && cell.is_file()).then_some(cell)
}

/// A length to the next 10 mm. mm
fn rounded(metres: f64) -> f64 {
    (metres * 100.0).round() * 10.0
}

/// The ranges of x, y and z of a cell in front of a robot that stands there (m): the box around what is in front of
/// it.
fn area(reach: f64, mount: Option<&Pose<f64>>) -> [[f64; 2]; 3] {
    let area = [[0.45 * reach, 0.8 * reach], [-0.3 * reach, 0.3 * reach], [0.15 * reach, 0.4 * reach]];
    let Some(mount) = mount else { return area };
    let corners = (0..8).map(|corner| {
        let end = |axis: usize| area[axis][(corner >> axis) & 1];
        mount.point(&Vector3::new(end(0), end(1), end(2)))
    });
    let none = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
    corners.fold(none, |ends, corner| {
        std::array::from_fn(|axis| [ends[axis][0].min(corner[axis]), ends[axis][1].max(corner[axis])])
    })
}

/// The text of the run file; `area` are the ranges of its cell, of z where nothing else is known. m
fn text(robot: &Robot, path: &ToolPath, area: [[f64; 2]; 3], known: &Known) -> String {
    let reach = robot.geometry().reach();
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let [low, high] = ends(path, axis);
        rounded((low + high) / 2.0)
    });
    let range = |[from, to]: [f64; 2]| format!("[{:?}, {:?}]", rounded(from), rounded(to));
    let (heights, about_heights) = heights(robot, path, area[2], known);
    let (feed, about_feed) = feed(path);
    let (turn, about_turn) = spindle_turn(path);
    let stock = known.removes().map(|(half, corner)| Guess::of_path(path, 2.0 * half, corner));
    // A cut beside the forces of the task would be a second source of them.
    let is_taken = |key: &&String| !(known.has_forces && key.starts_with("cut."));
    let has_engagement = known.cutter.as_ref().is_some_and(|own| own.has_engagement);
    let is_loaded = known.has_forces || stock.is_some() || has_engagement;
    let mut guesses = vec!["spindle".to_owned(), "cell".to_owned()];
    guesses.extend(path.feed(0).is_none().then(|| "redundancy.feed_mm_per_s".to_owned()));
    guesses.extend(stock.as_ref().map(|stock| format!("stock.{}", stock.key)));
    guesses.extend(known.cutter.iter().flat_map(|own| own.guesses.iter().filter(is_taken).cloned()));
    guesses.extend((!is_loaded).then(|| "forces".to_owned()));
    let cutter = known.cutter.as_ref().map(|own| {
        let end = own.text.find("\n[cut]").filter(|_| known.has_forces).unwrap_or(own.text.len());
        own.text[..end].trim_end().to_owned()
    });
    let frame = if known.mount.is_some() { "the cell frame: [mount] of the surroundings" } else { "the base frame" };
    filled(
        include_str!("run_for.toml"),
        &[
            ("guesses", Some(format!("{guesses:?}"))),
            ("robot", Some(known.robot.clone())),
            ("like", shown_if(!known.has_stiffness)),
            ("task", Some(known.task.clone())),
            ("surroundings", known.surroundings.clone()),
            ("removes", shown_if(stock.is_some())),
            ("frame", Some(frame.to_owned())),
            ("x_mm", Some(range(area[0]))),
            ("middle", Some(format!("{x:?}, {y:?}, {z:?}"))),
            ("y_mm", Some(range(area[1]))),
            ("z_mm", Some(range(heights))),
            ("about_z", Some(about_heights)),
            ("table", Some(format!("{:?}", rounded(0.6 * reach)))),
            ("length", Some(format!("{:?}", rounded(reach / 4.0)))),
            ("feed", Some(feed)),
            ("about_feed", Some(about_feed)),
            ("turn", Some(turn)),
            ("about_turn", Some(about_turn)),
            ("stock", stock.as_ref().map(Guess::row)),
            ("has_cutter", shown_if(cutter.is_some())),
            ("cutter", cutter),
            ("unloaded", shown_if(!is_loaded)),
        ],
    )
}

/// Where the origin of the workpiece may be above a ground (m), and where that comes from.
fn heights(robot: &Robot, path: &ToolPath, area: [f64; 2], known: &Known) -> ([f64; 2], String) {
    let reach = robot.geometry().reach();
    let ground = known.ground.as_ref();
    if let Some(Ground { name, height, is_floor: false }) = ground {
        // No point of the path is below the table.
        let from = height - ends(path, 2)[0];
        let about = format!(
            "from where the lowest point of the path is on {name:?} of the surroundings, {} mm high",
            rounded(*height)
        );
        return ([from, from + 0.25 * reach], about);
    }
    if let (Some(_), None) = (known.mount, ground) {
        return (area, "in front of the robot where the surroundings have it".to_owned());
    }
    // A root frame below the base of the rows is on the floor; one at the height of axis 2 is above it.
    let root = robot.controller().and_then(|controller| controller.root_from_base);
    let (floor, about) = match ground {
        Some(floor) => (floor.height, format!("{:?} of the surroundings", floor.name)),
        None => (root.map_or(0.0, |root| -root.translation.z.max(0.0)), "the foot of the robot".to_owned()),
    };
    let about = format!("above the floor, which is taken at {} mm, {about}", rounded(floor));
    ([floor + 0.15 * reach, floor + 0.4 * reach], about)
}

/// The programmed feed as the file has it, and where it comes from.
fn feed(path: &ToolPath) -> (String, String) {
    let feeds = (0..path.points().len()).filter_map(|point| path.feed(point)).map(|feed| (feed * 1e9).round() / 1e6);
    let ends = feeds.map(|feed| [feed; 2]).reduce(|[low, high], [feed, _]| [low.min(feed), high.max(feed)]);
    match ends {
        Some([low, high]) => {
            (format!("{high:?}"), format!("the highest of the task, whose own feeds count: {low:?} to {high:?} mm/s"))
        }
        None => ("50.0".to_owned(), "the task has no feeds of its own".to_owned()),
    }
}

/// How fast the spindle may turn in space (deg/mm), and why: never less than the tool axis itself turns along the path.
fn spindle_turn(path: &ToolPath) -> (String, String) {
    let axis = |point: usize| path.points()[point].axis;
    let inner = path.segments().iter().flat_map(|span| span.clone().skip(1)).filter(|p| !path.turns_in_place(*p));
    let rates = inner.map(|point| {
        let (from, to) = (axis(point - 1), axis(point));
        libm::atan2(from.cross(&to).norm(), from.dot(&to)).to_degrees() / (1e3 * path.step_length(point))
    });
    let fastest = rates.fold(0.0, f64::max);
    if fastest < SPINDLE_TURN / AXIS_ROOM {
        return (format!("{SPINDLE_TURN:?}"), "a plan that turns faster is driven more slowly".to_owned());
    }
    let turn = (fastest * AXIS_ROOM * 10.0).ceil() / 10.0;
    (format!("{turn:?}"), format!("the tool axis alone turns by up to {fastest:.2} along the path"))
}

/// The limit on the turn of the spindle that the guide recommends. deg/mm
const SPINDLE_TURN: f64 = 0.5;
/// By how much (as a factor) the spindle may turn faster than the tool axis does where that is the fastest, so that
/// beta is free there.
const AXIS_ROOM: f64 = 1.25;

/// The ends of a path along an axis of the workpiece frame. m
fn ends(path: &ToolPath, axis: usize) -> [f64; 2] {
    let values = path.points().iter().map(|point| point.position[axis]);
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

#[cfg(test)]
mod tests;
