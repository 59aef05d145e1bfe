//! `page-data.json`: what a page shows beyond the tables beside it.

use super::base64::base64;
use super::map_data;
use super::moves::moves;
use super::packed::singles;
use super::setup::{external_axes, part_turns};
use super::shapes::{BodyFrame, BodyMesh, bodies};
use super::surroundings::surroundings;
use crate::document::Document;
use crate::units::Unit;
use nalgebra::Vector3;
use serde_json::{Value, json};
use stead_placement::criterion::Direction;
use stead_placement::feasibility::DeflectionMap;
use stead_placement::outcome::Case;
use stead_placement::problem::{Interval, Placement, Problem};
use stead_placement::settings::TransferSettings;
use stead_placement::setup::Setup;

/// A deflection map with the placement and the setup that it is of and the name of its table.
pub(crate) type MapOf<'a> = (Placed<'a>, &'a DeflectionMap, &'static str);

/// A placement with the setup of the cell.
pub(crate) type Placed<'a> = (&'a Placement, &'a Setup);

/// The content of `page-data.json`: robot, spindle, cell, limits and task of a problem, the joint angles of its maps, the moves between
/// segments of its plans, and the bodies that are drawn. Lists of numbers are in single precision, little endian, as Base64.
pub(crate) fn page_data(
    document: Document,
    command: &str,
    problem: &Problem,
    settings: &TransferSettings,
    plans: &[&Case],
    maps: &[MapOf<'_>],
) -> Value {
    let mut data = json!({
        "command": command,
        "robot": robot(problem),
        "spindle": {
            "rotation": rows(&problem.spindle.flange_from_tool.rotation),
            "xyz_mm": mm(&problem.spindle.flange_from_tool.translation),
        },
        "cell": {
            "x_mm": interval(&problem.cell.position[0]),
            "y_mm": interval(&problem.cell.position[1]),
            "z_mm": interval(&problem.cell.position[2]),
        },
        "limits": {
            "min_inverse_condition": problem.constraints.min_inverse_condition,
            "max_deflection_mm": problem.constraints.max_deflection.map(|limit| Unit::DEFLECTION_MM.number(limit)),
        },
        "criterion": {
            "direction": problem.criterion.direction().map(Direction::name),
            "aggregate": problem.criterion.aggregate.name(),
        },
        "task": task(problem),
        "maps": maps
            .iter()
            .map(|((placement, setup), map, table)| map_data::joints(&problem.in_setup(setup), placement, map, table))
            .collect::<Value>(),
        "bodies": bodies(problem).iter().map(body).collect::<Value>(),
        "surroundings": surroundings(problem).iter().map(body).collect::<Value>(),
        "external_axes": external_axes(problem),
        "part_turns": part_turns(problem, plans),
    });
    if let Some(moves) = moves(problem, settings, plans) {
        data["moves"] = moves;
    }
    document.with(data)
}

fn robot(problem: &Problem) -> Value {
    let row = |joint: &stead_model::robot::Joint| {
        json!({
            "alpha_deg": joint.alpha.to_degrees(),
            "a_mm": joint.a * 1e3,
            "d_mm": joint.d * 1e3,
            "min_deg": Unit::ANGLE_DEG.number(joint.min),
            "max_deg": Unit::ANGLE_DEG.number(joint.max),
        })
    };
    let mount = problem.robot.is_mounted().then(|| {
        let pose = problem.robot.cell_from_base();
        json!({ "rotation": rows(&pose.rotation), "xyz_mm": mm(&pose.translation) })
    });
    json!({
        "name": problem.robot.name(),
        "rows": problem.robot.joints().iter().map(row).collect::<Value>(),
        "mount": mount,
    })
}

/// Places, feeds and tool axes in the workpiece frame, and the time from each point to the next at the programmed feed.
fn task(problem: &Problem) -> Value {
    let points = problem.task.points();
    let all = |of: fn(&stead_model::task::PathPoint) -> Vector3<f64>, factor: f64| {
        singles(points.iter().flat_map(|point| <[f64; 3]>::from(of(point) * factor)))
    };
    let starts: Vec<usize> = problem.task.segments().iter().map(|segment| segment.start).collect();
    let step = |point: usize| {
        let time = if starts.contains(&point) { 0.0 } else { problem.step_time(point) };
        if time.is_finite() { time } else { 0.0 }
    };
    json!({
        "points": points.len(),
        "segments": starts.len(),
        "position_mm": all(|point| point.position, 1e3),
        "feed": all(|point| point.feed, 1.0),
        "axis": all(|point| point.axis, 1.0),
        "step_s": singles((0..points.len()).map(step)),
    })
}

/// Corners in 32767 steps from the middle of a mesh to its farthest side: `mm_per_step` each.
fn body(mesh: &BodyMesh) -> Value {
    let ends = |k: usize| {
        let values = mesh.positions.iter().map(|position| f64::from(position[k]));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        if low.is_finite() { (low, high) } else { (0.0, 0.0) }
    };
    let sides = [ends(0), ends(1), ends(2)];
    let middle = sides.map(|(low, high)| (low + high) / 2.0);
    let step = (sides.iter().map(|(low, high)| (high - low) / 2.0).fold(0.0, f64::max) / 32767.0).max(1e-12);
    let quantised = |position: &[f32; 3]| {
        [0, 1, 2].map(|k| ((f64::from(position[k]) - middle[k]) / step).round() as i16).map(i16::to_le_bytes)
    };
    let positions: Vec<u8> = mesh.positions.iter().flat_map(quantised).flatten().collect();
    let is_wide = mesh.positions.len() > usize::from(u16::MAX);
    let corners = mesh.triangles.iter().flatten();
    let triangles: Vec<u8> = if is_wide {
        corners.flat_map(|corner| corner.to_le_bytes()).collect()
    } else {
        corners.flat_map(|corner| (*corner as u16).to_le_bytes()).collect()
    };
    json!({
        "name": mesh.name,
        "frame": frame(mesh.frame),
        "color": mesh.color.map(|part| (f64::from(part) * 1e3).round() / 1e3),
        "is_illustration": mesh.is_illustration,
        "middle_mm": middle.map(|value| value * 1e3),
        "mm_per_step": step * 1e3,
        "positions": base64(&positions),
        "wide": is_wide,
        "triangles": base64(&triangles),
    })
}

fn frame(frame: BodyFrame) -> String {
    match frame {
        BodyFrame::Base => "base".to_owned(),
        BodyFrame::Link(number) => format!("link_{number}"),
        BodyFrame::Tool => "tool".to_owned(),
        BodyFrame::Workpiece => "workpiece".to_owned(),
        BodyFrame::Cell => "cell".to_owned(),
        BodyFrame::Axis(number) => format!("axis_{}", number + 1),
    }
}

pub(super) fn rows(rotation: &nalgebra::Matrix3<f64>) -> Value {
    (0..3).map(|row| json!([0, 1, 2].map(|column| rotation[(row, column)]))).collect()
}

pub(super) fn mm(vector: &Vector3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z].map(|value| value * 1e3)
}

fn interval(interval: &Interval) -> [f64; 2] {
    [interval.min, interval.max].map(|value| Unit::PLACE_MM.number(value))
}
