//! Critical depths against the time domain, in which the tool really mills.

use super::*;

/// Whether motion dies out over time when the tool really mills: in the end the tip comes by the same way from period
/// to period, to a tenth of the feed of a tooth. The tool leans so that this part of the force along its axis acts
/// along the feed.
fn calm(cutter: &Cutter, cut: &PassCut, depth: f64, period: usize, lean: f64) -> bool {
    let mut cut = *cut;
    cut.section.axial_depth = depth;
    let (turn, dt) = (cut.steps_per_turn, cut.step());
    let mut milling = MaterialRemoval::new(cutter, &cut).unwrap();
    let feed = 0.1e-3 * cutter.teeth().len() as f64 / turn as f64;
    let (k, c) = (MASS * OMEGA * OMEGA, 2.0 * DAMPING * OMEGA * MASS);
    let effective = MASS + dt / 2.0 * c + dt * dt / 4.0 * k;
    let (mut u, mut v, mut a) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    let turns = 120;
    let mut course = Vec::with_capacity(turns * turn);
    // A turn with a rigid tool before, so that the first chips are as all others.
    for step in 0..turn {
        milling.remember(Node { place: [0.5 + feed * step as f64, RADIUS], motion: [feed, 0.0] });
    }
    for step in turn..turns * turn {
        let mut force = [0.0; 3];
        let (mut next_u, mut next_v, mut next_a) = (u, v, a);
        for _ in 0..6 {
            for axis in 0..2 {
                let free_v = v[axis] + dt / 2.0 * a[axis];
                let free_u = u[axis] + dt * v[axis] + dt * dt / 4.0 * a[axis];
                let push = if axis == 0 { force[0] + lean * force[2] } else { 0.0 };
                next_a[axis] = (push - c * free_v - k * free_u) / effective;
                next_v[axis] = free_v + dt / 2.0 * next_a[axis];
                next_u[axis] = free_u + dt * dt / 4.0 * next_a[axis];
            }
            let place = [0.5 + feed * step as f64 + next_u[0], RADIUS + next_u[1]];
            force = milling.force(step as f64, place).on_tool;
        }
        (u, v, a) = (next_u, next_v, next_a);
        let place = [0.5 + feed * step as f64 + u[0], RADIUS + u[1]];
        milling.remember(Node { place, motion: [feed + dt * v[0], dt * v[1]] });
        course.push(u[0]);
    }
    let last = course.len() - 10 * turn..course.len();
    last.map(|step| (course[step] - course[step - period]).abs()).fold(0.0, f64::max) < 0.01e-3
}

/// Within 5 % of the depth at which vibration in the time domain no longer dies out: equal and unequal pitch, with and
/// without helix, where the tool stays in the cut (linear theory knows no other).
#[test]
fn the_time_domain_has_the_same_critical_depths() {
    let plant = benchmark_plant();
    for (direction, immersion, rpm, pitches, helix, slices) in [
        (Way::Climb, 0.5, 5000.0, [180.0; 2], 0.0, 1),
        (Way::Climb, 0.5, 5000.0, [180.0; 2], 30.0, 8),
        (Way::Conventional, 0.5, 10_000.0, [180.0; 2], 0.0, 1),
        (Way::Climb, 0.1, 11_000.0, [180.0; 2], 0.0, 1),
        (Way::Conventional, 0.1, 7500.0, [180.0; 2], 0.0, 1),
        (Way::Climb, 0.6, 8000.0, [160.0, 200.0], 0.0, 1),
    ] {
        let cutter = benchmark_cutter(&pitches, helix);
        let cut = PassCut { slices, steps_per_turn: 360, ..cut(direction, immersion, rpm) };
        let period = if pitches[0] == pitches[1] { 180 } else { 360 };
        let ours = SemiDiscretisation::new(&plant, &cutter, &cut).unwrap().critical_depth(20e-3).unwrap();
        let calm = |depth: f64| calm(&cutter, &cut, depth, period, 0.0);
        assert!(calm(0.95 * ours) && !calm(1.05 * ours), "{ours} {direction:?} {immersion} {rpm} {pitches:?} {helix}");
    }
}

/// The force along the tool axis counts where it moves the tip in the plane of the cut: this depth becomes a third
/// less, or nearly twice.
#[test]
fn a_force_along_the_tool_axis_is_felt() {
    let (flat, cutter) = (benchmark_plant(), benchmark_cutter(&[180.0; 2], 0.0));
    let cut = PassCut { slices: 1, steps_per_turn: 360, ..cut(Way::Climb, 0.5, 5000.0) };
    let without = SemiDiscretisation::new(&flat, &cutter, &cut).unwrap().critical_depth(20e-3).unwrap();
    for lean in [-0.4, 0.4] {
        let b = DMatrix::from_row_slice(2, 3, &[0.0, 0.0, 0.0, 1.0 / MASS, 0.0, lean / MASS]);
        let plant = Plant::new(flat.a().clone(), b, flat.c().clone()).unwrap();
        let ours = SemiDiscretisation::new(&plant, &cutter, &cut).unwrap().critical_depth(20e-3).unwrap();
        let calm = |depth: f64| calm(&cutter, &cut, depth, 180, lean);
        assert!(calm(0.95 * ours) && !calm(1.05 * ours), "{ours} {lean}");
        assert!((ours / without - 1.0).abs() > 0.3, "{ours} {without}");
        let zero_order = ZeroOrder::new(&plant).critical_depth(&cutter, &cut, 0.1).unwrap().unwrap();
        let method = SemiDiscretisation::with_intervals(&plant, &cutter, &cut, 800).unwrap();
        let depth = method.critical_depth_by_the_mean(0.1).unwrap();
        assert!((zero_order / depth - 1.0).abs() < 5e-3, "{zero_order} {depth}");
    }
}
