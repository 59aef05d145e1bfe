use super::*;
use crate::arm::testing::{spindle, start, tx200};
use crate::arm::{AnyArm, Arm, Variant};

fn linear(damping_scale: f64) -> LinearArm {
    let arm = Arm::six(&tx200(), &spindle(), Variant::Springs, &start()).unwrap();
    LinearArm::of(&arm, &start().into(), damping_scale)
}

/// An independent prototype's frequencies for table 7: six springs, undamped.
#[test]
fn frequencies_of_the_published_arm() {
    let expected = [15.76, 25.05, 27.69, 33.55, 90.92, 143.08];
    let undamped = linear(0.0).undamped().unwrap();
    for (found, expected) in undamped.iter().zip(expected) {
        assert!((found - expected).abs() < 0.0051, "{found} {expected}");
    }
    // Of the damped arm, too, as long as all modes swing.
    for (mode, expected) in linear(1.0).modes().unwrap().iter().zip(&undamped) {
        assert_eq!(mode.undamped, Some(*expected));
        assert!(mode.frequency != *expected && (mode.frequency / expected - 1.0).abs() < 0.01, "{mode:?}");
    }
    assert!(linear(10.0).modes().unwrap().iter().all(|mode| mode.undamped.is_none()));
    let modes = linear(0.0).modes().unwrap();
    assert_eq!(modes.len(), 6);
    for (mode, expected) in modes.iter().zip(undamped) {
        assert!((mode.frequency - expected).abs() < 1e-9 && mode.damping_ratio.abs() < 1e-9, "{mode:?}");
    }
}

/// Each damped mode solves `(s^2 M + s C + K) x = 0`.
#[test]
fn shapes_are_those_of_the_eigenvalues() {
    let linear = linear(1.0);
    for mode in linear.modes().unwrap() {
        assert!(mode.damping_ratio > 0.0 && mode.damping_ratio < 1.0);
        let size = mode.frequency * TAU;
        let swing = (1.0 - mode.damping_ratio * mode.damping_ratio).sqrt();
        let s = Complex::new(-mode.damping_ratio * size, swing * size);
        let determinant = linear.dynamic_stiffness(s).determinant();
        let scale = linear.dynamic_stiffness(s * 1.01).determinant();
        assert!(determinant.norm() < 1e-9 * scale.norm(), "{determinant} {scale}");
        assert!((mode.joints.iter().fold(0.0_f64, |most, a| most.max(a.abs())) - 1.0).abs() < 1e-12);
    }
    // Without damping the shapes are real, and tell the eigenvalue apart by Rayleigh's quotient.
    let free = super::tests::linear(0.0);
    for mode in free.modes().unwrap() {
        let shape = DVector::from_column_slice(&mode.joints);
        let square = shape.dot(&(&free.stiffness * &shape)) / shape.dot(&(&free.mass * &shape));
        assert!((square.sqrt() / TAU - mode.frequency).abs() < 1e-9 * mode.frequency);
        assert!((mode.tip - &free.tip * shape).norm() < 1e-15);
    }
}

/// A chain of one joint has a closed form.
#[test]
fn one_joint_swings_as_the_formula_says() {
    let one = |value: f64| DMatrix::from_element(1, 1, value);
    let (mass, stiffness, damping) = (2.0, 800.0, 16.0);
    let tip = Matrix3xX::from_column_slice(&[0.0, 0.5, 0.0]);
    let linear = LinearArm { mass: one(mass), damping: one(damping), stiffness: one(stiffness), tip };
    let modes = linear.modes().unwrap();
    assert_eq!(modes.len(), 1);
    assert!((modes[0].frequency - 20.0 / TAU).abs() < 1e-12 && (modes[0].damping_ratio - 0.2).abs() < 1e-12);
    for frequency in [0.0, 1.0, 3.0, 10.0] {
        let omega = TAU * frequency;
        let expected = Complex::new(stiffness - mass * omega * omega, damping * omega).inv() * 0.25;
        let response = linear.response(frequency).unwrap();
        assert!((response[(1, 1)] - expected).norm() < 1e-15 && response[(0, 0)].norm() == 0.0);
    }
    // Overdamped: two real eigenvalues, both given.
    let creeping = LinearArm { damping: one(200.0), ..linear }.modes().unwrap();
    assert!(creeping.len() == 2 && creeping.iter().all(|mode| (mode.damping_ratio - 1.0).abs() < 1e-12));
}

/// At zero frequency the tip responds with the static compliance of the arm, and reciprocally at any.
#[test]
fn the_response_starts_from_the_static_compliance() {
    let AnyArm::Eighteen(arm) = AnyArm::new(&tx200(), &spindle(), Variant::Backlash, &start()).unwrap() else {
        panic!("the variant has eighteen joints");
    };
    let linear = LinearArm::of(&arm, &arm.at_rest(&Arm::<18>::spread(&start())), 1.0);
    let compliance = &linear.tip * linear.stiffness.clone().try_inverse().unwrap() * linear.tip.transpose();
    let response = linear.response(0.0).unwrap();
    assert!((response.map(|r| r.re) - compliance).amax() < 1e-12 * compliance.amax());
    // Pairs that swing, and by themselves those that creep: 36 states.
    let modes = linear.modes().unwrap();
    let states: usize = modes.iter().map(|mode| if mode.damping_ratio < 1.0 { 2 } else { 1 }).sum();
    assert_eq!(states, 36);
    let at = LinearArm { stiffness: (&linear.stiffness + linear.stiffness.transpose()) / 2.0, ..linear }
        .response(30.0)
        .unwrap();
    assert!((at - at.transpose()).map(|r| r.norm()).amax() < 1e-12 * at.map(|r| r.norm()).amax());
}
