//! Forces against closed forms, brute force, published figures, and each other.

use super::*;
use proptest::prelude::*;
use std::f64::consts::PI;
use stead_model::cutting::{Cut, Engagement, MillingDirection as Way, Rotation, Tooth};

mod pass_cut;
mod strips;

const K: Coefficients = Coefficients::new(661.553e6, 253.458e6, 0.1e9);
const RADIUS: f64 = 5e-3;

fn cutter(pitches_deg: &[f64], runouts: &[f64], helix_deg: f64) -> Cutter {
    let teeth = pitches_deg.iter().zip(runouts);
    let teeth = teeth.map(|(pitch, runout)| Tooth { pitch: pitch.to_radians(), radius: RADIUS + runout });
    Cutter::new(teeth.collect(), helix_deg.to_radians(), Some(0.02), Rotation::Clockwise, K).unwrap()
}

fn cut(direction: Way, slices: usize, steps_per_turn: usize) -> PassCut {
    let spindle_speed = 18_700.0 * TAU / 60.0;
    PassCut {
        section: Cut { direction, radial_depth: 4e-3, axial_depth: 1.6e-3 },
        length: 0.09,
        spindle_speed,
        slices,
        steps_per_turn,
    }
}

/// The published aluminium cut with a tool that does not yield.
fn aluminium(slices: usize, steps_per_turn: usize) -> (Cutter, PassCut) {
    (cutter(&[170.0, 190.0], &[0.0; 2], 30.0), cut(Way::Climb, slices, steps_per_turn))
}

/// Feed of 3.7 m/min after a ramp of 0.2 s, from 0.5 mm before the work: x and its derivative.
fn ramped(time: f64) -> [f64; 2] {
    let feed = 3.7 / 60.0;
    let rate = PI / 0.2;
    let [direction, speed] = if time < 0.2 {
        [feed * (time / 2.0 - libm::sin(rate * time) / (2.0 * rate)), feed / 2.0 * (1.0 - libm::cos(rate * time))]
    } else {
        [feed * (time - 0.1), feed]
    };
    [direction - RADIUS - 0.5e-3, speed]
}

/// Forces over a rigid pass: times and what is printed, F_x and -F_y.
fn rigid_pass((cutter, cut): &(Cutter, PassCut), until: f64) -> Vec<(f64, [f64; 2])> {
    let mut milling = MaterialRemoval::new(cutter, cut).unwrap();
    let step = cut.step();
    (0..(until / step) as usize)
        .map(|index| {
            let time = index as f64 * step;
            let [x, speed] = ramped(time);
            let [force_x, force_y, _] = milling.force(index as f64, [x, RADIUS]).on_tool;
            milling.remember(Node { place: [x, RADIUS], motion: [speed * step, 0.0] });
            (time, [force_x, -force_y])
        })
        .collect()
}

/// Mean, rms, minimum and maximum of one component between 0.4 and 1.4 s.
fn statistics(forces: &[(f64, [f64; 2])], part: usize) -> [f64; 4] {
    let inside = forces.iter().filter(|(time, _)| (0.4..=1.4).contains(time)).map(|(_, force)| force[part]);
    let (mut count, mut found) = (0.0, [0.0, 0.0, f64::MAX, f64::MIN]);
    for value in inside {
        count += 1.0;
        found = [found[0] + value, found[1] + value * value, found[2].min(value), found[3].max(value)];
    }
    [found[0] / count, (found[1] / count).sqrt(), found[2], found[3]]
}

/// Published for the rigid arm (to the digits given): F_x mean 8.74, rms 16.29, max 38.4; F_y mean -25.90, rms 44.7,
/// min -113.
#[test]
fn a_rigid_arm_gives_the_forces_known_for_aluminium() {
    let fine = rigid_pass(&aluminium(128, 1440), 1.4);
    let [[mean_x, rms_x, _, max_x], [mean_y, rms_y, min_y, _]] = [statistics(&fine, 0), statistics(&fine, 1)];
    for (found, known, digit) in [
        (mean_x, 8.74, 0.01),
        (rms_x, 16.29, 0.01),
        (max_x, 38.4, 0.1),
        (mean_y, -25.90, 0.01),
        (rms_y, 44.7, 0.1),
        (min_y, -113.0, 1.0),
    ] {
        assert!((found - known).abs() < 1.1 * digit, "{found} {known}");
    }
    let [normal, coarse] = [360, 90].map(|steps| rigid_pass(&aluminium(32, steps), 1.4));
    for part in 0..2 {
        let [fine, normal, coarse] = [&fine, &normal, &coarse].map(|forces| statistics(forces, part));
        for (number, tolerance) in [(0, 1e-3), (1, 1e-3)] {
            assert!((coarse[number] / normal[number] - 1.0).abs() < 2e-4, "{coarse:?} {normal:?}");
            assert!((normal[number] / fine[number] - 1.0).abs() < tolerance, "{normal:?} {fine:?}");
        }
    }
}

