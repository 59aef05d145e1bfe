//! External axes: rails and turntables that carry the robot or the workpiece.
//!
//! Axes that carry the same thing stand on each other in their order, the first one on the floor: a tilting table is a
//! turntable about a level axis with another one on it. Direction and point of an axis are given in the cell frame with
//! all axes at zero.
//!
//! ```
//! use nalgebra::Vector3;
//! use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis, robot_from_workpiece};
//! let rail = ExternalAxis {
//!     name: "rail".to_owned(), kind: AxisKind::Rail, carries: Carried::Robot,
//!     direction: Vector3::x(), point: Vector3::zeros(),
//!     min: 0.0, max: 3.0, max_speed: None, axis_use: AxisUse::Fixed,
//! };
//! // The robot a metre farther along x sees the workpiece a metre behind.
//! let seen = robot_from_workpiece(&[rail], &[1.0]);
//! assert_eq!(seen.translation, Vector3::new(-1.0, 0.0, 0.0));
//! ```

use crate::robot::Pose;
use nalgebra::Vector3;
use stead_numerics::rotation::rotation_from_vector;

/// How an external axis moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisKind {
    /// Along its direction; positions are in m.
    Rail,
    /// About its direction, through its point; positions are in rad.
    Turntable,
}

/// What stands on an external axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carried {
    /// The base of the robot.
    Robot,
    /// The workpiece.
    Workpiece,
}

/// How often an external axis moves, the poorer use first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AxisUse {
    /// One position for the whole path.
    Fixed,
    /// One position for each segment.
    Indexed,
    /// It moves with the robot along the path.
    Continuous,
}

/// A rail or a turntable.
#[derive(Debug, Clone, PartialEq)]
pub struct ExternalAxis {
    /// Its name, unique among the axes of a cell.
    pub name: String,
    /// How it moves.
    pub kind: AxisKind,
    /// What stands on it.
    pub carries: Carried,
    /// Unit vector along which, or about which, it moves. Cell frame, all axes at zero.
    pub direction: Vector3<f64>,
    /// A point on the axis of a turntable. Cell frame, all axes at zero, m
    pub point: Vector3<f64>,
    /// Lower end of its range. m or rad
    pub min: f64,
    /// Upper end of its range, not below the lower. m or rad
    pub max: f64,
    /// Largest speed, where known. m/s or rad/s
    pub max_speed: Option<f64>,
    /// How often it moves.
    pub axis_use: AxisUse,
}

impl ExternalAxis {
    /// What it does to what it carries at a position (m or rad): the pose there of a frame that is the cell frame at
    /// zero.
    pub fn motion(&self, position: f64) -> Pose<f64> {
        match self.kind {
            AxisKind::Rail => Pose { translation: self.direction * position, ..Pose::identity() },
            AxisKind::Turntable => {
                let rotation = rotation_from_vector(&(self.direction * position));
                Pose { rotation, translation: self.point - rotation * self.point }
            }
        }
    }

    /// The position from zero that is nearest inside the range. m or rad
    pub fn nearest_to_zero(&self) -> f64 {
        0.0_f64.max(self.min).min(self.max)
    }

    /// `count` positions from one end of the range to the other; one where the range is a point. m or rad
    pub fn grid(&self, count: usize) -> Vec<f64> {
        if self.max <= self.min || count < 2 {
            return vec![self.nearest_to_zero()];
        }
        let step = (self.max - self.min) / (count - 1) as f64;
        (0..count).map(|k| if k + 1 == count { self.max } else { self.min + step * k as f64 }).collect()
    }
}

/// Where axes at positions (m or rad) have brought the robot, or the workpiece: the pose in the cell of a frame that is
/// the cell frame with all axes at zero.
pub fn carried(axes: &[ExternalAxis], positions: &[f64], what: Carried) -> Pose<f64> {
    let of_it = axes.iter().zip(positions).filter(|(axis, _)| axis.carries == what);
    of_it.fold(Pose::identity(), |pose, (axis, position)| pose.then(&axis.motion(*position)))
}

/// What axes at positions (m or rad) do to the workpiece as the robot sees it: a rail under the robot moves it the
/// other way. The identity with all axes at zero.
pub fn robot_from_workpiece(axes: &[ExternalAxis], positions: &[f64]) -> Pose<f64> {
    let [robot, workpiece] = [Carried::Robot, Carried::Workpiece].map(|what| carried(axes, positions, what));
    if axes.iter().all(|axis| axis.carries == Carried::Workpiece) {
        return workpiece;
    }
    robot.inverse().then(&workpiece)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;
    use std::f64::consts::FRAC_PI_2;

    fn axis(kind: AxisKind, carries: Carried, direction: Vector3<f64>, point: Vector3<f64>) -> ExternalAxis {
        let name = "axis".to_owned();
        ExternalAxis {
            name,
            kind,
            carries,
            direction,
            point,
            min: -2.0,
            max: 2.0,
            max_speed: None,
            axis_use: AxisUse::Fixed,
        }
    }

    #[test]
    fn a_tilting_table_turns_about_the_tilted_axis() {
        let tilt = axis(AxisKind::Turntable, Carried::Workpiece, Vector3::x(), vector![0.0, 0.0, 1.0]);
        let turn = axis(AxisKind::Turntable, Carried::Workpiece, Vector3::z(), vector![0.5, 0.0, 0.0]);
        let pose = robot_from_workpiece(&[tilt, turn], &[FRAC_PI_2, FRAC_PI_2]);
        // A point a metre along x from the second axis goes to +y of it, and then up.
        let found = pose.point(&vector![1.5, 0.0, 1.0]);
        assert!((found - vector![0.5, 0.0, 2.0]).norm() < 1e-12, "{found}");
        // The place on both axes stays.
        assert!((pose.point(&vector![0.5, 0.0, 1.0]) - vector![0.5, 0.0, 1.0]).norm() < 1e-12);
    }

    #[test]
    fn carrying_the_robot_is_carrying_the_workpiece_the_other_way() {
        for kind in [AxisKind::Rail, AxisKind::Turntable] {
            let direction = vector![1.0, 2.0, -0.5].normalize();
            let point = vector![0.3, 0.1, 0.7];
            let [robot, workpiece] =
                [Carried::Robot, Carried::Workpiece].map(|what| axis(kind, what, direction, point));
            let (a, b) = (robot_from_workpiece(&[robot], &[0.8]), robot_from_workpiece(&[workpiece], &[-0.8]));
            assert!((a.rotation - b.rotation).norm() < 1e-14 && (a.translation - b.translation).norm() < 1e-14);
        }
    }

    #[test]
    fn a_grid_has_both_ends() {
        let rail = axis(AxisKind::Rail, Carried::Robot, Vector3::x(), Vector3::zeros());
        assert_eq!(rail.grid(5), [-2.0, -1.0, 0.0, 1.0, 2.0]);
        assert_eq!(ExternalAxis { min: 0.5, max: 0.5, ..rail }.grid(5), [0.5]);
    }
}
