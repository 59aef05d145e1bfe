//! The smallest circle around all points.

use super::chart::{Centre, Chart, Point, farthest};

/// The centre of the minimum circumscribed circle of points in their local frame.
///
/// Pivoting as Gaertner does for Welzl's algorithm (Fast and robust smallest enclosing balls, 1999): the point farthest
/// outside joins those that hold the circle, and the smallest circle around these four at most is found by trying all
/// pairs and triples. The radius grows each time, so that this ends; it takes a handful of passes over the points.
pub(super) fn minimum_circumscribed(points: &[Point]) -> Point {
    let mut support = vec![farthest::<Centre>(&[0.0, 0.0], points).0];
    let (mut centre, mut radius) = (support[0], 0.0);
    loop {
        let (outside, distance) = farthest::<Centre>(&centre, points);
        if distance <= radius || support.contains(&outside) {
            return centre;
        }
        support.push(outside);
        let found = smallest_around(&support);
        if found.radius <= radius {
            return centre;
        }
        (centre, radius, support) = (found.centre, found.radius, found.support);
    }
}

/// A circle and the points that hold it.
struct Held {
    centre: Point,
    radius: f64,
    support: Vec<Point>,
}

/// The smallest circle around two to four points.
fn smallest_around(points: &[Point]) -> Held {
    let mut best = Held { centre: points[0], radius: f64::INFINITY, support: Vec::new() };
    let mut offer = |centre: Point, support: &[Point]| {
        let (_, radius) = farthest::<Centre>(&Centre::at(centre), points);
        if radius < best.radius {
            best = Held { centre, radius, support: support.to_vec() };
        }
    };
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points.iter().enumerate().skip(i + 1) {
            offer([0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], &[*a, *b]);
            for c in &points[j + 1..] {
                if let Some(centre) = equidistant(*a, *b, *c) {
                    offer(centre, &[*a, *b, *c]);
                }
            }
        }
    }
    best
}

/// The centre of the circle through three points, unless they are on one line.
pub(super) fn equidistant(a: Point, b: Point, c: Point) -> Option<Point> {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let double = 2.0 * (u[0] * v[1] - u[1] * v[0]);
    let (uu, vv) = (u[0] * u[0] + u[1] * u[1], v[0] * v[0] + v[1] * v[1]);
    let centre = [a[0] + (v[1] * uu - u[1] * vv) / double, a[1] + (u[0] * vv - v[0] * uu) / double];
    (centre[0].is_finite() && centre[1].is_finite()).then_some(centre)
}
