//! The file of surroundings of an imported arm.

use super::ImportedRobot;
use super::collision::{LinkShape, LinkShapes};
use super::rows::rounded;
use super::visual::LinkVisual;
use super::xml::one_line;
use crate::mesh::MeshUnit;
use nalgebra::Vector3;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};
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

fn visual(text: &mut String, LinkVisual { visual, file, unit }: &LinkVisual, out: &Path) {
    let name = Value::from(visual.name.as_str());
    let _ = writeln!(text, "\n[[visual]]\nname = {name}\nattached = \"{}\"", visual.attached);
    let _ = writeln!(text, "mesh = {}", mesh_file(file, *unit, out));
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
fn shape(text: &mut String, LinkShape { shape, file }: &LinkShape, out: &Path) {
    let _ =
        writeln!(text, "\n[[shape]]\nname = {}\nattached = \"{}\"", Value::from(shape.name.as_str()), shape.attached);
    let round = |radius: f64, length: f64| format!("{{ radius = {:?}, length = {:?} }}", mm(radius), mm(length));
    let _ = match &shape.solid {
        Solid::Box(edges) => writeln!(text, "box_mm = {}", vector(edges)),
        Solid::Cylinder { radius, length } => writeln!(text, "cylinder_mm = {}", round(*radius, *length)),
        Solid::Capsule { radius, length } => writeln!(text, "capsule_mm = {}", round(*radius, *length)),
        Solid::Hull(_) | Solid::Mesh(_) => {
            let key = if matches!(shape.solid, Solid::Hull(_)) { "hull" } else { "mesh" };
            let (path, unit) =
                file.as_ref().map_or((Path::new(""), MeshUnit::Millimetre), |(path, unit)| (path.as_path(), *unit));
            writeln!(text, "{key} = {}", mesh_file(path, unit, out))
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

/// A path as it is named from a folder, with forward slashes; as it is where the two have nothing in common.
fn relative(folder: &Path, file: &Path) -> String {
    // The folder of a name alone is the working folder.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let (folder, file) = (absolute(folder), absolute(file));
    let common = folder.components().zip(file.components()).take_while(|(a, b)| a == b).count();
    let has_common = folder.components().take(common).any(|part| matches!(part, Component::RootDir));
    let named: PathBuf = if has_common {
        let up = folder.components().skip(common).map(|_| Component::ParentDir);
        up.chain(file.components().skip(common)).collect()
    } else {
        file
    };
    named.to_string_lossy().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_from_the_folder_of_the_file() {
        let named = |folder: &str, file: &str| relative(Path::new(folder), Path::new(file));
        assert_eq!(named("my", "my/meshes/a.stl"), "meshes/a.stl");
        assert_eq!(named("my/cells", "robots/a.stl"), "../../robots/a.stl");
        assert_eq!(named("", "a.stl"), "a.stl");
    }
}
