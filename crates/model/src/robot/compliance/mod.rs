//! Joint compliance, which may change with the joint angle.
//!
//! Most joints have one compliance. A gravity compensator adds stiffness that changes with the angle of its joint
//! (Klimchik et al. 2017, eq. 12 to 14): known by its [`Compensator`], or, where only the smallest and the largest
//! compliance of the joint are published (Table 4 there: 0.28 to 0.55 urad/(N m) for joint 2 of a KR 100 HA), by a
//! [`Compliance::Range`]. Whatever needs compliances takes them from [`Robot::compliances_at`], so that all jobs see
//! the same arm.

mod slope;

use super::{Joint, NormalSprings, Robot, RobotError, turns::Range};
use std::f64::consts::PI;
use stead_numerics::scalar::Scalar;

/// How the compliance of a joint and its drive depends on the joint angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Compliance {
    /// The same at every angle. rad/(N m)
    Constant(f64),
    /// Linear in the joint angle between the values at the two limits; for joints of less than a full turn.
    ///
    /// That it is linear, and which value belongs to which limit, is an assumption: published ranges give two numbers
    /// and no law between them.
    Range {
        /// At the lower limit. rad/(N m)
        at_min: f64,
        /// At the upper limit. rad/(N m)
        at_max: f64,
    },
    /// A joint beside which a spring acts: `1 / (K_theta + K_eq(q))` (Klimchik et al. 2017, eq. 12).
    Compensated {
        /// Without the spring, `1 / K_theta`. rad/(N m)
        alone: f64,
        /// The spring.
        compensator: Compensator,
    },
}

impl From<f64> for Compliance {
    /// The same compliance at every angle. rad/(N m)
    fn from(compliance: f64) -> Self {
        Self::Constant(compliance)
    }
}

/// A spring between a point of the link before the joint and a point of the link behind it, to carry part of the arm's
/// weight (Klimchik et al. 2017, Fig. 6c).
///
/// The two points are at distances `a` and `l` from the joint axis; at joint angle q the spring is `s` long,
/// `s^2 = a^2 + l^2 + 2 a l cos(psi)` with `psi = alpha + q`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensator {
    /// Stiffness of the spring, K_GC. N/m
    pub spring_stiffness: f64,
    /// Distance of the spring's one end from the joint axis. m
    pub a: f64,
    /// Distance of its other end from the joint axis, L in the paper. m
    pub l: f64,
    /// Angle psi between the two ends, less half a turn, at joint angle zero. rad
    pub alpha: f64,
    /// Length of the spring without load, s_0. m
    pub free_length: f64,
}

/// A spring may not get shorter than this within the limits of its joint. m
const MIN_SPRING: f64 = 1e-9;

impl Compensator {
    /// Length of the spring at a joint angle in rad. m
    pub fn length<T: Scalar>(&self, angle: T) -> T {
        self.length_at(self.cosine(angle))
    }

    /// The stiffness K_eq that the spring adds to the joint at an angle in rad: the second derivative of its energy
    /// `K_GC (s - s_0)^2 / 2`. It can be below zero. N m/rad
    ///
    /// `K_eq = K_GC a l [(s_0/s) (cos psi + (a l / s^2) sin^2 psi) - cos psi]`: Klimchik et al. 2017, eq. 13 and 14,
    /// where the printed eq. 14 has the opposite sign.
    pub fn stiffness<T: Scalar>(&self, angle: T) -> T {
        self.stiffness_at(self.cosine(angle))
    }

    fn cosine<T: Scalar>(&self, angle: T) -> T {
        (angle + T::constant(self.alpha)).sin_cos().1
    }

    #[inline]
    fn length_at<T: Scalar>(&self, cosine: T) -> T {
        let difference = self.a - self.l;
        ((cosine + T::one()).scale(2.0 * self.a * self.l) + T::constant(difference * difference)).sqrt()
    }

