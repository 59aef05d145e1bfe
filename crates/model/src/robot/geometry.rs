//! The shape of an elbow arm with a spherical wrist, reduced to what its closed-form inverse needs.

use super::pose::Pose;
use super::{Joint, RobotError};
use nalgebra::{Matrix3, Vector3};

/// An arm's shape, in the *root* frame: the base frame after the constant part of the first row, so that axis 1 is the
/// z axis through the origin.
///
/// The wrist centre moves in the plane spanned by the turned x axis and z, at a constant lateral offset from it:
/// shoulder at (`shoulder_radius`, `shoulder_height`), upper arm, then the forearm as one bar from axis 3 to the wrist
/// centre. Signs are those of the sines of the twists, each +1 or -1.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    /// Rotation from root to base coordinates; to those of the cell for an arm that is mounted
    /// ([`Robot::mounted`](super::Robot::mounted)).
    pub base_from_root: Matrix3<f64>,
    /// Origin of the root frame in the base frame. m
    pub root_in_base: Vector3<f64>,
    /// Distance of axis 2 from axis 1, `a_2`. m
    pub shoulder_radius: f64,
    /// Height of axis 2 in the root frame, `d_1`. m
    pub shoulder_height: f64,
    /// Length of the upper arm, `a_3`, above zero. m
    pub upper_arm: f64,
    /// Distance of the wrist centre from axis 3, `hypot(a_4, d_4)`, above zero. m
    pub forearm: f64,
    /// Angle of the bar from axis 3 to the wrist centre in frame 3: `delta = theta_3 + forearm_angle` is zero with the
    /// arm stretched. rad
    pub forearm_angle: f64,
    /// Distance of the wrist centre from the plane of the arm, along the turned y axis. m
    pub lateral: f64,
    /// Distance of the flange frame's origin from the wrist centre along axis 6, `d_6`. m
    pub flange: f64,
    /// Sign of sin(alpha_2): +1 when theta_2 lifts the arm.
    pub lift: f64,
    /// Sign of cos(alpha_3): -1 when axis 3 points against axis 2.
    pub fold: f64,
    /// Signs of sin(alpha_4), sin(alpha_5), sin(alpha_6).
    pub twist: [f64; 3],
}

/// A right or straight angle may be missed by this much (rad); it is then taken as exact.
const TWIST_TOLERANCE: f64 = 1e-6;
/// A length that must be zero may be this long (m); it is then taken as zero.
const LENGTH_TOLERANCE: f64 = 1e-9;

impl Geometry {
    pub(super) fn new(joints: &[Joint; 6]) -> Result<Self, RobotError> {
        let lift = right_angle(joints, 2, "axis 2 must be normal to axis 1")?;
        let fold = straight_angle(joints, 3)?;
        let twist = [
            right_angle(joints, 4, "axis 4 must be normal to axis 3")?,
            right_angle(joints, 5, "the wrist is not an orthogonal spherical wrist: axis 5 must be normal to axis 4")?,
            right_angle(joints, 6, "the wrist is not an orthogonal spherical wrist: axis 6 must be normal to axis 5")?,
        ];
        for (number, field, length) in [(5, "a", joints[4].a), (5, "d", joints[4].d), (6, "a", joints[5].a)] {
            if length.abs() > LENGTH_TOLERANCE {
                let reason = format!(
                    "the wrist is not spherical: axes 4, 5 and 6 must meet in one point, which needs {field}_{number} = 0 \
                     and not {} mm",
                    length * 1e3
                );
                return Err(RobotError::Geometry { joint: number, field, reason });
            }
        }
        let upper_arm = joints[2].a;
        if upper_arm <= LENGTH_TOLERANCE {
            let reason = format!("the upper arm a_3 must be above zero, and not {} mm", upper_arm * 1e3);
            return Err(RobotError::Geometry { joint: 3, field: "a", reason });
        }
        let (a4, d4) = (joints[3].a, joints[3].d);
        let forearm = libm::hypot(a4, d4);
        if forearm <= LENGTH_TOLERANCE {
            let reason = "a_4 and d_4 are both zero: the wrist centre lies on axis 3".to_owned();
            return Err(RobotError::Geometry { joint: 4, field: "d", reason });
        }
        let (sine, cosine) = libm::sincos(joints[0].alpha);
        let base_from_root = Matrix3::new(1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine);
        Ok(Self {
            base_from_root,
            root_in_base: Vector3::new(joints[0].a, 0.0, 0.0),
            shoulder_radius: joints[1].a,
            shoulder_height: joints[0].d,
            upper_arm,
            forearm,
            forearm_angle: libm::atan2(-d4 * twist[0], a4),
            lateral: -lift * (joints[1].d + fold * joints[2].d),
            flange: joints[5].d,
            lift,
            fold,
            twist,
        })
    }

    /// Largest distance of the wrist centre from axis 1. m
    pub fn reach(&self) -> f64 {
        libm::hypot(self.shoulder_radius.abs() + self.upper_arm + self.forearm, self.lateral)
    }

    /// The frame of every row at joint angle zero, in that before it: `Rx(alpha_i) Tx(a_i) Tz(d_i)`, right and straight
    /// twists taken as exact.
    pub(super) fn rows(&self, joints: &[Joint; 6]) -> [Pose<f64>; 6] {
        std::array::from_fn(|j| {
            let Joint { alpha, a, d, .. } = joints[j];
            let (sine, cosine) = match j {
                1 => (self.lift, 0.0),
                2 => (0.0, self.fold),
                3..=5 => (self.twist[j - 3], 0.0),
                _ => libm::sincos(alpha),
            };
            Pose {
                rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine),
                translation: Vector3::new(a, -sine * d, cosine * d),
            }
        })
    }
}

/// The sign of the sine of a twist that must be +-90 deg.
fn right_angle(joints: &[Joint; 6], number: usize, rule: &str) -> Result<f64, RobotError> {
    let (sine, cosine) = libm::sincos(joints[number - 1].alpha);
    if cosine.abs() > TWIST_TOLERANCE {
        let found = (joints[number - 1].alpha.to_degrees() * 1e6).round() / 1e6;
        let reason = format!("{rule}, which needs alpha_{number} = 90 or -90 deg and not {found} deg");
        return Err(RobotError::Geometry { joint: number, field: "alpha", reason });
    }
    Ok(if sine > 0.0 { 1.0 } else { -1.0 })
}

/// The sign of the cosine of a twist that must be 0 or 180 deg.
fn straight_angle(joints: &[Joint; 6], number: usize) -> Result<f64, RobotError> {
    let (sine, cosine) = libm::sincos(joints[number - 1].alpha);
    if sine.abs() > TWIST_TOLERANCE {
        let found = (joints[number - 1].alpha.to_degrees() * 1e6).round() / 1e6;
        let reason = format!(
            "axis {number} must be parallel to axis 2, which needs alpha_{number} = 0 or 180 deg and not {found} deg"
        );
        return Err(RobotError::Geometry { joint: number, field: "alpha", reason });
    }
    Ok(if cosine > 0.0 { 1.0 } else { -1.0 })
}
