//! Commanded motion: a straight pass of the tool with a smooth start, and its joint angles.

use nalgebra::{Vector3, Vector6};
use std::f64::consts::TAU;
use stead_model::cutting::{CutFrame, Side};
use stead_model::robot::{Frames, Pose, Posture, Robot, Spindle, Unreachable, angles::ANGLE_ROUNDING};

/// A start from rest to the feed with bounded jerk: constant jerk upwards over the first half of the time, downwards
/// over the second, so that acceleration is continuous and the feed is reached with none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// The feed that is reached. m/s
    pub feed: f64,
    /// Time until then; zero starts with the feed at once. s
    pub time: f64,
}

impl Ramp {
    /// Distance (m) and speed (m/s) at a time (s) from the start.
    pub fn at(&self, time: f64) -> (f64, f64) {
        let Self { feed, time: whole } = *self;
        if time <= 0.0 {
            return (0.0, if whole > 0.0 { 0.0 } else { feed });
        }
        if time >= whole {
            return (feed * (time - whole / 2.0), feed);
        }
        let jerk = 4.0 * feed / (whole * whole);
        if time <= whole / 2.0 {
            (jerk * time * time * time / 6.0, jerk * time * time / 2.0)
        } else {
            // The second half is the first turned around.
            let left = whole - time;
            let distance = feed * (time - whole / 2.0) + jerk * left * left * left / 6.0;
            (distance, feed - jerk * left * left / 2.0)
        }
    }

    /// When a distance (m) is completed. s
    pub fn time_of(&self, distance: f64) -> f64 {
        let at_feed = self.feed * self.time / 2.0;
        if distance >= at_feed {
            return distance / self.feed + self.time / 2.0;
        }
        let (mut low, mut high) = (0.0, self.time);
        for _ in 0..100 {
            let middle = (low + high) / 2.0;
            if self.at(middle).0 < distance { low = middle } else { high = middle }
        }
        high
    }
}

/// A straight path of the tool centre point, the orientation of the tool as at the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pass {
    /// Joint angles at the start. rad
    pub start: [f64; 6],
    /// Direction of the feed in the base frame.
    pub direction: Vector3<f64>,
    /// Length of the pass. m
    pub length: f64,
}

/// Why an arm cannot make a pass in the posture of its start.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// The wrist is out of reach.
    #[error("after {distance_mm} mm of the pass {reason}")]
    Unreachable {
        /// Where. mm
        distance_mm: f64,
        /// Why.
        reason: Unreachable,
    },
    /// A joint would leave its limits.
    #[error("after {distance_mm} mm of the pass joint {joint} would stand at {angle_deg} deg, beyond its limits")]
    Limit {
        /// Where. mm
        distance_mm: f64,
        /// Number of the joint, from 1.
        joint: usize,
        /// What it would have to stand at. deg
        angle_deg: f64,
    },
    /// The arm comes so near to a singularity that its joints cannot follow.
    #[error("after {distance_mm} mm of the pass the arm is in a singularity")]
    Singular {
        /// Where. mm
        distance_mm: f64,
    },
}

/// The joint angles of a pass over time, from closed-form inverse kinematics at knots a millimetre apart with the
/// slopes there, and cubics between.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// How it starts.
    pub ramp: Ramp,
    /// How far it goes. m
    pub length: f64,
    spacing: f64,
    knots: Vec<Knot>,
    /// The tool frame at the start, in the base frame.
    pub start: Pose<f64>,
    /// Direction of the feed in the base frame.
    pub direction: Vector3<f64>,
}

/// Joint angles (rad) and their derivatives along the pass (rad/m).
#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    angles: [f64; 6],
    slopes: [f64; 6],
}

/// Distance of the knots at most. m
const SPACING: f64 = 1e-3;
/// A joint that turns faster than this along the pass is at a singularity. rad/m
const STEEPEST: f64 = 1e3;

