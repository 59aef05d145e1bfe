//! What a sheet does not tell.

use super::super::law::LawError;
use super::super::normal_equations::Unidentifiable;
use super::*;

/// What is refused as unseen, by parameters.
fn unidentifiable(problem: &Problem) -> Vec<Unidentifiable> {
    match identify(problem) {
        Err(IdentifyError::Unidentifiable { unidentifiable, .. }) => unidentifiable,
        other => panic!("{other:?}"),
    }
}

fn unidentifiable_joint(joint: usize) -> Held {
    Held { parameter: Parameter::Joint(joint), reason: HeldReason::Unidentifiable }
}

/// The standard problem without noise, its shots changed.
fn changed(change: impl Fn(&mut LoadCase), cell: &MeasuringCell) -> Problem {
    let mut load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 20, 5);
    load_cases.iter_mut().for_each(change);
    problem(sheet(&arm(), cell, &load_cases, || 0.0, || 0.0), cell)
}

#[test]
fn what_cannot_be_seen_is_named_and_held_only_on_request() {
    let vertical = |load_case: &mut LoadCase| load_case.force = Vector3::new(0.0, 0.0, -2700.0);
    let no_first = changed(vertical, &cell(3));
    assert_eq!(unidentifiable(&no_first), [Unidentifiable { parameters: vec![Parameter::Joint(0)] }]);
    let on_axis = MeasuringCell { load_point: Vector3::new(0.0, 0.0, 0.2), ..cell(3) };
    let no_last = changed(|_| (), &on_axis);
    assert_eq!(unidentifiable(&no_last), [Unidentifiable { parameters: vec![Parameter::Joint(5)] }]);
    let straight = changed(|load_case| load_case.theta[4] = 0.0, &cell(3));
    let alike = unidentifiable(&straight);
    assert_eq!(alike.len(), 1);
    let mut pair = alike[0].parameters.clone();
    pair.sort_by_key(|parameter| matches!(parameter, Parameter::Joint(5)));
    assert_eq!(pair, [Parameter::Joint(3), Parameter::Joint(5)]);

    let found = identify(&Problem { reduce: true, ..no_first }).unwrap();
    assert_eq!(found.held, [unidentifiable_joint(0)]);
    assert_eq!(found.robot.joints()[0].compliance, kr270().joints()[0].compliance);
    for estimate in &found.compliances {
        let truth = truth(estimate.parameter, estimate.angle);
        assert!((estimate.value / truth - 1.0).abs() < 1e-9, "{estimate:?} {truth}");
    }
    assert!(found.compliances.iter().all(|estimate| estimate.parameter != Parameter::Joint(0)));
}

#[test]
fn a_varying_joint_that_is_seen_at_no_angle_keeps_its_law() {
    // Along axes 2 and 3: nothing but rounding is left of their columns. Under the load other joints turn, so that
    // these yield a little all the same; they are held at the truth.
    let along = |load_case: &mut LoadCase| {
        let axis = stead_model::robot::Frames::new(&arm(), &load_case.theta).twist(1, &Vector3::zeros()).1;
        load_case.force = axis * 2700.0;
    };
    let mut laws = kr270().joints().clone().map(|joint| joint.compliance);
    (1..3).for_each(|joint| laws[joint] = arm().joints()[joint].compliance);
    let robot = kr270().with_compliances(laws).unwrap();
    for law in [Law::Constant, Law::Spring(GEOMETRY)] {
        let problem = Problem { robot: robot.clone(), varying: Some((1, law)), ..changed(along, &cell(3)) };
        assert_eq!(unidentifiable(&problem).len(), 6);
        let found = identify(&Problem { reduce: true, ..problem }).unwrap();
        assert_eq!(found.held, [unidentifiable_joint(1), unidentifiable_joint(2)]);
        assert_eq!(found.robot.joints()[1].compliance, robot.joints()[1].compliance);
        assert_eq!(found.arm.len(), 4);
        for estimate in &found.arm {
            assert!((estimate.value / arm_truth(estimate.parameter) - 1.0).abs() < 1e-9, "{estimate:?}");
        }
    }
}

#[test]
fn of_two_joints_that_look_alike_one_is_held_and_the_compensator_is_found_all_the_same() {
    let straight = Problem { reduce: true, ..changed(|load_case| load_case.theta[4] = 0.0, &cell(3)) };
    // Held at the truth, the rest comes out true; straight through the sum of both otherwise.
    let mut compliances = kr270().constant_compliances().unwrap();
    compliances[3] = 2.79e-6;
    compliances[5] = 2.074e-6;
    let found = identify(&Problem { robot: kr270().with_compliances(compliances).unwrap(), ..straight }).unwrap();
    assert_eq!(found.held.len(), 1);
    assert_eq!(found.arm.len(), 7);
    for estimate in &found.arm {
        assert!((estimate.value / arm_truth(estimate.parameter) - 1.0).abs() < 1e-9, "{estimate:?}");
    }
    for estimate in &found.compliances {
        let truth = truth(estimate.parameter, estimate.angle);
        assert!((estimate.value / truth - 1.0).abs() < 1e-9, "{estimate:?} {truth}");
    }
}

#[test]
fn sheets_that_tell_too_little_are_refused() {
    let few = |count: usize, distinct: usize| {
        let load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), count, distinct);
        problem(sheet(&arm(), &cell(3), &load_cases, || 0.0, || 0.0), &cell(3))
    };
    let error = identify(&few(1, 1)).unwrap_err();
    assert!(
        matches!(error, IdentifyError::Setup(setup::SetupError::TooFew { equations: 9, unknowns: 15 })),
        "{error:?}"
    );
    let error = identify(&few(20, 2)).unwrap_err();
    assert!(matches!(error, IdentifyError::Law(LawError::TooFewAngles { found: 2, joint: 2 })), "{error:?}");
    let mut still = few(20, 5);
    let theta = still.sheet.configurations[0].theta;
    still.sheet.configurations.iter_mut().for_each(|c| c.theta[..5].copy_from_slice(&theta[..5]));
    let error = identify(&still).unwrap_err();
    assert!(matches!(error, IdentifyError::Setup(_)), "{error:?}");

    let mut metres = few(20, 5);
    for reading in &mut metres.sheet.readings {
        reading.unloaded /= 1e3;
        reading.loaded /= 1e3;
    }
    let error = identify(&metres).unwrap_err();
    assert!(matches!(error, IdentifyError::Setup(setup::SetupError::Scale { .. })), "{error:?}");
    let mut mixed = few(20, 5);
    mixed.sheet.readings[7].loaded /= 1e3;
    let error = identify(&mixed).unwrap_err();
    assert!(matches!(error, IdentifyError::TooFar { line: 9, .. }), "{error:?}");
}
