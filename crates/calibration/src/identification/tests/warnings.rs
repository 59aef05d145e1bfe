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

/// The kinds of warnings, and the whole text, of a sheet read with a load point that is stated wrongly by so much.
fn with_load_point_off(off: Vector3<f64>, noise: Option<f64>) -> (Vec<&'static str>, String) {
    let clean = standard(1, NOISE, 3);
    let identified = identify(&Problem { load_point: clean.load_point + off, noise, ..clean }).unwrap();
    (
        identified.warnings.iter().map(|warning| warning.kind).collect(),
        identified.warnings.iter().map(|warning| warning.message.clone()).collect::<Vec<_>>().join("\n"),
    )
}

#[test]
fn a_load_point_that_the_readings_contradict_is_named_with_the_place_that_they_tell() {
    for (axis, noise) in [(0, None), (1, None), (2, None), (2, Some(NOISE))] {
        let (found, text) = with_load_point_off(Vector3::ith(axis, 0.1), noise);
        assert!(found.contains(&"load-point"), "{axis}: {text}");
        let place = text.split("agree best with a load at [").nth(1).and_then(|rest| rest.split(']').next()).unwrap();
        let place: Vec<f64> = place.split(", ").map(|value| value.parse().unwrap()).collect();
        for (found, truth) in place.iter().zip(cell(3).load_point.iter()) {
            assert!((found - truth * 1e3).abs() < 5.0, "{axis}: {text}");
        }
    }
    let (_, text) = with_load_point_off(Vector3::new(0.0, 0.0, 0.1), None);
    assert!(text.contains("the compliance k_5 is 3.4"), "{text}");
}

#[test]
fn residuals_larger_than_the_unloaded_readings_scatter_are_warned_of() {
    let (found, text) = with_load_point_off(Vector3::new(0.0, 0.0, 0.1), None);
    assert!(found.contains(&"residual-misfit"), "{text}");
    // Where the wrench itself is not what the arm bears, no load point explains the readings.
    let mut problem = standard(1, NOISE, 3);
    let mut random = ChaCha8Rng::seed_from_u64(9);
    for configuration in &mut problem.sheet.configurations {
        configuration.force += direction(&mut random) * 150.0;
    }
    assert!(kinds(&problem).contains(&"residual-misfit"));
}

#[test]
fn sound_sheets_are_hardly_ever_suspected() {
    let suspected = (0..300_u64).into_par_iter().filter(|seed| {
        let problem = Problem { start: Some(cell(3).tracker_from_base.rotation), ..standard(*seed, NOISE, 3) };
        kinds(&problem).iter().any(|kind| ["load-point", "residual-misfit"].contains(kind))
    });
    assert!(suspected.count() <= 3);
}
