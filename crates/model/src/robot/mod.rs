//! The robot: geometry, kinematics, Jacobian, conditioning, joint limits and turns.
//!
//! A [`Robot`] is six revolute joints given by modified Denavit-Hartenberg rows,
//! `T_(i-1,i) = Rx(alpha_i) Tx(a_i) Rz(theta_i) Tz(d_i)` (Khalil and Dombre 2002), whose last three axes meet in one
//! point, the wrist centre. [`Robot::new`] refuses an arm that is not of that kind, with the reason, so that everything
//! above this room may rely on the closed-form inverse of [`Robot::inverse`] and on the block structure behind
//! [`conditioning::inverse_condition`].
//!
//! ```
//! use stead_model::robot::{Joint, Posture, Robot};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let upper = [(0.0, 0.0, 0.0), (90.0, 0.35, 0.0), (0.0, 1.25, 0.0)];
//! let wrist = [(-90.0, 0.055, 1.1), (90.0, 0.0, 0.0), (-90.0, 0.0, 0.0)];
//! let rows: [_; 6] = std::array::from_fn(|k| if k < 3 { upper[k] } else { wrist[k - 3] });
//! let joints = rows.map(|(alpha, a, d): (f64, f64, f64)| Joint {
//!     alpha: alpha.to_radians(), a, d, min: -6.0, max: 6.0,
//!     max_speed: None, max_acceleration: None, max_jerk: None, compliance: 1e-6.into(),
//! });
//! let robot = Robot::new("example", joints)?;
//! let theta = [0.1, 0.9, -1.8, 0.3, 0.7, -0.2];
//! let pose = robot.forward(&theta);
//! let back = robot.inverse(&pose, Posture::of(&robot, &theta))?;
//! assert!(theta.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-9));
//! # Ok(())
//! # }
//! ```

pub mod angles;
mod axes_2_3;
pub mod chain;
mod compliance;
pub mod conditioning;
mod controller;
mod data_sheet;
mod dynamics;
mod forward;
mod geometry;
mod inertial;
mod inverse;
mod margin;
mod mount;
mod pose;
pub mod posture;
mod shipped;
mod spindle;
mod springs;
pub mod turns;
mod uncertainty;

pub use axes_2_3::Axes23;
pub use compliance::{Compensator, Compliance};
pub use controller::{Controller, ControllerKind, kuka_status_and_turn};
pub use data_sheet::DataSheet;
pub use dynamics::{JointDynamics, Orthogonal};
pub use forward::Frames;
pub use geometry::Geometry;
pub use inertial::{Inertial, InertialError, PointMass};
pub use inverse::Unreachable;
pub use pose::{Pose, cast};
pub use posture::{Posture, PostureClass, PostureWord, PostureWords};
pub use shipped::ShippedArm;
pub use spindle::{Spindle, point_from_tool};
pub use springs::{About, BaseCompliance, MeasuredFrom, NormalSprings, Spring, SpringModel};
pub use uncertainty::{Parameter, Uncertainty, UncertaintyError};

use chain::{Axis, Chain, Link};

/// One row of the arm, base first: modified Denavit-Hartenberg parameters, limits, compliance.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Twist about the previous x axis, before the joint. rad
    pub alpha: f64,
    /// Offset along the previous x axis, before the joint. m
    pub a: f64,
    /// Offset along the joint axis. m
    pub d: f64,
    /// Lower limit of the joint angle. rad
    pub min: f64,
    /// Upper limit of the joint angle. rad
    pub max: f64,
    /// Largest joint speed, where known. rad/s
    pub max_speed: Option<f64>,
    /// Largest joint acceleration, where known. rad/s^2
    pub max_acceleration: Option<f64>,
    /// Largest joint jerk, where known. rad/s^3
    pub max_jerk: Option<f64>,
    /// Compliance of joint and drive about the axis (the inverse of the joint stiffness), a number or a law.
    pub compliance: Compliance,
}

/// Joint stiffness that is that of another arm.
#[derive(Debug, Clone, PartialEq, Eq)]
struct BorrowedStiffness {
    /// The other arm.
    of: String,
    /// The name of the arm with the stiffness of the other.
    name: String,
}

/// A checked six-axis arm with a spherical wrist.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    name: String,
    stiffness_like: Option<Box<BorrowedStiffness>>,
    joints: [Joint; 6],
    geometry: Geometry,
    rows: [Pose<f64>; 6],
    /// Pose of the base frame of the rows in the cell frame, where that is another.
    mount: Option<Pose<f64>>,
    flange: f64,
    data_sheet: DataSheet,
    uncertainty: Option<Uncertainty>,
    /// Springs beside those about the axes.
    springs: Box<springs::Springs>,
    dynamics: Option<Box<[JointDynamics; 6]>>,
    /// What joins axes 2 and 3.
    axes_2_3: Option<Axes23>,
    controller: Option<Box<Controller>>,
    unverified: Vec<String>,
}

