//! The tables `[[shape]]`, `[[keep_out]]` and `[collision]`, in a file of their own or in a run file.

use crate::mesh::MeshUnit;
use crate::mount::MountTable;
use crate::orientation::{OrientationKeys, Quaternion, orientation_keys};
use crate::place::Place;
use crate::quantity::Quantity;
use crate::scalars::{Word, words};
use crate::shapes::{Array, List, Matrix, Vector};
use crate::units::{Deg, Mm, NotNegative, Number, Positive};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use stead_cell::{Attachment, KeepOut, TrackedPoint, Visual, Zone};
use stead_disk::input::{InputError, InputFile};
use stead_disk::quote::garbles;
use stead_model::external_axis::ExternalAxis;
use stead_model::robot::Pose;

words!(MeshUnit: "mm" => MeshUnit::Millimetre, "m" => MeshUnit::Metre);
words!(TrackedPoint: "tool" => TrackedPoint::Tool, "wrist" => TrackedPoint::Wrist, "elbow" => TrackedPoint::Elbow);

/// What stands around a robot, and on it: the file that `surroundings` of a run file names.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct SurroundingsFile {
    /// Shapes that keep apart: fence, table, fixture, part, links, spindle.
    pub shape: Option<Vec<ShapeTable>>,
    /// Zones that points of the arm are kept out of.
    pub keep_out: Option<Vec<KeepOutTable>>,
    /// How far shapes keep apart, and which may touch.
    pub collision: Option<CollisionTable>,
    /// What the arm looks like: drawn in pages and scenes in place of an illustration, and held against nothing.
    pub visual: Option<Vec<VisualTable>>,
    /// Where the robot stands among them, in place of `[mount]` in the run file.
    pub mount: Option<MountTable>,
}

/// A cylinder along z about the origin of the shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CylinderTable {
    /// Its radius. mm
    pub radius: Mm<Positive>,
    /// Its length. mm
    pub length: Mm<Positive>,
}

/// A cylinder along z about the origin of the shape, with half spheres on its ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CapsuleTable {
    /// Its radius. mm
    pub radius: Mm<Positive>,
    /// The distance between the centres of the half spheres; 0 for a sphere. mm
    pub length: Mm<NotNegative>,
}

/// A shape: its form, its place, and what it moves with. Exactly one of `box_mm`, `cylinder_mm`, `capsule_mm`, `hull`,
/// `mesh`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShapeTable {
    /// Its name, which no other shape or zone has.
    pub name: String,
    /// What it moves with: `base` (what stands in the cell), `workpiece`, `flange`, a link, `link_1` to `link_6`, in
    /// the frame of its row, or the name of an external axis for what that carries, in the cell frame with all axes at
    /// zero.
    pub attached: String,
    /// A box about the origin of the shape: its edges along x, y and z.
    pub box_mm: Option<Vector<Mm<Positive>>>,
    /// A cylinder along z.
    pub cylinder_mm: Option<CylinderTable>,
    /// A capsule along z.
    pub capsule_mm: Option<CapsuleTable>,
    /// The convex hull of the vertices of a mesh file (STL, OBJ, DAE), relative to the folder of this file.
    pub hull: Option<String>,
    /// The triangles of a mesh file (STL, OBJ, DAE), relative to the folder of this file; a closed mesh is solid.
    pub mesh: Option<String>,
    /// The unit of the mesh file, which does not state it: `mm` (where left out) or `m`.
    pub unit: Option<Word<MeshUnit>>,
    /// Where the origin of the shape is, in the frame of what it moves with; zero where left out.
    pub xyz_mm: Option<Vector<Mm>>,
    /// How it is turned, as a rotation matrix by rows: this, one of the four keys below, or none for a shape that is
    /// not turned.
    pub rotation: Option<Matrix>,
    /// The same as KUKA's A, B, C: Rz(A) Ry(B) Rx(C).
    pub abc_deg: Option<Vector<Deg>>,
    /// The same as Fanuc's W, P, R: Rz(R) Ry(P) Rx(W).
    pub wpr_deg: Option<Vector<Deg>>,
    /// The same as roll, pitch, yaw of a URDF: Rz(y) Ry(p) Rx(r).
    pub rpy_deg: Option<Vector<Deg>>,
    /// The same as ABB's quaternion.
    pub quaternion_wxyz: Option<Quaternion>,
}

