//! The tables `[stock]` and `[finished_part]`: material before it is cut, and the part that shall be left of it.

use super::tables::{CylinderTable, pose};
use crate::mesh::MeshUnit;
use crate::orientation::{Quaternion, orientation_keys};
use crate::place::Place;
use crate::quantity::Quantity;
use crate::scalars::Word;
use crate::shapes::{Matrix, Vector};
use crate::units::{Deg, Gb, Mm, NotNegative, Positive};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;
use stead_cell::{Solid, TriangleMesh};
use stead_disk::input::{InputError, InputFile};
use stead_model::robot::Pose;
use stead_model::task::ToolPath;

/// Material before it is cut, in the workpiece frame: exactly one of `box_mm`, `cylinder_mm`, `mesh`, `allowance_mm`,
/// or what the path itself passes over: `depth_mm`, `layer_mm` or both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StockTable {
    /// A box about the origin of the stock: its edges along x, y and z.
    pub box_mm: Option<Vector<Mm<Positive>>>,
    /// A cylinder along z about the origin of the stock.
    pub cylinder_mm: Option<CylinderTable>,
    /// A closed mesh (STL, OBJ, DAE), relative to the folder of this file.
    pub mesh: Option<String>,
    /// The unit of the mesh file, which does not state it: `mm` (where left out) or `m`.
    pub unit: Option<Word<MeshUnit>>,
    /// The box of the tool centre points that are scored, grown along x and y by the first two numbers on both sides,
    /// and along z by the third at the top.
    pub allowance_mm: Option<Vector<Mm<NotNegative>>>,
    /// What the cutter passes over on its scored moves, up to this height above its tip: the axial depth.
    pub depth_mm: Option<Mm<Positive>>,
    /// What the operation before has left, normal to the surface; up to `depth_mm`, or to the end of the corner without
    /// it.
    pub layer_mm: Option<Mm<Positive>>,
    /// Where the origin of the stock is, in the workpiece frame; zero where left out.
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
    /// Distance of the lines by which the stock is held; chosen from cutter and cut where left out.
    pub cell_mm: Option<Mm<Positive>>,
    /// Memory that the lines may take; 2 where left out.
    pub memory_gb: Option<Gb<Positive>>,
    /// A file (CSV), relative to the folder of this one, in which the forces are kept: made where there is none, read
    /// where stock, path and cutter are those it was made of, else replaced. Results are the same with and without it.
    pub keep: Option<String>,
}

/// The part as it shall be: cuts into it are warned of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PartTable {
    /// A closed mesh (STL, OBJ, DAE), relative to the folder of this file.
    pub mesh: String,
    /// The unit of the mesh file, which does not state it: `mm` (where left out) or `m`.
    pub unit: Option<Word<MeshUnit>>,
    /// Where the origin of the mesh is, in the workpiece frame; zero where left out.
    pub xyz_mm: Option<Vector<Mm>>,
}

/// A form with its pose in the workpiece frame, and the file that it comes from, if there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSolid {
    /// The form.
    pub solid: Solid,
    /// Its pose.
    pub pose: Pose<f64>,
    /// The mesh file.
    pub file: Option<InputFile>,
}

/// The forms that stock can have.
#[derive(Debug, Clone, PartialEq)]
pub enum StockForm {
    /// A body.
    Solid(PlacedSolid),
    /// What the path passes over: axial depth and thickness of a layer, of which one at least is there. m
    Path {
        /// Axial depth.
        depth: Option<f64>,
        /// Thickness of the layer.
        layer: Option<f64>,
    },
}

const FORMS: &str = "exactly one of box_mm, cylinder_mm = { radius, length }, mesh (a closed mesh file), allowance_mm, or depth_mm \
                     and layer_mm, alone or together";
const CLOSED: &str = "a closed mesh: every edge of two triangles";

