//! What the user should know of a scene though it is not wrong, in sentences.

use nalgebra::Vector3;
use stead_cell::{Attachment, Scene, Shape, Solid};
use stead_model::robot::{Robot, Spindle};
use stead_numerics::digits::figures;

/// A shape that stands in the cell and is so many times as large as the reach looks wrong.
const LARGE_CELL: f64 = 20.0;
/// A mesh that is smaller looks wrong. m
const SMALLEST_MESH: f64 = 5e-3;

pub(super) fn notes(scene: &Scene, robot: &Robot, spindle: &Spindle) -> Vec<String> {
    let reach = reach(robot, spindle);
    let shapes = scene.surroundings().shapes();
    let mut notes: Vec<String> = shapes
        .iter()
        .flat_map(|shape| [size_note(shape, reach), open_note(shape), touching_note(shape)])
        .flatten()
        .collect();
    notes.extend(unchecked_note(&scene.unchecked_links()));
    notes
}

/// How far the tool centre point can be from axis 1. m
fn reach(robot: &Robot, spindle: &Spindle) -> f64 {
    robot.geometry().reach() + robot.geometry().flange.abs() + spindle.flange_from_tool.translation.norm()
}

/// A shape whose size suggests another unit.
fn size_note(shape: &Shape, reach: f64) -> Option<String> {
    let [low, high] = shape.solid.extent();
    let edges: Vector3<f64> = high - low;
    let (largest, name) = (edges.max(), &shape.name);
    let mm = figures(largest * 1e3);
    let limit = if shape.attached == Attachment::Base { LARGE_CELL * reach } else { reach };
    if largest > limit {
        let reach = figures(reach * 1e3);
        return Some(format!(
            "shape {name:?} is {mm} mm long, and the robot reaches {reach} mm: metres for millimetres?"
        ));
    }
    let is_small = shape.solid.mesh().is_some() && largest < SMALLEST_MESH;
    is_small.then(|| format!("shape {name:?} is {mm} mm long: is its mesh in metres (unit = \"m\")?"))
}

/// A mesh without an inside.
fn open_note(shape: &Shape) -> Option<String> {
    let is_open = matches!(&shape.solid, Solid::Mesh(mesh) if !mesh.is_closed());
    is_open.then(|| {
        format!("the mesh of shape {:?} is not closed: its surface counts, but nothing is inside of it", shape.name)
    })
}

/// A mesh of several solids that touch each other.
fn touching_note(shape: &Shape) -> Option<String> {
    let Solid::Mesh(mesh) = &shape.solid else { return None };
    mesh.is_touching().then(|| {
        let (name, count) = (&shape.name, mesh.solids().len());
        format!("the mesh of shape {name:?} is made of {count} closed surfaces, some of which touch: each is solid by itself")
    })
}

/// Links that nothing is known of.
fn unchecked_note(links: &[u8]) -> Option<String> {
    let numbers: Vec<String> = links.iter().map(u8::to_string).collect();
    (!numbers.is_empty())
        .then(|| format!("no shape is attached to links {}: the arm is not checked there", numbers.join(", ")))
}
