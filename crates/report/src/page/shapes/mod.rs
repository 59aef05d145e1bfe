//! The shapes that stand for a robot, its spindle and the work: bodies made from the rows of the robot alone.
//!
//! A robot file states axes and lengths, not what the links look like. These bodies show where the rows have them, with
//! widths in proportion to the arm; they are illustrations ([`BodyMesh::is_illustration`]), and nothing is checked
//! against them.

mod arm;
mod attached;
mod illustration;
mod loft;
mod maker;
mod shading;
mod visuals;

pub use arm::arm_bodies;
pub use attached::{block_of, spindle_bodies};
pub use shading::{Shaded, shaded};

use stead_problem::problem::Problem;

/// The frame that a body is fixed in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyFrame {
    /// The base frame of the robot.
    Base,
    /// Frame i (1 to 6) of the modified Denavit-Hartenberg rows, which turns with joint i.
    Link(u8),
    /// The tool frame: origin at the tool centre point, z out of the spindle.
    Tool,
    /// The workpiece frame.
    Workpiece,
    /// The frame of the cell, in which nothing moves.
    Cell,
    /// What an external axis moves, by its number from 0: the frame of the cell where all axes are at zero.
    Axis(u8),
}

/// A closed surface, or several, that moves with one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyMesh {
    /// What it stands for.
    pub name: String,
    /// What it is fixed to.
    pub frame: BodyFrame,
    /// Red, green and blue, sRGB from 0 to 1.
    pub color: [f32; 3],
    /// Corners in that frame. m
    pub positions: Vec<[f32; 3]>,
    /// Corners of each triangle, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Whether it only stands for the thing, its real shape not being known.
    pub is_illustration: bool,
}

/// The bodies of the arm, its base first, and of its spindle: what they look like where that is known, else
/// illustrations. What it works on is `block_of`.
pub fn bodies(problem: &Problem) -> Vec<BodyMesh> {
    let mut bodies = arm_bodies(&problem.robot, &problem.spindle);
    if let Some(scene) = &problem.scene {
        visuals::put(&mut bodies, &problem.robot, scene.surroundings().visuals());
    }
    bodies.extend(spindle_bodies(&problem.robot, &problem.spindle));
    bodies
}

#[cfg(test)]
mod tests;
