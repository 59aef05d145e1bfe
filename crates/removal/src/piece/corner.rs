//! The round corner of a bull nose: a disc about the axis, grown by the radius of the corner.
//!
//! From the nearest point of the disc, of radius a at the height r, to a point y with `h = y . s` and `w = y - h s`
//! leads `v = (h - r) s + w max(0, 1 - a / |w|)`. So `f = |v| - r` is how far y is outside, with the gradient v / |v|,
//! and convex, and so is the least of it over a move, `F(l) = min over m in [0, 1] of f(w + l d - m u)`. From beyond
//! either end Newton's method on F comes to the end without passing it.

use super::{Line, Piece, TINY};
use nalgebra::Vector3;

/// Both ends are found to this. m
const ROUNDING: f64 = 1e-11;
/// Steps of Newton's method along a line, most of them where the line grazes.
const STEPS: usize = 60;
/// Steps along the move, of which a few are needed.
const STEPS_OF_MOVE: usize = 40;

/// A disc of a radius about the axis at the height of the corner (m), grown by it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub disc: f64,
    pub radius: f64,
}

/// Products of a line and its move, from the point of the line that is nearest to the middle of the corner: with them a
/// point is `y = w + l d - m u` by a few numbers.
struct Products {
    /// Of w with axis, w, d and u.
    w: [f64; 4],
    /// Of d with axis, d and u.
    d: [f64; 3],
    /// Of u with axis and u.
    u: [f64; 2],
    /// Length of u. m
    size: f64,
}

/// The way v from the disc to a point: its length, its parts along d and u, and how that along u grows with -m.
struct Way {
    length: f64,
    along: f64,
    with_move: f64,
    curve: f64,
}

impl Products {
    fn new(axis: &Vector3<f64>, w: &Vector3<f64>, d: &Vector3<f64>, u: &Vector3<f64>) -> Self {
        Self {
            w: [w.dot(axis), w.norm_squared(), w.dot(d), w.dot(u)],
            d: [d.dot(axis), d.norm_squared(), d.dot(u)],
            u: [u.dot(axis), u.norm_squared()],
            size: u.norm(),
        }
    }

    fn way(&self, corner: &Corner, l: f64, m: f64) -> Way {
        let ([h, ww, wd, wu], [hd, dd, du], [hu, uu]) = (self.w, self.d, self.u);
        let height = h + l * hd - m * hu;
        let (by_d, by_u) = (wd + l * dd - m * du, wu + l * du - m * uu);
        let square = ww + l * (wd + by_d) - m * (wu + by_u) - height * height;
        let up = height - corner.radius;
        if square <= corner.disc * corner.disc {
            return Way { length: up.abs(), along: up * hd, with_move: up * hu, curve: hu * hu };
        }
        let rho = square.sqrt();
        let part = 1.0 - corner.disc / rho;
        let (out_d, out_u) = (by_d - height * hd, by_u - height * hu);
        let across = out_u * out_u / square;
        Way {
            length: (up * up + (rho - corner.disc) * (rho - corner.disc)).sqrt(),
            along: up * hd + part * out_d,
            with_move: up * hu + part * out_u,
            curve: hu * hu + across + part * (uu - hu * hu - across).max(0.0),
        }
    }

    /// The shortest way from the disc to a point of the line within the move, from the time at which a search begins.
    fn nearest(&self, corner: &Corner, l: f64, m: &mut f64) -> Way {
        let (mut low, mut high) = (-f64::EPSILON, 1.0 + f64::EPSILON);
        let mut way = self.way(corner, l, *m);
        for _ in 0..STEPS_OF_MOVE {
            let slope = -way.with_move;
            if slope == 0.0 || (slope > 0.0 && *m <= 0.0) || (slope < 0.0 && *m >= 1.0) {
                break;
            }
            *(if slope > 0.0 { &mut high } else { &mut low }) = *m;
            let next = (*m - slope / way.curve.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let next = if next > low && next < high { next } else { (low + high) / 2.0 };
            if (next - *m).abs() * self.size < ROUNDING {
                break;
            }
            *m = next;
            way = self.way(corner, l, *m);
        }
        way
    }

    /// The end of the interval that is met from outside, on the way to a limit.
    fn end(&self, corner: &Corner, from: f64, limit: f64) -> Option<f64> {
        let (mut l, mut m) = (from, if self.size > 0.0 { 0.5 } else { 0.0 });
        for _ in 0..STEPS {
            let way = self.nearest(corner, l, &mut m);
            let outside = way.length - corner.radius;
            if outside <= ROUNDING {
                return Some(l);
            }
            let step = -outside * way.length / way.along;
            let is_ahead = step.is_finite() && (step > 0.0) == (limit > from);
            if !is_ahead || (l + step - limit) * (limit - from) > 0.0 {
                return None;
            }
            l += step;
        }
        Some(l)
    }
}

impl Corner {
    /// From the nearest point of the disc to a point. m
    pub fn way_to(&self, y: &Vector3<f64>, axis: &Vector3<f64>) -> Vector3<f64> {
        let h = y.dot(axis);
        let across = y - axis * h;
        let rho = across.norm();
        let up = axis * (h - self.radius);
        if rho <= self.disc { up } else { up + across * (1.0 - self.disc / rho) }
    }

