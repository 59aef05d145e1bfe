//! What stands around the arm of a run, and on it.

use super::{Writer, about, angles, vector};
use nalgebra::{Point3, Rotation3, Vector3};
use std::fmt::Write as _;

impl Writer<'_> {
    /// Surroundings, and a mesh file where they name one.
    pub(super) fn shapes(&mut self) -> (String, Option<(&'static str, Vec<u8>)>) {
        let kind = self.of("shapes");
        if kind == "none" {
            return (String::new(), None);
        }
        let key = self.key;
        let mut text = String::new();
        let mut shape =
            |name: &str, attached: &str, form: &str, place: Vector3<f64>, turned: Option<Rotation3<f64>>| {
                let turned = turned.map_or(String::new(), |rotation| format!("{}\n", angles(key, &rotation)));
                let _ = writeln!(
                    text,
                    "[[shape]]\nname = \"{name}\"\nattached = \"{attached}\"\n{form}\nxyz_mm = {}\n{turned}",
                    vector(&(place * 1e3))
                );
            };
        let spindle = (self.tool * Point3::new(0.0, 0.0, -0.19)).coords;
        let along = self.tool.rotation.to_rotation_matrix();
        let mut mesh = None;
        if kind == "hull" {
            shape("spindle", "flange", "hull = \"body.obj\"\nunit = \"m\"", spindle, Some(along));
            mesh = Some(("body.obj", block_obj([0.07, 0.07, 0.18]).into_bytes()));
        } else {
            shape("spindle", "flange", "capsule_mm = { radius = 40.0, length = 120.0 }", spindle, Some(along));
        }
        if kind == "mesh" {
            shape("part", "workpiece", "mesh = \"part.stl\"", Vector3::new(0.0, 0.01, -0.052), None);
            mesh = Some(("part.stl", block_stl([170.0, 190.0, 80.0])));
        } else {
            shape("part", "workpiece", "box_mm = [170.0, 190.0, 80.0]", Vector3::new(0.0, 0.01, -0.052), None);
        }
        shape("table", "workpiece", "box_mm = [260.0, 260.0, 30.0]", Vector3::new(0.0, 0.0, -0.12), None);
        if kind == "cell" {
            let [_, _, upper, forearm] = self.sizes;
            let arm = format!("capsule_mm = {{ radius = 110.0, length = {:.1} }}", upper * 1e3);
            shape("upper arm", "link_2", &arm, Vector3::new(upper / 2.0, 0.0, 0.0), Some(about(Vector3::y(), 90.0)));
            let arm = format!("cylinder_mm = {{ radius = 90.0, length = {:.1} }}", forearm * 400.0);
            shape("forearm", "link_4", &arm, Vector3::new(0.0, 0.0, -0.55 * forearm), None);
            let floor = self.part.z - 0.55;
            shape("floor", "base", "box_mm = [5000.0, 5000.0, 60.0]", Vector3::new(self.part.x, 0.0, floor), None);
            shape(
                "fence",
                "base",
                "box_mm = [2500.0, 30.0, 1500.0]",
                Vector3::new(self.part.x, 1.4, floor + 0.8),
                Some(about(Vector3::z(), 8.0)),
            );
            shape(
                "clamp",
                "workpiece",
                "cylinder_mm = { radius = 12.0, length = 40.0 }",
                Vector3::new(0.1, 0.11, 0.01),
                None,
            );
        }
        if let Some(axis) = match self.of("axes") {
            axes if axes.starts_with("table")
                || axes == "held"
                || axes.ends_with("table") && axes.starts_with("rail") =>
            {
                Some("turn")
            }
            "tilt and turn" => Some("tilt"),
            "part rail continuous" => Some("slide"),
            _ => None,
        } {
            shape("carrier", axis, "box_mm = [300.0, 300.0, 40.0]", self.part - Vector3::z() * 0.29, None);
        }
        if kind == "cell" {
            let far = vector(&((self.part - Vector3::new(0.0, 1.6, 0.0)) * 1e3));
            let _ = writeln!(
                text,
                "[[keep_out]]\nname = \"door\"\npoints = [\"tool\", \"wrist\", \"elbow\"]\nhalf_space = {{ xyz_mm = {far}, normal = [0.0, -1.0, 0.0] }}\n"
            );
            let place = vector(&((self.part + Vector3::new(0.3, 0.5, 0.3)) * 1e3));
            let turned = angles(key, &about(Vector3::z(), 20.0));
            let _ = writeln!(
                text,
                "[[keep_out]]\nname = \"cabinet\"\npoints = [\"wrist\", \"elbow\"]\nbox_mm = [200.0, 200.0, 600.0]\nxyz_mm = {place}\n{turned}\n"
            );
        }
        let clearance = if kind == "cell" { 4.0 } else { 6.0 };
        let ignore = match kind {
            "cell" => {
                "[[\"link_2\", \"link_4\"], [\"table\", \"carrier\"], [\"part\", \"carrier\"], [\"floor\", \"link_2\"]]"
            }
            _ => "[[\"table\", \"carrier\"], [\"part\", \"carrier\"]]",
        };
        let has_carrier = text.contains("\"carrier\"");
        let ignore = if has_carrier {
            ignore.to_owned()
        } else {
            ignore
                .replace("[\"table\", \"carrier\"], [\"part\", \"carrier\"]", "")
                .replace(", ,", ",")
                .replace("[, ", "[")
        };
        let ignore = if ignore == "[]" { String::new() } else { format!("ignore = {ignore}\n") };
        let _ = writeln!(text, "[collision]\nclearance_mm = {clearance}\n{ignore}");
        (text, mesh)
    }
}

/// The corners of a block about the origin, and its twelve triangles, outwards.
fn block(edges: [f64; 3]) -> ([Vector3<f64>; 8], [[usize; 3]; 12]) {
    let corner =
        |k: usize| Vector3::from_fn(|axis, _| if k >> axis & 1 == 1 { edges[axis] / 2.0 } else { -edges[axis] / 2.0 });
    let triangles = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    (std::array::from_fn(corner), triangles)
}

fn block_stl(edges: [f64; 3]) -> Vec<u8> {
    let (corners, triangles) = block(edges);
    let mut bytes = vec![b' '; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0_u8; 12]);
        for corner in triangle {
            corners[corner].iter().for_each(|value| bytes.extend((*value as f32).to_le_bytes()));
        }
        bytes.extend([0_u8; 2]);
    }
    bytes
}

fn block_obj(edges: [f64; 3]) -> String {
    let (corners, triangles) = block(edges);
    let mut text = String::new();
    corners.iter().for_each(|c| {
        let _ = writeln!(text, "v {} {} {}", c.x, c.y, c.z);
    });
    triangles.iter().for_each(|t| {
        let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    });
    text
}
