//! Where all that moves stands: the frames that shapes are attached to.

use crate::shape::Attachment;
use nalgebra::Matrix3;
use std::f64::consts::FRAC_1_SQRT_2;
use stead_model::robot::{Pose, Robot};

/// Frames that shapes are attached to: the base, six links, the workpiece, and external axes.
pub(super) const FRAMES: usize = 8 + MAX_AXES;
/// External axes that shapes can be attached to, at the most.
pub const MAX_AXES: usize = 6;
/// That of the workpiece.
pub(super) const WORKPIECE: usize = 7;

/// Where all that moves stands in one configuration, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Poses {
    pub(super) frames: [Pose<f64>; FRAMES],
}

impl Poses {
    /// The arm at its joint angles (rad), and the workpiece at a pose in the base frame (m).
    pub fn new(robot: &Robot, joints: &[f64; 6], base_from_workpiece: &Pose<f64>) -> Self {
        let mut frames = [Pose::identity(); FRAMES];
        frames[1..=6].copy_from_slice(&robot.link_frames(joints));
        frames[WORKPIECE] = *base_from_workpiece;
        Self { frames }
    }

    /// The flange and the workpiece at poses in one frame (m), for pairs of these two alone: all else is left at the
    /// origin.
    pub fn of_tool(base_from_flange: &Pose<f64>, base_from_workpiece: &Pose<f64>) -> Self {
        let mut frames = [Pose::identity(); FRAMES];
        frames[6] = *base_from_flange;
        frames[WORKPIECE] = *base_from_workpiece;
        Self { frames }
    }

    /// The same with what stands in the cell at a pose in the base frame: where an external axis carries the robot.
    pub fn with_cell(mut self, base_from_cell: Pose<f64>) -> Self {
        self.frames[0] = base_from_cell;
        self
    }

    /// The same with what an external axis carries at a pose in the base frame.
    pub fn with_axis(mut self, number: usize, base_from_axis: Pose<f64>) -> Self {
        if number < MAX_AXES {
            self.frames[8 + number] = base_from_axis;
        }
        self
    }

    /// The pose of what shapes are attached to, in the base frame.
    pub fn of(&self, attached: Attachment) -> &Pose<f64> {
        &self.frames[frame(attached)]
    }
}

/// The number of the frame of an attachment.
pub(super) fn frame(attached: Attachment) -> usize {
    match attached {
        Attachment::Base => 0,
        Attachment::Link(number) => usize::from(number).clamp(1, 6),
        Attachment::Flange => 6,
        Attachment::Workpiece => WORKPIECE,
        Attachment::Axis(number) => 8 + usize::from(number).min(MAX_AXES - 1),
    }
}

/// The number of the link that a frame is; zero for what does not move with the arm.
pub(super) fn on_arm(frame: usize) -> usize {
    if (1..=6).contains(&frame) { frame } else { 0 }
}

/// How far a point can be moved by a turn from one orientation to another, per metre from its centre: the largest
/// singular value of the difference.
pub(super) fn largest_move(before: &Matrix3<f64>, after: &Matrix3<f64>) -> f64 {
    (after - before).norm() * FRAC_1_SQRT_2
}
