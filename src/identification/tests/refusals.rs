//! What a sheet does not tell.

use super::super::law::LawError;
use super::super::normal::Unseen;
use super::*;

/// What is refused as unseen, by parameters.
fn unseen(problem: &Problem) -> Vec<Unseen> {
    match identify(problem) {
        Err(IdentifyError::Unseen { unseen, .. }) => unseen,
        other => panic!("{other:?}"),
    }
}

/// The standard problem without noise, its shots changed.
fn changed(change: impl Fn(&mut Shot), cell: &Cell) -> Problem {
    let mut shots = shots(&mut ChaCha8Rng::seed_from_u64(3), 20, 5);
    shots.iter_mut().for_each(change);
    problem(sheet(&arm(), cell, &shots, || 0.0, || 0.0), cell)
}

#[test]
fn what_cannot_be_seen_is_named_and_held_only_on_request() {
    let vertical = |shot: &mut Shot| shot.1 = Vector3::new(0.0, 0.0, -2700.0);
    let no_first = changed(vertical, &cell(3));
    assert_eq!(unseen(&no_first), [Unseen { parameters: vec![Parameter::Joint(0)] }]);
    let on_axis = Cell { load_point: Vector3::new(0.0, 0.0, 0.2), ..cell(3) };
    let no_last = changed(|_| (), &on_axis);
    assert_eq!(unseen(&no_last), [Unseen { parameters: vec![Parameter::Joint(5)] }]);
    let straight = changed(|shot| shot.0[4] = 0.0, &cell(3));
    let alike = unseen(&straight);
    assert_eq!(alike.len(), 1);
    let mut pair = alike[0].parameters.clone();
    pair.sort_by_key(|parameter| matches!(parameter, Parameter::Joint(5)));
    assert_eq!(pair, [Parameter::Joint(3), Parameter::Joint(5)]);

    let found = identify(&Problem { reduce: true, ..no_first }).unwrap();
    assert_eq!(found.held, [Parameter::Joint(0)]);
    assert_eq!(found.robot.joints()[0].compliance, kr270().joints()[0].compliance);
    for estimate in &found.seen {
        let truth = truth(estimate.parameter, estimate.angle);
        assert!((estimate.value / truth - 1.0).abs() < 1e-9, "{estimate:?} {truth}");
    }
    assert!(found.seen.iter().all(|estimate| estimate.parameter != Parameter::Joint(0)));
}

#[test]
fn sheets_that_tell_too_little_are_refused() {
    let few = |count: usize, distinct: usize| {
        let shots = shots(&mut ChaCha8Rng::seed_from_u64(3), count, distinct);
        problem(sheet(&arm(), &cell(3), &shots, || 0.0, || 0.0), &cell(3))
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
