//! A KR 270 in a cell, for the tests of this crate and of those above.
#![allow(clippy::unwrap_used, reason = "for tests alone")]
use crate::scene::Scene;
use crate::shape::{Attachment, KeepOut, Shape, TrackedPoint, Zone};
use crate::solid::Solid;
use crate::surroundings::Surroundings;
use nalgebra::{Matrix3, Vector3};
use stead_model::robot::Pose;
use stead_model::robot::testing::{kr270, spindle};

/// A shape without rotation, at a place (m) of what it is attached to.
pub fn shape(name: &str, attached: Attachment, solid: Solid, at: [f64; 3]) -> Shape {
    Shape { name: name.to_owned(), attached, solid, pose: Pose { translation: at.into(), ..Pose::identity() } }
}

/// A capsule from the origin of the frame of a link to a point of it. m
fn along(name: &str, link: u8, radius: f64, to: [f64; 3]) -> Shape {
    let to = Vector3::from(to);
    let z = to.normalize();
    let x = z.cross(&Vector3::new(z.y, z.z, z.x)).normalize();
    Shape {
        name: name.to_owned(),
        attached: Attachment::Link(link),
        solid: Solid::Capsule { radius, length: to.norm() },
        pose: Pose { rotation: Matrix3::from_columns(&[x, z.cross(&x), z]), translation: to / 2.0 },
    }
}

/// A KR 270 of capsules with its spindle, a part, a pillar and a fence behind them.
pub fn kr270_shapes() -> Vec<Shape> {
    vec![
        along("upper arm", 2, 0.16, [1.25, 0.0, 0.0]),
        along("forearm", 3, 0.13, [-0.055, 1.1, 0.0]),
        shape("spindle", Attachment::Flange, Solid::Cylinder { radius: 0.09, length: 0.4 }, [0.0, 0.0, 0.3]),
        shape("part", Attachment::Workpiece, Solid::Box(Vector3::new(0.4, 0.5, 0.2)), [0.0, 0.0, -0.1]),
        shape("pillar", Attachment::Base, Solid::Cylinder { radius: 0.15, length: 3.0 }, [0.5, -2.6, 0.0]),
        shape("fence", Attachment::Base, Solid::Box(Vector3::new(5.0, 0.05, 2.0)), [0.0, -3.0, 0.0]),
    ]
}

/// The KR 270 with its spindle among shapes, its tool, wrist and elbow kept above a floor; with a clearance (m).
pub fn scene_of(shapes: Vec<Shape>, clearance: f64) -> Scene {
    let floor = Zone::HalfSpace { point: Vector3::new(0.0, 0.0, -0.7), normal: Vector3::new(0.0, 0.0, -1.0) };
    let zones = vec![KeepOut { name: "floor".to_owned(), zone: floor, points: TrackedPoint::ALL.to_vec() }];
    let around = Surroundings::new(shapes, zones, clearance, Vec::new()).unwrap();
    Scene::new(&kr270(), &spindle().flange_from_tool, around).unwrap()
}