/// Why six rows do not make an arm that this crate can work with.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobotError {
    /// A number of a row is NaN or infinite.
    #[error("joint {joint}: {field} is {value}, but must be a finite number")]
    NotFinite {
        /// Number of the joint, from 1.
        joint: usize,
        /// Which number of the row.
        field: &'static str,
        /// What was found.
        value: f64,
    },
    /// The lower limit is not below the upper limit.
    #[error("joint {joint}: the lower limit {min_deg} deg is not below the upper limit {max_deg} deg")]
    Limits {
        /// Number of the joint, from 1.
        joint: usize,
        /// Lower limit in degrees.
        min_deg: f64,
        /// Upper limit in degrees.
        max_deg: f64,
    },
    /// A compliance, speed, acceleration or jerk that is not above zero.
    #[error("joint {joint}: {field} is {value}, but must be above zero")]
    NotPositive {
        /// Number of the joint, from 1.
        joint: usize,
        /// Which number of the row.
        field: &'static str,
        /// What was found.
        value: f64,
    },
    /// A compliance normal to the axis that is below zero.
    #[error("joint {joint}: {field} is {value}, but must not be below zero")]
    Negative {
        /// Number of the joint, from 1.
        joint: usize,
        /// Which number of the row.
        field: &'static str,
        /// What was found.
        value: f64,
    },
    /// The compliance is a range over the joint angle, but one wrapped angle has several real ones.
    #[error(
        "joint {joint}: a compliance that changes from limit to limit needs limits less than 360 deg apart, and not {range_deg} deg"
    )]
    AmbiguousRange {
        /// Number of the joint, from 1.
        joint: usize,
        /// Upper limit less lower limit, in degrees.
        range_deg: f64,
    },
    /// The two ends of a compensator's spring meet at an angle within the limits.
    #[error("joint {joint}: the two ends of the compensator's spring meet at {angle_deg} deg")]
    SpringVanishes {
        /// Number of the joint, from 1.
        joint: usize,
        /// Where, in degrees.
        angle_deg: f64,
    },
    /// With its compensator a joint has no positive stiffness at an angle within the limits.
    #[error(
        "joint {joint}: with its compensator the stiffness at {angle_deg} deg is {stiffness} N m/rad, but must be above zero"
    )]
    GivesWay {
        /// Number of the joint, from 1.
        joint: usize,
        /// Where, in degrees.
        angle_deg: f64,
        /// The sum of the stiffnesses of joint and spring there. N m/rad
        stiffness: f64,
    },
    /// What is said to join axes 2 and 3 does not.
    #[error("axes 2 and 3: {field} {reason}")]
    Sum {
        /// Which of it.
        field: &'static str,
        /// The rule, with the value found.
        reason: String,
    },
    /// A figure of the data sheet that is not a finite number above zero.
    #[error("data sheet: {field} is {value}, but must be a finite number above zero")]
    DataSheet {
        /// Which figure.
        field: &'static str,
        /// What was found.
        value: f64,
    },
    /// The geometry is not that of an elbow arm with a spherical wrist.
    #[error("joint {joint}: {reason}")]
    Geometry {
        /// Number of the joint whose row breaks the rule, from 1.
        joint: usize,
        /// Which row entry breaks the rule, as named in robot files without its unit.
        field: &'static str,
        /// The rule, with the value found.
        reason: String,
    },
}

impl Robot {
    /// Checks six rows, base first.
    ///
    /// # Errors
    /// [`RobotError`] when a number is not finite or out of its range, or when the arm is not an elbow arm (axis 2
    /// normal to axis 1, axis 3 parallel to axis 2, axis 4 normal to axis 3) with a spherical wrist (axes 4, 5, 6 meet
    /// in one point, neighbours at right angles).
    pub fn new(name: impl Into<String>, joints: [Joint; 6]) -> Result<Self, RobotError> {
        for (index, joint) in joints.iter().enumerate() {
            check_joint(index + 1, joint)?;
        }
        let geometry = Geometry::new(&joints)?;
        Ok(Self {
            name: name.into(),
            stiffness_like: None,
            rows: geometry.rows(&joints),
            joints,
            geometry,
            mount: None,
            flange: 0.0,
            data_sheet: DataSheet::default(),
            uncertainty: None,
            springs: Box::default(),
            dynamics: None,
            axes_2_3: None,
            controller: None,
            unverified: Vec::new(),
        })
    }

    /// The name by which results call the arm: that of the robot file, with that of another arm where the joint
    /// stiffness is that one's.
    pub fn name(&self) -> &str {
        self.stiffness_like.as_ref().map_or(&self.name, |borrowed| &borrowed.name)
    }

