//! The convex hull of points (Andrew's monotone chain), and where a place lies relative to it.

use super::chart::Point;
use rayon::slice::ParallelSliceMut;

/// A convex polygon.
pub(super) struct Hull {
    /// Its corners, counter-clockwise.
    pub vertices: Vec<Point>,
}

/// Twice the area of the triangle, positive when it turns left.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl Hull {
    /// The hull of points that are not all on one line.
    pub fn new(points: &[Point]) -> Self {
        let mut sorted = points.to_vec();
        sorted.par_sort_unstable_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
        let mut vertices = chain(sorted.iter());
        let upper = chain(sorted.iter().rev());
        vertices.pop();
        vertices.extend_from_slice(&upper[..upper.len() - 1]);
        Self { vertices }
    }

    /// The distance of the two parallel lines that enclose the hull most closely (rotating calipers).
    pub fn width(&self) -> f64 {
        let corners = &self.vertices;
        let count = corners.len();
        let mut opposite = 1;
        let mut width = f64::INFINITY;
        for k in 0..count {
            let (a, b) = (corners[k], corners[(k + 1) % count]);
            while turn(a, b, corners[(opposite + 1) % count]) > turn(a, b, corners[opposite]) {
                opposite = (opposite + 1) % count;
            }
            width = width.min(turn(a, b, corners[opposite]) / libm::hypot(b[0] - a[0], b[1] - a[1]));
        }
        width
    }

    /// The edge that faces a place, as a corner and the direction to the next; seen from the first corner, the place
    /// lies in the angle over that edge or behind it.
    pub fn facing(&self, place: Point) -> (Point, Point) {
        let corners = &self.vertices;
        let root = corners[0];
        let last = corners.len() - 1;
        let from = if turn(root, corners[1], place) < 0.0 {
            0
        } else if turn(root, corners[last], place) > 0.0 {
            last
        } else {
            // Corners 1, 2, ... turn left about corner 0, and the place is between the first and the last.
            corners[1..].partition_point(|corner| turn(root, *corner, place) >= 0.0).min(last - 1)
        };
        let to = (from + 1) % corners.len();
        (corners[from], [corners[to][0] - corners[from][0], corners[to][1] - corners[from][1]])
    }
}

/// The chain of left turns from the first to the last of sorted points.
fn chain<'a>(sorted: impl Iterator<Item = &'a Point>) -> Vec<Point> {
    let mut chain: Vec<Point> = Vec::new();
    for p in sorted {
        while let [.., a, b] = chain[..]
            && turn(a, b, *p) <= 0.0
        {
            chain.pop();
        }
        chain.push(*p);
    }
    chain
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn all_points_are_inside_and_every_corner_is_a_point(
            points in prop::collection::vec(prop::array::uniform2(-1.0..1.0_f64), 3..60)
        ) {
            let hull = Hull::new(&points);
            let count = hull.vertices.len();
            for k in 0..count {
                prop_assert!(points.contains(&hull.vertices[k]));
                let (a, b) = (hull.vertices[k], hull.vertices[(k + 1) % count]);
                prop_assert!(points.iter().all(|p| turn(a, b, *p) >= -1e-15));
                let middle = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                // From a little outside the middle of an edge it is that edge, or one that is in the way as well.
                let outward = [middle[0] + 1e-6 * (b[1] - a[1]), middle[1] - 1e-6 * (b[0] - a[0])];
                let (corner, along) = hull.facing(outward);
                prop_assert!(turn(corner, [corner[0] + along[0], corner[1] + along[1]], outward) < 0.0);
            }
            for p in &points {
                let (corner, along) = hull.facing(*p);
                prop_assert!(turn(corner, [corner[0] + along[0], corner[1] + along[1]], *p) >= -1e-15);
            }
        }
    }
}
