//! What the arm holds and what it works on: spindle with bracket and tool, and a block under the path.

use super::arm::{flange_face, scale};
use super::illustration::{Paint, illustration};
use super::loft::{Section, Solid};
use super::{BodyFrame, BodyMesh};
use nalgebra::Vector3;
use stead_model::robot::{Robot, Spindle};

/// Distance of the tool centre point from the flange that the sizes of the spindle belong to: that of Caro 2013, eq. 9.
/// mm
const NOMINAL_MM: f64 = 684.0;

/// How far the block goes beyond the path on every side. m
const MARGIN: f64 = 0.06;
/// Thickness of the block. m
const DEPTH: f64 = 0.1;
/// Distance of the block from the path. m
const GAP: f64 = 0.01;

/// Tool, holder, spindle, and the bracket that carries it on the flange, in the tool frame.
pub fn spindle_bodies(robot: &Robot, spindle: &Spindle) -> Vec<BodyMesh> {
    let size = scale(robot);
    // Length in m of a mm of the nominal spindle.
    let unit = spindle.flange_from_tool.translation.norm().clamp(0.12 * size, size) / NOMINAL_MM;
    let flange = spindle.flange_from_tool.inverse().point(&(Vector3::z() * flange_face(robot, spindle)));
    let up = |mm: f64| Vector3::z() * (-mm * unit);
    // Height above the tool centre point where the bracket holds the spindle.
    let held = (-flange.z / unit).clamp(260.0, 460.0);
    let part = |name: &str, paint: Paint, build: &dyn Fn(&mut Solid)| {
        let mut solid = Solid::default();
        build(&mut solid);
        illustration(name, BodyFrame::Tool, paint, solid)
    };
    let bar = |solid: &mut Solid, ends: [f64; 2], radii: [f64; 2], bevel: f64, section: Section| {
        solid.bar(ends.map(up), radii.map(|radius| radius * unit), [0.0; 2], bevel * unit, section);
    };
    let round = Section::round();
    vec![
        part("tool", Paint::Tool, &|solid| bar(solid, [0.0, 95.0], [10.0; 2], 1.0, round)),
        part("tool holder", Paint::Steel, &|solid| {
            bar(solid, [92.0, 150.0], [22.0, 34.0], 3.0, round);
            bar(solid, [150.0, 190.0], [62.0, 74.0], 6.0, round);
        }),
        part("spindle", Paint::Spindle, &|solid| {
            bar(solid, [190.0, held + 130.0], [88.0; 2], 10.0, Section::squarish(5.0));
        }),
        part("spindle bracket", Paint::Dark, &|solid| {
            bar(solid, [held + 130.0, held + 165.0], [60.0, 50.0], 10.0, round);
            let section = Section::squarish(6.0).flattened(0.8, Vector3::z());
            let radii = [74.0, 86.0].map(|radius| radius * unit);
            solid.bar([flange, up(held)], radii, [0.0; 2], 8.0 * unit, section);
        }),
    ]
}

/// A block that a path may lie on, in the workpiece frame: its extent with a margin, on the side of it away from the
/// tool; from the path points (m) and the tool axes there.
pub fn block_of(points: &[Vector3<f64>], axes: &[Vector3<f64>]) -> BodyMesh {
    let extreme = |start: f64, choose: fn(f64, f64) -> f64| {
        points.iter().fold(Vector3::repeat(start), |bound, point| bound.zip_map(point, choose))
    };
    let (mut low, mut high) = (extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max));
    let axis: Vector3<f64> = axes.iter().sum();
    let side = axis.iamax();
    for other in (0..3).filter(|other| *other != side) {
        low[other] -= MARGIN;
        high[other] += MARGIN;
    }
    if axis[side] >= 0.0 {
        (low[side], high[side]) = (low[side] - GAP - DEPTH, low[side] - GAP);
    } else {
        (low[side], high[side]) = (high[side] + GAP, high[side] + GAP + DEPTH);
    }
    let mut solid = Solid::default();
    solid.cuboid(low, high);
    illustration("block under the path", BodyFrame::Workpiece, Paint::Part, solid)
}
