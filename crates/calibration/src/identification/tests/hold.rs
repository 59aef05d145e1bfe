//! Joints whose compliances are held on request.

use super::*;

/// The standard problem without noise, with the true arm as the starting one but for what is to be found.
fn held(joints: &[usize]) -> Problem {
    let mut hold = [false; 6];
    joints.iter().for_each(|joint| hold[*joint] = true);
    let mut laws = kr270().joints().clone().map(|joint| joint.compliance);
    joints.iter().for_each(|joint| laws[*joint] = arm().joints()[*joint].compliance);
    Problem { robot: kr270().with_compliances(laws).unwrap(), hold, ..standard(1, 0.0, 3) }
}

#[test]
fn held_joints_keep_their_compliance_and_the_others_are_found_beside_them() {
    for joints in [&[3, 5][..], &[0], &[1], &[1, 2, 4]] {
        let problem = held(joints);
        let found = identify(&problem).unwrap();
        let requested = |joint: &usize| Held { parameter: Parameter::Joint(*joint), reason: HeldReason::Asked };
        assert_eq!(found.held, joints.iter().map(requested).collect::<Vec<_>>());
        assert_eq!(found.warnings.iter().filter(|warning| warning.kind == "held").count(), joints.len());
        for joint in joints {
            assert_eq!(found.robot.joints()[*joint].compliance, problem.robot.joints()[*joint].compliance);
        }
        assert!(found.arm.iter().all(|estimate| !joints.contains(&estimate.parameter.joint)));
        assert_eq!(found.covariance.nrows(), found.arm.len());
        assert_eq!(found.arm.len(), if joints.contains(&1) { 6 } else { 8 } - joints.len());
        for estimate in &found.arm {
            assert!((estimate.value / arm_truth(estimate.parameter) - 1.0).abs() < 1e-9, "{joints:?}: {estimate:?}");
        }
        // What the held joints contribute is in the deflections that are reported.
        let free = identify(&standard(1, 0.0, 3)).unwrap();
        for (row, other) in found.rows.iter().zip(&free.rows) {
            assert!((row.measured - other.measured).norm() < 1e-12 && (row.predicted - row.measured).norm() < 1e-12);
        }
    }
}

#[test]
fn a_wrong_value_that_is_held_spoils_the_others_and_nothing_else_is_tried() {
    let mut problem = held(&[3]);
    let mut laws = problem.robot.joints().clone().map(|joint| joint.compliance);
    laws[3] = Compliance::from(2.0 * 2.79e-6);
    problem.robot = problem.robot.with_compliances(laws).unwrap();
    let found = identify(&problem).unwrap();
    assert_eq!(found.robot.joints()[3].compliance, laws[3]);
    assert!(found.residual_rms > 1e-5, "{}", found.residual_rms);
}

#[test]
fn holding_one_of_two_joints_that_are_identifiable_only_in_combination_frees_the_other() {
    let cell = cell(3);
    let mut load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 20, 5);
    load_cases.iter_mut().for_each(|load_case| load_case.theta[4] = 0.0);
    let readings = sheet(&arm(), &cell, &load_cases, || 0.0, || 0.0);
    let found = identify(&Problem { sheet: readings, ..held(&[3]) }).unwrap();
    let sixth = found.arm.iter().find(|estimate| estimate.parameter.joint == 5).unwrap();
    assert!((sixth.value / 2.074e-6 - 1.0).abs() < 1e-9, "{sixth:?}");
}

#[test]
fn with_every_joint_held_there_is_nothing_to_identify() {
    let error = identify(&Problem { hold: [true; 6], ..standard(1, NOISE, 3) }).unwrap_err();
    assert_eq!((&error, error.fault()), (&IdentifyError::NothingFree, None));
}
