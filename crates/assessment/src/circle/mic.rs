//! The largest circle without a point in it, its centre in the convex hull.

use super::chart::{Centre, Chart, Point, nearest};
use super::hull::Hull;
use super::search::CentreSearch;

/// The centre of the maximum inscribed circle of points in their local frame; starts are guesses at it.
pub(super) fn maximum_inscribed(points: &[Point], hull: &Hull, starts: &[Point]) -> Point {
    let is_inside = |start: &&Point| {
        let (corner, along) = hull.facing(**start);
        along[0] * (start[1] - corner[1]) - along[1] * (start[0] - corner[0]) >= 0.0
    };
    let objective = |start: &Point| -nearest::<Centre>(&Centre::at(*start), points).1;
    // Any corner of the hull is a centre too, of a circle without size.
    let mut best = (hull.vertices[0], 0.0);
    for start in starts.iter().filter(is_inside) {
        if objective(start) < best.1 {
            best = (*start, objective(start));
        }
    }
    let (mut from, mut to) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for corner in &hull.vertices {
        from = [from[0].min(corner[0]), from[1].min(corner[1])];
        to = [to[0].max(corner[0]), to[1].max(corner[1])];
    }
    let search = CentreSearch { outer: &[], inner: points, fence: Some(hull) };
    search.best::<Centre>(from, to, best.1).map_or(best.0, |found| found.coordinates)
}