    /// The arm whose joint stiffness this one is given, where it is not its own.
    pub fn stiffness_like(&self) -> Option<&str> {
        self.stiffness_like.as_ref().map(|borrowed| borrowed.of.as_str())
    }

    /// The same arm, with a joint stiffness that is that of another one.
    #[must_use]
    pub fn with_stiffness_like(mut self, other: &str) -> Self {
        let name = format!("{} (stiffness of {other})", self.name);
        self.stiffness_like = Some(Box::new(BorrowedStiffness { of: other.to_owned(), name }));
        self
    }

    /// Which of its numbers nobody has checked against their source, each with what is known of them.
    pub fn unverified(&self) -> &[String] {
        &self.unverified
    }

    /// The same arm, with numbers that nobody has checked against their source.
    pub fn with_unverified(mut self, unverified: Vec<String>) -> Self {
        self.unverified = unverified;
        self
    }

    /// The six rows, base first.
    pub fn joints(&self) -> &[Joint; 6] {
        &self.joints
    }

    /// The middle of the range of every joint. rad
    pub fn mid_range(&self) -> [f64; 6] {
        self.joints.each_ref().map(|joint| (joint.min + joint.max) / 2.0)
    }

    /// The frame of every row at joint angle zero, in that before it (the base frame of the rows for the first).
    pub fn rows(&self) -> &[Pose<f64>; 6] {
        &self.rows
    }

    /// The arm as a [`Chain`] with a body behind every joint, given in the frame of its row, and a tip in the flange
    /// frame.
    pub fn chain(&self, bodies: &[Inertial; 6], flange_from_tip: Pose<f64>) -> Chain<6> {
        let rows = self.mounted_rows();
        let links = std::array::from_fn(|j| Link::new(rows[j], Axis::Z, Some(bodies[j])));
        Chain::new(links, flange_from_tip)
    }

    /// The geometry of the arm, as the closed-form inverse uses it.
    pub fn geometry(&self) -> &Geometry {
        &self.geometry
    }
}

impl Joint {
    /// Whether an angle is beyond one of its limits by more than a margin. rad
    pub fn is_beyond(&self, angle: f64, margin: f64) -> bool {
        !(self.min - margin..=self.max + margin).contains(&angle)
    }
}

fn check_joint(number: usize, joint: &Joint) -> Result<(), RobotError> {
    let finite =
        [("alpha", joint.alpha), ("a", joint.a), ("d", joint.d), ("min", joint.min), ("max", joint.max)].into_iter();
    let speeds =
        [("max_speed", joint.max_speed), ("max_acceleration", joint.max_acceleration), ("max_jerk", joint.max_jerk)];
    let positive: Vec<_> = speeds
        .into_iter()
        .filter_map(|(field, value)| value.map(|value| (field, value)))
        .chain(joint.compliance.positive())
        .collect();
    for (field, value) in finite.chain(joint.compliance.finite()).chain(positive.iter().copied()) {
        if !value.is_finite() {
            return Err(RobotError::NotFinite { joint: number, field, value });
        }
    }
    for (field, value) in positive {
        if value <= 0.0 {
            return Err(RobotError::NotPositive { joint: number, field, value });
        }
    }
    if joint.min >= joint.max {
        return Err(RobotError::Limits {
            joint: number,
            min_deg: joint.min.to_degrees(),
            max_deg: joint.max.to_degrees(),
        });
    }
    Compliance::check(number, joint)
}

#[cfg(any(test, feature = "testing"))]
pub mod testing {
    //! Arms for the tests of this crate and of those above.
    use super::*;
    use nalgebra::{matrix, vector};

    /// Rows (alpha deg, a m, d m, min deg, max deg, stiffness MN m/rad) to a robot.
    pub fn robot_from(rows: [(f64, f64, f64, f64, f64, f64); 6]) -> Robot {
        let joints = rows.map(|(alpha, a, d, min, max, stiffness)| Joint {
            alpha: alpha.to_radians(),
            a,
            d,
            min: min.to_radians(),
            max: max.to_radians(),
            max_speed: None,
            max_acceleration: None,
            max_jerk: None,
            compliance: (1e-6 / stiffness).into(),
        });
        Robot::new("test", joints).unwrap_or_else(|e| unreachable!("{e}"))
    }

    /// The KUKA KR270-2 of Caro 2013.
    pub fn kr270() -> Robot {
        robot_from([
            (0.0, 0.0, 0.0, -185.0, 185.0, 0.237),
            (90.0, 0.35, 0.0, 0.0, 146.0, 3.32),
            (0.0, 1.25, 0.0, -245.0, 29.0, 2.79),
            (-90.0, 0.055, 1.1, -350.0, 350.0, 0.486),
            (90.0, 0.0, 0.0, -125.0, 125.0, 0.521),
            (-90.0, 0.0, 0.0, -350.0, 350.0, 0.38),
        ])
    }

