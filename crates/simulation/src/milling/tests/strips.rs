//! What a tool that comes from outside leaves in the work, against a search by brute force.

use super::*;

/// A tool that comes from outside and swings across the feed: a shoulder, a cut nearly as wide as the tool, above which
/// it leaves a strip of work when it swings down, and a slot.
#[test]
fn what_a_tool_leaves_behind_it_and_above_it_is_cut_when_it_comes_back() {
    let (turn, length) = (120, 4.9e-3);
    // Off its path, away from the upper edge of the work.
    let wild = Wild {
        start: [-RADIUS - 0.6e-3, RADIUS - 0.26e-3],
        feed: 0.4584e-3,
        amplitude: [0.016e-3, 0.15e-3],
        waves_per_turn: [1.4185, 0.632],
        phase: 4.797,
        turn: turn as f64,
    };
    for (direction, width) in
        [(Way::Climb, 4e-3), (Way::Climb, 9.75e-3), (Way::Conventional, 9.75e-3), (Way::Climb, 10e-3)]
    {
        let cutter = cutter(&[360.0], &[0.0], 0.0);
        let mut cut = PassCut { length, ..cut(direction, 1, turn) };
        cut.section.radial_depth = width;
        let mut milling = MaterialRemoval::new(&cutter, &cut).unwrap();
        let mut met = 0;
        for step in 0..30 * turn {
            let node = wild.node(step as f64);
            let found = milling.force(step as f64, node.place).on_tool[2] / K.axial / 1.6e-3;
            milling.remember(node);
            if step < 12 * turn || step % 3 != 0 {
                continue;
            }
            let ([x, y], psi) = (node.place, cut.section.sense() * (step as f64 / turn as f64 * TAU));
            let (sine, cosine) = libm::sincos(psi);
            let top = if cut.section.is_slot(&cutter) { f64::MAX } else { width };
            // Where the ray comes into the block and where it leaves it.
            let (mut from, mut to) = (0.0_f64, RADIUS);
            for (inside, slope) in [(x, sine), (length - x, -sine), (top - y, cosine)] {
                let edge = -inside / slope;
                if slope > 0.0 { from = from.max(edge) } else { to = to.min(edge) }
            }
            let reach = brute_force(&wild, &cutter, cut.section.sense(), step as f64, psi);
            let expected = (to - from.max(reach)).max(0.0);
            met += usize::from(expected > 0.0);
            assert!((found - expected).abs() < 2e-9, "{found} {expected} at {step} {direction:?} {width}");
        }
        assert!(met > 10, "{met}");
    }
}
