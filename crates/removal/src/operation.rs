//! What is cut: stock, the operations that cut it, and their cutters.

use crate::profile::Profile;
use nalgebra::Vector3;
use std::sync::Arc;
use stead_cell::tool_scene::Cylinder;
use stead_cell::{Solid, TriangleMesh};
use stead_model::cutting::Cutter;
use stead_model::robot::Pose;
use stead_model::task::ToolPath;

/// Material before it is cut.
#[derive(Debug, Clone, PartialEq)]
pub enum Stock {
    /// A form: a box, a cylinder, or a closed mesh.
    Solid {
        /// The form.
        solid: Solid,
        /// The pose of the form in the workpiece frame.
        pose: Pose<f64>,
    },
    /// What the operation itself passes over.
    Path(PathStock),
}

/// Stock from the path: what the cutter sweeps on its scored moves, up to a height above its tip, less what it would
/// sweep on the same path were it smaller by a layer and as much higher. At least one of the two is stated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PathStock {
    /// Axial depth: how high above the tip material stands before the cut (m); where it is not stated, up to the end of
    /// the corner.
    pub depth: Option<f64>,
    /// Thickness of the layer that the operation before has left, normal to the surface. m
    pub layer: Option<f64>,
}

/// An end mill with its outer shape: flat, bull nose, ball or tapered.
#[derive(Debug, Clone, PartialEq)]
pub struct EndMill {
    /// Teeth, radius, helix, flutes, sense of rotation and coefficients. The radius of a tapered cutter is that which
    /// a corner of its tip has at its side; above, it grows.
    pub cutter: Cutter,
    /// Length of the flutes. m
    pub flute_length: f64,
    /// Radius of the corner: 0 of a flat cutter, half the diameter of a ball. m
    pub corner_radius: f64,
    /// Angle between side and axis. rad
    pub taper: f64,
    /// Whether its bottom cuts up to the axis.
    pub is_centre_cutting: bool,
    /// Shank and holder above the flutes, from below.
    pub holder: Vec<Cylinder>,
}

/// Of a cutter that is not centre-cutting, over its diameter.
const DEAD_CENTRE: f64 = 0.15;

impl EndMill {
    /// Radius about the axis in which the bottom does not cut. m
    pub fn dead_centre(&self) -> f64 {
        if self.is_centre_cutting { 0.0 } else { DEAD_CENTRE * self.cutter.diameter() }
    }

    /// Its outer shape along the flutes.
    pub fn profile(&self) -> Profile {
        Profile {
            radius: self.cutter.radius(),
            corner: self.corner_radius,
            taper: self.taper,
            length: self.flute_length,
        }
    }
}

/// A place of the tool in the air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AirPoint {
    /// Tool centre point in the workpiece frame. m
    pub position: Vector3<f64>,
    /// Tool axis, of unit length, from the workpiece to the spindle.
    pub axis: Vector3<f64>,
}

/// A tool path with the cutter that takes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Operation {
    /// What messages call it: the name of its file.
    pub name: String,
    /// The path, with a feed at every point.
    pub path: ToolPath,
    /// The rapid moves before each segment, and after the last: the places between which the tool moves straight, from
    /// the end of the segment before to the start of the next, both left out. Empty where they are not known, as of
    /// a task file.
    pub rapids: Vec<Vec<AirPoint>>,
    /// The cutter.
    pub mill: EndMill,
    /// Speed of the spindle. rev/s
    pub spindle_speed: f64,
}

/// Forces along a path, from what it removes of the stock.
#[derive(Debug, Clone, PartialEq)]
pub struct ForcesProblem {
    /// The stock before the first operation.
    pub stock: Stock,
    /// Operations that are done before, in order; nothing is reported of them.
    pub before: Vec<Operation>,
    /// The operation whose forces are computed.
    pub operation: Operation,
    /// The part as it shall be, which must not be cut into: a closed mesh with its pose in the workpiece frame.
    pub finished_part: Option<(Arc<TriangleMesh>, Pose<f64>)>,
    /// Distance of neighbouring lines of the stock, where it is stated. m
    pub cell: Option<f64>,
    /// Memory that it may take. bytes
    pub memory: f64,
}
