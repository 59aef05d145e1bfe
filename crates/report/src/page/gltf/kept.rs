//! The scene of a results folder, from the files of its run alone: so `stead page` makes the same bytes as the run.

use super::super::PageError;
use super::super::content::{DATA, json_file, scene_files};
use super::super::packed::bytes_of;
use super::super::shapes::{BodyFrame, BodyMesh, block_of};
use super::super::table::Table;
use super::motion::{Motion, SHORTEST_MOVE, Stop, UNKNOWN_MOVE};
use super::scene::{Cell, glb};
use crate::Files;
use crate::placement::setup::{column, unit, word};
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_model::robot::Pose;
use stead_planning::course::{MovePart, PlaceOnMove};
use stead_problem::problem::Placement;

/// `cell.glb` of the files of a run, `page-data.json` among them: its first plan.
pub(crate) fn scene(files: &Files) -> Result<Vec<u8>, PageError> {
    let bytes = |name: &str| {
        let found = files.iter().find(|(file, _)| file == name).map(|(_, bytes)| bytes.as_slice());
        found.ok_or_else(|| PageError::file(name, "is missing"))
    };
    let data = json_file(DATA, bytes(DATA)?)?;
    let command = data["command"].as_str().unwrap_or_default();
    let [document, plan] =
        scene_files(command).ok_or_else(|| PageError::data("command", "names no command that leaves a page"))?;
    let document = json_file(document, bytes(document)?)?;
    let plan = Table::read(plan, bytes(plan)?)?;
    // `stead place` states its cases, `stead score` one placement with its plans.
    let (case, driven) = match &document["cases"][0] {
        Value::Null => (&document, &document["best"]),
        case => (case, case),
    };
    let turn = &data["part_turns"][0];
    let turn = if turn.is_null() { Matrix3::identity() } else { rotation(turn, "part_turns")? };
    let mut cell_from_workpiece = placement(case)?.base_from_workpiece();
    cell_from_workpiece.rotation *= turn;
    let mount = &data["robot"]["mount"];
    let axes = external_axes(&data["external_axes"])?;
    let read = |key: &str| {
        let list = data[key].as_array().map_or(&[][..], Vec::as_slice);
        list.iter().map(body).collect::<Option<Vec<_>>>().ok_or_else(bad_bodies)
    };
    let mut bodies = read("bodies")?;
    // Collision shapes of the arm enclose the bodies of it.
    bodies.extend(read("surroundings")?.into_iter().filter(|body| !matches!(body.frame, BodyFrame::Link(_))));
    let positions = vectors(&data["task"]["position_mm"], 1e-3);
    if !bodies.iter().any(|body| body.frame == BodyFrame::Workpiece) {
        bodies.push(block_of(&positions, &vectors(&data["task"]["axis"], 1.0)));
    }
    let ways = ways(&data["moves"][0], &axes).ok_or_else(|| PageError::data("moves", NOT_OURS))?;
    let cell = Cell {
        name: data["robot"]["name"].as_str().unwrap_or_default(),
        rows: rows(&data["robot"]["rows"])?,
        flange_from_tool: pose(&data["spindle"], "spindle")?,
        mount: if mount.is_null() { Pose::identity() } else { pose(mount, "mount")? },
        axes: &axes,
        cell_from_workpiece,
        bodies: &bodies,
        motion: &motion(&plan, driven, &axes, &positions, &singles(&data["task"]["step_s"]), &ways)?,
    };
    Ok(glb(&cell))
}

/// What is wrong with an entry that is there.
const NOT_OURS: &str = "is not as stead writes it";

fn bad_bodies() -> PageError {
    PageError::data("bodies", NOT_OURS)
}

/// Numbers in single precision as Base64.
fn singles(value: &Value) -> Vec<f64> {
    let bytes = bytes_of(value.as_str().unwrap_or_default());
    bytes.chunks_exact(4).map(|four| f64::from(f32::from_le_bytes([four[0], four[1], four[2], four[3]]))).collect()
}

fn vectors(value: &Value, factor: f64) -> Vec<Vector3<f64>> {
    singles(value).chunks_exact(3).map(|three| Vector3::new(three[0], three[1], three[2]) * factor).collect()
}

fn number(value: &Value, key: &str) -> Result<f64, PageError> {
    value[key].as_f64().ok_or_else(|| PageError::data(key, "is missing"))
}

