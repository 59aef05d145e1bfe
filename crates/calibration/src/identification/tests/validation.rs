//! The error of prediction, and what is said of a single reading.

use super::*;

/// The equations of a sheet that was read in this cell.
fn observations(robot: &Robot, sheet: &Sheet, cell: &synthetic::MeasuringCell) -> Vec<model::Observation<6>> {
    let setup =
        setup::Setup { tracker_from_base: cell.tracker_from_base, points: cell.points.clone(), residual_rms: 0.0 };
    let noise = model::Noise { position: NOISE, orientation: 1.0 };
    let load_point = &cell.load_point;
    model::ObservationModel { robot, sheet, setup: &setup, load_point, noise, hold: [false; 6] }.linear()
}

#[test]
fn leaving_a_configuration_out_is_what_estimating_without_it_gives() {
    let cell = cell(3);
    let plain = [0.54e-6, 0.3e-6, 0.42e-6, 2.79e-6, 3.48e-6, 2.074e-6].map(Compliance::from);
    let robot = kr270().with_compliances(plain).unwrap();
    let load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 8, 8);
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let readings = sheet(&robot, &cell, &load_cases, || NOISE * gauss(&mut random), || 0.0);
    let equations = observations(&robot, &readings, &cell);
    let layout = model::Layout::new(&readings, FitModel::Axes, None, 0.0);
    let solved = |weights: &[f64]| {
        let normal = normal_equations::NormalEquations::new(&readings, &layout, &equations, weights);
        let solution = normal.solve(&normal.free_unless([false; 6]), (&nalgebra::Vector6::zeros(), &[])).unwrap();
        (normal, solution)
    };
    let (normal, solution) = solved(&[1.0; 24]);
    let arm = law::fit(&normal, [true; 6], &solution, &[], Law::Constant).unwrap();
    let found = cross_validation::leave_one_out(&readings, &layout, &equations, &[true; 24], &arm);
    let mut sum = 0.0;
    for out in 0..8 {
        let weights: Vec<f64> = (0..24).map(|reading| if reading / 3 == out { 0.0 } else { 1.0 }).collect();
        let (_, without) = solved(&weights);
        let left = equations[3 * out..3 * out + 3].iter();
        sum += left.map(|e| (e.deflection - e.design * without.joints).norm_squared()).sum::<f64>();
    }
    let expected = libm::sqrt(sum / 72.0);
    assert!((found.rms / expected - 1.0).abs() < 1e-10, "{} {expected}", found.rms);
    assert!(found.unpredicted.is_empty());
}

#[test]
fn intervals_are_students_where_the_noise_is_estimated_and_normal_where_it_is_known() {
    // 180 equations for 10 compliances; 1.974017 is the upper 2.5 % point of t with 170 degrees of freedom.
    for (noise, expected) in [(None, 1.974_017), (Some(NOISE), 1.959_964)] {
        let found = identify(&Problem { noise, ..standard(1, NOISE, 3) }).unwrap();
        assert_eq!(found.degrees_of_freedom, 170);
        for Estimate { value, deviation, interval: [low, high], .. } in &found.compliances {
            assert!(((high - value) / deviation - expected).abs() < 1e-6);
            assert!(((value - low) / deviation - expected).abs() < 1e-6);
        }
    }
}

#[test]
fn a_reading_that_is_left_out_is_judged_by_how_well_the_others_predict_it() {
    // Few readings, so that what they predict is uncertain too.
    let cell = cell(1);
    let plain = [0.54e-6, 0.3e-6, 0.42e-6, 2.79e-6, 3.48e-6, 2.074e-6].map(Compliance::from);
    let robot = kr270().with_compliances(plain).unwrap();
    let load_cases = load_cases(&mut ChaCha8Rng::seed_from_u64(3), 9, 9);
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut readings = sheet(&robot, &cell, &load_cases, || NOISE * gauss(&mut random), || 0.0);
    readings.readings[4].loaded += direction(&mut random) * 5e-3;
    let observations = observations(&robot, &readings, &cell);
    let layout = model::Layout::new(&readings, FitModel::Axes, None, 0.0);
    let free =
        normal_equations::NormalEquations::new(&readings, &layout, &observations, &[1.0; 9]).free_unless([false; 6]);
    let held = (&nalgebra::Vector6::zeros(), &[][..]);
    let search = outliers::OutlierSearch {
        sheet: &readings,
        layout: &layout,
        observations: &observations,
        free: &free,
        held,
        min_scale: 1e-12,
    };
    let robust = search.robust_estimate().unwrap();
    assert!(robust.kept.iter().enumerate().all(|(index, kept)| *kept == (index != 4)), "{:?}", robust.kept);
    // By dense matrices: the others' estimate, and the variance of its prediction beside that of the reading.
    let mut design = nalgebra::DMatrix::zeros(24, 6);
    let mut deflection = nalgebra::DVector::zeros(24);
    for (slot, index) in (0..9).filter(|index| *index != 4).enumerate() {
        design.rows_mut(3 * slot, 3).copy_from(&observations[index].design.fixed_rows::<3>(0));
        deflection.rows_mut(3 * slot, 3).copy_from(&observations[index].deflection.fixed_rows::<3>(0));
    }
    let design = design * 1e-6;
    let covariance = (design.transpose() * &design).try_inverse().unwrap();
    let estimate = &covariance * design.transpose() * &deflection;
    let variance = (&deflection - &design * &estimate).norm_squared() / 18.0;
    let own = observations[4].design.fixed_rows::<3>(0) * 1e-6;
    let residual = observations[4].deflection.fixed_rows::<3>(0) - own * &estimate;
    let predicted = nalgebra::Matrix3::identity() + own * &covariance * own.transpose();
    let square = (residual.transpose() * predicted.try_inverse().unwrap() * residual)[(0, 0)];
    let expected = libm::sqrt(square / 3.0 / variance);
    assert!((robust.studentised[4] / expected - 1.0).abs() < 1e-6, "{} {expected}", robust.studentised[4]);
    assert!((robust.variance / variance - 1.0).abs() < 1e-6);
}
