//! Dynamics of the joints: links with mass, damping and backlash of the drives.

use super::{Inertial, Robot};

/// Stiffness and damping of a joint about the two directions normal to its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthogonal {
    /// Stiffness about x and y of the frame of the row. N m/rad
    pub stiffness: [f64; 2],
    /// Damping about x and y of the frame of the row. N m s/rad
    pub damping: [f64; 2],
}

/// A joint and the link behind it, as far as motion is concerned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointDynamics {
    /// The link that the joint moves, in the frame of its Denavit-Hartenberg row.
    pub link: Inertial,
    /// Damping of the drive about the axis. N m s/rad
    pub damping: f64,
    /// Half the play of the gear: as far the joint turns from its middle without torque. rad
    pub backlash: f64,
    /// Whether a compensator carries what gravity does about this axis with joints 4 and 6 at zero, the arm in a plane.
    pub gravity_compensated: bool,
    /// Stiffness and damping normal to the axis, where known.
    pub orthogonal: Option<Orthogonal>,
    /// Where along its axis the joint yields normal to it: coordinate on the z axis of the row's frame. m
    pub bearing: f64,
}

impl Robot {
    /// What is known of the motion of all six joints, if it is.
    pub fn dynamics(&self) -> Option<&[JointDynamics; 6]> {
        self.dynamics.as_deref()
    }

    /// The same arm with links that have mass.
    pub fn with_dynamics(mut self, dynamics: [JointDynamics; 6]) -> Self {
        self.dynamics = Some(Box::new(dynamics));
        self
    }
}
