//! The quickest test of a pair: one sphere against a box that does not move with the arm, or against another sphere.

use super::poses::{Poses, WORKPIECE};
use super::{Members, Pair, Scene};
use nalgebra::Vector3;
use stead_model::robot::Pose;

/// Shapes that are tested quickly, at the most; pairs of others go straight to their covers.
const MOST: usize = 64;

/// The spheres around shapes in one configuration.
pub(super) struct Quick {
    /// Their centres in the base frame. m
    centres: [Vector3<f64>; MOST],
    /// From the base frame to the frame of the cell, and to that of the workpiece.
    fixed: [Pose<f64>; 2],
}

impl Quick {
    pub fn new(scene: &Scene, poses: &Poses) -> Self {
        let mut centres = [Vector3::zeros(); MOST];
        for (centre, body) in centres.iter_mut().zip(&scene.bodies) {
            *centre = poses.frames[body.frame].point(&body.cover.bound.centre);
        }
        Self { centres, fixed: [0, WORKPIECE].map(|frame| poses.frames[frame].inverse()) }
    }

    /// Whether a pair is farther apart than it has to be by some room (m) for certain; false says nothing.
    pub fn leaves(&self, scene: &Scene, pair: &Pair, room: f64) -> bool {
        let Members::Bodies(a, b) = pair.members else { return false };
        if a >= MOST || b >= MOST {
            return false;
        }
        let (first, second) = (&scene.bodies[a], &scene.bodies[b]);
        let within = first.cover.bound.radius + pair.required + room;
        // Spheres that touch are not apart, whatever the clearance.
        let is_apart = |square: f64, within: f64| square > within * within;
        let fixed = match second.frame {
            0 => &self.fixed[0],
            WORKPIECE => &self.fixed[1],
            _ => {
                let within = within + second.cover.bound.radius;
                return is_apart((self.centres[a] - self.centres[b]).norm_squared(), within);
            }
        };
        let centre = second.box_from_attachment.point(&fixed.point(&self.centres[a]));
        let outside = (centre.abs() - second.cover.half).sup(&Vector3::zeros());
        is_apart(outside.norm_squared(), within)
    }
}
