//! The file of surroundings of an imported arm.

use super::ImportedRobot;
use super::collision::{LinkShape, LinkShapes};
use super::rows::rounded;
use super::visual::LinkVisual;
use super::xml::one_line;
use crate::mesh::MeshUnit;
use crate::written::relative;
use nalgebra::Vector3;
use std::fmt::Write;
use std::path::Path;
use stead_cell::Solid;
use stead_model::robot::Pose;
use stead_numerics::rotation::{quaternion_from_rotation, zyx_from_rotation};
use toml::Value;

/// The text of a file of surroundings at a path, from whose folder mesh files are named.
pub(super) fn text(robot: &ImportedRobot, links: &LinkShapes, file: &Path) -> String {
    let visuals = &robot.link_visuals;
    let mut text = format!(
        "# The links of an arm, by `stead import robot --collision` from {}: its <collision> shapes in the frames of the rows.\n\
         # A run file takes it by surroundings = \"{}\"; fence, table and spindle are added beside it.\n",
        robot.name,
        one_line(&file.file_name().unwrap_or_default().to_string_lossy()),
    );
    if let Some(mount) = &robot.mount {
        let [yaw, pitch, roll] = zyx_from_rotation(&mount.rotation).map(|angle| rounded(angle.to_degrees()));
        let _ = writeln!(
            text,
            "\n# Where the robot stands by the fixed joints before link {}: the base frame of its rows in the cell frame, which is that\n\
             # of the root link, its z axis up. Of a robot that stands elsewhere, the shapes on \"base\" below move too.\n\
             [mount]\nxyz_mm = {}\nrpy_deg = {:?}",
            one_line(&robot.base_link),
            vector(&mount.translation),
            [roll, pitch, yaw]
        );
    }
    links.shapes.iter().for_each(|link| shape(&mut text, link, file));
    if !links.ignored.is_empty() {
        text.push_str(
            "\n# These touch in every posture tried, or at joint values zero of the URDF, or are near each other in \
             every posture.\n\
             [collision]\nignore = [\n",
        );
        for [a, b] in &links.ignored {
            let _ = writeln!(text, "    [{}, {}],", Value::from(a.as_str()), Value::from(b.as_str()));
        }
        text.push_str("]\n");
    }
    if !visuals.is_empty() {
        text.push_str("\n# What the links look like: drawn, and held against nothing.");
        visuals.iter().for_each(|of| visual(&mut text, of, file));
    }
    text
}

fn visual(text: &mut String, of: &LinkVisual, out: &Path) {
    let visual = &of.visual;
    let name = Value::from(visual.name.as_str());
    let _ = writeln!(text, "\n[[visual]]\nname = {name}\nattached = \"{}\"", visual.attached);
    let _ = writeln!(text, "mesh = {}", mesh_file(&of.file, of.unit, out));
    if let Some(color) = visual.color {
        let _ = writeln!(text, "color = {:?}", color.map(|part| (part * 1e3).round() / 1e3));
    }
    place(text, &visual.pose);
}

/// A mesh file as it is named from the folder of a file, with the line of its unit behind it.
fn mesh_file(mesh: &Path, unit: MeshUnit, out: &Path) -> String {
    let name = Value::from(relative(out.parent().unwrap_or(Path::new("")), mesh));
    format!("{name}{}", if unit == MeshUnit::Metre { "\nunit = \"m\"" } else { "" })
}

fn place(text: &mut String, pose: &Pose<f64>) {
    let _ = writeln!(text, "xyz_mm = {}", vector(&pose.translation));
    let turn = quaternion_from_rotation(&pose.rotation).map(|value| (value * 1e15).round() / 1e15 + 0.0);
    if turn != [1.0, 0.0, 0.0, 0.0] {
        let _ = writeln!(text, "quaternion_wxyz = {turn:?}");
    }
}

/// Writing to a text cannot fail.
fn shape(text: &mut String, of: &LinkShape, out: &Path) {
    let shape = &of.shape;
    let _ =
        writeln!(text, "\n[[shape]]\nname = {}\nattached = \"{}\"", Value::from(shape.name.as_str()), shape.attached);
    let round = |radius: f64, length: f64| format!("{{ radius = {:?}, length = {:?} }}", mm(radius), mm(length));
    let _ = match &shape.solid {
        Solid::Box(edges) => writeln!(text, "box_mm = {}", vector(edges)),
        Solid::Cylinder { radius, length } => writeln!(text, "cylinder_mm = {}", round(*radius, *length)),
        Solid::Capsule { radius, length } => writeln!(text, "capsule_mm = {}", round(*radius, *length)),
        Solid::Hull(_) | Solid::Mesh(_) => {
            let key = if matches!(shape.solid, Solid::Hull(_)) { "hull" } else { "mesh" };
            let named = of.file.as_ref().map(|(path, unit)| mesh_file(path, *unit, out));
            writeln!(text, "{key} = {}", named.unwrap_or_default())
        }
    };
    place(text, &shape.pose);
}

/// A length in mm, to 1e-9 mm.
fn mm(value: f64) -> f64 {
    (value * 1e12).round() / 1e9 + 0.0
}

fn vector(value: &Vector3<f64>) -> String {
    format!("{:?}", [value.x, value.y, value.z].map(mm))
}