    /// The interval of a line that is inside at any time of the move; ends that are within a known one may be left
    /// where they are met at the latest.
    pub fn interval(&self, line: &Line<'_>, known: [f64; 2]) -> Option<[f64; 2]> {
        let Line { axis, d, u, .. } = *line;
        let (hd, hu) = (d.dot(axis), u.dot(axis));
        if hu.abs() <= TINY && hd.abs() <= 1e-9 {
            return self.level(line);
        }
        if hu.abs() <= TINY && hd * hd >= d.norm_squared() * (1.0 - 1e-15) {
            return self.upright(line, hd);
        }
        let (products, centre, [from, to]) = self.about(line)?;
        let ends = match [known[0] <= centre + from, known[1] >= centre + to] {
            [true, true] => None,
            [true, false] => products.end(self, to, from).map(|high| [high, high]),
            [false, true] => products.end(self, from, to).map(|low| [low, low]),
            [false, false] => {
                let low = products.end(self, from, to)?;
                let high = products.end(self, to, low)?;
                (high > low).then_some([low, high])
            }
        };
        ends.map(|ends| ends.map(|end| centre + end))
    }

    /// Where a line that does not move comes in, where that is no later than a place and it does not leave before 0.
    pub fn entry(&self, line: &Line<'_>, until: f64) -> Option<f64> {
        let (products, centre, [from, to]) = self.about(line)?;
        if centre + to < 0.0 || centre + from > until {
            return None;
        }
        let low = products.end(self, from, to)?;
        let is_left = || products.end(self, to, low).is_none_or(|high| centre + high < 0.0);
        (centre + low <= until && (centre + low >= 0.0 || !is_left())).then_some(centre + low)
    }

    /// The products of a line, counted from where it is nearest to the middle of the corner, that place, and from there
    /// where it comes into the ball about all of the corner and leaves it.
    fn about(&self, line: &Line<'_>) -> Option<(Products, f64, [f64; 2])> {
        let Line { axis, w, d, u } = *line;
        let square = d.norm_squared();
        let reach = self.disc + self.radius;
        let to_centre = axis * self.radius - w;
        let [centre, shift] = [to_centre.dot(d), u.dot(d)].map(|along| along / square);
        let (beside, by) = (to_centre - d * centre, u - d * shift);
        let m = (-beside.dot(&by) / by.norm_squared().max(TINY * TINY)).clamp(0.0, 1.0);
        let half = reach * reach - (beside + by * m).norm_squared();
        let half = (half.max(0.0) / square).sqrt();
        let products = Products::new(axis, &(w + d * centre), d, u);
        (half > 0.0).then_some((products, centre, [shift.min(0.0) - half, shift.max(0.0) + half]))
    }

    /// Of a line and a move normal to the axis: those of the circle at its height.
    fn level(&self, line: &Line<'_>) -> Option<[f64; 2]> {
        let up = line.w.dot(line.axis) - self.radius;
        let beside = self.radius * self.radius - up * up;
        if beside <= 0.0 {
            return None;
        }
        let radius = self.disc + beside.sqrt();
        let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
        Piece::cylinder(radius).sweep(line, &mut ends);
        (ends[1] > ends[0]).then_some(ends)
    }

    /// Of a line along the axis and a move normal to it.
    fn upright(&self, line: &Line<'_>, hd: f64) -> Option<[f64; 2]> {
        let h = line.w.dot(line.axis);
        let across = line.w - line.axis * h;
        let m = (across.dot(line.u) / line.u.norm_squared().max(TINY * TINY)).clamp(0.0, 1.0);
        let out = ((across - line.u * m).norm() - self.disc).max(0.0);
        let half = self.radius * self.radius - out * out;
        let [low, high] = [-1.0, 1.0].map(|side| (self.radius + side * half.max(0.0).sqrt() * hd.signum() - h) / hd);
        (half > 0.0 && high > low).then_some([low, high])
    }
}
