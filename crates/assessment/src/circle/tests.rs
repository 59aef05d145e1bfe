//! All four circles against brute force, over shapes of every kind.

use super::testing::*;
use super::*;
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::f64::consts::{PI, TAU};

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
    // Cuts through corners of a cell, along its sides and its diagonals are exact for such points, and leave cells
    // without any area.
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
        assert_eq!(fit(&[]), Err(CircleError::TooFew(0)));
        assert_eq!(fit(&[[1.1, 2.0]]), Err(CircleError::TooFew(1)));
        assert_eq!(fit(&[[1.1, 2.0]; 7]), Err(CircleError::TooFew(1)));
        assert_eq!(fit(&[[1.0, 2.0], [3.0, 4.0], [1.0, 2.0]]), Err(CircleError::TooFew(2)));
        assert_eq!(fit(&line), Err(CircleError::Collinear));
        assert_eq!(fit(&slanted), Err(CircleError::Collinear));
        assert_eq!(fit(&[[0.0, 1.0], [f64::NAN, 0.0], [2.0, 3.0]]), Err(CircleError::NotFinite(1)));
        assert_eq!(fit(&[[0.0, 1.0], [1.0, 0.0], [f64::INFINITY, 3.0]]), Err(CircleError::NotFinite(2)));
    }
}

#[test]
fn published_ratio_of_least_squares_to_zone_is_in_reach() {
    let points = shape(0, 360, 5);
    let circles = Circles::new(&points).unwrap();
    let ratio = circles.lsc.circularity / circles.mzc.circularity;
    assert!(ratio > 1.0 && ratio < 1.15, "{ratio}");
}