    /// [`Compensator::stiffness`] over cos(psi), with the first bracket of the formula put over one denominator:
    /// `cos psi + (a l / s^2) sin^2 psi = (a + l cos psi) (l + a cos psi) / s^2`.
    #[inline]
    pub fn stiffness_at<T: Scalar>(&self, cosine: T) -> T {
        let length = self.length_at(cosine);
        let product = (cosine.scale(self.l) + T::constant(self.a)) * (cosine.scale(self.a) + T::constant(self.l));
        let pull = product.scale(self.free_length) / (length * length * length);
        (pull - cosine).scale(self.spring_stiffness * self.a * self.l)
    }

    /// Refuses a spring whose two ends meet, or that makes the joint give way, somewhere between the limits.
    ///
    /// K_eq is concave in the cosine of psi: the derivative of `(a + l c) (l + a c) / s^3` by c is
    /// `1 / (4 s) + 3 (a^2 - l^2)^2 / (4 s^5)`, and s grows with c. So its least value between two limits, like the
    /// least length, is at one of them or where the cosine is 1 or -1: this check leaves no angle out.
    fn check(&self, number: usize, joint: &Joint, alone: f64) -> Result<(), RobotError> {
        let first = ((self.alpha + joint.min) / PI).ceil();
        let straight = [first, first + 1.0].map(|k| (k * PI - self.alpha, if k % 2.0 == 0.0 { 1.0 } else { -1.0 }));
        let ends = [joint.min, joint.max].map(|angle| (angle, self.cosine(angle)));
        for (angle, cosine) in ends.into_iter().chain(straight) {
            if angle > joint.max {
                continue;
            }
            let angle_deg = angle.to_degrees();
            if self.length_at(cosine) <= MIN_SPRING {
                return Err(RobotError::SpringVanishes { joint: number, angle_deg });
            }
            let stiffness = 1.0 / alone + self.stiffness_at(cosine);
            if !(stiffness > 0.0 && stiffness.is_finite()) {
                return Err(RobotError::GivesWay { joint: number, angle_deg, stiffness });
            }
        }
        Ok(())
    }
}

impl Compliance {
    /// The numbers that must be finite and above zero, by name.
    pub(super) fn positive(&self) -> Vec<(&'static str, f64)> {
        match self {
            Self::Constant(value) => vec![("compliance", *value)],
            Self::Range { at_min, at_max } => vec![("compliance", *at_min), ("compliance", *at_max)],
            Self::Compensated { alone, compensator } => vec![
                ("compliance", *alone),
                ("compensator.spring_stiffness", compensator.spring_stiffness),
                ("compensator.a", compensator.a),
                ("compensator.l", compensator.l),
                ("compensator.free_length", compensator.free_length),
            ],
        }
    }

    /// The number that must be finite, of any sign, by name.
    pub(super) fn finite(&self) -> Option<(&'static str, f64)> {
        match self {
            Self::Constant(_) | Self::Range { .. } => None,
            Self::Compensated { compensator, .. } => Some(("compensator.alpha", compensator.alpha)),
        }
    }

    /// Whether it suits its joint, whose numbers are finite and whose limits are in order.
    pub(super) fn check(number: usize, joint: &Joint) -> Result<(), RobotError> {
        match &joint.compliance {
            Self::Constant(_) => Ok(()),
            Self::Range { .. } if Range::of(joint).has_turns() => {
                let range_deg = (joint.max - joint.min).to_degrees();
                Err(RobotError::AmbiguousRange { joint: number, range_deg })
            }
            Self::Range { .. } => Ok(()),
            Self::Compensated { alone, compensator } => compensator.check(number, joint, *alone),
        }
    }
}

