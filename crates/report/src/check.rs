//! What was understood of a run or a robot file, before anything is computed with it.

use crate::columns::line;
use crate::document::{Document, PlacementFigures};
use crate::figure::{AngleDeg, PlaceMm, SpeedMmPerS, each};
use crate::forces::CutRecord;
use crate::names;
use crate::units::{Unit, fixed};
use serde_json::Value;
use stead_disk::input::InputFile;
use stead_model::robot::{Axes23, Robot};
use stead_numerics::mean_max::MeanAndMax;
use stead_numerics::message::{Note, Warning};
use stead_numerics::rotation::zyx_from_rotation;
use stead_placement::overview::{Hit, Overview, Stand, Yields};
use stead_problem::problem::Problem;
use stead_removal::cut::CutFigures;

/// A run as it was understood.
#[derive(Debug, Clone)]
pub struct CheckedRun<'a> {
    /// What is to be solved.
    pub problem: &'a Problem,
    /// Its figures.
    pub overview: &'a Overview,
    /// What the path cuts of a stock.
    pub cut: Option<CutFigures>,
    /// The files that were read.
    pub inputs: &'a [InputFile],
    /// What the user should know, in sentences.
    pub notes: &'a [Note],
    /// What the user should see to.
    pub warnings: &'a [Warning],
}

const MM: Unit = Unit { factor: 1e3, decimals: 1 };
const DEG: Unit = Unit { factor: 180.0 / std::f64::consts::PI, decimals: 1 };

fn interval(unit: Unit, ends: [f64; 2]) -> String {
    ends.map(|end| unit.text(end)).join(" to ")
}

/// What `stead check` prints of a run.
pub fn run_text(run: &CheckedRun<'_>) -> String {
    let CheckedRun { problem, overview, .. } = run;
    let mut lines = path_lines(problem, overview);
    let cut = run.cut.map(|cut| cut.lines());
    lines.extend(cut.into_iter().flatten().zip(["cut", ""]).map(|(text, about)| format!("{about:<10}{text}")));
    lines.push(match overview.feeds {
        None => format!("feed      {} mm/s", MM.text(problem.redundancy.feed)),
        Some(feeds) => format!(
            "feed      {} mm/s, as the task states; the {} mm/s of redundancy.feed_mm_per_s apply to none of its moves",
            interval(MM, feeds),
            MM.text(problem.redundancy.feed)
        ),
    });
    let [x, y, z] = problem.cell.position.map(|bounds| interval(MM, [bounds.min, bounds.max]));
    let yaw = interval(DEG, [problem.cell.yaw.min, problem.cell.yaw.max]);
    let frame = names::place_frame(problem);
    lines.push(format!("cell      workpiece origin in the {frame} frame x {x}, y {y}, z {z} mm, yaw {yaw} deg"));
    lines.extend(mount_line(problem));
    lines.push(format!("          {} mm from axis 1", interval(MM, overview.cell_distances)));
    lines.extend(middle_lines(problem, overview));
    let mut text = robot_lines(&problem.robot, None);
    lines.iter().for_each(|words| line(&mut text, words));
    text
}

/// The tool, the path and its forces.
fn path_lines(problem: &Problem, overview: &Overview) -> Vec<String> {
    let mut lines = Vec::new();
    let mut say = |words: String| lines.push(words);
    let tool = &problem.robot.on_flange(&problem.spindle.flange_from_tool);
    let [x, y, z] = [0, 1, 2].map(|axis| MM.text(tool.translation[axis]));
    let [ax, ay, az] = [0, 1, 2].map(|axis| fixed(tool.rotation.column(2)[axis], 4));
    say(format!("spindle   tool centre point on the flange: {x}, {y}, {z} mm"));
    say(format!(
        "          tool axis (z of the tool frame) there: {ax}, {ay}, {az}; {} deg from the flange axis",
        DEG.text(overview.tool_tilt)
    ));
    let lengths = &overview.segment_lengths;
    let (points, length) = (problem.task.points().len(), MM.text(lengths.iter().sum()));
    say(format!("path      {points} points in {} segments, {length} mm in all", lengths.len()));
    let [x, y, z] = overview.extents.map(|extent| interval(MM, extent));
    say(format!("          in the workpiece frame x {x}, y {y}, z {z} mm"));
    say(format!("          tool axis tilted {} deg against z of the workpiece", interval(DEG, overview.tilts)));
    let newtons = |figure: f64| fixed(figure, 1);
    say(format!("forces    mean {} N, largest {} N", newtons(overview.force.mean), newtons(overview.force.max)));
    if overview.moment.max > 0.0 {
        say(format!("          moment about the tool centre point up to {} N m", fixed(overview.moment.max, 2)));
    }
    lines
}

