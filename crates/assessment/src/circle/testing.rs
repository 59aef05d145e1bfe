//! Shapes of every kind, and the best of all candidate centres by trying them all.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::f64::consts::TAU;

pub(super) type Points = Vec<[f64; 2]>;

/// Uniform in [0, 1).
pub(super) fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 * 0.5_f64.powi(53)
}

pub(super) fn polar(angle: f64, radius: f64) -> [f64; 2] {
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

/// Shapes of extent one or so.
pub(super) const SHAPES: usize = 14;

pub(super) fn shape(kind: usize, count: usize, seed: u64) -> Points {
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

pub(super) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

pub(super) fn extremes(points: &[[f64; 2]], centre: [f64; 2]) -> (f64, f64) {
    let distances = points.iter().map(|p| distance(*p, centre));
    distances.fold((f64::INFINITY, 0.0), |(low, high), d| (low.min(d), high.max(d)))
}

/// Where two lines `normal . x = offset` meet.
pub(super) fn meet(a: ([f64; 2], f64), b: ([f64; 2], f64)) -> Option<[f64; 2]> {
    let ((n, f), (m, g)) = (a, b);
    let determinant = n[0] * m[1] - n[1] * m[0];
    let place = [(f * m[1] - g * n[1]) / determinant, (g * n[0] - f * m[0]) / determinant];
    (place[0].is_finite() && place[1].is_finite()).then_some(place)
}

/// The bisectors of all pairs of points.
pub(super) fn bisectors(points: &[[f64; 2]]) -> Vec<([f64; 2], f64)> {
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
pub(super) fn edges(points: &[[f64; 2]]) -> Vec<([f64; 2], f64)> {
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

/// Smallest zone, smallest circumscribed and largest inscribed radius from all centres that can be any of them. The
/// zone may also be one between parallel lines.
pub(super) fn brute_force(points: &[[f64; 2]]) -> [f64; 3] {
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
pub(super) const ROUNDING: f64 = 1e-13;
