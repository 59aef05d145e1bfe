//! The closed form of a sweep against the same piece put down many times.

use super::*;
use proptest::prelude::*;

fn pieces() -> [Piece; 7] {
    [
        Piece::corner(0.0, 5e-3, 0.0),
        Piece::cone([0.0, 0.02], [8e-3, 8e-3]),
        Piece::cone([0.0, 0.02], [2e-3, 6e-3]),
        Piece::cone([1e-3, 2e-3], [5e-3, 5.8e-3]),
        Piece::cone([2e-3, 0.03], [2e-3, 2.5e-3]),
        Piece::corner(4e-3, 2e-3, 0.0),
        Piece::corner(1e-3, 5e-3, 0.2),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn a_sweep_is_what_stamps_along_it_cover(
        which in 0..7_usize,
        axis in prop::array::uniform3(-1.0..1.0_f64),
        at in prop::array::uniform2(-9e-3..9e-3_f64),
        by in prop::array::uniform3(-4e-3..4e-3_f64),
        along in 0..3_usize,
        upright in 0..3_usize
    ) {
        // Leaning, upright, and upright on a level move.
        let axis = if upright > 0 { Vector3::z() } else { Vector3::from(axis) };
        let by = if upright > 1 { [by[0], by[1], 0.0] } else { by };
        prop_assume!(axis.norm() > 0.1);
        let axis = axis.normalize();
        let piece = pieces()[which];
        let (mut d, mut o, u) = (Vector3::zeros(), Vector3::zeros(), Vector3::from(by));
        d[along] = 1.0;
        (o[(along + 1) % 3], o[(along + 2) % 3]) = (at[0], at[1]);
        let mut swept = [f64::INFINITY, f64::NEG_INFINITY];
        piece.sweep(&Line { axis: &axis, w: &o, d: &d, u: &u }, &mut swept);
        let steps = 4000;
        let mut stamped = [f64::INFINITY, f64::NEG_INFINITY];
        for step in 0..=steps {
            let moved = o - u * (f64::from(step) / f64::from(steps));
            if let Some(chord) = piece.chord(&axis, &moved, &d) {
                stamped = [stamped[0].min(chord.ends[0]), stamped[1].max(chord.ends[1])];
            }
        }
        if stamped[0] > stamped[1] {
            // Stamps can miss a line that the sweep just touches.
            prop_assert!(swept[0] > swept[1] || swept[1] - swept[0] < 1e-4, "{:?} {:?}", swept, stamped);
            return Ok(());
        }
        // Between two stamps the surface moves by a micrometre, and along a line that grazes it by some of them.
        for k in 0..2 {
            let apart = (swept[k] - stamped[k]).abs();
            prop_assert!(apart < 1e-4, "{:?} {:?}", swept, stamped);
        }
        prop_assert!(swept[0] <= stamped[0] + 1e-9 && swept[1] >= stamped[1] - 1e-9, "{:?} {:?}", swept, stamped);
    }

    #[test]
    fn the_ends_of_a_chord_are_on_the_surface_and_its_middle_is_inside(
        which in 0..7_usize,
        axis in prop::array::uniform3(-1.0..1.0_f64),
        y in prop::array::uniform3(-8e-3..8e-3_f64),
        d in prop::array::uniform3(-1.0..1.0_f64),
        upright in 0..3_usize
    ) {
        // Leaning, and upright lines and level ones about an upright axis.
        let axis = if upright > 0 { Vector3::z() } else { Vector3::from(axis) };
        let d = [Vector3::from(d), Vector3::z() * d[2], Vector3::new(d[0], d[1], 0.0)][upright];
        prop_assume!(axis.norm() > 0.1 && d.norm() > 0.1);
        let (axis, y, piece) = (axis.normalize(), Vector3::from(y), pieces()[which]);
        // How far a point is outside: of the side and of the planes at its ends.
        let outside = |point: &Vector3<f64>| {
            let height = point.dot(&axis);
            let radius = (point - axis * height).norm();
            let [from, to] = piece.heights;
            let corners = [(0, [0.0, 5e-3]), (5, [4e-3, 2e-3]), (6, [1e-3, 5e-3])];
            if let Some((_, [disc, corner])) = corners.iter().find(|(number, _)| *number == which) {
                return libm::hypot(height - corner, (radius - disc).max(0.0)) - corner;
            }
            let share = (height - from) / (to - from);
            let ends = [[8e-3, 8e-3], [2e-3, 6e-3], [5e-3, 5.8e-3], [2e-3, 2.5e-3]][which - 1];
            (radius - (ends[0] + (ends[1] - ends[0]) * share)).max(from - height).max(height - to)
        };
        match piece.chord(&axis, &y, &d) {
            Some(chord) => {
                for end in chord.ends {
                    prop_assert!(outside(&(y + d * end)).abs() < 1e-8);
                }
                let entry = piece.entry(&axis, &y, &d, f64::INFINITY).map(|(at, _)| at);
                prop_assert!(entry.is_some() == (chord.ends[1] >= 0.0), "{:?} {:?}", entry, chord);
                prop_assert!(entry.is_none_or(|at| (at - chord.ends[0]).abs() < 1e-9), "{:?} {:?}", entry, chord);
                prop_assert!(outside(&(y + d * ((chord.ends[0] + chord.ends[1]) / 2.0))) < 1e-9);
            }
            None => {
                for step in -200..200 {
                    prop_assert!(outside(&(y + d * f64::from(step) * 1e-4)) > -1e-6);
                }
            }
        }
    }
}
