//! The file of surroundings of an imported arm.

use super::ImportedRobot;
use super::collision::{LinkShape, LinkShapes};
use super::rows::rounded;
use super::visual::LinkVisual;
use super::xml::one_line;
use crate::mesh::MeshUnit;
use crate::written::relative;
use nalgebra::Vector3;
use std::path::Path;
use stead_cell::{Attachment, Shape, Solid, Visual};
use stead_disk::template::{filled, shown_if};
use stead_model::robot::Pose;
use stead_numerics::rotation::{quaternion_from_rotation, zyx_from_rotation};
use toml::Value;

/// The text of a file of surroundings at a path, from whose folder mesh files are named.
pub(super) fn text(robot: &ImportedRobot, links: &LinkShapes, file: &Path) -> String {
    let joined = |parts: Vec<String>| {
        let all = parts.join("\n");
        (!all.is_empty()).then(|| all.trim_end_matches('\n').to_owned())
    };
    let shapes = links.shapes.iter().map(|link| shape(link, file)).collect();
    let visuals = robot.link_visuals.iter().map(|of| visual(of, file)).collect();
    let name = |name: &String| Value::from(name.as_str());
    let ignored = links.ignored.iter().map(|[a, b]| format!("    [{}, {}],", name(a), name(b))).collect();
    let angles = robot.mount.map(|mount| zyx_from_rotation(&mount.rotation).map(|angle| rounded(angle.to_degrees())));
    filled(
        include_str!("cell_text.toml"),
        &[
            ("robot", Some(robot.name.clone())),
            ("file", Some(one_line(&file.file_name().unwrap_or_default().to_string_lossy()))),
            ("stands", shown_if(robot.mount.is_some())),
            ("base", Some(one_line(&robot.base_link))),
            ("xyz", robot.mount.map(|mount| vector(&mount.translation))),
            ("rpy", angles.map(|[yaw, pitch, roll]| format!("{:?}", [roll, pitch, yaw]))),
            ("shapes", joined(shapes)),
            ("touch", shown_if(!links.ignored.is_empty())),
            ("ignored", joined(ignored)),
            ("drawn", shown_if(!robot.link_visuals.is_empty())),
            ("visuals", joined(visuals)),
        ],
    )
}

fn visual(of: &LinkVisual, out: &Path) -> String {
    let Visual { name, attached, pose, color, .. } = &of.visual;
    let color = color.map(|color| format!("{:?}", color.map(|part| (part * 1e3).round() / 1e3)));
    let own =
        [("table", Some("visual".to_owned())), ("mesh", Some(mesh_file(&of.file, of.unit, out))), ("color", color)];
    part(name, *attached, pose, own)
}

/// A mesh file as it is named from the folder of a file, with the line of its unit behind it.
fn mesh_file(mesh: &Path, unit: MeshUnit, out: &Path) -> String {
    let name = Value::from(relative(out.parent().unwrap_or(Path::new("")), mesh));
    format!("{name}{}", if unit == MeshUnit::Metre { "\nunit = \"m\"" } else { "" })
}

fn shape(of: &LinkShape, out: &Path) -> String {
    let Shape { name, attached, solid, pose } = &of.shape;
    let round = |radius: f64, length: f64| format!("{{ radius = {:?}, length = {:?} }}", mm(radius), mm(length));
    let mesh = || of.file.as_ref().map(|(path, unit)| mesh_file(path, *unit, out)).unwrap_or_default();
    let (key, form) = match solid {
        Solid::Box(edges) => ("box", vector(edges)),
        Solid::Cylinder { radius, length } => ("cylinder", round(*radius, *length)),
        Solid::Capsule { radius, length } => ("capsule", round(*radius, *length)),
        Solid::Hull(_) => ("hull", mesh()),
        Solid::Mesh(_) => ("mesh", mesh()),
    };
    part(name, *attached, pose, [("table", Some("shape".to_owned())), (key, Some(form))])
}

/// A table of a shape or a visual, with what is its own.
fn part(
    name: &str,
    attached: Attachment,
    pose: &Pose<f64>,
    own: impl IntoIterator<Item = (&'static str, Option<String>)>,
) -> String {
    let turn = quaternion_from_rotation(&pose.rotation).map(|value| (value * 1e15).round() / 1e15 + 0.0);
    let mut holes = vec![
        ("name", Some(Value::from(name).to_string())),
        ("attached", Some(attached.to_string())),
        ("xyz", Some(vector(&pose.translation))),
        ("turn", (turn != [1.0, 0.0, 0.0, 0.0]).then(|| format!("{turn:?}"))),
    ];
    holes.extend(own);
    filled(include_str!("cell_part.toml"), &holes)
}

/// A length in mm, to 1e-9 mm.
fn mm(value: f64) -> f64 {
    (value * 1e12).round() / 1e9 + 0.0
}

fn vector(value: &Vector3<f64>) -> String {
    format!("{:?}", [value.x, value.y, value.z].map(mm))
}
