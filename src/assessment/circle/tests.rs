//! All four circles against brute force, over shapes of every kind.

use super::*;
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::{PI, TAU};

type Points = Vec<[f64; 2]>;

/// Uniform in [0, 1).
fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 * 0.5_f64.powi(53)
}

fn polar(angle: f64, radius: f64) -> [f64; 2] {
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

/// Shapes of extent one or so.
const SHAPES: usize = 14;

fn shape(kind: usize, count: usize, seed: u64) -> Points {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut next = |from: f64, to: f64| from + (to - from) * uniform(&mut random);
    let turns: Vec<f64> = (0..count).map(|k| TAU * k as f64 / count as f64).collect();
    let arc = |span: f64, noise: f64, next: &mut dyn FnMut(f64, f64) -> f64| -> Points {
        let radius = 1.0 / span;
        let place = |k: usize| span * (k as f64 / (count - 1) as f64 - 0.5);
        (0..count).map(|k| polar(place(k), radius + next(-noise, noise))).collect()
    };
    match kind {
        // Measured rounds: noise, and three lobes with noise.
        0 => turns.iter().map(|t| polar(*t, 1.0 + next(-1e-3, 1e-3))).collect(),
        1 => turns.iter().map(|t| polar(*t, 1.0 + 1e-4 * libm::cos(3.0 * t + 0.3) + next(-1e-6, 1e-6))).collect(),
        // A cloud in a square, and one with most points in a small cluster.
        2 => turns.iter().map(|_| [next(-1.0, 1.0), next(-1.0, 1.0)]).collect(),
        3 => (0..count)
            .map(|k| if k < 4 { polar(next(0.0, TAU), 1.0) } else { [next(0.3, 0.30001), next(0.1, 0.10001)] })
            .collect(),
        // Regular polygons, some with every corner twice.
        4 => turns.iter().map(|t| polar(*t + 0.1, 1.0)).collect(),
        5 => turns.iter().flat_map(|t| [polar(*t, 1.0), polar(*t, 1.0)]).collect(),
        // Outlines of an ellipse and of a rectangle.
        6 => turns.iter().map(|t| [libm::cos(*t + 0.2), 0.6 * libm::sin(*t + 0.2)]).collect(),
        7 => (0..count)
            .map(|k| {
                let along = 4.0 * k as f64 / count as f64;
                let part = along.fract() - 0.5;
                match along as usize {
                    0 => [part, -0.35],
                    1 => [0.5, 0.7 * part],
                    2 => [-part, 0.35],
                    _ => [-0.5, -0.7 * part],
                }
            })
            .collect(),
        // Arcs, from a third of a turn to almost straight.
        8 => arc(2.0, 1e-3, &mut next),
        9 => arc(0.5, 1e-4, &mut next),
        10 => arc(0.05, 1e-6, &mut next),
        11 => arc(0.4, 3e-2, &mut next),
        // A thin band along a line.
        12 => turns.iter().map(|_| [next(-1.0, 1.0), next(-0.01, 0.01)]).collect(),
        // A round with a few wild points.
        _ => {
            (0..count).map(|k| polar(turns[k], if k % 17 == 3 { next(0.4, 1.5) } else { next(0.999, 1.001) })).collect()
        }
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

fn extremes(points: &[[f64; 2]], centre: [f64; 2]) -> (f64, f64) {
    let distances = points.iter().map(|p| distance(*p, centre));
    distances.fold((f64::INFINITY, 0.0), |(low, high), d| (low.min(d), high.max(d)))
}

/// Where two lines `normal . x = offset` meet.
fn meet(a: ([f64; 2], f64), b: ([f64; 2], f64)) -> Option<[f64; 2]> {
    let ((n, f), (m, g)) = (a, b);
    let determinant = n[0] * m[1] - n[1] * m[0];
    let place = [(f * m[1] - g * n[1]) / determinant, (g * n[0] - f * m[0]) / determinant];
    (place[0].is_finite() && place[1].is_finite()).then_some(place)
}

/// The bisectors of all pairs of points.
fn bisectors(points: &[[f64; 2]]) -> Vec<([f64; 2], f64)> {
    let mut lines = Vec::new();
    for (k, a) in points.iter().enumerate() {
        for b in &points[k + 1..] {
            let normal = [b[0] - a[0], b[1] - a[1]];
            lines.push((normal, 0.5 * (normal[0] * (a[0] + b[0]) + normal[1] * (a[1] + b[1]))));
        }
    }
    lines
}

/// Lines through all pairs that have all points on one side, the normal pointing away from them.
fn edges(points: &[[f64; 2]]) -> Vec<([f64; 2], f64)> {
    let mut lines = Vec::new();
    for a in points {
        for b in points {
            let normal = [b[1] - a[1], a[0] - b[0]];
            let offset = normal[0] * a[0] + normal[1] * a[1];
            if a != b && points.iter().all(|p| normal[0] * p[0] + normal[1] * p[1] <= offset + 1e-14) {
                lines.push((normal, offset));
            }
        }
    }
    lines
}

/// Smallest zone, smallest circumscribed and largest inscribed radius from all centres that can be any of them. The zone
/// may also be one between parallel lines.
fn brute_force(points: &[[f64; 2]]) -> [f64; 3] {
    let (lines, edges) = (bisectors(points), edges(points));
    let mut centres = Vec::new();
    for (k, a) in lines.iter().enumerate() {
        centres.extend(lines[k + 1..].iter().filter_map(|b| meet(*a, *b)));
        centres.extend(edges.iter().filter_map(|b| meet(*a, *b)));
    }
    let pairs = points.iter().flat_map(|a| points.iter().map(|b| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]));
    centres.extend(pairs);
    let [mut zone, mut around, mut inside] = [f64::INFINITY, f64::INFINITY, 0.0_f64];
    for centre in centres {
        let (low, high) = extremes(points, centre);
        if high < 1e5 {
            zone = zone.min(high - low);
        }
        around = around.min(high);
        if edges.iter().all(|(n, offset)| n[0] * centre[0] + n[1] * centre[1] <= offset + 1e-12) {
            inside = inside.max(low);
        }
    }
    for (normal, offset) in edges {
        let depth = points.iter().map(|p| offset - normal[0] * p[0] - normal[1] * p[1]).fold(0.0, f64::max);
        zone = zone.min(depth / libm::hypot(normal[0], normal[1]));
    }
    [zone, around, inside]
}

/// A number times the residual that a difference in the last places makes.
const ROUNDING: f64 = 1e-13;

#[test]
fn zone_circumscribed_and_inscribed_are_the_best_of_all_candidates() {
    for kind in 0..SHAPES {
        for seed in 0..12 {
            let points = shape(kind, 5 + seed as usize % 6, seed);
            let [zone, around, inside] = brute_force(&points);
            let (mcc, mic) = (minimum_circumscribed(&points).unwrap(), maximum_inscribed(&points).unwrap());
            assert!((mcc.circle.radius / around - 1.0).abs() < 1e-12, "MCC {kind} {seed}");
            assert!((mic.circle.radius - inside).abs() < 1e-11, "MIC {kind} {seed}: {} {inside}", mic.circle.radius);
            match minimum_zone(&points) {
                Ok(mzc) => {
                    let excess = mzc.circularity - zone;
                    // The brute force computes distances from afar, and so with fewer digits.
                    let rounding = ROUNDING.max(1e-15 * mzc.largest);
                    assert!(excess.abs() < 1e-9 * zone + rounding, "MZC {kind} {seed}: {} {zone}", mzc.circularity);
                }
                Err(error) => assert_eq!(error, CircleError::Straight, "{kind} {seed}"),
            }
        }
    }
}

#[test]
fn points_of_a_square_grid_are_no_harder() {
    // Cuts through corners of a cell, along its sides and its diagonals are exact for such points, and leave cells without
    // any area.
    let fixed: [&[[f64; 2]]; 2] = [
        &[[0.0, 2.0], [2.0, 0.0], [1.0, 1.0], [2.0, 2.0]],
        &[[5.0, 0.0], [3.0, 4.0], [0.0, 5.0], [1.0, 4.0], [4.0, 4.0], [4.0, 2.0], [5.0, 1.0], [1.0, 5.0]],
    ];
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let mut next = |end: f64| libm::floor(end * uniform(&mut random));
    let mut compared = 0;
    for round in 0..400 {
        let points: Points = match fixed.get(round) {
            Some(points) => points.to_vec(),
            None => (0..3 + round % 7).map(|_| [next(5.0), next(5.0)]).collect(),
        };
        let (Ok(mcc), Ok(mic)) = (minimum_circumscribed(&points), maximum_inscribed(&points)) else { continue };
        let [zone, around, inside] = brute_force(&points);
        assert!((mcc.circle.radius / around - 1.0).abs() < 1e-12, "MCC {points:?}");
        assert!((mic.circle.radius - inside).abs() < 1e-11, "MIC {points:?}: {} {inside}", mic.circle.radius);
        match minimum_zone(&points) {
            Ok(mzc) => assert!((mzc.circularity - zone).abs() < 1e-11, "MZC {points:?}: {} {zone}", mzc.circularity),
            Err(error) => assert_eq!(error, CircleError::Straight, "{points:?}"),
        }
        compared += 1;
    }
    assert!(compared > 300, "{compared}");
}

#[test]
fn no_centre_of_a_grid_is_better() {
    for kind in 0..SHAPES {
        let points = shape(kind, 60, 99);
        let (around, inside) = (minimum_circumscribed(&points).unwrap(), maximum_inscribed(&points).unwrap());
        let (zone, edges) = (minimum_zone(&points).ok(), edges(&points));
        let (origin, size) = (around.circle.center, around.circle.radius);
        for i in -40..=40 {
            for j in -40..=40 {
                for reach in [1.0, 1e-3, 3.0] {
                    let near = if reach < 1.0 { zone.map_or(origin, |zone| zone.circle.center) } else { origin };
                    let step = reach * size / 40.0;
                    let centre = [near[0] + step * f64::from(i), near[1] + step * f64::from(j)];
                    let (low, high) = extremes(&points, centre);
                    assert!(high >= around.circle.radius * (1.0 - 1e-14), "MCC {kind}");
                    let within = |(n, offset): &([f64; 2], f64)| n[0] * centre[0] + n[1] * centre[1] <= *offset;
                    assert!(low <= inside.circle.radius + 1e-14 || !edges.iter().all(within), "MIC {kind}");
                    if let Some(zone) = zone {
                        assert!(high - low >= zone.circularity - 1e-14 * zone.largest, "MZC {kind}");
                    }
                }
            }
        }
    }
}

#[test]
fn zone_is_never_wider_than_about_another_centre() {
    for kind in 0..SHAPES {
        for seed in 0..6 {
            let points = shape(kind, 30 + 20 * seed as usize, 7 + seed);
            let Ok(circles) = Circles::new(&points) else { continue };
            for other in [circles.lsc, circles.mic, circles.mcc] {
                assert!(circles.mzc.circularity <= other.circularity + 1e-15, "{kind} {seed}");
            }
            assert!(circles.mic.circle.radius >= circles.mzc.smallest - 1e-14 || kind > 1, "{kind} {seed}");
            let least = circles.mcc.circle.radius * (1.0 - 1e-15);
            assert!(least <= circles.lsc.largest && least <= circles.mzc.largest && least <= circles.mic.largest);
            let alone = [minimum_zone(&points), maximum_inscribed(&points), minimum_circumscribed(&points)];
            for (alone, together) in alone.into_iter().zip([circles.mzc, circles.mic, circles.mcc]) {
                assert!((alone.unwrap().circularity - together.circularity).abs() < 1e-12, "{kind} {seed}");
            }
        }
    }
}

/// The sum of squared residuals at a centre, computed plainly.
fn residuals(points: &[[f64; 2]], centre: [f64; 2]) -> f64 {
    let mean = points.iter().map(|p| distance(*p, centre)).sum::<f64>() / points.len() as f64;
    points.iter().map(|p| (distance(*p, centre) - mean) * (distance(*p, centre) - mean)).sum()
}

#[test]
fn least_squares_is_the_minimum_over_a_grid_and_its_neighbourhood() {
    for kind in 0..SHAPES {
        for seed in 0..6 {
            let points = shape(kind, 25 + 9 * seed as usize, 40 + seed);
            let Ok(fit) = least_squares(&points) else { continue };
            let (centre, radius) = (fit.circle.center, fit.circle.radius);
            let least = residuals(&points, centre);
            let rounding = 1e-13 * radius * radius * points.len() as f64 * 1e-3;
            for k in 0..16 {
                for length in [1e-6, 1e-4, 1e-2] {
                    let step = polar(PI * f64::from(k) / 8.0, length * radius);
                    let there = residuals(&points, [centre[0] + step[0], centre[1] + step[1]]);
                    assert!(there >= least - rounding, "{kind} {seed} {length}: {there} {least}");
                }
            }
            for i in -30..=30 {
                for j in -30..=30 {
                    let grid = [0.1 * f64::from(i), 0.1 * f64::from(j)];
                    assert!(residuals(&points, grid) >= least - rounding, "{kind} {seed} {grid:?} {centre:?}");
                }
            }
        }
    }
}

/// The last step counts: sums of squares see no difference between a centre and one that is 1e-10 off.
#[test]
fn least_squares_has_no_slope_left() {
    for seed in [273, 1, 2, 3] {
        let points: Points = shape(1, 40, seed);
        let (sine, cosine) = libm::sincos(1.580435795957136);
        let image = |p: &[f64; 2]| {
            [cosine * p[0] - sine * p[1] + 5.403499666945094, sine * p[0] + cosine * p[1]]
                .map(|c| 262.11568439944966 * c)
        };
        for points in [points.iter().map(image).collect(), points] {
            let fit = least_squares(&points).unwrap();
            let ([x, y], radius) = (fit.circle.center, fit.circle.radius);
            let slope = points.iter().fold([0.0; 2], |[gx, gy], p| {
                let (dx, dy) = (p[0] - x, p[1] - y);
                let distance = libm::hypot(dx, dy);
                let share = (distance - radius) / distance;
                [gx + share * dx, gy + share * dy]
            });
            assert!(libm::hypot(slope[0], slope[1]) < 40.0 * 1e-14 * radius, "{seed}: {slope:?}");
        }
    }
}

/// Points whose coordinates have so few digits that moving them by 2^13 rounds nothing.
fn coarse(points: &[[f64; 2]]) -> Points {
    let unit = 0.5_f64.powi(38);
    points.iter().map(|p| p.map(|c| (c / unit).round() * unit)).collect()
}

#[test]
fn a_place_far_from_the_origin_costs_no_digits() {
    for kind in 0..SHAPES {
        let points = coarse(&shape(kind, 72, 3));
        let moved: Points = points.iter().map(|p| [p[0] + 8192.0, p[1] - 16384.0]).collect();
        let (Ok(here), Ok(there)) = (Circles::new(&points), Circles::new(&moved)) else { continue };
        for (a, b) in [(here.lsc, there.lsc), (here.mzc, there.mzc), (here.mic, there.mic), (here.mcc, there.mcc)] {
            let rounding = 1e-14;
            assert!((a.circularity - b.circularity).abs() < 1e-9 * a.circularity + rounding, "{kind} {a:?} {b:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn turning_scaling_and_moving_change_only_the_centre(
        kind in 0..SHAPES, seed in 0..1000_u64, angle in 0.0..TAU, scale in 1e-3..1e3_f64, x in -10.0..10.0_f64, y in -10.0..10.0_f64,
    ) {
        let points = shape(kind, 40, seed);
        let (sine, cosine) = libm::sincos(angle);
        let image = |p: [f64; 2]| {
            [scale * (cosine * p[0] - sine * p[1] + x), scale * (sine * p[0] + cosine * p[1] + y)]
        };
        let moved: Points = points.iter().map(|p| image(*p)).collect();
        let (here, there) = (Circles::new(&points), Circles::new(&moved));
        prop_assert_eq!(here.err(), there.err());
        if let (Ok(here), Ok(there)) = (here, there) {
            // The image is rounded to 2e-15 of its place.
            let alike = |a: f64, b: f64| (a * scale - b).abs() < 3e-13 * scale;
            prop_assert!(alike(here.mzc.circularity, there.mzc.circularity));
            prop_assert!(alike(here.mic.circle.radius, there.mic.circle.radius));
            prop_assert!(alike(here.mcc.circle.radius, there.mcc.circle.radius));
            prop_assert!(distance(image(here.mcc.circle.center), there.mcc.circle.center) < 1e-7 * scale);
            // Scattered points have several minima, and which of them the starts lead to depends on how they lie.
            if ![2, 3, 12, 13].contains(&kind) {
                prop_assert!((here.lsc.circularity * scale - there.lsc.circularity).abs() < 1e-12 * scale * (1.0 + here.lsc.circle.radius));
            }
        }
    }

    #[test]
    fn three_points_and_points_on_a_circle_are_met_exactly(
        angles in prop::collection::vec(0.0..TAU, 3..40), radius in 1e-3..1e3_f64, x in -1e3..1e3_f64, y in -1e3..1e3_f64,
    ) {
        let points: Points = angles.iter().map(|t| polar(*t, radius)).map(|p| [p[0] + x, p[1] + y]).collect();
        let rounding = 1e-13 * (radius + x.abs() + y.abs());
        if let Ok(lsc) = least_squares(&points) {
            prop_assert!(lsc.circularity < rounding);
            prop_assert!(minimum_zone(&points).unwrap().circularity < rounding);
        }
    }
}

#[test]
fn zone_between_lines_is_told_as_such() {
    // Two parallel lines enclose a zigzag more closely than any two circles.
    let zigzag: Points = (0..10).map(|k| [f64::from(k), f64::from(k % 2)]).collect();
    assert_eq!(minimum_zone(&zigzag), Err(CircleError::Straight));
    assert_eq!(least_squares(&zigzag), Err(CircleError::Straight));
    assert!(maximum_inscribed(&zigzag).is_ok() && minimum_circumscribed(&zigzag).is_ok());
    // One point a little out of line bends the best zone, to a large but finite radius.
    let mut bent = zigzag.clone();
    bent[4][1] -= 1e-3;
    let fit = minimum_zone(&bent).unwrap();
    assert!(fit.circularity < 1.001 && fit.circle.radius > 1e3, "{fit:?}");
}

#[test]
fn what_is_no_circle_has_a_name() {
    type Method = fn(&[[f64; 2]]) -> Result<Fit, CircleError>;
    let fits: [Method; 4] = [least_squares, minimum_zone, maximum_inscribed, minimum_circumscribed];
    let line = [[1.0, 1.0], [2.1, 2.1], [3.3, 3.3], [0.7, 0.7]];
    let slanted: Points = (0..20).map(|k| [1e4 + 0.1 * f64::from(k), 2e4 + 0.3 * f64::from(k)]).collect();
    for fit in fits {
        assert_eq!(fit(&[]), Err(CircleError::TooFew { distinct: 0 }));
        assert_eq!(fit(&[[1.1, 2.0]]), Err(CircleError::TooFew { distinct: 1 }));
        assert_eq!(fit(&[[1.1, 2.0]; 7]), Err(CircleError::TooFew { distinct: 1 }));
        assert_eq!(fit(&[[1.0, 2.0], [3.0, 4.0], [1.0, 2.0]]), Err(CircleError::TooFew { distinct: 2 }));
        assert_eq!(fit(&line), Err(CircleError::Collinear));
        assert_eq!(fit(&slanted), Err(CircleError::Collinear));
        assert_eq!(fit(&[[0.0, 1.0], [f64::NAN, 0.0], [2.0, 3.0]]), Err(CircleError::NotFinite { point: 1 }));
        assert_eq!(fit(&[[0.0, 1.0], [1.0, 0.0], [f64::INFINITY, 3.0]]), Err(CircleError::NotFinite { point: 2 }));
    }
}

#[test]
fn published_ratio_of_least_squares_to_zone_is_in_reach() {
    let points = shape(0, 360, 5);
    let circles = Circles::new(&points).unwrap();
    let ratio = circles.lsc.circularity / circles.mzc.circularity;
    assert!(ratio > 1.0 && ratio < 1.15, "{ratio}");
}
