//! The pair of concentric circles around and inside all points that are closest to each other.

use super::CircleError;
use super::chart::{Centre, Chart, Far, Middle, Point, farthest, nearest};
use super::hull::Hull;
use super::search::CentreSearch;
use std::f64::consts::TAU;

/// Half the side of the square of near centres; farther ones are on the other chart.
const NEAR: f64 = 1.0 / Far::MAX;
/// How much closer two lines may seem than the best circles before that is more than rounding: of the width, and of the
/// unit.
const ROUNDING: [f64; 2] = [1e-12, 8.0 * f64::EPSILON];

/// The centre of the minimum zone circles of points in their local frame; starts are guesses at it, besides their
/// middle.
pub(super) fn minimum_zone(points: &[Point], hull: &Hull, starts: &[Point]) -> Result<Middle, CircleError> {
    let width = |start: &Point| {
        let at = Centre::at(*start);
        farthest::<Centre>(&at, &hull.vertices).1 - nearest::<Centre>(&at, points).1
    };
    let middle = [0.0, 0.0];
    let mut best = (Middle::Near(middle), width(&middle));
    for start in starts.iter().filter(|start| start[0].abs().max(start[1].abs()) <= NEAR) {
        if width(start) < best.1 {
            best = (Middle::Near(*start), width(start));
        }
    }
    let search = CentreSearch { outer: &hull.vertices, inner: points, fence: None };
    if let Some(found) = search.best::<Centre>([-NEAR, -NEAR], [NEAR, NEAR], best.1) {
        best = (Middle::Near(found.coordinates), found.objective);
    }
    if let Some(found) = search.best::<Far>([0.0, 0.0], [TAU, Far::MAX], best.1) {
        best = (Middle::Far(found.coordinates), found.objective);
    }
    let [relative, absolute] = ROUNDING;
    let is_straight = hull.width() <= best.1 * (1.0 + relative) + absolute && best.1 > absolute;
    if is_straight { Err(CircleError::Straight) } else { Ok(best.0) }
}