/// A zone of the cell that points of the arm are kept out of: a box by `box_mm`, or a `half_space`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KeepOutTable {
    /// Its name, which no other zone or shape has.
    pub name: String,
    /// The points that are kept out: `tool` (tool centre point), `wrist` (where axes 4, 5 and 6 meet), `elbow` (origin
    /// of row 3).
    pub points: List<Word<TrackedPoint>>,
    /// A box about its origin: its edges along x, y and z.
    pub box_mm: Option<Vector<Mm<Positive>>>,
    /// All that is beyond a plane.
    pub half_space: Option<HalfSpaceTable>,
    /// Where the origin of the box is, in the base frame; zero where left out.
    pub xyz_mm: Option<Vector<Mm>>,
    /// How the box is turned, as a rotation matrix by rows: this, one of the four keys below, or none.
    pub rotation: Option<Matrix>,
    /// The same as KUKA's A, B, C: Rz(A) Ry(B) Rx(C).
    pub abc_deg: Option<Vector<Deg>>,
    /// The same as Fanuc's W, P, R: Rz(R) Ry(P) Rx(W).
    pub wpr_deg: Option<Vector<Deg>>,
    /// The same as roll, pitch, yaw of a URDF: Rz(y) Ry(p) Rx(r).
    pub rpy_deg: Option<Vector<Deg>>,
    /// The same as ABB's quaternion.
    pub quaternion_wxyz: Option<Quaternion>,
}

/// The surface of a part of the arm as it looks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VisualTable {
    /// Its name.
    pub name: String,
    /// What it moves with: `base` (the base of the robot, wherever that is carried), `flange`, or a link, `link_1` to
    /// `link_6`, in the frame of its row.
    pub attached: String,
    /// A mesh file (STL, OBJ, DAE), relative to the folder of this file.
    pub mesh: String,
    /// The unit of the mesh file, which does not state it: `mm` (where left out) or `m`.
    pub unit: Option<Word<MeshUnit>>,
    /// Its colour, red, green and blue from 0 to 1; that of the maker of the robot where left out.
    pub color: Option<Vector<Number>>,
    /// Where the origin of the mesh is, in the frame of what it moves with; zero where left out.
    pub xyz_mm: Option<Vector<Mm>>,
    /// How it is turned, as a rotation matrix by rows: this, one of the four keys below, or none.
    pub rotation: Option<Matrix>,
    /// The same as KUKA's A, B, C: Rz(A) Ry(B) Rx(C).
    pub abc_deg: Option<Vector<Deg>>,
    /// The same as Fanuc's W, P, R: Rz(R) Ry(P) Rx(W).
    pub wpr_deg: Option<Vector<Deg>>,
    /// The same as roll, pitch, yaw of a URDF: Rz(y) Ry(p) Rx(r).
    pub rpy_deg: Option<Vector<Deg>>,
    /// The same as ABB's quaternion.
    pub quaternion_wxyz: Option<Quaternion>,
}

/// All that is on one side of a plane, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HalfSpaceTable {
    /// A point of the plane.
    pub xyz_mm: Vector<Mm>,
    /// The direction from the plane into the zone, of any length.
    pub normal: Vector<Number>,
}

/// How far shapes keep apart.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct CollisionTable {
    /// The smallest distance between two shapes that may be; 10 where left out.
    pub clearance_mm: Option<Mm<NotNegative>>,
    /// Pairs that may touch: each two names of shapes, or what shapes are attached to (`link_2`) for all of these.
    pub ignore: Option<List<Array<String, 2>>>,
}

/// The clearance where none is stated. m
pub(crate) const CLEARANCE: f64 = 10e-3;

/// What a shape may move with, for messages.
const FRAMES: &str = "\"base\", \"workpiece\", \"flange\", a link, \"link_1\" to \"link_6\", or an external axis";

/// What an external axis of a name carries.
pub(super) fn axis_of(name: &str, axes: &[ExternalAxis]) -> Option<Attachment> {
    let number = axes.iter().position(|axis| axis.name == name)?;
    u8::try_from(number).ok().map(Attachment::Axis)
}

/// The frame of a name.
pub(crate) fn attachment(name: &str) -> Option<Attachment> {
    match name {
        "base" => Some(Attachment::Base),
        "workpiece" => Some(Attachment::Workpiece),
        "flange" => Some(Attachment::Flange),
        _ => {
            let number: u8 = name.strip_prefix("link_")?.parse().ok()?;
            let link = Attachment::Link(number);
            ((1..=6).contains(&number) && link.to_string() == name).then_some(link)
        }
    }
}

/// Refuses a name that stands for a frame, or that would break the lines in which it is printed.
fn check_name(name: &str, axes: &[ExternalAxis], at: &Place<'_>) -> Result<(), InputError> {
    let allowed = "a name on one line, without quotes, that is none of the frames that shapes are attached to";
    if attachment(name).is_some() || axis_of(name, axes).is_some() {
        return Err(at.key("name").error("is the name of a frame", allowed));
    }
    if name.contains(|c: char| garbles(c) || c == '"') {
        return Err(at.key("name").error("holds a quote or a control character", allowed));
    }
    Ok(())
}

/// The pose that a table states: no turn where it has no orientation key.
pub(super) fn pose(xyz: Option<Vector<Mm>>, keys: &OrientationKeys, at: &Place<'_>) -> Result<Pose<f64>, InputError> {
    let mut pose = Pose { translation: xyz.map_or(Vector3::zeros(), |xyz| xyz.vector()), ..Pose::identity() };
    if keys.is_given() {
        pose.rotation = keys.rotation(at)?;
    }
    Ok(pose)
}