impl Motion {
    /// Follows the pass with the inverse kinematics, in the posture of the start, each joint going on from where it
    /// was.
    ///
    /// # Errors
    /// [`MotionError`] where the arm cannot follow.
    pub fn new(robot: &Robot, spindle: &Spindle, pass: &Pass, ramp: Ramp) -> Result<Self, MotionError> {
        let posture = Posture::of(robot, &pass.start);
        let flange = robot.forward(&pass.start);
        let count = (pass.length / SPACING).ceil().max(1.0);
        let spacing = pass.length / count;
        let mut knots = Vec::with_capacity(count as usize + 1);
        let mut before = pass.start;
        for k in 0..=count as usize {
            let distance = spacing * k as f64;
            let distance_mm = distance * 1e3;
            let target = Pose { translation: flange.translation + pass.direction * distance, ..flange };
            let wrapped =
                robot.inverse(&target, posture).map_err(|reason| MotionError::Unreachable { distance_mm, reason })?;
            let angles: [f64; 6] = std::array::from_fn(|j| wrapped[j] + TAU * ((before[j] - wrapped[j]) / TAU).round());
            for (j, joint) in robot.joints().iter().enumerate() {
                if angles[j] < joint.min - ANGLE_ROUNDING || angles[j] > joint.max + ANGLE_ROUNDING {
                    return Err(MotionError::Limit { distance_mm, joint: j + 1, angle_deg: angles[j].to_degrees() });
                }
            }
            let jacobian = Frames::new(robot, &angles).jacobian(&target.translation);
            let mut velocity = Vector6::zeros();
            velocity.fixed_rows_mut::<3>(0).copy_from(&pass.direction);
            let slopes = jacobian.lu().solve(&velocity).ok_or(MotionError::Singular { distance_mm })?;
            let jumped = k > 0 && (0..6).any(|j| (angles[j] - before[j]).abs() > STEEPEST * spacing);
            if jumped || slopes.amax() > STEEPEST {
                return Err(MotionError::Singular { distance_mm });
            }
            knots.push(Knot { angles, slopes: slopes.into() });
            before = angles;
        }
        let start = flange.then(&spindle.flange_from_tool);
        Ok(Self { ramp, length: pass.length, spacing, knots, start, direction: pass.direction })
    }

    /// When the pass is completed. s
    pub fn duration(&self) -> f64 {
        self.ramp.time_of(self.length)
    }

    /// The frame of a cut along the pass, with the wall on a side of the feed.
    pub fn cut_frame(&self, wall: Side) -> CutFrame {
        CutFrame::new(self.direction, -self.start.rotation.column(2), wall)
    }

    /// Where the tool centre point should be (m, base frame) at a time (s), and the distance from the start (m).
    pub fn tool(&self, time: f64) -> (Vector3<f64>, f64) {
        let distance = self.ramp.at(time).0;
        (self.start.translation + self.direction * distance, distance)
    }

    /// Angles (rad) and speeds (rad/s) of the motors at a time (s); beyond the end of the pass as the last cubic goes
    /// on.
    pub fn motors(&self, time: f64) -> ([f64; 6], [f64; 6]) {
        let (distance, feed) = self.ramp.at(time);
        self.motors_at(distance, feed)
    }

    /// Angles (rad) and speeds (rad/s) of the motors at a distance (m) from the start, at a feed (m/s).
    pub fn motors_at(&self, distance: f64, feed: f64) -> ([f64; 6], [f64; 6]) {
        let index = ((distance / self.spacing).floor().max(0.0) as usize).min(self.knots.len() - 2);
        let (a, b) = (&self.knots[index], &self.knots[index + 1]);
        let (h, u) = (self.spacing, distance / self.spacing - index as f64);
        let (mut angles, mut speeds) = ([0.0; 6], [0.0; 6]);
        for j in 0..6 {
            // Hermite's cubic, written about its left end.
            let rise = (b.angles[j] - a.angles[j]) / h;
            let second = 3.0 * rise - 2.0 * a.slopes[j] - b.slopes[j];
            let third = a.slopes[j] + b.slopes[j] - 2.0 * rise;
            angles[j] = a.angles[j] + h * u * (a.slopes[j] + u * (second + u * third));
            speeds[j] = feed * (a.slopes[j] + u * (2.0 * second + u * 3.0 * third));
        }
        (angles, speeds)
    }
}

#[cfg(test)]
mod tests;
