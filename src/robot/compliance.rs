//! How a joint yields: its compliance, which may change with the joint angle.
//!
//! Most joints have one compliance. A gravity compensator adds stiffness that changes with the angle of its joint (Klimchik
//! et al. 2017, eq. 12 to 14): known by its [`Compensator`], or, where only the smallest and the largest compliance of the
//! joint are published (Table 4 there: 0.28 to 0.55 urad/(N m) for joint 2 of a KR 100 HA), by a [`Compliance::Range`].
//! Whatever needs compliances takes them from [`Robot::compliances_at`], so that all jobs see the same arm.

use super::{Joint, Robot, RobotError, scalar::Scalar, turns::Range};
use std::f64::consts::PI;

/// How the compliance of a joint and its drive depends on the joint angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Compliance {
    /// The same at every angle. rad/(N m)
    Constant(f64),
    /// Linear in the joint angle between the values at the two limits; for joints of less than a full turn.
    ///
    /// That it is linear, and which value belongs to which limit, is an assumption: published ranges give two numbers and no
    /// law between them.
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
const LEAST_SPRING: f64 = 1e-9;

impl Compensator {
    /// Length of the spring at a joint angle in rad. m
    pub fn length<T: Scalar>(&self, angle: T) -> T {
        self.length_at(self.cosine(angle))
    }

    /// The stiffness K_eq that the spring adds to the joint at an angle in rad: the second derivative of its energy
    /// `K_GC (s - s_0)^2 / 2`. It can be below zero. N m/rad
    ///
    /// `K_eq = K_GC a l [(s_0/s) (cos psi + (a l / s^2) sin^2 psi) - cos psi]`: Klimchik et al. 2017, eq. 13 and 14, where
    /// the printed eq. 14 has the opposite sign.
    pub fn stiffness<T: Scalar>(&self, angle: T) -> T {
        self.stiffness_at(self.cosine(angle))
    }

    fn cosine<T: Scalar>(&self, angle: T) -> T {
        (angle + T::constant(self.alpha)).sin_cos().1
    }

    fn length_at<T: Scalar>(&self, cosine: T) -> T {
        let difference = self.a - self.l;
        ((cosine + T::one()).scale(2.0 * self.a * self.l) + T::constant(difference * difference)).sqrt()
    }

    /// The stiffness over cos(psi), with the first bracket of the formula put over one denominator:
    /// `cos psi + (a l / s^2) sin^2 psi = (a + l cos psi) (l + a cos psi) / s^2`.
    fn stiffness_at<T: Scalar>(&self, cosine: T) -> T {
        let length = self.length_at(cosine);
        let product = (cosine.scale(self.l) + T::constant(self.a)) * (cosine.scale(self.a) + T::constant(self.l));
        let pull = product.scale(self.free_length) / (length * length * length);
        (pull - cosine).scale(self.spring_stiffness * self.a * self.l)
    }

