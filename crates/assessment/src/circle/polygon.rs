//! Convex polygons as cells of a search: cut by lines, split in two.

use super::chart::Point;

/// A convex polygon, its corners in order; without corners it is empty.
#[derive(Clone)]
pub(super) struct Polygon {
    corners: Vec<Point>,
}

impl Polygon {
    /// The rectangle between two corners.
    pub fn rectangle(from: Point, to: Point) -> Self {
        Self { corners: vec![from, [to[0], from[1]], to, [from[0], to[1]]] }
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Keeps the part where `normal . (x - from) <= offset`.
    pub fn cut(&mut self, from: Point, normal: Point, offset: f64) {
        let excess = |c: &Point| normal[0] * (c[0] - from[0]) + normal[1] * (c[1] - from[1]) - offset;
        if self.corners.iter().all(|c| excess(c) <= 0.0) {
            return;
        }
        let mut kept = Vec::with_capacity(self.corners.len() + 1);
        let mut last = self.corners.last().map(|corner| (*corner, excess(corner)));
        for b in &self.corners {
            let eb = excess(b);
            if let Some((a, ea)) = last
                && ((ea < 0.0 && eb > 0.0) || (ea > 0.0 && eb < 0.0))
            {
                let part = ea / (ea - eb);
                kept.push([a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]);
            }
            if eb <= 0.0 {
                kept.push(*b);
            }
            last = Some((*b, eb));
        }
        self.corners = kept;
    }

    /// Area and centroid; of a polygon too thin for that, zero and the mean of the corners. It must not be empty.
    pub fn area_and_centroid(&self) -> (f64, Point) {
        let root = self.corners[0];
        let (mut area, mut moment, mut sum) = (0.0, [0.0; 2], [0.0; 2]);
        let seen = |c: &Point| [c[0] - root[0], c[1] - root[1]];
        for (c, d) in self.corners.iter().zip(self.corners.iter().cycle().skip(1)) {
            let (a, b) = (seen(c), seen(d));
            let double = a[0] * b[1] - a[1] * b[0];
            area += double;
            moment = [moment[0] + double * (a[0] + b[0]), moment[1] + double * (a[1] + b[1])];
            sum = [sum[0] + a[0], sum[1] + a[1]];
        }
        let count = self.corners.len() as f64;
        let mut centroid = [sum[0] / count, sum[1] / count];
        // Rounding may put the centroid of a sliver outside; its mean is inside.
        let spread = self.corners.iter().map(seen).fold(0.0_f64, |max, a| max.max(a[0] * a[0] + a[1] * a[1]));
        if area > 1e-6 * spread {
            centroid = [moment[0] / (3.0 * area), moment[1] / (3.0 * area)];
        }
        (0.5 * area.max(0.0), [root[0] + centroid[0], root[1] + centroid[1]])
    }

    /// The corner farthest from a place, and how far it is. The polygon must not be empty.
    pub fn farthest(&self, place: Point) -> (Point, f64) {
        let squared = |c: &Point| (c[0] - place[0]) * (c[0] - place[0]) + (c[1] - place[1]) * (c[1] - place[1]);
        let corner = self.corners.iter().fold(self.corners[0], |a, b| if squared(b) > squared(&a) { *b } else { a });
        (corner, squared(&corner).sqrt())
    }

    /// Cuts across the longest direction, through a place inside.
    pub fn split(self, place: Point) -> [Self; 2] {
        let (corner, _) = self.farthest(place);
        let along = [corner[0] - place[0], corner[1] - place[1]];
        let mut halves = [self.clone(), self];
        halves[0].cut(place, along, 0.0);
        halves[1].cut(place, [-along[0], -along[1]], 0.0);
        halves
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_triangle_cut_from_a_square() {
        let mut polygon = Polygon::rectangle([0.0, 0.0], [2.0, 2.0]);
        assert_eq!(polygon.area_and_centroid(), (4.0, [1.0, 1.0]));
        polygon.cut([0.0, 0.0], [1.0, 1.0], 2.0);
        let (area, centroid) = polygon.area_and_centroid();
        assert_eq!(area, 2.0);
        assert!((centroid[0] - 2.0 / 3.0).abs() < 1e-15 && (centroid[1] - 2.0 / 3.0).abs() < 1e-15);
        polygon.cut([0.0, 0.0], [1.0, 1.0], -1e-9);
        assert!(polygon.is_empty());
    }

    proptest! {
        #[test]
        fn halves_add_up(cuts in prop::collection::vec((0.0..6.3_f64, 0.05..1.0_f64), 0..12)) {
            let mut polygon = Polygon::rectangle([-1.0, -1.0], [1.0, 1.0]);
            for (angle, offset) in cuts {
                polygon.cut([0.0, 0.0], [libm::cos(angle), libm::sin(angle)], offset);
            }
            let (area, centroid) = polygon.area_and_centroid();
            prop_assert!(area > 0.0);
            let halves = polygon.split(centroid).map(|half| half.area_and_centroid());
            prop_assert!((halves[0].0 + halves[1].0 - area).abs() < 1e-12);
            for axis in 0..2 {
                let moment = halves[0].0 * halves[0].1[axis] + halves[1].0 * halves[1].1[axis];
                prop_assert!((moment - area * centroid[axis]).abs() < 1e-12);
            }
        }
    }
}