/// Of three teeth with unequal pitches and radii each comes its own pitch after the one before it, and cuts the feed
/// over that pitch and what it is longer than that one: with the teeth in another order, or each pitch counted to the
/// tooth that follows, both are others.
#[test]
fn each_tooth_follows_the_one_before_it_at_its_own_pitch() {
    let (pitches, runouts, feed) = ([100.0, 120.0, 140.0], [6e-6, 0.0, -4e-6], 0.3e-3);
    let cutter = cutter(&pitches, &runouts, 0.0);
    for (direction, sense) in [(Way::Climb, -1.0), (Way::Conventional, 1.0)] {
        // A slot, so that a tooth that is ahead of the tool is alone in the work; a step is a degree.
        let cut = PassCut {
            section: Cut { radial_depth: 2.0 * RADIUS, ..cut(direction, 1, 360).section },
            ..cut(direction, 1, 360)
        };
        let mut milling = MaterialRemoval::new(&cutter, &cut).unwrap();
        let chips: Vec<f64> = (0..4 * 360)
            .map(|step| {
                let place = [20e-3 + feed * step as f64 / 360.0, RADIUS];
                let chip = milling.force(step as f64, place).chip;
                milling.remember(Node { place, motion: [feed / 360.0, 0.0] });
                chip
            })
            .collect();
        let mut ahead = 360.0 + 90.0 * sense;
        for tooth in [0, 1, 2] {
            ahead += if tooth == 0 { 0.0 } else { pitches[tooth] };
            let chip = feed * pitches[tooth] / 360.0 + runouts[tooth] - runouts[(tooth + 2) % 3];
            let found = chips[3 * 360 + ahead as usize % 360];
            assert!((found - chip).abs() < 1e-9, "{direction:?} tooth {}: {found} {chip}", tooth + 1);
        }
    }
}

/// A tool of one tooth that stands still while the tooth cuts and is moved on by the feed while it does not leaves
/// circles. The chip between two of them is `R + f sin(psi) - sqrt(R^2 - f^2 cos^2(psi))`, or ends at the top of the
/// stock.
#[test]
fn a_cut_of_circular_arcs_has_its_closed_form() {
    let feed = 0.2e-3;
    for (direction, sense) in [(Way::Climb, -1.0), (Way::Conventional, 1.0)] {
        let (turn, slices) = (180, 5);
        let cutter = cutter(&[360.0], &[0.0], 30.0);
        let cut = cut(direction, slices, turn);
        let mut milling = MaterialRemoval::new(&cutter, &cut).unwrap();
        let mut largest = 0.0_f64;
        for step in 0..6 * turn {
            // The tooth is away from the work from 120 to 240 deg; there the tool is moved.
            let (turns, moved) = (step / turn, step % turn > turn / 2);
            let turns = turns as f64 + if moved { 1.0 } else { 0.0 };
            let x = 20e-3 + turns * feed;
            let force = milling.force(step as f64, [x, RADIUS]).on_tool;
            milling.remember(Node { place: [x, RADIUS], motion: [0.0; 2] });
            // In the first turn, and within a radian after it, nothing was cut before.
            if step < turn + turn / 6 {
                continue;
            }
            let mut expected = [0.0; 3];
            for slice in 0..slices {
                let height = (slice as f64 + 0.5) / slices as f64 * 1.6e-3;
                let psi = sense * (step as f64 / turn as f64 * TAU - height * libm::tan(30_f64.to_radians()) / RADIUS);
                let (sine, cosine) = (libm::sin(psi), libm::cos(psi));
                let surface = (RADIUS * RADIUS - feed * feed * cosine * cosine).sqrt() - feed * sine;
                let top = if cosine > 0.0 { (RADIUS - 4e-3) / cosine } else { f64::MAX };
                let chip = (RADIUS - surface.max(top)).max(0.0) * 1.6e-3 / slices as f64;
                expected[0] += chip * (-sense * K.tangential * cosine - K.radial * sine);
                expected[1] += chip * (-sense * K.tangential * sine + K.radial * cosine);
                expected[2] += chip * K.axial;
            }
            for (found, expected) in force.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-9, "{found} {expected} at {step}");
                largest = largest.max(expected.abs());
            }
        }
        assert!(largest > 100.0);
    }
}

