//! Two charts of all circle centres, those at infinity included: near ones by their place, far ones by direction and
//! curvature. In each chart every point has a *reach*, its distance from the centre up to a constant, of which the
//! search needs gradient and bounds.

/// A place in the plane, or a pair of chart coordinates.
pub(super) type Point = [f64; 2];

/// A chart of centres. Points lie within the unit disc about the origin.
pub(super) trait Chart {
    /// What is computed once per centre.
    type At;
    /// Largest length of a gradient of the reach.
    const STEEPEST: f64;

    /// The centre with the given coordinates.
    fn at(coordinates: Point) -> Self::At;
    /// A number that grows with the reach and costs less.
    fn key(at: &Self::At, point: &Point) -> f64;
    /// The reach that belongs to a key.
    fn reach(key: f64) -> f64;
    /// The reach of a point, its gradient, and its second derivatives: twice by the first coordinate, by both, twice by
    /// the second.
    fn derivatives(at: &Self::At, point: &Point) -> (f64, Point, [f64; 3]);
    /// A bound, from a centre where the reach is as given to anywhere: reach there >= reach + gradient . x - bend |x|^2
    /// / 2.
    fn bend_below(reach: f64) -> f64;
    /// Likewise, reach there <= reach + gradient . x + bend |x|^2 / 2.
    fn bend_above(reach: f64) -> f64;
}

/// Centres by their place; the reach is the distance.
pub(super) struct Centre;

impl Chart for Centre {
    type At = Point;
    const STEEPEST: f64 = 1.0;

    fn at(coordinates: Point) -> Point {
        coordinates
    }

    #[inline(always)]
    fn key(c: &Point, p: &Point) -> f64 {
        let (x, y) = (p[0] - c[0], p[1] - c[1]);
        x * x + y * y
    }

    fn reach(key: f64) -> f64 {
        key.sqrt()
    }

    #[inline(always)]
    fn derivatives(c: &Point, p: &Point) -> (f64, Point, [f64; 3]) {
        let (x, y) = (c[0] - p[0], c[1] - p[1]);
        let length = (x * x + y * y).sqrt();
        // At the point itself there is no gradient; zero is between all that there are around it.
        let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
        let (x, y) = (x * inverse, y * inverse);
        (length, [x, y], [y * y * inverse, -x * y * inverse, x * x * inverse])
    }

    /// A distance is a convex function.
    fn bend_below(_: f64) -> f64 {
        0.0
    }

    /// sqrt(b^2 + s) <= b + s / (2 b).
    fn bend_above(reach: f64) -> f64 {
        1.0 / reach
    }
}

/// Far centres `n / curvature` with `n = (cos, sin)` of an angle. Coordinates are angle and curvature, the latter
/// within [`Far::MAX`] on either side of zero. The reach is distance less `1 / curvature`, without the cancellation:
/// `(k |p|^2 - 2 p.n) / (|k p - n| + 1)`. It runs smoothly through curvature zero, where it is the distance from a
/// line; behind, centre and sign have changed sides.
pub(super) struct Far;

/// A far centre.
pub(super) struct FarAt {
    normal: Point,
    curvature: f64,
}

impl Far {
    /// Largest curvature on this chart.
    pub const MAX: f64 = 1.0 / 3.0;
    /// Bound of the second derivatives of the reach in any direction, see the test.
    const BEND: f64 = 1.6;
}

impl Chart for Far {
    type At = FarAt;
    const STEEPEST: f64 = 1.15;

    fn at(coordinates: Point) -> FarAt {
        let [angle, curvature] = coordinates;
        let (sine, cosine) = libm::sincos(angle);
        FarAt { normal: [cosine, sine], curvature }
    }

    #[inline(always)]
    fn key(at: &FarAt, p: &Point) -> f64 {
        let (n, k) = (at.normal, at.curvature);
        let (x, y) = (k * p[0] - n[0], k * p[1] - n[1]);
        let along = p[0] * n[0] + p[1] * n[1];
        (k * (p[0] * p[0] + p[1] * p[1]) - 2.0 * along) / ((x * x + y * y).sqrt() + 1.0)
    }

    fn reach(key: f64) -> f64 {
        key
    }

