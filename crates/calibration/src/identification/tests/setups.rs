//! Base transform and reference points: what does not fit, and how well it is known.

use super::super::setup::SetupError;
use super::*;

/// The misfit that a sheet is refused for: line and the largest distance in mm.
fn misfit(problem: &Problem) -> (usize, f64) {
    match identify(problem) {
        Err(IdentifyError::Setup(SetupError::Misfit { line, off_mm, worst_mm, moved_mm })) => {
            assert!(off_mm <= worst_mm && off_mm > 0.02 * moved_mm);
            (line, worst_mm)
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn readings_that_are_not_those_of_the_joint_angles_are_refused() {
    let clean = standard(1, NOISE, 3);
    let mut mirrored = clean.clone();
    for reading in &mut mirrored.sheet.readings {
        reading.unloaded.swap_rows(0, 1);
        reading.loaded.swap_rows(0, 1);
    }
    misfit(&mirrored);
    let mut inches = clean.clone();
    for reading in &mut inches.sheet.readings {
        reading.unloaded /= 25.4;
        reading.loaded /= 25.4;
    }
    misfit(&inches);
    let mut counted_otherwise = clean.clone();
    counted_otherwise.sheet.configurations.iter_mut().for_each(|c| c.theta[3] = -c.theta[3]);
    misfit(&counted_otherwise);
    // Its deflection is right, so that it is no outlier; only its place is wrong.
    let mut mistyped = clean;
    mistyped.sheet.readings[6].unloaded.x += 1.0;
    mistyped.sheet.readings[6].loaded.x += 1.0;
    let (line, distance) = misfit(&mistyped);
    assert_eq!(line, 8);
    assert!(distance > 800.0 && distance < 1000.0, "{distance}");
}

#[test]
fn the_reading_farthest_off_is_known() {
    let mut problem = standard(1, NOISE, 3);
    problem.sheet.readings[20].unloaded.z += 5e-3;
    problem.sheet.readings[20].loaded.z += 5e-3;
    let found = identify(&problem).unwrap();
    assert_eq!((found.outliers().count(), found.setup_fit.worst.0), (0, 22));
    let distance = found.setup_fit.worst.1;
    assert!(distance > 4e-3 && distance < 5e-3 && found.setup_fit.others_rms < 0.2 * distance, "{distance}");
}

#[test]
fn deviations_of_reference_points_are_those_of_many_sheets() {
    // Flanges that are tilted but a little: how high a point sits on them is told by that alone.
    let mut load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 20, 5);
    for (index, LoadCase { theta, .. }) in load_cases.iter_mut().enumerate() {
        theta[3] = 0.01 * (index % 3) as f64;
        theta[4] = 0.02 * (index % 4) as f64 - theta[1] - theta[2];
    }
    let cell = cell(3);
    let flanges: Vec<_> = load_cases.iter().map(|load_case| arm().forward(&load_case.theta)).collect();
    let found: Vec<_> = (0..300_u64)
        .into_par_iter()
        .map(|seed| {
            let mut random = ChaCha8Rng::seed_from_u64(seed);
            let readings = sheet(&arm(), &cell, &load_cases, || NOISE * gauss(&mut random), || 0.0);
            let kept = vec![true; readings.readings.len()];
            let start = cell.tracker_from_base.rotation;
            let setup = setup::estimate(&readings, &flanges, &kept, Some(&start)).unwrap();
            let fit = setup::check(&readings, &flanges, &kept, &setup).unwrap();
            (setup.points, fit.point_deviations)
        })
        .collect();
    for point in 0..3 {
        let square = found.iter().fold(nalgebra::Matrix3::zeros(), |sum, (points, _)| {
            let off = points[point] - cell.points[point];
            sum + off * off.transpose()
        });
        let spread = libm::sqrt((square / found.len() as f64).symmetric_eigenvalues().max());
        let reported = found.iter().map(|(_, deviations)| deviations[point]).sum::<f64>() / found.len() as f64;
        // The spread of 300 sheets is itself known to 4 %.
        assert!((spread / reported - 1.0).abs() < 0.15, "{point}: {spread} {reported}");
        assert!(reported > 2.0 * NOISE, "{reported}");
    }
}

#[test]
fn a_point_whose_deflections_are_all_outliers_is_left_out() {
    let mut problem = standard(1, NOISE, 3);
    let mut random = ChaCha8Rng::seed_from_u64(9);
    for reading in problem.sheet.readings.iter_mut().filter(|reading| reading.point == 2) {
        reading.loaded += direction(&mut random) * 2e-3;
    }
    let found = identify(&problem).unwrap();
    assert!(found.outliers().count() == 20 && found.outliers().all(|row| row.point == 2));
    for estimate in &found.compliances {
        let off = (estimate.value - truth(estimate.parameter, estimate.angle)) / estimate.deviation;
        assert!(off.abs() < 4.0, "{estimate:?}");
    }
}

#[test]
fn what_outliers_alone_see_is_refused_with_their_lines() {
    let mut load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 20, 5);
    load_cases.iter_mut().for_each(|load_case| load_case.force = Vector3::new(0.0, 0.0, -2700.0));
    load_cases[7].force = Vector3::new(1500.0, 1500.0, -1500.0);
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut problem = problem(sheet(&arm(), &cell(3), &load_cases, || NOISE * gauss(&mut random), || 0.0), &cell(3));
    for reading in &mut problem.sheet.readings[21..24] {
        reading.loaded += direction(&mut random) * 3e-3;
    }
    for reduce in [false, true] {
        match identify(&Problem { reduce, ..problem.clone() }) {
            Err(IdentifyError::Unidentifiable { unidentifiable, outliers, .. }) => {
                assert_eq!(unidentifiable[0].parameters, [Parameter::Joint(0)]);
                assert_eq!(outliers, [23, 24, 25]);
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn joints_that_turn_against_their_load_are_refused() {
    let mut problem = standard(1, NOISE, 3);
    problem.sheet.configurations.iter_mut().for_each(|configuration| configuration.force *= -1.0);
    for varying in [problem.varying, None] {
        match identify(&Problem { varying, ..problem.clone() }) {
            Err(IdentifyError::Negative { value_urad, deviation_urad, .. }) => {
                assert!(value_urad < -6.0 * deviation_urad);
            }
            other => panic!("{other:?}"),
        }
    }
}