/// With little feed the mean over a turn comes near that of `h = f_z sin(phi)`, whose integrals the engagement knows.
#[test]
fn the_mean_force_is_that_of_the_engagement_for_a_small_feed() {
    for direction in [Way::Climb, Way::Conventional] {
        let cutter = cutter(&[180.0; 2], &[0.0; 2], 0.0);
        let turn = 3600;
        let cut = cut(direction, 1, turn);
        let mut milling = MaterialRemoval::new(&cutter, &cut).unwrap();
        let per_tooth = 1e-6;
        let step = 2.0 * per_tooth / turn as f64;
        let mut mean = [0.0; 2];
        for index in 0..=2 * turn {
            let centre = [30e-3 + index as f64 * step, RADIUS];
            let force = milling.force(index as f64, centre).on_tool;
            milling.remember(Node { place: centre, motion: [step, 0.0] });
            if index > turn {
                mean = [mean[0] + force[0] / turn as f64, mean[1] + force[1] / turn as f64];
            }
        }
        let engagement = match direction {
            Way::Climb => Engagement::down(4e-3, 2.0 * RADIUS),
            Way::Conventional => Engagement::up(4e-3, 2.0 * RADIUS),
        };
        let [arc] = engagement.unwrap().arcs()[..] else { panic!() };
        // Midpoints: the integral of the force on one tooth over its arc, by phi; the wall is at phi = pi in down
        // milling.
        let (mut sum, parts) = ([0.0; 2], 10_000);
        let width = (arc.exit - arc.entry) / parts as f64;
        for part in 0..parts {
            let (sine, cosine) = libm::sincos(arc.entry + (part as f64 + 0.5) * width);
            let chip = per_tooth * sine * width / PI * 1.6e-3;
            // On the tool: against the motion of the tooth, (cos phi, +-sin phi), and from the tooth to the axis.
            let side = if direction == Way::Climb { 1.0 } else { -1.0 };
            sum[0] += chip * (-K.tangential * cosine - K.radial * sine);
            sum[1] += chip * side * (K.tangential * sine - K.radial * cosine);
        }
        for (found, expected) in mean.iter().zip(sum) {
            assert!((found / expected - 1.0).abs() < 2e-3, "{mean:?} {sum:?} {direction:?}");
        }
    }
}

/// The area cleared in a turn is the width of cut times the feed. A tooth clears `h (R - h / 2) dpsi` by turning, less
/// what its centre moves on meanwhile in the sense in which it does not turn.
#[test]
fn what_is_cut_is_what_is_fed() {
    let (cutter, turn) = (cutter(&[170.0, 190.0], &[0.0; 2], 0.0), 3600);
    let mut milling = MaterialRemoval::new(&cutter, &cut(Way::Climb, 1, turn)).unwrap();
    let step = 0.198e-3 / turn as f64;
    let mut area = 0.0;
    for index in 0..=4 * turn {
        let centre = [20e-3 + index as f64 * step, RADIUS];
        let chip = milling.force(index as f64, centre).chip;
        milling.remember(Node { place: centre, motion: [step, 0.0] });
        if index > 3 * turn {
            let angle = TAU / turn as f64;
            let in_front = |offset: f64| libm::sincos(offset - index as f64 * angle);
            let offsets = [0.0, 190_f64.to_radians()].map(in_front);
            let cosine =
                offsets.iter().find(|(sine, cosine)| *sine > -0.1 && *cosine > 0.0).map_or(0.0, |tooth| tooth.1);
            area += chip * ((RADIUS - chip / 2.0) * angle - step * cosine);
        }
    }
    assert!((area / (4e-3 * 0.198e-3) - 1.0).abs() < 1e-3, "{area}");
}

