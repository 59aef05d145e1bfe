//! The robot file of an imported arm.

use super::read::Urdf;
use super::rows::written;
use super::stiffness::Borrowed;
use super::xml::{one_line, quoted};
use super::{ImportedRobot, POSTURES};
use nalgebra::{Matrix3, Vector3};
use stead_disk::template::{filled, shown_if};
use stead_model::robot::{ControllerKind, Inertial, Pose};
use toml::Value;

/// The text of the robot file; `digest` is the SHA-256 digest of the URDF.
pub(super) fn text(robot: &ImportedRobot, urdf: &Urdf, digest: &str, borrowed: Option<&Borrowed>) -> String {
    let file = urdf.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let toml = |text: String| Value::from(text).to_string();
    let angles: Vec<String> = (0..6).map(|k| format!("#   {}", robot.angle(k))).collect();
    let joints: String = (0..6).map(|k| joint(robot, k, borrowed)).collect();
    let tip = &robot.flange_from_tip;
    let row = |k: usize| numbers(&[0, 1, 2].map(|column| tip.rotation[(k, column)]), 1e12);
    let is_turned = (tip.rotation - Matrix3::identity()).norm() > 1e-9;
    let [sum_min, sum_max] = [0, 1].map(|end| robot.linkage_sums_deg.map(|sums| format!("{:?}", sums[end])));
    let is_read = robot.controller.is_some();
    let counting = robot.controller.unwrap_or_else(|| robot.controller_of_urdf(ControllerKind::Kuka));
    let is_linked = robot.linkage_sums_deg.is_some();
    let states_level = is_read && (counting.is_level() || counting.kind == ControllerKind::Fanuc || is_linked);
    let offset = counting.offset.map(|offset| format!("{:?}", rounded(offset.to_degrees(), 1e9)));
    let root = counting.root_from_base.unwrap_or_else(Pose::identity).translation;
    filled(
        include_str!("robot_text.toml"),
        &[
            ("file", Some(quoted(&file))),
            ("digest", Some(digest.to_owned())),
            ("base", Some(quoted(&robot.base_link))),
            ("tip", Some(quoted(&robot.tip_link))),
            ("postures", Some(POSTURES.to_string())),
            ("position_mm", Some(format!("{:.1e}", robot.deviation.position_mm))),
            ("angle_deg", Some(format!("{:.1e}", robot.deviation.angle_deg))),
            ("angles", Some(angles.join("\n"))),
            ("link_from_base", Some(millimetres(&robot.link_from_base.translation))),
            ("flange_from_tip", Some(millimetres(&tip.translation))),
            ("turned", is_turned.then(|| format!("[{}, {}, {}]", row(0), row(1), row(2)))),
            ("has_bodies", shown_if(robot.bodies.is_some())),
            ("lender", borrowed.map(|borrowed| one_line(&borrowed.arm))),
            ("source_of_lender", borrowed.map(|borrowed| one_line(&borrowed.source))),
            ("is_lent", shown_if(borrowed.is_some())),
            ("is_unknown", shown_if(borrowed.is_none())),
            ("name", Some(toml(robot.name.clone()))),
            ("source", Some(toml(source(&file, borrowed)))),
            ("stiffness_like", borrowed.map(|borrowed| toml(one_line(&borrowed.arm)))),
            ("stiffness_model", borrowed.and_then(|borrowed| Some(toml(borrowed.model?.word().to_owned())))),
            ("joints", Some(joints.trim_end_matches('\n').to_owned())),
            ("is_linked", shown_if(is_linked)),
            ("sum_min", sum_min),
            ("sum_max", sum_max),
            ("is_read", shown_if(is_read)),
            ("is_assumed", shown_if(!is_read)),
            ("mark", Some(if is_read { "" } else { "# " }.to_owned())),
            ("kind", Some(counting.kind.word().to_owned())),
            ("sign", Some(format!("[{}]", counting.sign.map(|sign| sign.to_string()).join(", ")))),
            ("offset", Some(format!("[{}]", offset.join(", ")))),
            ("is_level", states_level.then(|| counting.is_level().to_string())),
            ("is_level_open", shown_if(is_linked && !states_level)),
            ("root", Some(millimetres(&root))),
        ],
    )
}

/// Where the numbers come from, on one line.
fn source(file: &str, borrowed: Option<&Borrowed>) -> String {
    let stiffness =
        borrowed.map(|lender| format!("; stiffness: that of another arm, {} ({})", lender.arm, lender.source));
    one_line(&format!("geometry, limits, speeds: URDF {file}{}", stiffness.unwrap_or_default()))
}

/// The table of a joint, from 0.
fn joint(robot: &ImportedRobot, k: usize, borrowed: Option<&Borrowed>) -> String {
    let (row, [min, max]) = (&robot.rows[k], robot.limits_deg[k]);
    let number = |value: f64| Some(format!("{value:?}"));
    let body = robot.bodies.as_ref().map(|bodies| &bodies[k]);
    let stiffness = borrowed.map_or("# stiffness_mnm_per_rad = ?", |borrowed| borrowed.lines[k].as_str());
    filled(
        include_str!("joint_text.toml"),
        &[
            ("joint", Some(one_line(&robot.joints[k]))),
            ("alpha", number(row.alpha_deg)),
            ("a", number(row.a_mm)),
            ("d", number(row.d_mm)),
            ("min", number(min)),
            ("max", number(max)),
            ("speed", robot.max_speed_deg_per_s[k].and_then(number)),
            ("stiffness", Some(stiffness.to_owned())),
            ("mass", body.and_then(|body| number(rounded(body.mass(), 1e9)))),
            ("centre", body.map(|body| numbers((body.centre() * 1e3).as_ref(), 1e6))),
            ("inertia", body.map(inertia)),
            ("has_body", shown_if(body.is_some())),
        ],
    )
}

fn inertia(body: &Inertial) -> String {
    let entry = |row: usize, column: usize| rounded(body.inertia()[(row, column)], 1e9);
    let [xx, yy, zz] = [0, 1, 2].map(|k| entry(k, k));
    let [xy, xz, yz] = [entry(0, 1), entry(0, 2), entry(1, 2)];
    format!("{{ xx = {xx:?}, yy = {yy:?}, zz = {zz:?}, xy = {xy:?}, xz = {xz:?}, yz = {yz:?} }}")
}

fn millimetres(point: &Vector3<f64>) -> String {
    let [x, y, z] = [point.x, point.y, point.z].map(|value| written(value * 1e3));
    format!("[{x:?}, {y:?}, {z:?}]")
}

fn numbers(values: &[f64; 3], scale: f64) -> String {
    let [x, y, z] = values.map(|value| rounded(value, scale));
    format!("[{x:?}, {y:?}, {z:?}]")
}

fn rounded(value: f64, scale: f64) -> f64 {
    (value * scale).round() / scale + 0.0
}