    /// The ABB IRB 4400-60 (rows of its robot file), whose axis 3 a parallelogram drives, with springs of
    /// 2.5, 2.5, 2, 0.4, 0.4 and 0.3 MN m/rad and ABB's angles, A3 counted against the horizontal.
    pub fn irb4400() -> Robot {
        let arm = robot_from([
            (0.0, 0.0, 0.68, -165.0, 165.0, 2.5),
            (90.0, 0.2, 0.0, -5.0, 160.0, 2.5),
            (0.0, 0.89, 0.0, -230.0, -130.0, 2.0),
            (-90.0, -0.15, 0.88, -200.0, 200.0, 0.4),
            (90.0, 0.0, 0.0, -120.0, 120.0, 0.4),
            (-90.0, 0.0, 0.14, -400.0, 400.0, 0.3),
        ]);
        let sum = turns::Range { min: -155_f64.to_radians(), max: -30_f64.to_radians() };
        let offset = [0.0, 90.0, -180.0, 0.0, 0.0, 0.0].map(f64::to_radians);
        let sign = [1.0, -1.0, -1.0, 1.0, -1.0, 1.0];
        let (kind, root_from_base) = (ControllerKind::Abb, Some(Pose::identity()));
        arm.with_axes_2_3(Some(Axes23 { linkage: true, sum }))
            .unwrap_or_else(|e| unreachable!("{e}"))
            .with_controller(Controller { kind, sign, offset, is_j3_level: Some(true), root_from_base })
    }

    /// The arms of [`odd_arms`] with a parallelogram beside axes 2 and 3, whose ranges are narrowed for it.
    pub fn linked_arms() -> Vec<Robot> {
        let linked = |arm: Robot| {
            let mut joints = arm.joints().clone();
            for joint in [1, 2] {
                (joints[joint].min, joints[joint].max) = (-3.0, 3.0);
            }
            let sum = turns::Range { min: -2.0, max: 2.0 };
            Robot::new("linked", joints).and_then(|arm| arm.with_axes_2_3(Some(Axes23 { linkage: true, sum })))
        };
        odd_arms().into_iter().map(|arm| linked(arm).unwrap_or_else(|e| unreachable!("{e}"))).collect()
    }

    /// Arms with every sign of twist, offsets at shoulder and wrist, and a tilted base.
    pub fn odd_arms() -> Vec<Robot> {
        let wide = (-350.0, 350.0);
        let mut arms = Vec::new();
        for signs in 0..32 {
            let s = |bit: u32| if signs >> bit & 1 == 0 { 90.0 } else { -90.0 };
            let fold = if signs >> 4 & 1 == 0 { 0.0 } else { 180.0 };
            arms.push(robot_from([
                (20.0, 0.1, 0.4, wide.0, wide.1, 1.0),
                (s(0), 0.3, 0.07, wide.0, wide.1, 2.0),
                (fold, 0.9, -0.02, wide.0, wide.1, 3.0),
                (s(1), -0.05, 0.8, wide.0, wide.1, 4.0),
                (s(2), 0.0, 0.0, wide.0, wide.1, 5.0),
                (s(3), 0.0, 0.15, wide.0, wide.1, 6.0),
            ]));
        }
        arms
    }

    /// The spindle of Caro 2013, eq. 9.
    pub fn spindle() -> Spindle {
        let h = std::f64::consts::FRAC_1_SQRT_2;
        Spindle::new(matrix![0.0, -h, h; 1.0, 0.0, 0.0; 0.0, h, h], vector![0.0, 0.0, 0.684])
            .unwrap_or_else(|e| unreachable!("{e}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rejects_what_is_no_arm() {
        let good = testing::kr270();
        let mut joints = good.joints().clone();
        joints[2].compliance = (-1.0).into();
        assert!(matches!(Robot::new("x", joints), Err(RobotError::NotPositive { joint: 3, field: "compliance", .. })));
        let mut joints = good.joints().clone();
        joints[4].a = f64::NAN;
        assert!(matches!(Robot::new("x", joints), Err(RobotError::NotFinite { joint: 5, field: "a", .. })));
        let mut joints = good.joints().clone();
        (joints[1].min, joints[1].max) = (1.0, -1.0);
        assert!(matches!(Robot::new("x", joints), Err(RobotError::Limits { joint: 2, .. })));
        let mut joints = good.joints().clone();
        joints[4].d = 0.1;
        assert!(matches!(Robot::new("x", joints), Err(RobotError::Geometry { joint: 5, field: "d", .. })));
    }
}