/// What the arm reaches and what yields with the workpiece in the middle of the cell, and where shapes are then.
fn middle_lines(problem: &Problem, overview: &Overview) -> Vec<String> {
    let mut lines = Vec::new();
    let mut say = |words: String| lines.push(words);
    let middle = &overview.middle;
    say(format!(
        "middle    {} of {} path points reached within the joint limits with the workpiece in the middle of the cell",
        middle.reached, middle.tried
    ));
    let at = middle.first.map_or("mid-range joints".to_owned(), |(point, _)| format!("point {point}"));
    if let Some(Yields { axes, normal, base, mount, tip, part }) = &overview.yields {
        let shares = [
            (axes, "joints about their axes"),
            (normal, "joints normal to them"),
            (base, "what carries the robot"),
            (mount, "mount of the spindle"),
            (tip, "holder and tool"),
            (part, "part"),
        ];
        let shares = shares.into_iter().filter(|(share, _)| **share != 0.0);
        let said: Vec<String> = shares.map(|(share, what)| format!("{what} {} %", fixed(share * 100.0, 1))).collect();
        say(format!("yields    {} of the deflection there, at {at}", said.join(", ")));
    }
    if !overview.shapes.is_empty() {
        say(format!(
            "shapes    with the workpiece there and the arm at {at}, in the {} frame, mm:",
            shape_frame(problem)
        ));
    }
    for stand in &overview.shapes {
        let [x, y, z] = stand.extents.map(|extent| interval(MM, extent));
        say(format!("          {} (moves with {}): x {x}, y {y}, z {z}", stand.name, stand.attached));
    }
    lines
}

/// The frame in which shapes are stated: what stands in the cell does not move there.
fn shape_frame(problem: &Problem) -> &'static str {
    if problem.robot.is_mounted() || !problem.external_axes.is_empty() { "cell" } else { "base" }
}

/// Where a mounted robot stands.
fn mount_line(problem: &Problem) -> Option<String> {
    let mount = problem.robot.is_mounted().then(|| problem.robot.cell_from_base::<f64>())?;
    let [x, y, z]: [String; 3] = <[f64; 3]>::from(mount.translation).map(|value| MM.text(value));
    let [yaw, pitch, roll] = zyx_from_rotation(&mount.rotation).map(|angle| DEG.text(angle));
    let up = problem.robot.geometry().base_from_root[(2, 2)].clamp(-1.0, 1.0);
    let lean = DEG.text(libm::acos(up));
    Some(format!(
        "mount     base frame in the cell frame at x {x}, y {y}, z {z} mm, roll {roll}, pitch {pitch}, yaw {yaw} deg; axis 1 leans \
         {lean} deg from upright"
    ))
}

/// What `stead check` prints of a robot file; `has_stiffness` is nothing where it goes without saying.
pub fn robot_lines(robot: &Robot, has_stiffness: Option<bool>) -> String {
    let mut text = String::new();
    line(
        &mut text,
        &format!("robot     {}; wrist centre up to {} mm from axis 1", robot.name(), MM.text(robot.geometry().reach())),
    );
    let controller = robot.controller();
    let words = match controller {
        Some(controller) => {
            let root = if controller.root_from_base.is_some() { "with its root frame" } else { "root frame not given" };
            format!("{}, {root}", controller.kind.word())
        }
        None => "not given: no programs can be written ([controller], [root])".to_owned(),
    };
    line(&mut text, &format!("          controller: {words}"));
    let limits: Vec<String> = robot.joints().iter().map(|joint| interval(DEG, [joint.min, joint.max])).collect();
    line(&mut text, &format!("          joint limits, deg: {}", limits.join("; ")));
    if let Some(Axes23 { linkage, sum }) = robot.axes_2_3() {
        let sum = interval(DEG, [sum.min, sum.max]);
        let linkage = if *linkage { ", driven by a parallelogram: row 3 has its speed and stiffness" } else { "" };
        line(&mut text, &format!("          sum of joints 2 and 3, deg: {sum}{linkage}"));
    }
    let stiffness = match has_stiffness {
        Some(false) => "not given: measure the arm (stead identify plan), or take that of a shipped arm".to_owned(),
        _ => {
            robot.compliances_at(&robot.mid_range()).map(|compliance| fixed(1e-6 / compliance, 3)).join("; ")
                + " MN m/rad"
        }
    };
    line(&mut text, &format!("          joint stiffness: {stiffness}"));
    text
}

