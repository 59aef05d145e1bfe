//! What stands in a cell or moves in it: forms with a name, a place, and what they are attached to.

use crate::solid::Solid;
use nalgebra::Vector3;
use std::fmt;
use stead_model::robot::Pose;

/// What a shape moves with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Attachment {
    /// The cell: fence, pillar, floor, pedestal. Its frame is the robot base frame of the placements.
    Base,
    /// A link of the arm, from 1 to 6, in the frame of its row (modified Denavit-Hartenberg).
    Link(u8),
    /// The flange, in the flange frame: spindle, holder, cables.
    Flange,
    /// The workpiece, in the frame of the task: part, stock, fixture, a table that moves with them.
    Workpiece,
    /// What an external axis carries, by its number from 0, in the frame that is the cell frame with all axes at zero.
    Axis(u8),
}

impl fmt::Display for Attachment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Base => write!(f, "base"),
            Self::Link(number) => write!(f, "link_{number}"),
            Self::Flange => write!(f, "flange"),
            Self::Workpiece => write!(f, "workpiece"),
            Self::Axis(number) => write!(f, "axis {}", number + 1),
        }
    }
}

/// A form with a name, a place, and what it moves with.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its name, unlike those of the others.
    pub name: String,
    /// What it moves with.
    pub attached: Attachment,
    /// Its form.
    pub solid: Solid,
    /// From the frame of the form to that of what it is attached to. m
    pub pose: Pose<f64>,
}

/// A point of the arm that a zone is kept free of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TrackedPoint {
    /// The tool centre point.
    Tool,
    /// Where axes 4, 5 and 6 meet.
    Wrist,
    /// Where axis 3 is.
    Elbow,
}

impl TrackedPoint {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Tool, Self::Wrist, Self::Elbow];

    /// As files and messages call it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Tool => "tool",
            Self::Wrist => "wrist",
            Self::Elbow => "elbow",
        }
    }
}

/// A part of space in the cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Zone {
    /// A box by its edges, about a pose in the base frame. m
    Box {
        /// Along x, y and z of the pose. m
        edges: Vector3<f64>,
        /// From the frame of the box to the base frame. m
        pose: Pose<f64>,
    },
    /// All points on the side of a plane to which its normal points, in the base frame.
    HalfSpace {
        /// A point on the plane. m
        point: Vector3<f64>,
        /// The normal, of length 1.
        normal: Vector3<f64>,
    },
}

impl Zone {
    /// Signed distance of a point of the base frame from the zone, negative inside. m
    pub fn distance(&self, point: &Vector3<f64>) -> f64 {
        match self {
            Self::HalfSpace { point: origin, normal } => -(point - origin).dot(normal),
            Self::Box { edges, pose } => {
                let outside = pose.inverse().point(point).abs() - edges / 2.0;
                let apart = outside.sup(&Vector3::zeros()).norm();
                if apart > 0.0 { apart } else { outside.max() }
            }
        }
    }
}

/// A zone that points of the arm are kept out of.
#[derive(Debug, Clone, PartialEq)]
pub struct KeepOut {
    /// Its name.
    pub name: String,
    /// The zone.
    pub zone: Zone,
    /// The points that stay out of it.
    pub points: Vec<TrackedPoint>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    #[test]
    fn zones_know_inside_from_outside() {
        let pose = Pose { rotation: Matrix3::identity(), translation: Vector3::new(1.0, 0.0, 0.0) };
        let zone = Zone::Box { edges: Vector3::new(2.0, 2.0, 2.0), pose };
        assert!((zone.distance(&Vector3::new(1.0, 0.0, 0.75)) + 0.25).abs() < 1e-12);
        assert!((zone.distance(&Vector3::new(5.0, 5.0, 0.0)) - 5.0).abs() < 1e-12);
        let floor = Zone::HalfSpace { point: Vector3::zeros(), normal: Vector3::new(0.0, 0.0, -1.0) };
        assert_eq!(floor.distance(&Vector3::new(0.0, 0.0, 0.5)), 0.5);
        assert_eq!(floor.distance(&Vector3::new(0.0, 0.0, -0.5)), -0.5);
    }
}