    #[inline(always)]
    fn derivatives(at: &FarAt, p: &Point) -> (f64, Point, [f64; 3]) {
        let (n, k) = (at.normal, at.curvature);
        let (a, b) = (p[0] * n[0] + p[1] * n[1], p[1] * n[0] - p[0] * n[1]);
        let m = ((1.0 - k * a) * (1.0 - k * a) + k * k * b * b).sqrt();
        let by_curvature = (k * (a * a + b * b) - a) / m;
        let sum = m + 1.0 - k * a;
        let gradient = [-b / m, b * b / (m * sum)];
        let twice_angle = a / m - k * b * b / (m * m * m);
        let both = b * by_curvature / (m * m);
        let twice_curvature = -b * b * (by_curvature / (m * m * sum) + (by_curvature - a) / (m * sum * sum));
        (Self::key(at, p), gradient, [twice_angle, both, twice_curvature])
    }

    fn bend_below(_: f64) -> f64 {
        Self::BEND
    }

    fn bend_above(_: f64) -> f64 {
        Self::BEND
    }
}

/// A centre on one of the two charts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Middle {
    /// Coordinates of [`Centre`].
    Near(Point),
    /// Coordinates of [`Far`].
    Far(Point),
}

impl Middle {
    /// The centre `x / w, y / w`, at infinity for a weight of zero.
    pub fn from_homogeneous(place: Point, weight: f64) -> Self {
        let [x, y] = place;
        let length = libm::hypot(x, y);
        if length <= weight.abs() / Far::MAX {
            return if length > 0.0 { Self::Near([x / weight, y / weight]) } else { Self::Near([0.0, 0.0]) };
        }
        Self::Far([libm::atan2(y, x), weight / length])
    }

    /// The same centre on the chart that suits it; both are good for centres near their common border.
    pub fn recharted(self) -> Self {
        match self {
            Self::Near([x, y]) if libm::hypot(x, y) > 1.2 / Far::MAX => Self::from_homogeneous([x, y], 1.0),
            Self::Far([angle, curvature]) if curvature.abs() > 1.2 * Far::MAX => {
                let (sine, cosine) = libm::sincos(angle);
                Self::Near([cosine / curvature, sine / curvature])
            }
            good => good,
        }
    }

    /// Another centre on the same chart.
    pub fn moved(self, by: Point) -> Self {
        let [dx, dy] = by;
        match self {
            Self::Near([x, y]) => Self::Near([x + dx, y + dy]),
            Self::Far([x, y]) => Self::Far([x + dx, (y + dy).clamp(-2.0 * Far::MAX, 2.0 * Far::MAX)]),
        }
    }

    /// Where it is, if not at infinity.
    pub fn place(self) -> Point {
        match self {
            Self::Near(place) => place,
            Self::Far([angle, curvature]) => {
                let (sine, cosine) = libm::sincos(angle);
                [cosine / curvature, sine / curvature]
            }
        }
    }

    /// What has to be added to a reach to have a distance, and the sign of the reach in it.
    pub fn distance_from_reach(self) -> (f64, f64) {
        match self {
            Self::Near(_) => (0.0, 1.0),
            Self::Far([_, curvature]) => (1.0 / curvature.abs(), if curvature < 0.0 { -1.0 } else { 1.0 }),
        }
    }
}

/// Points looked at together by [`farthest`] and [`nearest`].
const BLOCK: usize = 64;
/// Running extremes side by side, which the compiler puts into vector registers.
const LANES: usize = 8;

/// The point of the largest reach, the first of several, and its reach. Points must not be empty.
pub(super) fn farthest<C: Chart>(at: &C::At, points: &[Point]) -> (Point, f64) {
    extreme::<C, 1>(at, points)
}

/// The point of the smallest reach, the first of several, and its reach. Points must not be empty.
pub(super) fn nearest<C: Chart>(at: &C::At, points: &[Point]) -> (Point, f64) {
    extreme::<C, -1>(at, points)
}

