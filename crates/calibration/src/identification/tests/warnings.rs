//! What may be wrong with a result, by kind.

use super::*;

fn kinds(problem: &Problem) -> Vec<&'static str> {
    identify(problem).unwrap().warnings.iter().map(|warning| warning.kind).collect()
}

#[test]
fn a_sound_sheet_gives_no_warning() {
    assert_eq!(kinds(&standard(1, NOISE, 3)), [""; 0]);
    assert_eq!(kinds(&Problem { noise: Some(NOISE), ..standard(1, NOISE, 3) }), [""; 0]);
}

#[test]
fn noise_that_the_residuals_contradict_is_warned_of() {
    for factor in [0.5, 2.0] {
        assert_eq!(kinds(&Problem { noise: Some(factor * NOISE), ..standard(1, NOISE, 3) }), ["noise-mismatch"]);
    }
}

#[test]
fn a_law_that_the_angles_contradict_is_warned_of() {
    let constant = Problem { varying: Some((1, Law::Constant)), ..standard(1, NOISE, 3) };
    assert_eq!(kinds(&constant), ["law-misfit"]);
}

#[test]
fn few_readings_and_many_outliers_are_warned_of() {
    let cell = cell(1);
    let plain = [0.54e-6, 0.3e-6, 0.42e-6, 2.79e-6, 3.48e-6, 2.074e-6].map(Compliance::from);
    let robot = kr270().with_compliances(plain).unwrap();
    let load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 5, 5);
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let readings = sheet(&robot, &cell, &load_cases, || 1e-6 * gauss(&mut random), || 0.0);
    let few = Problem { robot, varying: None, noise: Some(1e-6), ..problem(readings, &cell) };
    assert!(kinds(&few).contains(&"outliers-not-searched"), "{:?}", kinds(&few));

    let mut many = standard(1, NOISE, 3);
    for reading in many.sheet.readings.iter_mut().filter(|reading| reading.point == 2) {
        reading.loaded += direction(&mut random) * 2e-3;
    }
    assert!(kinds(&many).contains(&"many-outliers"));
}

#[test]
fn estimates_of_few_standard_deviations_are_warned_of_by_name() {
    // Loads so small that the noise is a good part of every deflection.
    let cell = cell(3);
    let mut load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 20, 5);
    load_cases.iter_mut().for_each(|load_case| load_case.force /= 10.0);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let readings = sheet(&arm(), &cell, &load_cases, || NOISE * gauss(&mut random), || 0.0);
    let found = identify(&Problem { varying: Some((1, Law::Constant)), ..problem(readings, &cell) }).unwrap();
    let weak: Vec<&str> =
        found.warnings.iter().filter(|w| w.kind == "weakly-identified").map(|w| w.message.as_str()).collect();
    for estimate in &found.arm {
        let is_weak = estimate.value < 5.0 * estimate.deviation;
        let start = format!("{} is weakly identified", estimate.parameter);
        assert_eq!(weak.iter().any(|message| message.starts_with(&start)), is_weak, "{start}: {weak:?}");
    }
}
