//! Nodes, meshes and tracks of a scene.

use super::super::shapes::{BodyFrame, BodyMesh, shaded};
use super::axes::{self, AxisNodes};
use super::document::{
    Animation, Asset, Extras, Material, Mesh, Node, Primitive, Scene, Target, Writer, linear, single,
};
use super::motion::{Motion, quaternion, turn_about};
use super::path;
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;
use stead_model::external_axis::{Carried, ExternalAxis};
use stead_model::robot::Pose;

/// What a scene shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell<'a> {
    /// Its name.
    pub name: &'a str,
    /// The frame of each row at joint angle zero in that before it.
    pub rows: [Pose<f64>; 6],
    /// The tool frame in frame 6.
    pub flange_from_tool: Pose<f64>,
    /// The robot base frame on what carries the robot.
    pub mount: Pose<f64>,
    /// Rails and turntables.
    pub axes: &'a [ExternalAxis],
    /// The workpiece frame in the cell with all axes at zero.
    pub cell_from_workpiece: Pose<f64>,
    /// All shapes.
    pub bodies: &'a [BodyMesh],
    /// What the arm does.
    pub motion: &'a Motion,
}

/// A scene as the bytes of a `.glb` file.
pub fn glb(cell: &Cell) -> Vec<u8> {
    let mut writer = Writer::default();
    let root = writer.add_node(Node {
        name: "cell (z up)".to_owned(),
        rotation: Some(turn_about(&Vector3::x(), -FRAC_PI_2)),
        ..Node::default()
    });
    writer.document.scenes.push(Scene { name: cell.name.to_owned(), nodes: vec![root] });
    let axes = writer.add_axes(cell.axes, root);
    let on = |what: Carried| axes::last_of(cell.axes, &axes, what).unwrap_or(root);
    let base = writer.add_frame("base", &cell.mount, on(Carried::Robot));
    let joints = writer.add_arm(&cell.rows, base);
    let tool = writer.add_frame("tool", &cell.flange_from_tool, joints[5]);
    let workpiece = writer.add_frame("workpiece", &cell.cell_from_workpiece, on(Carried::Workpiece));
    for body in cell.bodies {
        let parent = match body.frame {
            BodyFrame::Cell => root,
            BodyFrame::Base => base,
            BodyFrame::Link(number) => joints[usize::from(number.clamp(1, 6)) - 1],
            BodyFrame::Tool => tool,
            BodyFrame::Workpiece => workpiece,
            BodyFrame::Axis(number) => axes.get(usize::from(number)).map_or(root, |axis| axis.frame),
        };
        writer.add_body(body, parent);
    }
    writer.add_path(&path::tubes(cell.motion), workpiece);
    writer.add_animation(cell, &joints, &axes);
    writer.finish()
}

/// How much of a body of the cell is seen: fences and walls stand before the robot.
const OPACITY: f32 = 0.25;

impl Writer {
    /// A node for a frame given in that of its parent.
    fn add_frame(&mut self, name: &str, parent_from_frame: &Pose<f64>, parent: usize) -> usize {
        let node = Node {
            name: name.to_owned(),
            translation: Some(single(&parent_from_frame.translation)),
            rotation: Some(quaternion(&parent_from_frame.rotation)),
            ..Node::default()
        };
        self.add_child(node, parent)
    }

    /// The nodes of the rows; returns those of the joints.
    fn add_arm(&mut self, rows: &[Pose<f64>; 6], base: usize) -> [usize; 6] {
        let mut parent = base;
        std::array::from_fn(|j| {
            let row = self.add_frame(&format!("row {}", j + 1), &rows[j], parent);
            // Animated nodes state their rotation, else viewers show what a node is at rest differently.
            let rest = Some([0.0, 0.0, 0.0, 1.0]);
            parent = self.add_child(Node { name: format!("joint {}", j + 1), rotation: rest, ..Node::default() }, row);
            parent
        })
    }

    fn add_body(&mut self, body: &BodyMesh, parent: usize) {
        let drawn = shaded(body);
        if drawn.triangles.is_empty() {
            return;
        }
        let [red, green, blue] = body.color.map(linear);
        let opacity = if body.frame == BodyFrame::Cell { OPACITY } else { 1.0 };
        let material = self.material(Material::new(&body.name, [red, green, blue, opacity], 0.1, 0.45));
        let primitive = Primitive::new(&mut self.buffer, &drawn, None, material);
        let extras = body.is_illustration.then_some(Extras { is_illustration: true });
        self.add_mesh(&body.name, primitive, extras, parent);
    }

    fn add_path(&mut self, tubes: &path::Tubes, parent: usize) {
        if tubes.mesh.triangles.is_empty() {
            return;
        }
        let material = self.material(Material::new("tool path by deflection", [1.0; 4], 0.0, 0.8));
        let primitive = Primitive::new(&mut self.buffer, &tubes.mesh, Some(&tubes.colors), material);
        self.add_mesh("tool path", primitive, None, parent);
    }

    fn add_mesh(&mut self, name: &str, primitive: Primitive, extras: Option<Extras>, parent: usize) {
        self.document.meshes.push(Mesh { name: name.to_owned(), primitives: vec![primitive] });
        let mesh = Some(self.document.meshes.len() - 1);
        self.add_child(Node { name: name.to_owned(), mesh, extras, ..Node::default() }, parent);
    }

    /// The number of a material: of one that looks the same where there is one.
    fn material(&mut self, material: Material) -> usize {
        let materials = &mut self.document.materials;
        if let Some(known) = materials.iter().position(|known| known.looks_like(&material)) {
            return known;
        }
        materials.push(material);
        materials.len() - 1
    }

    /// A track for each joint and each external axis.
    fn add_animation(&mut self, cell: &Cell, joints: &[usize; 6], axes: &[AxisNodes]) {
        let keys = cell.motion.keys();
        if keys.is_empty() {
            return;
        }
        let times: Vec<f32> = keys.iter().map(|key| key.time).collect();
        let input = self.buffer.times(&times);
        let mut animation = Animation { name: cell.motion.name.clone(), ..Animation::default() };
        for (joint, node) in joints.iter().enumerate() {
            let turns: Vec<[f32; 4]> = keys.iter().map(|key| turn_about(&Vector3::z(), key.joints[joint])).collect();
            animation.add(input, self.buffer.rotations(&turns), Target { node: *node, path: "rotation" });
        }
        for (number, (axis, nodes)) in cell.axes.iter().zip(axes).enumerate() {
            let positions = keys.iter().map(|key| key.axes.get(number).copied().unwrap_or(0.0));
            let (output, path) = axes::track(&mut self.buffer, axis, positions);
            animation.add(input, output, Target { node: nodes.moving, path });
        }
        self.document.animations.push(animation);
    }

    fn finish(self) -> Vec<u8> {
        let Self { mut document, buffer } = self;
        document.asset = Asset { version: "2.0", generator: concat!("stead ", env!("CARGO_PKG_VERSION")) };
        document.in_container(buffer)
    }
}