fn extreme<C: Chart, const SIGN: i8>(at: &C::At, points: &[Point]) -> (Point, f64) {
    let key = |p: &Point| f64::from(SIGN) * C::key(at, p);
    let mut best = (0, f64::NEG_INFINITY);
    for (index, block) in points.chunks(BLOCK).enumerate() {
        let mut lanes = [f64::NEG_INFINITY; LANES];
        let mut groups = block.chunks_exact(LANES);
        for group in &mut groups {
            for (lane, p) in lanes.iter_mut().zip(group) {
                let value = key(p);
                *lane = if value > *lane { value } else { *lane };
            }
        }
        let rest = groups.remainder().iter().map(key).fold(f64::NEG_INFINITY, f64::max);
        let max = lanes.into_iter().fold(rest, f64::max);
        if max > best.1 {
            best = (index, max);
        }
    }
    let block = &points[best.0 * BLOCK..points.len().min((best.0 + 1) * BLOCK)];
    let point = block.iter().find(|p| key(p) == best.1).unwrap_or(&block[0]);
    (*point, C::reach(f64::from(SIGN) * best.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn far_reach(y: Point, p: &Point) -> f64 {
        Far::key(&Far::at(y), p)
    }

    proptest! {
        #[test]
        fn far_reach_is_the_distance_less_that_of_the_origin(
            angle in 0.0..6.3_f64, curvature in 0.01..Far::MAX, direction in 0.0..6.3_f64, length in 0.0..1.0_f64,
        ) {
            let p = [length * libm::cos(direction), length * libm::sin(direction)];
            let c = Middle::Far([angle, curvature]).place();
            let expected = libm::hypot(p[0] - c[0], p[1] - c[1]) - 1.0 / curvature;
            prop_assert!((far_reach([angle, curvature], &p) - expected).abs() < 1e-13);
            let other_side = far_reach([angle + std::f64::consts::PI, -curvature], &p);
            prop_assert!((other_side + expected).abs() < 1e-13);
        }

        #[test]
        fn far_derivatives_are_those_of_the_reach(
            angle in 0.0..6.3_f64, curvature in -Far::MAX..Far::MAX, direction in 0.0..6.3_f64, length in 0.0..1.0_f64,
        ) {
            let p = [length * libm::cos(direction), length * libm::sin(direction)];
            let (_, gradient, [aa, ak, kk]) = Far::derivatives(&Far::at([angle, curvature]), &p);
            let h = 1e-6;
            let at = |x: f64, y: f64| Far::derivatives(&Far::at([angle + x, curvature + y]), &p).1;
            let reach = |x: f64, y: f64| far_reach([angle + x, curvature + y], &p);
            prop_assert!((gradient[0] - (reach(h, 0.0) - reach(-h, 0.0)) / (2.0 * h)).abs() < 1e-9);
            prop_assert!((gradient[1] - (reach(0.0, h) - reach(0.0, -h)) / (2.0 * h)).abs() < 1e-9);
            prop_assert!((aa - (at(h, 0.0)[0] - at(-h, 0.0)[0]) / (2.0 * h)).abs() < 1e-9);
            prop_assert!((ak - (at(0.0, h)[0] - at(0.0, -h)[0]) / (2.0 * h)).abs() < 1e-9);
            prop_assert!((kk - (at(0.0, h)[1] - at(0.0, -h)[1]) / (2.0 * h)).abs() < 1e-9);
        }
    }

    #[test]
    fn bounds_of_the_far_chart_hold_everywhere_and_are_not_far_off() {
        let (mut steepest, mut bend) = (0.0_f64, 0.0_f64);
        for step in 0..=200 {
            for turn in 0..360 {
                for curvature in [-1.0, -0.8, -0.5, -0.2, 0.0, 0.1, 0.3, 0.6, 0.9, 1.0] {
                    let (sine, cosine) = libm::sincos(f64::from(turn).to_radians());
                    let length = f64::from(step) / 200.0;
                    let (_, [g, h], [aa, ak, kk]) =
                        Far::derivatives(&Far::at([0.0, curvature * Far::MAX]), &[length * cosine, length * sine]);
                    steepest = steepest.max(libm::hypot(g, h));
                    // The larger eigenvalue in absolute terms.
                    bend = bend.max((aa + kk).abs() / 2.0 + libm::hypot((aa - kk) / 2.0, ak));
                }
            }
        }
        assert!(steepest < Far::STEEPEST && steepest > 0.95 * Far::STEEPEST, "{steepest}");
        assert!(bend < Far::BEND && bend > 0.95 * Far::BEND, "{bend}");
    }

    #[test]
    fn extremes_are_the_first_of_their_kind_wherever_they_stand() {
        for count in [1, 7, 8, 63, 64, 65, 200] {
            for place in 0..count {
                let mut points = vec![[1.0, 0.0]; count];
                points[place] = [0.0, 3.0];
                points[count - 1 - place] = [0.25, 0.0];
                let found = farthest::<Centre>(&[0.0, 0.0], &points);
                let distances = points.iter().map(|p| libm::hypot(p[0], p[1]));
                assert_eq!(found.1, distances.clone().fold(0.0, f64::max));
                assert_eq!(nearest::<Centre>(&[0.0, 0.0], &points).1, distances.fold(9.0, f64::min));
            }
        }
    }
}