/// Three numbers of a list.
fn triple(value: &Value) -> Option<Vector3<f64>> {
    Some(Vector3::new(value[0].as_f64()?, value[1].as_f64()?, value[2].as_f64()?))
}

/// The frames of the rows at joint angle zero: `Rx(alpha) Tx(a) Tz(d)`.
fn rows(list: &Value) -> Result<[Pose<f64>; 6], PageError> {
    let mut rows = [Pose::identity(); 6];
    for (row, value) in rows.iter_mut().zip(list.as_array().into_iter().flatten()) {
        let [alpha, a, d] = ["alpha_deg", "a_mm", "d_mm"].map(|key| number(value, key));
        let (sine, cosine) = libm::sincos(alpha?.to_radians());
        let (a, d) = (a? / 1e3, d? / 1e3);
        row.rotation = Matrix3::new(1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine);
        row.translation = Vector3::new(a, -sine * d, cosine * d);
    }
    Ok(rows)
}

fn pose(value: &Value, key: &str) -> Result<Pose<f64>, PageError> {
    let translation = triple(&value["xyz_mm"]).ok_or_else(|| PageError::data(key, NOT_OURS))? / 1e3;
    Ok(Pose { rotation: rotation(&value["rotation"], key)?, translation })
}

/// A rotation by rows.
fn rotation(value: &Value, key: &str) -> Result<Matrix3<f64>, PageError> {
    let rows = [0, 1, 2].map(|row| triple(&value[row]));
    let [Some(first), Some(second), Some(third)] = rows else { return Err(PageError::data(key, NOT_OURS)) };
    Ok(Matrix3::from_rows(&[first.transpose(), second.transpose(), third.transpose()]))
}

fn external_axes(list: &Value) -> Result<Vec<ExternalAxis>, PageError> {
    list.as_array()
        .into_iter()
        .flatten()
        .map(|value| external_axis(value).ok_or_else(|| PageError::data("external_axes", NOT_OURS)))
        .collect()
}

fn external_axis(value: &Value) -> Option<ExternalAxis> {
    Some(ExternalAxis {
        name: value["name"].as_str()?.to_owned(),
        kind: [AxisKind::Rail, AxisKind::Turntable].into_iter().find(|kind| value["kind"] == word(*kind))?,
        carries: if value["carries"] == "robot" { Carried::Robot } else { Carried::Workpiece },
        direction: triple(&value["direction"])?,
        point: triple(&value["point_mm"])? / 1e3,
        // What it may do is not requested: the plan has what it does.
        min: 0.0,
        max: 0.0,
        max_speed: None,
        axis_use: AxisUse::Continuous,
    })
}