records! {
    /// A run as it was understood, in a document.
    pub struct CheckFigures of (run: &CheckedRun<'_>) {
        let CheckedRun { problem, overview, .. } = run;
    } with {
        /// The robot.
        robot: RobotFigures = (&problem.robot).into(),
        /// Angle of the tool axis to the flange axis.
        tool_tilt_deg: AngleDeg = overview.tool_tilt.into(),
        /// Path points.
        points: usize = problem.task.points().len(),
        /// Segments.
        segments: usize = overview.segment_lengths.len(),
        /// Length of each segment.
        segment_lengths_mm: Vec<PlaceMm> = overview.segment_lengths.iter().map(|length| PlaceMm(*length)).collect(),
        /// Extents of the path in the workpiece frame, along x, y and z.
        extents_mm: [[PlaceMm; 2]; 3] = overview.extents.map(each),
        /// Least and largest tilt of the tool axis against z of the workpiece.
        tilts_deg: [AngleDeg; 2] = each(overview.tilts),
        /// Size of the force on the tool. N
        force_n: MeanFigures = (&overview.force).into(),
        /// Least and largest feed, where the task states feeds.
        feeds_mm_per_s: Option<[SpeedMmPerS; 2]> = overview.feeds.map(each),
        /// Size of the moment about the tool centre point. N m
        moment_nm: MeanFigures = (&overview.moment).into(),
        /// What the path cuts of a stock, where the run has one.
        cut?: CutRecord = run.cut.as_ref().map(Into::into),
        /// Least and largest distance of the cell from axis 1.
        cell_distances_mm: [PlaceMm; 2] = each(overview.cell_distances),
        /// What the arm reaches with the workpiece in the middle of the cell.
        middle: MiddleFigures = MiddleFigures::of(run),
        /// The shapes of the cell.
        shapes: Vec<ShapeFigures> = overview.shapes.iter().map(ShapeFigures::of).collect(),
        /// Pairs of shapes that are too near.
        hits: Vec<HitFigures> = overview.hits.iter().map(HitFigures::of).collect(),
    }

    /// Mean and largest size of a load.
    pub struct MeanFigures from figures: &MeanAndMax {
        /// Mean.
        mean: f64 = figures.mean,
        /// Largest.
        max: f64 = figures.max,
    }

    /// What the arm reaches with the workpiece in the middle of the cell.
    pub struct MiddleFigures of (run: &CheckedRun<'_>) {
        /// The placement.
        placement: PlacementFigures = (&run.overview.middle.placement).into(),
        /// Path points tried.
        points_tried: usize = run.overview.middle.tried,
        /// Path points reached within the joint limits.
        points_reached: usize = run.overview.middle.reached,
        /// The first of them, from 0.
        first_point_reached: Option<usize> = run.overview.middle.first.map(|(point, _)| point),
    }

    /// A shape of the cell.
    pub struct ShapeFigures of (stand: &Stand) {
        /// Its name.
        name: String = stand.name.clone(),
        /// What it moves with.
        attached: String = stand.attached.clone(),
        /// Its extents along x, y and z.
        extents_mm: [[PlaceMm; 2]; 3] = stand.extents.map(each),
    }

    /// A pair of shapes that is too near.
    pub struct HitFigures of (hit: &Hit) {
        /// The two.
        pair: [String; 2] = hit.pair.clone(),
        /// Their distance.
        distance_mm: PlaceMm = hit.distance.into(),
        /// The distance that they have to keep.
        required_mm: PlaceMm = hit.required.into(),
    }
}

/// What `stead check --json` prints of a run.
pub fn run_json(run: &CheckedRun<'_>) -> Value {
    Document::new(run.inputs).notes(run.notes).warnings(run.warnings).with(CheckFigures::of(run))
}

records! {
    /// An arm in a document.
    pub struct RobotFigures from robot: &Robot {
        let controller = robot.controller();
    } with {
        /// Its name.
        name: String = robot.name().to_owned(),
        /// How far its wrist centre gets from axis 1.
        wrist_reach_mm: PlaceMm = robot.geometry().reach().into(),
        /// Its controller.
        controller: Option<&'static str> = controller.map(|controller| controller.kind.word()),
        /// Whether the root frame of the controller is known.
        has_root: bool = controller.is_some_and(|controller| controller.root_from_base.is_some()),
        /// The arm whose stiffness it borrows.
        stiffness_like: Option<String> = robot.stiffness_like().map(str::to_owned),
        /// Figures that nobody has verified.
        unverified: Vec<String> = robot.unverified().to_vec(),
    }

    /// A robot file as it was understood, in a document.
    struct CheckedRobot of (robot: &Robot, has_stiffness: bool) {
        /// The arm.
        robot: RobotFigures = robot.into(),
        /// Whether the file states its stiffness.
        has_stiffness: bool = has_stiffness,
    }
}

/// What `stead check --json` prints of a robot file.
pub fn robot_json(robot: &Robot, has_stiffness: bool, notes: &[Note], inputs: &[InputFile]) -> Value {
    Document::new(inputs).notes(notes).with(CheckedRobot::of(robot, has_stiffness))
}
