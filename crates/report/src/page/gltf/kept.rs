//! The scene of a results folder, from the files of its run alone: so `stead page` makes the same bytes as the run.

use super::super::PageError;
use super::super::base64::bytes_of;
use super::super::content::{DATA, json_file, scene_files};
use super::super::shapes::{BodyFrame, BodyMesh, block_of};
use super::super::table::Table;
use super::motion::{Motion, SHORTEST_MOVE, Stop, UNKNOWN_MOVE};
use super::{Cell, glb};
use crate::Files;
use nalgebra::{Matrix3, Vector3};
use serde_json::Value;
use stead_model::robot::Pose;
use stead_placement::problem::Placement;

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
    let base_from_workpiece = placement(case)?.base_from_workpiece();
    let mut bodies =
        data["bodies"].as_array().into_iter().flatten().map(body).collect::<Option<Vec<_>>>().ok_or_else(bad_bodies)?;
    bodies.push(block_of(&vectors(&data["task"]["position_mm"], 1e-3), &vectors(&data["task"]["axis"], 1.0)));
    let cell = Cell {
        name: data["robot"]["name"].as_str().unwrap_or_default(),
        rows: rows(&data["robot"]["rows"])?,
        flange_from_tool: spindle(&data["spindle"])?,
        base_from_workpiece,
        bodies: &bodies,
        motion: &motion(&plan, driven, &singles(&data["task"]["step_s"]))?,
    };
    Ok(glb(&cell))
}

fn bad_bodies() -> PageError {
    PageError::data("bodies", "are not as stead writes them")
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

fn spindle(value: &Value) -> Result<Pose<f64>, PageError> {
    let rows = [0, 1, 2].map(|row| triple(&value["rotation"][row]));
    let ([Some(first), Some(second), Some(third)], Some(place)) = (rows, triple(&value["xyz_mm"])) else {
        return Err(PageError::data("spindle", "is not as stead writes it"));
    };
    let rotation = Matrix3::from_rows(&[first.transpose(), second.transpose(), third.transpose()]);
    Ok(Pose { rotation, translation: place / 1e3 })
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
        word => word.strip_prefix("link_")?.parse().ok().filter(|link| (1..=6).contains(link)).map(BodyFrame::Link),
    }
}

/// The plan at the feed that is held, with the times of its moves between segments: as long as its document says.
pub(super) fn motion(plan: &Table, driven: &Value, steps: &[f64]) -> Result<Motion, PageError> {
    let column = |name: &str| plan.numbers(name);
    let angles = [1, 2, 3, 4, 5, 6].map(|joint| column(&format!("theta{joint}_deg")));
    let [one, two, three, four, five, six] = angles;
    let angles = [one?, two?, three?, four?, five?, six?];
    let places = [column("x_mm")?, column("y_mm")?, column("z_mm")?];
    let (segments, scores) = (column("segment")?, column("score_mm")?);
    let programmed: f64 = steps.iter().sum();
    let scale = driven["cutting_s"].as_f64().filter(|_| programmed > 0.0).map_or(1.0, |cutting| cutting / programmed);
    let mut time = 0.0;
    let stops = (0..plan.len()).map(|point| {
        let segment = segments[point] as usize;
        if point > 0 && segments[point - 1] == segments[point] {
            // A turn of the tool in place has no time of its own.
            let step = steps.get(point).copied().filter(|step| *step > 0.0);
            time += step.map_or(UNKNOWN_MOVE, |step| step * scale);
        } else if point > 0 {
            let duration = driven["transfers"][(segments[point - 1] as usize).saturating_sub(1)]["duration_s"].as_f64();
            time += duration.unwrap_or(UNKNOWN_MOVE).max(SHORTEST_MOVE);
        }
        Stop {
            joints: std::array::from_fn(|joint| angles[joint][point].to_radians()),
            position: Vector3::new(places[0][point], places[1][point], places[2][point]) / 1e3,
            segment,
            score: scores[point] / 1e3,
            time,
        }
    });
    Ok(Motion { name: "best plan".to_owned(), stops: stops.collect() })
}
