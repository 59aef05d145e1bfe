//! The round corner of a bull nose: a disc about the axis, grown by the radius of the corner.
//!
//! From the nearest point of the disc, of radius a at the height r, to a point y with `h = y . s` and `w = y - h s`
//! leads `v = (h - r) s + w max(0, 1 - a / |w|)`. So `f = |v| - r` is how far y is outside, with the gradient v / |v|,
//! and convex, and so is the least of it over a move, `F(l) = min over m in [0, 1] of f(w + l d - m u)`. From beyond
//! either end Newton's method on F comes to the end without passing it.

use super::{Piece, TINY};
use nalgebra::Vector3;

/// Both ends are found to this. m
const ROUNDING: f64 = 1e-11;
/// Steps of Newton's method along a line, most of them where the line grazes.
const STEPS: usize = 60;
/// Steps along the move, of which a few are needed.
const STEPS_OF_MOVE: usize = 40;

/// A line `w + l d` that a corner moves over by u.
pub(super) struct Line<'l> {
    pub axis: &'l Vector3<f64>,
    pub w: &'l Vector3<f64>,
    pub d: &'l Vector3<f64>,
    pub u: &'l Vector3<f64>,
}

/// A disc of a radius about the axis at the height of the corner (m), grown by it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub disc: f64,
    pub radius: f64,
}

impl Corner {
    /// From the nearest point of the disc to a point. m
    pub fn from_disc(&self, y: &Vector3<f64>, axis: &Vector3<f64>) -> Vector3<f64> {
        self.with_slope(y, axis, &Vector3::zeros()).0
    }

    /// The same, and how it grows along a direction: `u . dv/dy u`.
    fn with_slope(&self, y: &Vector3<f64>, axis: &Vector3<f64>, u: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let (h, rise) = (y.dot(axis), u.dot(axis));
        let across = y - axis * h;
        let square = across.norm_squared();
        let up = axis * (h - self.radius);
        if square <= self.disc * self.disc {
            return (up, rise * rise);
        }
        let rho = square.sqrt();
        let (part, out) = (1.0 - self.disc / rho, u.dot(&across) / rho);
        let around = (u.norm_squared() - rise * rise - out * out).max(0.0);
        (up + across * part, rise * rise + out * out + part * around)
    }

    /// The interval of a line that is inside at any time of the move.
    pub fn interval(&self, line: &Line<'_>) -> Option<[f64; 2]> {
        let Line { axis, w, d, u } = *line;
        let (hd, hu) = (d.dot(axis), u.dot(axis));
        if hu.abs() <= TINY && hd.abs() <= 1e-9 {
            return self.level(line);
        }
        if hu.abs() <= TINY && hd * hd >= d.norm_squared() * (1.0 - 1e-15) {
            return self.upright(line, hd);
        }
        // From where the line comes into the ball about all of it.
        let square = d.norm_squared();
        let reach = self.disc + self.radius;
        let to_centre = axis * self.radius - w;
        let [centre, shift] = [to_centre.dot(d), u.dot(d)].map(|along| along / square);
        let (beside, by) = (to_centre - d * centre, u - d * shift);
        let m = (-beside.dot(&by) / by.norm_squared().max(TINY * TINY)).clamp(0.0, 1.0);
        let half = reach * reach - (beside + by * m).norm_squared();
        if half <= 0.0 {
            return None;
        }
        let half = (half / square).sqrt();
        let (from, to) = (centre + shift.min(0.0) - half, centre + shift.max(0.0) + half);
        let low = self.end(line, from, to)?;
        let high = self.end(line, to, low)?;
        (high > low).then_some([low, high])
    }

    /// The end of the interval that is met from outside, on the way to a limit.
    fn end(&self, line: &Line<'_>, from: f64, limit: f64) -> Option<f64> {
        let (mut l, mut m) = (from, 0.5);
        for _ in 0..STEPS {
            let v = self.nearest(line, &(line.w + line.d * l), &mut m);
            let length = v.norm();
            let outside = length - self.radius;
            if outside <= ROUNDING {
                return Some(l);
            }
            let step = -outside * length / v.dot(line.d);
            let is_ahead = step.is_finite() && (step > 0.0) == (limit > from);
            if !is_ahead || (l + step - limit) * (limit - from) > 0.0 {
                return None;
            }
            l += step;
        }
        Some(l)
    }

    /// The shortest way from the disc to a point within the move, and when, from where a search begins.
    fn nearest(&self, line: &Line<'_>, y: &Vector3<f64>, m: &mut f64) -> Vector3<f64> {
        let Line { axis, u, .. } = *line;
        let at = |m: f64| {
            let (v, curve) = self.with_slope(&(y - u * m), axis, u);
            (v, -v.dot(u), curve)
        };
        let (first, begins, _) = at(0.0);
        if begins >= 0.0 {
            *m = 0.0;
            return first;
        }
        let (last, ends, _) = at(1.0);
        if ends <= 0.0 {
            *m = 1.0;
            return last;
        }
        if *m <= 0.0 || *m >= 1.0 {
            *m = begins / (begins - ends);
        }
        let [mut low, mut high] = [0.0, 1.0];
        let size = u.norm();
        for _ in 0..STEPS_OF_MOVE {
            let (v, slope, curve) = at(*m);
            *(if slope > 0.0 { &mut high } else { &mut low }) = *m;
            let next = *m - slope / curve.max(f64::MIN_POSITIVE);
            let next = if next > low && next < high { next } else { (low + high) / 2.0 };
            if (next - *m).abs() * size < ROUNDING {
                return v;
            }
            *m = next;
        }
        at(*m).0
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
        let cylinder = Piece::cylinder(radius);
        cylinder.sweep(line.axis, line.w, line.d, line.u, &mut ends);
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
