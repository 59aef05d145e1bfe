//! Where the tool has to be after every move of a program: from the task, the placement and beta, or from the corrected
//! path.

use super::super::transfer_paths::TransferPaths;
use super::super::{corrected, motion};
use super::geometry::{Frame, Matrix, about_z, cross, flange, length, seen};
use std::path::Path;
use stead_disk::input::InputError;
use stead_model::robot::Pose;
use stead_model::task::PathPoint;
use stead_planning::transfer_path::TransferPath;
use stead_problem::problem::{Placement, Problem};
use stead_runs::plan::PlacedPlan;

/// One move as it has to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Expected {
    pub segment: usize,
    /// The path point, from 0, at which or behind which the tool is, or on a way between segments where the external
    /// axes are those of.
    pub point: usize,
    /// Whether all joints move at once.
    pub is_joint: bool,
    /// Whether the tool is retracted.
    pub is_retracted: bool,
    /// The tool in the base frame.
    pub tool: Frame,
    /// Angles that those of the arm are near to. rad
    pub near: [f64; 6],
    /// Where the external axes are. mm and deg
    pub external: [Option<f64>; 6],
    /// Speed of the tool, for moves on lines. mm/s
    pub feed: f64,
    /// Whether the next move may begin before this one has arrived.
    pub is_blended: bool,
}

/// A frame of the model, in mm.
pub(super) fn frame(pose: &Pose<f64>) -> Frame {
    let turn = std::array::from_fn(|row| std::array::from_fn(|column| pose.rotation[(row, column)]));
    Frame { turn, origin: [0, 1, 2].map(|axis| pose.translation[axis] * 1e3) }
}

/// The frame that is placed, in the base frame with all external axes at zero.
pub(super) fn workpiece(placement: &Placement) -> Frame {
    let Placement { x, y, z, yaw } = *placement;
    Frame { turn: about_z(yaw), origin: [x, y, z].map(|m| m * 1e3) }
}

/// All moves of a program with these ways between segments, and this retraction where there is none (mm).
///
/// # Errors
/// [`InputError`] for a corrected path that cannot be read.
pub(super) fn moves(
    problem: &Problem,
    plan: &PlacedPlan,
    transfer_paths: &TransferPaths,
    corrected: Option<&Path>,
    approach: f64,
) -> Result<Vec<Expected>, InputError> {
    let tools = tools(problem, plan, corrected)?;
    let (mounted, stand) = (frame(&problem.spindle.flange_from_tool), frame(&problem.robot.cell_from_base()));
    let feeds = feeds(problem);
    let mut moves = Vec::new();
    for (number, range) in problem.task.segments().iter().enumerate() {
        let at = |point: usize, is_joint: bool, by: f64| {
            let (tool, near) = tools[point];
            // The tool's z axis points to the workpiece.
            let tool = tool.of(&Frame::shift([0.0, 0.0, -by]));
            let external = motion::external_at(problem, point);
            let is_inside = point > range.start && point + 1 < range.end;
            Expected {
                segment: number + 1,
                point,
                is_joint,
                is_retracted: by > 0.0,
                tool,
                near,
                external,
                feed: feeds[point],
                is_blended: is_inside && !is_joint && by == 0.0,
            }
        };
        let has_approach = approach > 0.0;
        let via = |way: &TransferPath, place: usize, point: usize| {
            let near = way.joints[place];
            let tool = stand.of(&flange(problem.robot.joints(), &near)).of(&mounted);
            Expected { near, tool, is_retracted: true, is_blended: false, ..at(point, !way.is_along_axis(place), 0.0) }
        };
        let is_at_first = if let Some(way) = transfer_paths.free_to(number) {
            let end = way.joints.len() - 1;
            for place in 1 + usize::from(way.along_axis[0])..end {
                let point = if place < way.axes_from { range.start - 1 } else { range.start };
                moves.push(via(way, place, point));
            }
            moves.push(at(range.start, !way.is_along_axis(end), 0.0));
            true
        } else {
            moves.push(at(range.start, true, approach));
            !has_approach
        };
        moves.extend(range.clone().skip(usize::from(is_at_first)).map(|point| at(point, false, 0.0)));
        if let Some(way) = transfer_paths.free_from(number) {
            moves.extend(way.along_axis[0].then(|| via(way, 1, range.end - 1)));
        } else if has_approach {
            moves.push(at(range.end - 1, false, approach));
        }
    }
    Ok(moves)
}

/// The tool in the base frame at every path point, and the joint angles of the plan (rad): of the task or, where they
/// are corrected, of the commands.
fn tools(problem: &Problem, plan: &PlacedPlan, corrected: Option<&Path>) -> Result<Vec<(Frame, [f64; 6])>, InputError> {
    let placed = workpiece(&plan.placement);
    let points = problem.task.points().iter().enumerate();
    let mut tools: Vec<(Frame, [f64; 6])> = points
        .zip(plan.betas.iter().zip(&plan.points))
        .map(|((number, point), (beta, row))| {
            let seen = seen(&problem.external_axes, &motion::external_at(problem, number));
            (seen.of(&placed).of(&tool_at(point, *beta)), row.joints)
        })
        .collect();
    let (mounted, stand) = (frame(&problem.spindle.flange_from_tool), frame(&problem.robot.cell_from_base()));
    if let Some(file) = corrected {
        for (tool, command) in tools.iter_mut().zip(corrected::printed_commands(file)?) {
            if command.is_corrected {
                let joints = command.joints.map(f64::to_radians);
                let turn = stand.of(&flange(problem.robot.joints(), &joints)).of(&mounted).turn;
                *tool = (Frame { turn, origin: command.position }, joints);
            }
        }
    }
    Ok(tools)
}

/// The feed of the tip to each path point, in mm/s: what the task states at it, for the first of a segment what it
/// states at the next, or the run's; times the way of the tip over that of the point that the tool touches.
fn feeds(problem: &Problem) -> Vec<f64> {
    let path = problem.task.path();
    let of_segment = |range: &std::ops::Range<usize>| {
        let points: Vec<usize> = range.clone().collect();
        let first = points.get(1).or(points.first()).copied();
        first.into_iter().chain(points.into_iter().skip(1)).collect::<Vec<usize>>()
    };
    let requested = path.segments().iter().flat_map(of_segment);
    let upright = problem.task.upright().points();
    let share = |point: usize| {
        let way = |points: &[PathPoint]| (points[point].position - points[point - 1].position).norm();
        let is_first = path.segments().iter().any(|range| range.start == point);
        if is_first || way(upright) < 1e-9 { 1.0 } else { way(path.points()) / way(upright) }
    };
    requested.map(|point| path.feed(point).unwrap_or(problem.redundancy.feed) * 1e3 * share(point)).collect()
}

/// The tool at a path point in the workpiece frame: z against the tool axis, x at beta from the feed towards the left
/// of it.
fn tool_at(point: &PathPoint, beta: f64) -> Frame {
    let numbers = |v: &nalgebra::Vector3<f64>| [v.x, v.y, v.z];
    let (axis, feed) = (numbers(&point.axis), numbers(&point.feed));
    let left = cross(&axis, &feed);
    let size = length(&left);
    let left = left.map(|v| v / size);
    let ahead = cross(&left, &axis);
    let (s, c) = libm::sincos(beta);
    let x: [f64; 3] = std::array::from_fn(|k| c * ahead[k] + s * left[k]);
    let z = axis.map(|v| -v);
    let y = cross(&z, &x);
    let turn: Matrix = std::array::from_fn(|row| [x[row], y[row], z[row]]);
    Frame { turn, origin: numbers(&point.position).map(|m| m * 1e3) }
}