    /// Refuses a spring that is nowhere taut or that makes the joint give way somewhere between its limits.
    ///
    /// K_eq is concave in the cosine of psi: the derivative of `(a + l c) (l + a c) / s^3` by c is
    /// `1 / (4 s) + 3 (a^2 - l^2)^2 / (4 s^5)`, and s grows with c. So its least value between two limits, like the least
    /// length, is at one of them or where the cosine is 1 or -1: this check leaves no angle out.
    fn check(&self, number: usize, joint: &Joint, alone: f64) -> Result<(), RobotError> {
        let first = ((self.alpha + joint.min) / PI).ceil();
        let straight = [first, first + 1.0].map(|k| (k * PI - self.alpha, if k % 2.0 == 0.0 { 1.0 } else { -1.0 }));
        let ends = [joint.min, joint.max].map(|angle| (angle, self.cosine(angle)));
        for (angle, cosine) in ends.into_iter().chain(straight) {
            if angle > joint.max {
                continue;
            }
            let angle_deg = angle.to_degrees();
            if self.length_at(cosine) <= LEAST_SPRING {
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

    /// The same arm with other joint compliances (laws, or constants in rad/(N m)), as from an identification.
    ///
    /// # Errors
    /// [`RobotError`] for a compliance that [`Robot::new`] refuses.
    pub fn with_compliances<C: Into<Compliance>>(&self, compliances: [C; 6]) -> Result<Self, RobotError> {
        let mut joints = self.joints().clone();
        for (joint, compliance) in joints.iter_mut().zip(compliances) {
            joint.compliance = compliance.into();
        }
        Self::new(self.name(), joints)?.with_data_sheet(*self.data_sheet())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{scalar::Dual, testing::kr270};
    use super::*;
    use proptest::prelude::*;

    /// A KR270's compensator on joint 2, in size (Klimchik et al. 2013).
    const SPRING: Compensator = Compensator { spring_stiffness: 1.4e5, a: 0.7, l: 0.18, alpha: 0.2, free_length: 0.46 };

    fn with_second(compliance: Compliance) -> Result<Robot, RobotError> {
        let mut joints = kr270().joints().clone();
        joints[1].compliance = compliance;
        Robot::new("x", joints)
    }

    fn compensator() -> impl Strategy<Value = Compensator> {
        (1e3..1e6_f64, 0.05..1.0_f64, 0.05..1.0_f64, -4.0..4.0_f64, 0.05..1.5_f64).prop_map(
            |(spring_stiffness, a, l, alpha, free_length)| Compensator { spring_stiffness, a, l, alpha, free_length },
        )
    }

    proptest! {
        #[test]
        fn spring_stiffness_is_the_second_derivative_of_its_energy(spring in compensator(), angle in -6.0..6.0_f64) {
            let Compensator { spring_stiffness, a, l, alpha, free_length } = spring;
            let scale = spring_stiffness * a * l;
            // The length by the triangle of its two ends, in numbers that carry the first derivative.
            let torque = |angle: f64| {
                let (sine, cosine) = (Dual::<1>::variable(angle, 0) + Dual::constant(alpha)).sin_cos();
                let (x, y) = (cosine.scale(l) + Dual::constant(a), sine.scale(l));
                let stretch = (x * x + y * y).sqrt() - Dual::constant(free_length);
                (stretch * stretch).scale(0.5 * spring_stiffness).gradient[0]
            };
            prop_assume!(spring.length(angle) > 0.2);
            let h = 1e-5;
            let expected = (torque(angle + h) - torque(angle - h)) / (2.0 * h);
            let found = spring.stiffness(angle);
            prop_assert!((found - expected).abs() < 1e-6 * scale, "{} {}", found, expected);
            // Eq. 14 with its sign corrected.
            let (sine, cosine) = libm::sincos(alpha + angle);
            let s = spring.length(angle);
            let bracket = free_length / s * (cosine + a * l / (s * s) * sine * sine) - cosine;
            prop_assert!((found - scale * bracket).abs() < 1e-10 * scale, "{} {}", found, scale * bracket);
        }

        #[test]
        fn the_check_finds_the_least_stiffness(
            spring in compensator(), min in -5.0..0.0_f64, width in 0.5..9.0_f64, alone in 1e-7..1e-4_f64
        ) {
            let joint = Joint { min, max: min + width, ..kr270().joints()[1].clone() };
            let steps = 4000;
            let angle = |k: i32| min + width * f64::from(k) / f64::from(steps);
            let stiffness = (0..=steps).map(|k| 1.0 / alone + spring.stiffness(angle(k))).fold(f64::MAX, f64::min);
            match spring.check(2, &joint, alone) {
                Ok(()) => prop_assert!(stiffness > 0.0),
                Err(RobotError::GivesWay { joint: 2, angle_deg, stiffness: found }) => {
                    let there = 1.0 / alone + spring.stiffness(angle_deg.to_radians());
                    prop_assert!((there - found).abs() < 1e-6 * found.abs().max(1.0 / alone));
                    prop_assert!(found <= 0.0);
                    prop_assert!((min - 1e-12..=joint.max + 1e-12).contains(&angle_deg.to_radians()));
                }
                Err(error) => prop_assert!(spring.a == spring.l, "{}", error),
            }
        }

        #[test]
        fn a_law_carries_derivatives_and_does_not_see_turns(angle in 0.01..2.53_f64, turns in -2..3_i32) {
            for law in [
                Compliance::Range { at_min: 5e-7, at_max: 3e-7 },
                Compliance::Compensated { alone: 4e-7, compensator: SPRING },
            ] {
                let robot = with_second(law).unwrap();
                let joint = &robot.joints()[1];
                let turned = angle + std::f64::consts::TAU * f64::from(turns);
                let exact = joint.compliance_at(Dual::<1>::variable(turned, 0));
                prop_assert!((exact.value - joint.compliance_at(angle)).abs() < 1e-20);
                let h = 1e-6;
                let slope = (joint.compliance_at(angle + h) - joint.compliance_at(angle - h)) / (2.0 * h);
                prop_assert!((exact.gradient[0] - slope).abs() < 1e-14, "{} {}", exact.gradient[0], slope);
            }
        }
    }

    #[test]
    fn a_range_runs_between_the_limits_and_stays_beyond_them() {
        let robot = with_second(Compliance::Range { at_min: 5e-7, at_max: 3e-7 }).unwrap();
        for (deg, expected) in
            [(0.0, 5e-7), (73.0, 4e-7), (146.0, 3e-7), (160.0, 3e-7), (-5.0, 5e-7), (-300.0, 4.178e-7)]
        {
            let theta = [0.0, f64::to_radians(deg), 0.0, 0.0, 0.0, 0.0];
            let found = robot.compliances_at(&theta);
            assert!((found[1] - expected).abs() < 1e-11, "{deg} {}", found[1]);
            assert_eq!(found[0], 1e-6 / 0.237);
        }
        let beyond = robot.joints()[1].compliance_at(Dual::<1>::variable(2.7, 0));
        assert_eq!(beyond, Dual::constant(beyond.value));
    }

    #[test]
    fn a_compensator_adds_its_stiffness() {
        let robot = with_second(Compliance::Compensated { alone: 4e-7, compensator: SPRING }).unwrap();
        let found = robot.joints()[1].compliance_at(1.1);
        assert!((1.0 / found - 2.5e6 - SPRING.stiffness(1.1)).abs() < 1e-8, "{found}");
        assert_eq!(robot.constant_compliances(), None);
        let plain = robot.with_compliances([1e-6; 6]).unwrap();
        assert_eq!(plain.constant_compliances(), Some([1e-6; 6]));
    }

    #[test]
    fn laws_that_do_not_suit_the_joint_are_refused() {
        let compensated = |compensator| with_second(Compliance::Compensated { alone: 4e-7, compensator });
        let strong = Compensator { spring_stiffness: 1.4e8, ..SPRING };
        let error = compensated(strong).unwrap_err();
        let RobotError::GivesWay { joint: 2, angle_deg, stiffness } = error else { panic!("{error}") };
        assert!((0.0..=146.0).contains(&angle_deg) && stiffness < 0.0);
        // Both ends meet where psi is half a turn.
        let meeting = Compensator { a: 0.18, alpha: PI - 1.0, ..SPRING };
        let error = compensated(meeting).unwrap_err();
        let RobotError::SpringVanishes { joint: 2, angle_deg } = error else { panic!("{error}") };
        assert!((angle_deg - 1.0_f64.to_degrees()).abs() < 1e-12);
        assert!(compensated(Compensator { alpha: 0.1, ..meeting }).is_ok());
        let nan = Compensator { alpha: f64::NAN, ..SPRING };
        assert!(matches!(compensated(nan), Err(RobotError::NotFinite { field: "compensator.alpha", .. })));
        let none = Compensator { free_length: 0.0, ..SPRING };
        assert!(matches!(compensated(none), Err(RobotError::NotPositive { field: "compensator.free_length", .. })));
        assert!(with_second(Compliance::Range { at_min: 1e-7, at_max: -1e-7 }).is_err());
        let range = Compliance::Range { at_min: 1e-7, at_max: 2e-7 };
        let mut joints = kr270().joints().clone();
        joints[3].compliance = range;
        let error = Robot::new("x", joints).unwrap_err();
        assert!(matches!(error, RobotError::AmbiguousRange { joint: 4, .. }), "{error}");
    }
}