impl Joint {
    /// The compliance at a joint angle (rad), wrapped or not. Beyond the limits the value at the nearer limit holds.
    /// rad/(N m)
    pub fn compliance_at<T: Scalar>(&self, angle: T) -> T {
        match self.compliance {
            Compliance::Constant(value) => T::constant(value),
            Compliance::Range { at_min, at_max } => {
                let share = (self.inside(angle) - T::constant(self.min)).scale(1.0 / (self.max - self.min));
                share.scale(at_max - at_min) + T::constant(at_min)
            }
            Compliance::Compensated { alone, compensator } => {
                T::constant(alone) / (compensator.stiffness(self.inside(angle)).scale(alone) + T::one())
            }
        }
    }

    /// The real angle inside the limits, with its derivatives; beyond them the nearer limit, which does not move.
    fn inside<T: Scalar>(&self, angle: T) -> T {
        let (real, excess) = Range::of(self).nearest(angle.value());
        let inside = real.max(self.min).min(self.max);
        if excess > 0.0 { T::constant(inside) } else { angle + T::constant(inside - angle.value()) }
    }
}

impl Robot {
    /// The six joint compliances at joint angles `theta` (rad), wrapped or not. rad/(N m)
    pub fn compliances_at<T: Scalar>(&self, theta: &[T; 6]) -> [T; 6] {
        std::array::from_fn(|j| self.joints()[j].compliance_at(theta[j]))
    }

    /// The six joint compliances where none of them changes with the joint angle. rad/(N m)
    pub fn constant_compliances(&self) -> Option<[f64; 6]> {
        let mut constants = [0.0; 6];
        for (slot, joint) in constants.iter_mut().zip(self.joints()) {
            let Compliance::Constant(value) = joint.compliance else { return None };
            *slot = value;
        }
        Some(constants)
    }

    /// Whether the two wrist flips of a posture class yield alike under every load: no compliance of joints 4 to 6
    /// changes with the joint angle, and springs normal to axis 5, which points the other way, sit in the wrist centre.
    pub fn flips_yield_alike(&self) -> bool {
        let are_constant = self.joints()[3..].iter().all(|joint| matches!(joint.compliance, Compliance::Constant(_)));
        let is_fifth_central =
            |normal: &[NormalSprings; 6]| normal[4].bearing == 0.0 || normal[4].compliance == [0.0; 2];
        are_constant && self.normal_springs().is_none_or(is_fifth_central)
    }

    /// The same arm with other joint compliances (laws, or constants in rad/(N m)), as from an identification. How well
    /// the old ones were known ([`Robot::uncertainty`]), and whose they were, says nothing of them, and is left out.
    /// What yields beside the joints about their axes stays.
    ///
    /// # Errors
    /// [`RobotError`] for a compliance that [`Robot::new`] refuses.
    pub fn with_compliances<C: Into<Compliance>>(&self, compliances: [C; 6]) -> Result<Self, RobotError> {
        let mut joints = self.joints().clone();
        for (joint, compliance) in joints.iter_mut().zip(compliances) {
            joint.compliance = compliance.into();
        }
        let robot = Self::new(&self.name, joints)?.with_data_sheet(*self.data_sheet())?;
        let robot = robot.with_axes_2_3(self.axes_2_3)?;
        let robot = Self { springs: self.springs.clone(), ..robot.mounted(&self.cell_from_base()) };
        Ok(match self.dynamics() {
            Some(dynamics) => robot.with_dynamics(*dynamics),
            None => robot,
        })
    }

    /// The same arm with one compliance in place of every range, so far from its smaller to its larger value: 0 to 1.
    ///
    /// # Errors
    /// [`RobotError`] where that is no compliance, for a share that is not from 0 to 1.
    pub fn with_range_share(&self, share: f64) -> Result<Self, RobotError> {
        let robot = self.with_compliances(self.joints().clone().map(|joint| match joint.compliance {
            Compliance::Range { at_min, at_max } => {
                let (least, most) = (at_min.min(at_max), at_min.max(at_max));
                Compliance::Constant(least + share * (most - least))
            }
            law => law,
        }))?;
        Ok(match self.stiffness_like() {
            Some(other) => robot.with_stiffness_like(other),
            None => robot,
        })
    }
}

#[cfg(test)]
mod tests;