impl ShapeTable {
    /// What the shape moves with, and its pose there.
    ///
    /// # Errors
    /// [`InputError`] for a frame or a name that cannot be, and for an orientation that is none.
    pub(super) fn attached_at(
        &self,
        axes: &[ExternalAxis],
        at: &Place<'_>,
    ) -> Result<(Attachment, Pose<f64>), InputError> {
        check_name(&self.name, axes, at)?;
        let unknown = || {
            let names: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
            let named = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
            at.key("attached").error("is an unknown frame", format!("{FRAMES}{named}"))
        };
        let attached = attachment(&self.attached).or_else(|| axis_of(&self.attached, axes));
        Ok((attached.ok_or_else(unknown)?, pose(self.xyz_mm, &orientation_keys!(self), at)?))
    }
}

impl KeepOutTable {
    /// The zone.
    ///
    /// # Errors
    /// [`InputError`] for a name that cannot be, two forms or none, a plane without a normal, a point that is named
    /// twice.
    pub(super) fn keep_out(&self, axes: &[ExternalAxis], at: &Place<'_>) -> Result<KeepOut, InputError> {
        check_name(&self.name, axes, at)?;
        let mut points = Vec::new();
        for (word, number) in self.points.0.iter().zip(1..) {
            if points.contains(&word.0) {
                return Err(at.key("points").element(number).error("is there twice", "each point once"));
            }
            points.push(word.0);
        }
        let zone = match (self.box_mm, self.half_space) {
            (Some(edges), None) => {
                Zone::Box { edges: edges.vector(), pose: pose(self.xyz_mm, &orientation_keys!(self), at)? }
            }
            (None, Some(plane)) => {
                let keys = orientation_keys!(self);
                if self.xyz_mm.is_some() || keys.is_given() {
                    let key = if self.xyz_mm.is_some() { at.key("xyz_mm") } else { at.key("half_space") };
                    return Err(key.error(
                        "is there with a place or an orientation of a box",
                        "half_space = { xyz_mm = [x, y, z], normal = [x, y, z] } alone, or box_mm",
                    ));
                }
                let normal = plane.normal.vector();
                let length = normal.norm();
                if length < SHORTEST_NORMAL {
                    let at = at.key("half_space").key("normal");
                    return Err(at.error("has no direction", "three numbers that are not all 0"));
                }
                Zone::HalfSpace { point: plane.xyz_mm.vector(), normal: normal / length }
            }
            (Some(_), Some(_)) => {
                return Err(at.key("half_space").error("is there beside box_mm", "one of the two"));
            }
            (None, None) => return Err(at.key("box_mm").missing("box_mm, or half_space = { xyz_mm, normal }")),
        };
        Ok(KeepOut { name: self.name.clone(), zone, points })
    }
}

impl VisualTable {
    /// What is drawn, and the mesh file.
    ///
    /// # Errors
    /// [`InputError`] for a frame that is none of the arm, a colour that is none, and a mesh file that cannot be read.
    pub(super) fn visual(&self, at: &Place<'_>) -> Result<(Visual, InputFile), InputError> {
        check_name(&self.name, &[], at)?;
        let of_arm = |attached: &Attachment| !matches!(attached, Attachment::Workpiece | Attachment::Axis(_));
        let unknown = || {
            let allowed = "\"base\", \"flange\", or a link, \"link_1\" to \"link_6\"";
            at.key("attached").error("is no frame of the arm", allowed)
        };
        let attached = attachment(&self.attached).filter(of_arm).ok_or_else(unknown)?;
        let color = self.color.map(|color| <[f64; 3]>::from(color.vector()));
        if color.is_some_and(|parts| parts.iter().any(|part| !(0.0..=1.0).contains(part))) {
            return Err(at.key("color").error("is no colour", "red, green and blue, each from 0 to 1"));
        }
        let pose = pose(self.xyz_mm, &orientation_keys!(self), at)?;
        let (mesh, file) = at.key("mesh").named_mesh(self.unit.map_or(MeshUnit::Millimetre, |word| word.0))?;
        Ok((Visual { name: self.name.clone(), attached, mesh, pose, color }, file))
    }
}

/// A shorter vector has no direction.
const SHORTEST_NORMAL: f64 = 1e-9;

impl CollisionTable {
    /// The clearance, where it is stated. m
    pub(super) fn clearance(&self) -> Option<f64> {
        self.clearance_mm.map(Quantity::si)
    }

    /// The pairs that may touch.
    pub(super) fn ignored(&self) -> impl Iterator<Item = [String; 2]> + '_ {
        self.ignore.iter().flat_map(|list| list.0.iter().map(|pair| pair.0.clone()))
    }
}
