//! One constraint on one state or step, measured: by how much it holds or is broken.

use super::ConstraintKind;
use crate::evaluate::reference::State;
use crate::problem::Problem;
use std::fmt;
use std::sync::Arc;
use stead_model::robot::{Robot, Unreachable, angles::ANGLE_ROUNDING, turns::Range};

/// Joint steps are compared with their limits up to this (rad), steps of beta up to this share of the grid's step:
/// rounding.
pub const STEP_ROUNDING: f64 = 1e-9;

/// What shapes that touch are counted as beyond their clearance: as much as 0.1 m.
const TOUCHING: f64 = 1.0;

/// A constraint with what it is measured by.
#[derive(Debug, Clone, PartialEq)]
pub enum Measured {
    /// The posture does not reach the point.
    Reach(Unreachable),
    /// A joint angle, held against the nearer of its limits.
    JointLimit {
        /// The joint, from 1.
        joint: u8,
        /// The joint angle. rad
        angle: f64,
        /// The nearer limit. rad
        limit: f64,
        /// The signed distance to it, positive inside. rad
        margin: f64,
    },
    /// The sum of joint angles 2 and 3, held against the nearer of its limits.
    AxesSum {
        /// The sum. rad
        angle: f64,
        /// The nearer limit. rad
        limit: f64,
        /// The signed distance to it, positive inside. rad
        margin: f64,
    },
    /// 1/kappa_F, held against its bound.
    Conditioning {
        /// What it is.
        value: f64,
        /// What it must be at least.
        limit: f64,
    },
    /// The distance of the tool centre point from axis 1, held against the smallest allowed.
    BaseDistance {
        /// What it is. m
        value: f64,
        /// What it must be at least. m
        limit: f64,
    },
    /// The score of a point, held against c_max.
    MaxDeflection {
        /// What it is. m
        value: f64,
        /// What it may be. m
        limit: f64,
    },
    /// The distance of two shapes, or of a point of the arm from a zone, held against the smallest allowed.
    Clearance {
        /// Their names.
        names: Arc<[String; 2]>,
        /// What it is; zero or less where they touch. m
        distance: f64,
        /// What it must be at least. m
        required: f64,
    },
    /// The step of a joint from one path point to the next; of joint 3 of an arm with a linkage that of the sum of
    /// joints 2 and 3.
    JointStep {
        /// The joint, from 1.
        joint: u8,
        /// The size of the step. rad
        step: f64,
        /// Its limit. rad
        limit: f64,
    },
    /// The step of beta from one path point to the next.
    BetaRate {
        /// The size of the step. rad
        step: f64,
        /// Its limit. rad
        limit: f64,
    },
    /// The angle between the tool frames at one path point and the next.
    SpindleTurn {
        /// What it is. rad
        turn: f64,
        /// What it may be. rad
        limit: f64,
    },
}

impl Measured {
    /// The kind of constraint.
    pub fn kind(&self) -> ConstraintKind {
        match *self {
            Self::Reach(_) => ConstraintKind::Reach,
            Self::JointLimit { joint, .. } => ConstraintKind::JointLimit(joint),
            Self::AxesSum { .. } => ConstraintKind::AxesSum,
            Self::Conditioning { .. } => ConstraintKind::Conditioning,
            Self::BaseDistance { .. } => ConstraintKind::BaseDistance,
            Self::MaxDeflection { .. } => ConstraintKind::MaxDeflection,
            Self::Clearance { .. } => ConstraintKind::Clearance,
            Self::JointStep { .. } => ConstraintKind::JointStep,
            Self::BetaRate { .. } => ConstraintKind::BetaRate,
            Self::SpindleTurn { .. } => ConstraintKind::SpindleTurn,
        }
    }