impl StockTable {
    /// The stock of a path.
    ///
    /// # Errors
    /// [`InputError`] for two forms or none, a mesh that cannot be read or is not closed, an allowance with a place,
    /// and one that leaves no volume.
    pub fn form(&self, path: &ToolPath, at: &Place<'_>) -> Result<StockForm, InputError> {
        let of_path = if self.depth_mm.is_some() { "depth_mm" } else { "layer_mm" };
        let given = ["box_mm", "cylinder_mm", "mesh", "allowance_mm", of_path].map(|key| at.key(key));
        let mut given = given.iter().filter(|place| place.is_given());
        let Some(form) = given.next() else { return Err(at.key("box_mm").error("has no form", FORMS)) };
        if let Some(second) = given.next() {
            let first = form.path.rsplit('.').next().unwrap_or_default();
            return Err(second.error(format!("is a second form beside {first}"), FORMS));
        }
        if self.unit.is_some() && self.mesh.is_none() {
            return Err(at.key("unit").error("is for a mesh file", "mesh beside it; box_mm and the others are in mm"));
        }
        let keys = orientation_keys!(self);
        let [depth, layer] = [self.depth_mm, self.layer_mm].map(|length| length.map(Quantity::si));
        let is_of_path = depth.or(layer).is_some();
        if (is_of_path || self.allowance_mm.is_some()) && (self.xyz_mm.is_some() || keys.is_given()) {
            let key = if self.xyz_mm.is_some() { at.key("xyz_mm") } else { form.clone() };
            return Err(key.error(
                "is there with stock that lies about the path",
                "allowance_mm, depth_mm or layer_mm without a place, or box_mm with xyz_mm and an orientation",
            ));
        }
        if is_of_path {
            return Ok(StockForm::Path { depth, layer });
        }
        if let Some(allowance) = self.allowance_mm {
            return about(path, allowance.vector(), form).map(StockForm::Solid);
        }
        let pose = pose(self.xyz_mm, &keys, at)?;
        let (solid, file) = if let Some(edges) = self.box_mm {
            (Solid::Box(edges.vector()), None)
        } else if let Some(table) = self.cylinder_mm {
            (Solid::Cylinder { radius: table.radius.si(), length: table.length.si() }, None)
        } else {
            let (mesh, file) = closed(form, self.unit)?;
            (Solid::Mesh(mesh), Some(file))
        };
        Ok(StockForm::Solid(PlacedSolid { solid, pose, file }))
    }

    /// Distance of lines, where it is stated. m
    pub fn cell(&self) -> Option<f64> {
        self.cell_mm.map(Quantity::si)
    }

    /// The file in which what takes long is kept, and the place that names it.
    pub fn keep(&self, at: &Place<'_>) -> Option<(PathBuf, InputError)> {
        let at = at.key("keep");
        self.keep.as_ref().map(|name| (at.path_of(name), at.error("", "")))
    }

    /// Memory that they may take. bytes
    pub fn memory(&self) -> f64 {
        self.memory_gb.map_or(2e9, Quantity::si)
    }
}

impl PartTable {
    /// The mesh, its pose and its file.
    ///
    /// # Errors
    /// [`InputError`] for a mesh that cannot be read or is not closed.
    pub fn mesh(&self, at: &Place<'_>) -> Result<(Arc<TriangleMesh>, Pose<f64>, InputFile), InputError> {
        let (mesh, file) = closed(&at.key("mesh"), self.unit)?;
        let translation = self.xyz_mm.map_or(Vector3::zeros(), |xyz| xyz.vector());
        Ok((mesh, Pose { translation, ..Pose::identity() }, file))
    }
}

/// The closed mesh of the file that is named here.
fn closed(at: &Place<'_>, unit: Option<Word<MeshUnit>>) -> Result<(Arc<TriangleMesh>, InputFile), InputError> {
    let (mesh, file) = at.named_mesh(unit.map_or(MeshUnit::Millimetre, |word| word.0))?;
    if !mesh.is_closed() {
        return Err(at.error("is not closed: it has no inside", CLOSED));
    }
    Ok((mesh, file))
}

/// A box about the points of a path that are scored.
fn about(path: &ToolPath, allowance: Vector3<f64>, at: &Place<'_>) -> Result<PlacedSolid, InputError> {
    let scored = path.points().iter().enumerate().filter(|(number, _)| path.is_scored(*number));
    let ends = scored.fold(None, |known: Option<[Vector3<f64>; 2]>, (_, point)| {
        let at = point.position;
        Some(known.map_or([at, at], |[low, high]| [low.inf(&at), high.sup(&at)]))
    });
    let [mut low, mut high] = ends.unwrap_or_default();
    high += allowance;
    low -= Vector3::new(allowance.x, allowance.y, 0.0);
    let edges = high - low;
    let has_volume = edges.min() > 1e-6;
    if !has_volume {
        return Err(at.error(
            format!("leaves a box of {} x {} x {} mm", edges.x * 1e3, edges.y * 1e3, edges.z * 1e3),
            "allowances with which the box about the path has a volume",
        ));
    }
    let pose = Pose { translation: (low + high) / 2.0, ..Pose::identity() };
    Ok(PlacedSolid { solid: Solid::Box(edges), pose, file: None })
}