fn placement(case: &Value) -> Result<Placement, PageError> {
    let value = &case["placement"];
    let [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(|key| number(value, key));
    Ok(Placement::from_mm_deg([x?, y?, z?], number(value, "yaw_deg")?))
}

/// A body with its corners in steps from its middle.
fn body(value: &Value) -> Option<BodyMesh> {
    let (middle, step) = (triple(&value["middle_mm"])?, value["mm_per_step"].as_f64()?);
    let steps = bytes_of(value["positions"].as_str()?);
    let steps: Vec<f64> = steps.chunks_exact(2).map(|two| f64::from(i16::from_le_bytes([two[0], two[1]]))).collect();
    let position = |three: &[f64]| [0, 1, 2].map(|k| ((middle[k] + three[k] * step) / 1e3) as f32);
    let corners = bytes_of(value["triangles"].as_str()?);
    let corners: Vec<u32> = if value["wide"].as_bool()? {
        corners.chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect()
    } else {
        corners.chunks_exact(2).map(|two| u32::from(u16::from_le_bytes([two[0], two[1]]))).collect()
    };
    let positions: Vec<[f32; 3]> = steps.chunks_exact(3).map(position).collect();
    if corners.iter().any(|corner| *corner as usize >= positions.len()) {
        return None;
    }
    let color = triple(&value["color"])?;
    Some(BodyMesh {
        name: value["name"].as_str()?.to_owned(),
        frame: frame(value["frame"].as_str()?)?,
        color: [color.x as f32, color.y as f32, color.z as f32],
        positions,
        triangles: corners.chunks_exact(3).map(|three| [three[0], three[1], three[2]]).collect(),
        is_illustration: value["is_illustration"].as_bool()?,
    })
}

fn frame(word: &str) -> Option<BodyFrame> {
    match word {
        "base" => Some(BodyFrame::Base),
        "tool" => Some(BodyFrame::Tool),
        "workpiece" => Some(BodyFrame::Workpiece),
        "cell" => Some(BodyFrame::Cell),
        word => match word.split_once('_')? {
            ("link", link) => link.parse().ok().filter(|link| (1..=6).contains(link)).map(BodyFrame::Link),
            ("axis", number) => number.parse().ok().and_then(|number: u8| number.checked_sub(1)).map(BodyFrame::Axis),
            _ => None,
        },
    }
}

/// The ways of the moves of a plan, in their order; empty where a move is straight in joint space.
fn ways(list: &Value, axes: &[ExternalAxis]) -> Option<Vec<Vec<MovePart>>> {
    let one = |value: &Value| if value.is_null() { Some(Vec::new()) } else { way(value, axes) };
    list.as_array().into_iter().flatten().map(one).collect()
}

fn way(value: &Value, axes: &[ExternalAxis]) -> Option<Vec<MovePart>> {
    let (joints, positions) = (singles(&value["joints_deg"]), singles(&value["axes"]));
    let place = |number: usize| {
        let joints = joints.get(6 * number..6 * (number + 1))?;
        let positions = positions.get(axes.len() * number..axes.len() * (number + 1))?;
        let axes = positions.iter().zip(axes).map(|(at, axis)| at / unit(axis.kind).factor).collect();
        Some(PlaceOnMove { joints: std::array::from_fn(|j| joints[j].to_radians()), axes })
    };
    let mut first = 0;
    let parts = value["steps"].as_array()?.iter().zip(value["time_shares"].as_array()?);
    let part = |(steps, share): (&Value, &Value)| {
        let last = first + steps.as_u64()? as usize;
        let places = (first..=last).map(place).collect::<Option<Vec<_>>>()?;
        first = last;
        Some(MovePart { places, time_share: share.as_f64()? })
    };
    parts.map(part).collect()
}

/// The plan at the feed that is held, with the times of its moves between segments: as long as its document says.
pub(super) fn motion(
    plan: &Table<'_>,
    driven: &Value,
    axes: &[ExternalAxis],
    positions: &[Vector3<f64>],
    steps: &[f64],
    ways: &[Vec<MovePart>],
) -> Result<Motion, PageError> {
    let numbers = |name: &str| plan.numbers(name);
    let angles = [1, 2, 3, 4, 5, 6].map(|joint| numbers(&format!("theta{joint}_deg")));
    let [one, two, three, four, five, six] = angles;
    let angles = [one?, two?, three?, four?, five?, six?];
    let along = |(number, axis): (usize, &ExternalAxis)| column_of(plan, number, axis.kind);
    let along = axes.iter().enumerate().map(along).collect::<Result<Vec<_>, _>>()?;
    let (segments, scores) = (numbers("segment")?, numbers("score_mm")?);
    let programmed: f64 = steps.iter().sum();
    let scale = driven["cutting_s"].as_f64().filter(|_| programmed > 0.0).map_or(1.0, |cutting| cutting / programmed);
    let mut time = 0.0;
    let stops = (0..plan.len()).map(|point| {
        let segment = segments[point] as usize;
        let mut way = Vec::new();
        if point > 0 && segments[point - 1] == segments[point] {
            // A turn of the tool in place has no time of its own.
            let step = steps.get(point).copied().filter(|step| *step > 0.0);
            time += step.map_or(UNKNOWN_MOVE, |step| step * scale);
        } else if point > 0 {
            let number = (segments[point - 1] as usize).saturating_sub(1);
            way = ways.get(number).cloned().unwrap_or_default();
            let duration = driven["transfers"][number]["duration_s"].as_f64();
            time += duration.unwrap_or(UNKNOWN_MOVE).max(SHORTEST_MOVE);
        }
        Stop {
            joints: std::array::from_fn(|joint| angles[joint][point].to_radians()),
            axes: along.iter().map(|positions| positions[point]).collect(),
            position: positions.get(point).copied().unwrap_or_default(),
            segment,
            score: scores[point] / 1e3,
            time,
            way,
        }
    });
    Ok(Motion { name: "best plan".to_owned(), stops: stops.collect() })
}

/// The positions of an external axis along a plan. m or rad
fn column_of(plan: &Table<'_>, number: usize, kind: AxisKind) -> Result<Vec<f64>, PageError> {
    let mut positions = plan.numbers(&column(number, kind))?;
    positions.iter_mut().for_each(|at| *at /= unit(kind).factor);
    Ok(positions)
}