    /// The signed margin, positive where the constraint holds: m of reach or score, rad, or a difference of 1/kappa_F.
    pub fn margin(&self) -> f64 {
        match *self {
            Self::Reach(unreachable) => -unreachable.by(),
            Self::JointLimit { margin, .. } | Self::AxesSum { margin, .. } => margin,
            Self::Conditioning { value, limit } | Self::BaseDistance { value, limit } => value - limit,
            Self::MaxDeflection { value, limit } => limit - value,
            // Shapes that touch break the constraint also where no clearance is requested.
            Self::Clearance { distance, required, .. } if distance <= 0.0 => {
                (distance - required).min(-f64::MIN_POSITIVE)
            }
            Self::Clearance { distance, required, .. } => distance - required,
            Self::JointStep { step, limit, .. } | Self::BetaRate { step, limit } => limit - step,
            Self::SpindleTurn { turn, limit } => limit - turn,
        }
    }

    /// Whether the constraint holds, up to the rounding of angles and steps.
    pub fn holds(&self) -> bool {
        let rounding = match self {
            Self::JointLimit { .. } | Self::AxesSum { .. } => ANGLE_ROUNDING,
            Self::JointStep { .. } | Self::BetaRate { .. } | Self::SpindleTurn { .. } => STEP_ROUNDING,
            Self::Reach(_)
            | Self::Conditioning { .. }
            | Self::BaseDistance { .. }
            | Self::Clearance { .. }
            | Self::MaxDeflection { .. } => 0.0,
        };
        self.margin() >= -rounding
    }

    /// How badly a constraint is broken, to tell which of several states comes nearest to being allowed: in tenths of a
    /// metre or radian, or relative.
    pub fn severity(&self) -> f64 {
        match *self {
            // A point out of reach has no joint angles, so it counts as farther off than any state that has them.
            Self::Reach(_) => 100.0 - self.margin() * 10.0,
            // How far shapes are into each other is not known.
            Self::Clearance { distance, .. } if distance <= 0.0 => TOUCHING - self.margin() * 10.0,
            Self::JointLimit { .. }
            | Self::AxesSum { .. }
            | Self::JointStep { .. }
            | Self::BetaRate { .. }
            | Self::SpindleTurn { .. }
            | Self::Clearance { .. }
            | Self::BaseDistance { .. } => -self.margin() * 10.0,
            Self::Conditioning { value, limit } => 1.0 - value / limit,
            Self::MaxDeflection { value, limit } => value / limit - 1.0,
        }
    }
}

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Reach(Unreachable::InsideOffset { by }) => {
                write!(f, "wrist centre {:.1} mm too near to axis 1 for the arm's lateral offset", by * 1e3)
            }
            Self::Reach(Unreachable::TooFar { by }) => {
                write!(f, "wrist centre {:.1} mm beyond the stretched arm", by * 1e3)
            }
            Self::Reach(Unreachable::TooNear { by }) => {
                write!(f, "wrist centre {:.1} mm nearer to the shoulder than the folded arm", by * 1e3)
            }
            Self::JointLimit { angle, limit, .. } | Self::AxesSum { angle, limit, .. } => {
                let (side, by) = if angle > limit { ("above", angle - limit) } else { ("below", limit - angle) };
                let (angle, limit, by) = (angle.to_degrees(), limit.to_degrees(), by.to_degrees());
                match *self {
                    Self::JointLimit { joint, .. } => write!(f, "joint {joint}")?,
                    _ => f.write_str("the sum of joints 2 and 3")?,
                }
                write!(f, " at {angle:.2} deg is {by:.2} deg {side} its limit {limit:.2} deg")
            }
            Self::Conditioning { value, limit } => {
                write!(f, "1/kappa {value:.4} is {:.4} below {limit}", limit - value)
            }
            Self::BaseDistance { value, limit } => {
                let (value, by, limit) = (value * 1e3, (limit - value) * 1e3, limit * 1e3);
                write!(
                    f,
                    "the path is {value:.1} mm from axis 1, {by:.1} mm nearer than min_base_distance = {limit} mm"
                )
            }
            Self::Clearance { ref names, distance, required } if distance <= 0.0 => {
                write!(f, "{} and {} touch, limit {:.1} mm apart", names[0], names[1], required * 1e3)
            }
            Self::Clearance { ref names, distance, required } => {
                let (distance, by, required) = (distance * 1e3, (required - distance) * 1e3, required * 1e3);
                let [a, b] = names.as_ref();
                write!(f, "{a} and {b} are {distance:.1} mm apart, {by:.1} mm nearer than {required:.1} mm")
            }
            Self::MaxDeflection { value, limit } => {
                let (value, by, limit) = (value * 1e3, (value - limit) * 1e3, limit * 1e3);
                write!(f, "deflection {value:.4} mm is {by:.4} mm above c_max = {limit} mm")
            }
            Self::JointStep { joint, step, limit } => {
                write!(f, "joint {joint} steps {:.3} deg, limit {:.3} deg", step.to_degrees(), limit.to_degrees())
            }
            Self::BetaRate { step, limit } => {
                write!(f, "beta steps {:.3} deg, limit {:.3} deg", step.to_degrees(), limit.to_degrees())
            }
            Self::SpindleTurn { turn, limit } => {
                write!(f, "the spindle turns {:.3} deg, limit {:.3} deg", turn.to_degrees(), limit.to_degrees())
            }
        }
    }
}

