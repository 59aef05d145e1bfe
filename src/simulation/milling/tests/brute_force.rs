//! Chips of a tool that moves as it likes, against a search by brute force.

use super::*;

/// A tool that vibrates as wildly as its way, over time in steps.
#[derive(Debug, Clone)]
pub(super) struct Wild {
    pub start: f64,
    pub feed: f64,
    pub amplitude: [f64; 2],
    pub waves_per_turn: [f64; 2],
    pub phase: f64,
    pub turn: f64,
}

impl Wild {
    pub fn node(&self, time: f64) -> Node {
        let [along, across] = self.waves_per_turn.map(|waves| waves * TAU / self.turn);
        let (sine, cosine) = libm::sincos(along * time);
        let (side_sine, side_cosine) = libm::sincos(across * time + self.phase);
        let feed = self.feed / self.turn;
        let [x, y] = self.amplitude;
        Node {
            place: [self.start + feed * time + x * sine, RADIUS + y * side_sine],
            motion: [feed + x * along * cosine, y * across * side_cosine],
        }
    }
}

/// Where the work begins on a ray from the centre at a time: the farthest crossing with any earlier edge, found by following
/// each edge in small steps over all its earlier turns. A pass counts if its tooth was turned as on the ray, about a fixed
/// centre, more than a radian after the start.
fn brute_force(wild: &Wild, cutter: &Cutter, sense: f64, time: f64, psi: f64) -> f64 {
    let centre = wild.node(time).place;
    let (sine, cosine) = libm::sincos(psi);
    let mut farthest: f64 = 0.0;
    for (tooth, offset) in cutter.teeth().iter().zip(cutter.offsets()) {
        let edge = |at: f64| {
            let (sine, cosine) = libm::sincos(sense * (at / wild.turn * TAU - offset));
            let place = wild.node(at).place;
            let [dx, dy] = [place[0] + tooth.radius * sine - centre[0], place[1] - tooth.radius * cosine - centre[1]];
            [dx, dy]
        };
        let split = |[dx, dy]: [f64; 2]| [dx * sine - dy * cosine, dx * cosine + dy * sine];
        let fine = 0.25;
        // An edge is not met again before a quarter of a step has passed.
        let mut last = split(edge(0.0));
        for index in 1..((time - 0.25) / fine) as usize {
            let next = split(edge(index as f64 * fine));
            if last[1] * next[1] <= 0.0 && last[0] > 0.0 {
                // Bisection between the two.
                let (mut a, mut b) = ((index - 1) as f64 * fine, index as f64 * fine);
                for _ in 0..60 {
                    let middle = (a + b) / 2.0;
                    if split(edge(middle))[1] * split(edge(a))[1] <= 0.0 { b = middle } else { a = middle }
                }
                let turned = sense * psi - (a / wild.turn * TAU - offset);
                let apart = turned - (turned / TAU).round() * TAU;
                if a / wild.turn * TAU + apart >= 1.0 {
                    farthest = farthest.max(split(edge(a))[0]);
                }
            }
            last = next;
        }
    }
    farthest
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Whatever the tool does: vibration that leaves the cut, runout, unequal pitch, down and up milling. What is left, up to 7e-10 m,
    /// is what cubics between steps miss of the vibration.
    #[test]
    fn chips_are_those_that_a_search_by_brute_force_finds(
        feed in 0.02e-3..0.3e-3_f64,
        amplitude in [0.0..0.3e-3_f64, 0.0..0.3e-3_f64],
        waves_per_turn in [0.05..2.5_f64, 0.05..2.5_f64],
        phase in 0.0..TAU,
        pitch in 100.0..200.0_f64,
        runout in -20e-6..20e-6_f64,
        climb in any::<bool>(),
    ) {
        let turn = 120;
        let wild = Wild { start: 20e-3, feed, amplitude, waves_per_turn, phase, turn: turn as f64 };
        let way = if climb { Way::Climb } else { Way::Conventional };
        let cutter = cutter(&[pitch, 360.0 - pitch], &[0.0, runout], 0.0);
        let cut = cut(way, 1, turn);
        let mut milling = Milling::new(&cutter, &cut).unwrap();
        let turns = 6;
        let mut met = 0;
        for step in 0..turns * turn {
            let node = wild.node(step as f64);
            let force = milling.force(step as f64, node.place);
            milling.remember(node);
            if step < (turns - 1) * turn || step % 5 != 0 {
                continue;
            }
            let mut expected = 0.0;
            for (tooth, offset) in cutter.teeth().iter().zip(cutter.offsets()) {
                let psi = cut.sense() * (step as f64 / turn as f64 * TAU - offset);
                let cosine = libm::cos(psi);
                // Only the shoulder: what is behind and above is checked by the other rays.
                let top = if cosine > 0.0 { (node.place[1] - 4e-3) / cosine } else { f64::MAX };
                let reach = brute_force(&wild, &cutter, cut.sense(), step as f64, psi);
                expected += (tooth.radius - reach.max(top)).max(0.0);
            }
            let found = force.on_tool[2] / K.axial / 1.6e-3;
            met += usize::from(expected > 0.0);
            prop_assert!((found - expected).abs() < 2e-9, "{} {} at {}", found, expected, step);
        }
        // Another case, please, for a tool that has gone back and forth so far that nothing is left to cut.
        prop_assume!(met > 0);
    }
}

/// A tool that comes from outside and swings across the feed: a shoulder, a cut nearly as wide as the tool, above which it leaves a
/// strip of work when it swings down, and a slot.
#[test]
fn what_a_tool_leaves_behind_it_and_above_it_is_cut_when_it_comes_back() {
    let (turn, feed, length) = (120, 0.45e-3, 5e-3);
    let wild = Wild {
        start: -RADIUS - 0.5e-3,
        feed,
        amplitude: [0.05e-3, 0.2e-3],
        waves_per_turn: [1.4, 0.63],
        phase: 4.8,
        turn: turn as f64,
    };
    for (way, width) in [(Way::Climb, 4e-3), (Way::Climb, 9.8e-3), (Way::Conventional, 9.8e-3), (Way::Climb, 10e-3)] {
        let cutter = cutter(&[360.0], &[0.0], 0.0);
        let cut = Cut { radial_depth: width, length, ..cut(way, 1, turn) };
        let mut milling = Milling::new(&cutter, &cut).unwrap();
        let mut met = 0;
        for step in 0..30 * turn {
            let node = wild.node(step as f64);
            let found = milling.force(step as f64, node.place).on_tool[2] / K.axial / 1.6e-3;
            milling.remember(node);
            if step < 16 * turn || step % 11 != 0 {
                continue;
            }
            let ([x, y], psi) = (node.place, cut.sense() * (step as f64 / turn as f64 * TAU));
            let (sine, cosine) = libm::sincos(psi);
            let top = if cut.is_slot(&cutter) { f64::MAX } else { width };
            // Where the ray comes into the block and where it leaves it.
            let (mut from, mut to) = (0.0_f64, RADIUS);
            for (inside, slope) in [(x, sine), (length - x, -sine), (top - y, cosine)] {
                let edge = -inside / slope;
                if slope > 0.0 { from = from.max(edge) } else { to = to.min(edge) }
            }
            let reach = brute_force(&wild, &cutter, cut.sense(), step as f64, psi);
            let expected = (to - from.max(reach)).max(0.0);
            met += usize::from(expected > 0.0);
            assert!((found - expected).abs() < 2e-9, "{found} {expected} at {step} {way:?} {width}");
        }
        assert!(met > 10, "{met}");
    }
}