/// A tool that vibrates as wildly as its way, over time in steps.
#[derive(Debug, Clone)]
struct Wild {
    start: [f64; 2],
    feed: f64,
    amplitude: [f64; 2],
    waves_per_turn: [f64; 2],
    phase: f64,
    turn: f64,
}

impl Wild {
    fn node(&self, time: f64) -> Node {
        let [along, across] = self.waves_per_turn.map(|waves| waves * TAU / self.turn);
        let (sine, cosine) = libm::sincos(along * time);
        let (side_sine, side_cosine) = libm::sincos(across * time + self.phase);
        let feed = self.feed / self.turn;
        let [x, y] = self.amplitude;
        Node {
            place: [self.start[0] + feed * time + x * sine, self.start[1] + y * side_sine],
            motion: [feed + x * along * cosine, y * across * side_cosine],
        }
    }
}

/// Where the work begins on a ray from the centre at a time: the farthest crossing with any earlier edge, found by
/// following each edge in small steps over all its earlier turns. A pass counts if its tooth was turned as on the ray,
/// about a fixed centre, more than a radian after the start.
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

    /// Whatever the tool does: vibration that leaves the cut, runout, unequal pitch, down and up milling. What is left,
    /// up to 7e-10 m, is what cubics between steps miss of the vibration.
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
        let wild = Wild { start: [20e-3, RADIUS], feed, amplitude, waves_per_turn, phase, turn: turn as f64 };
        let direction = if climb { Way::Climb } else { Way::Conventional };
        let cutter = cutter(&[pitch, 360.0 - pitch], &[0.0, runout], 0.0);
        let cut = cut(direction, 1, turn);
        // Short stretches, so that there are some.
        let mut milling = MaterialRemoval { trail: Trail::with_room(0, 40), ..MaterialRemoval::new(&cutter, &cut).unwrap() };
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
                let psi = cut.section.sense() * (step as f64 / turn as f64 * TAU - offset);
                let cosine = libm::cos(psi);
                // Only the shoulder: what is behind and above is checked by the other rays.
                let top = if cosine > 0.0 { (node.place[1] - 4e-3) / cosine } else { f64::MAX };
                let reach = brute_force(&wild, &cutter, cut.section.sense(), step as f64, psi);
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

/// The first cut into the work, its end, and a tool before it.
#[test]
fn nothing_is_cut_outside_the_work() {
    let pass = rigid_pass(&aluminium(8, 90), 1.85);
    let contact = |time: f64| ramped(time)[0] + RADIUS;
    let first = pass.iter().find(|(_, force)| force[1] != 0.0).unwrap().0;
    let last = pass.iter().rfind(|(_, force)| force[1] != 0.0).unwrap().0;
    assert!(contact(first) > 0.0 && contact(first) < 0.3e-3, "{first}");
    // The edges that cut are ahead of the centre.
    assert!((ramped(last)[0] - 0.09).abs() < 0.3e-3, "{last}");
}

#[test]
fn every_kind_of_instructions_gives_the_same_bits() {
    let (cutter, cut) = aluminium(20, 45);
    let (amplitude, waves_per_turn) = ([0.1e-3, 0.2e-3], [0.3, 0.7]);
    let wild = Wild { start: [20e-3, RADIUS], feed: 0.2e-3, amplitude, waves_per_turn, phase: 0.4, turn: 45.0 };
    let runs = Instructions::all().into_iter().map(|instructions| {
        let mut milling = MaterialRemoval { instructions, ..MaterialRemoval::new(&cutter, &cut).unwrap() };
        let forces = (0..450).map(|step| {
            let node = wild.node(step as f64);
            let force = milling.force(step as f64, node.place);
            milling.remember(node);
            force
        });
        forces.collect::<Vec<_>>()
    });
    let runs: Vec<_> = runs.collect();
    assert!(runs[0].iter().any(|force| force.chip > 0.2e-3));
    assert!(runs.iter().all(|run| run == &runs[0]));
}