/// The constraints on real joint angles (rad): the limits of each, and those of the sum of 2 and 3.
pub fn on_joints(problem: &Problem, joints: &[f64; 6]) -> impl Iterator<Item = Measured> + use<> {
    let nearer = |angle: f64, range: Range| {
        let (below, above) = (angle - range.min, range.max - angle);
        if above < below { (range.max, above) } else { (range.min, below) }
    };
    let each: [Measured; 6] = std::array::from_fn(|j| {
        let (angle, joint) = (joints[j], &problem.robot.joints()[j]);
        let (limit, margin) = nearer(angle, Range::of(joint));
        Measured::JointLimit { joint: j as u8 + 1, angle, limit, margin }
    });
    let sum = problem.robot.sum_range().map(|range| {
        let angle = problem.robot.sum_of(joints);
        let (limit, margin) = nearer(angle, range);
        Measured::AxesSum { angle, limit, margin }
    });
    each.into_iter().chain(sum)
}

/// The constraints on a single state beside joint limits: conditioning, the distance from axis 1 and the largest score.
pub fn on_state(problem: &Problem, state: &State<f64>) -> impl Iterator<Item = Measured> + use<> {
    let conditioning =
        Measured::Conditioning { value: state.inverse_condition, limit: problem.constraints.min_inverse_condition };
    let value = state.score();
    let deflection = problem.constraints.max_deflection.map(|limit| Measured::MaxDeflection { value, limit });
    let limit = problem.constraints.min_base_distance;
    let distance = (limit > 0.0).then_some(Measured::BaseDistance { value: state.base_distance, limit });
    [Some(conditioning), distance, deflection].into_iter().flatten()
}

/// Whether the steps of all real joint angles (rad) between neighbouring path points are within their limits: the same
/// as that every constraint of [`on_joint_steps`] holds, for loops over many pairs. What steps is what the motors turn
/// ([`Robot::drives`]).
#[inline]
pub fn joint_steps_hold(robot: &Robot, from: &[f64; 6], to: &[f64; 6], limits: &[f64; 6]) -> bool {
    let (from, to) = (robot.drives(from), robot.drives(to));
    (0..6).all(|j| (to[j] - from[j]).abs() <= limits[j] + STEP_ROUNDING)
}

