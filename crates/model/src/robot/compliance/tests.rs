//! The laws against energies, differences and samples.

use super::super::testing::kr270;
use super::*;
use proptest::prelude::*;
use stead_numerics::scalar::Dual;

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
    for (deg, expected) in [(0.0, 5e-7), (73.0, 4e-7), (146.0, 3e-7), (160.0, 3e-7), (-5.0, 5e-7), (-300.0, 4.178e-7)] {
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

#[test]
fn a_share_of_a_range_is_one_compliance() {
    let mut laws = kr270().joints().clone().map(|joint| joint.compliance);
    laws[1] = Compliance::Range { at_min: 5e-7, at_max: 3e-7 };
    let robot = kr270().with_compliances(laws).unwrap();
    for (share, expected) in [(0.0, 3e-7), (0.25, 3.5e-7), (1.0, 5e-7)] {
        let fixed = robot.with_range_share(share).unwrap().constant_compliances().unwrap();
        assert!((fixed[1] - expected).abs() < 1e-20);
        assert_eq!(fixed[0], robot.compliances_at(&[0.0; 6])[0]);
    }
    assert!(robot.with_range_share(-9.0).is_err());
}
