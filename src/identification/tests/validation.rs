//! The error of prediction.

use super::*;

#[test]
fn leaving_a_configuration_out_is_what_estimating_without_it_gives() {
    let cell = cell(3);
    let plain = [0.54e-6, 0.3e-6, 0.42e-6, 2.79e-6, 3.48e-6, 2.074e-6].map(Compliance::from);
    let robot = kr270().with_compliances(plain).unwrap();
    let shots = shots(&mut ChaCha8Rng::seed_from_u64(3), 8, 8);
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let readings = sheet(&robot, &cell, &shots, || NOISE * gauss(&mut random), || 0.0);
    let setup =
        setup::Setup { tracker_from_base: cell.tracker_from_base, points: cell.points.clone(), residual_rms: 0.0 };
    let noise = model::Noise { position: NOISE, orientation: 1.0 };
    let equations = model::observations(&robot, &readings, &setup, &cell.load_point, &noise);
    let layout = model::Layout::new(&readings, None, 0.0);
    let solved = |weights: &[f64]| {
        let normal = normal::Normal::new(&readings, &layout, &equations, weights);
        let solution = normal.solve(&normal.all_free(), (&nalgebra::Vector6::zeros(), &[])).unwrap();
        (normal, solution)
    };
    let (normal, solution) = solved(&[1.0; 24]);
    let arm = law::fit(&normal, [true; 6], &solution, &[], Law::Constant).unwrap();
    let found = validate::leave_one_out(&readings, &layout, &equations, &[true; 24], &arm);
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