/// The constraints on the steps of the real joint angles (rad) between neighbouring path points.
pub fn on_joint_steps(robot: &Robot, from: &[f64; 6], to: &[f64; 6], limits: &[f64; 6]) -> [Measured; 6] {
    let (from, to) = (robot.drives(from), robot.drives(to));
    std::array::from_fn(|j| Measured::JointStep { joint: j as u8 + 1, step: (to[j] - from[j]).abs(), limit: limits[j] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::five_segments;
    use std::f64::consts::PI;
    use stead_model::robot::testing::{irb4400, kr270};

    #[test]
    fn margins_are_positive_inside_and_negative_outside() {
        let problem = five_segments();
        let joints = problem.robot.joints();
        let middle = joints.each_ref().map(|joint| (joint.min + joint.max) / 2.0);
        assert!(on_joints(&problem, &middle).all(|measured| measured.holds() && measured.margin() > 0.0));
        for j in 0..6 {
            for (limit, side) in [(joints[j].min, -1.0), (joints[j].max, 1.0)] {
                let mut angles = middle;
                angles[j] = limit + side * 0.01;
                let broken: Vec<_> = on_joints(&problem, &angles).filter(|m| !m.holds()).collect();
                assert_eq!(
                    broken.iter().map(Measured::kind).collect::<Vec<_>>(),
                    [ConstraintKind::JointLimit(j as u8 + 1)]
                );
                assert!((broken[0].margin() + 0.01).abs() < 1e-12 && (broken[0].severity() - 0.1).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_fast_form_of_steps_agrees() {
        let (from, limits) = ([0.3; 6], [0.1, 0.2, 0.3, 0.4, 0.5, PI]);
        for j in 0..6 {
            for (excess, holds) in [(-1e-6, true), (0.0, true), (1e-6, false)] {
                for side in [-1.0, 1.0] {
                    let mut to = from;
                    to[j] += side * (limits[j] + excess);
                    assert_eq!(joint_steps_hold(&kr270(), &from, &to, &limits), holds);
                    assert_eq!(on_joint_steps(&kr270(), &from, &to, &limits).iter().all(Measured::holds), holds);
                }
            }
        }
    }

    #[test]
    fn the_sum_of_joints_2_and_3_has_limits_and_motor_3_steps_by_it() {
        let mut parts = five_segments().into_parts();
        parts.robot = irb4400();
        let problem = parts.build().unwrap();
        let degrees = |second: f64, third: f64| [0.0, second, third, 0.0, 10.0, 0.0].map(f64::to_radians);
        let broken = |joints: [f64; 6]| {
            on_joints(&problem, &joints).filter(|m| !m.holds()).map(|m| (m.kind(), m.to_string())).collect::<Vec<_>>()
        };
        // Joint 2 from -5 to 160 deg, joint 3 from -230 to -130, their sum from -155 to -30.
        assert_eq!(broken(degrees(90.0, -180.0)), []);
        let [(kind, text)] = &broken(degrees(120.0, -140.0))[..] else { panic!() };
        assert_eq!(*kind, ConstraintKind::AxesSum);
        assert_eq!(text, "the sum of joints 2 and 3 at -20.00 deg is 10.00 deg above its limit -30.00 deg");
        let [(_, text)] = &broken(degrees(20.0, -190.0))[..] else { panic!() };
        assert!(text.contains("at -170.00 deg is 15.00 deg below its limit -155.00 deg"), "{text}");
        assert!(problem.constraint_kinds().contains(&ConstraintKind::AxesSum));
        // Both together by 3 deg leave the forearm where it is; one alone is a step of motor 3.
        let from = degrees(90.0, -180.0);
        let limits = [4.0, 4.0, 2.0, 4.0, 4.0, 4.0].map(f64::to_radians);
        for (to, holds) in [
            (degrees(93.0, -183.0), true),
            (degrees(90.0, -183.0), false),
            (degrees(93.0, -180.0), false),
            (degrees(95.0, -185.0), false),
        ] {
            assert_eq!(joint_steps_hold(&problem.robot, &from, &to, &limits), holds);
            let measured = on_joint_steps(&problem.robot, &from, &to, &limits);
            assert_eq!(measured.iter().all(Measured::holds), holds);
        }
    }
}
