//! Convex pieces of a cutter: where lines meet them, and where lines meet them swept along a move.
//!
//! A point y from the tool centre point, at the height `h = y . a` along the tool axis a, is inside a piece where
//!
//! `Q(y) = y . y - alpha h^2 - 2 beta h - gamma <= 0` and `h0 <= h <= h1`:
//!
//! a ball of radius R about the height c has alpha 0, beta c, gamma `R^2 - c^2`; a cone of radius `s + k h` has alpha
//! `1 + k^2`, beta `k s`, gamma `s^2`, and a cylinder is one with k = 0. Along a line, `y = w + l d`, Q is a quadratic
//! in l; swept, `y = w + l d - m u`, one in l and m. The corner of a bull nose is a disc grown by a ball (`corner`). A
//! piece and what it sweeps are convex, so that each has one interval on a line.

mod corner;

use corner::Corner;
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// A point of the edge of a cutter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgePoint {
    /// Height above the tool centre point. m
    pub height: f64,
    /// Radial and axial part of the normal out of the surface.
    pub normal: [f64; 2],
}

/// A convex piece about the tool axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    alpha: f64,
    beta: f64,
    gamma: f64,
    /// Heights between which it reaches. m
    pub heights: [f64; 2],
    /// Its largest radius. m
    pub radius: f64,
    /// Radius of the disc that is grown by a ball. m
    disc: f64,
    /// Angle along its edge, of a round one. rad
    arc: f64,
}

/// Which surface of a piece a line meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// The side: ball, cone or cylinder.
    Side,
    /// The plane at its lower end.
    Bottom,
    /// The plane at its upper end.
    Top,
}

/// A line `w + l d` that a piece moves over by u: all from the tool centre point at the start of the move.
#[derive(Debug, Clone, Copy)]
pub struct Line<'l> {
    /// The tool axis.
    pub axis: &'l Vector3<f64>,
    /// A point of the line. m
    pub w: &'l Vector3<f64>,
    /// Its direction.
    pub d: &'l Vector3<f64>,
    /// What the piece moves by. m
    pub u: &'l Vector3<f64>,
}

/// A part of a line inside a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chord {
    /// Where it begins and ends on the line.
    pub ends: [f64; 2],
    /// The surface where it begins.
    pub first: Surface,
}

/// No interval.
const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
/// Lengths that are less are none. m
const TINY: f64 = 1e-12;

impl Piece {
    /// The round corner at the tip of a cutter: a disc of a radius about the axis, grown by that of the corner (m), to
    /// a side at an angle to the axis (rad). A ball has a disc without a radius.
    pub fn corner(disc: f64, corner: f64, taper: f64) -> Self {
        Self {
            alpha: 0.0,
            beta: corner,
            gamma: 0.0,
            heights: [0.0, 2.0 * corner],
            radius: disc + corner,
            disc,
            arc: FRAC_PI_2 - taper,
        }
    }

    /// A cone (or cylinder) between two heights, with the radii there (m).
    pub fn cone(heights: [f64; 2], radii: [f64; 2]) -> Self {
        let k = (radii[1] - radii[0]) / (heights[1] - heights[0]);
        let s = radii[0] - k * heights[0];
        let radius = radii[0].max(radii[1]);
        Self { alpha: 1.0 + k * k, beta: k * s, gamma: s * s, heights, radius, disc: 0.0, arc: 0.0 }
    }

    /// A cylinder without ends, of a radius (m).
    fn cylinder(radius: f64) -> Self {
        let heights = [f64::NEG_INFINITY, f64::INFINITY];
        Self { alpha: 1.0, beta: 0.0, gamma: radius * radius, heights, radius, disc: 0.0, arc: 0.0 }
    }

    /// Length of its edge from end to end of its heights; of a corner from the tip to the side. m
    pub fn edge(&self) -> f64 {
        let [from, to] = self.heights;
        if self.has_planes() { (to - from) * self.alpha.sqrt() } else { self.round() * self.arc }
    }

    /// Place along its edge of a point of its side at a height and a distance from the axis (m), from its lower end. m
    pub fn along(&self, height: f64, radius: f64) -> f64 {
        if self.has_planes() {
            (height - self.heights[0]) * self.alpha.sqrt()
        } else {
            self.round() * libm::atan2((radius - self.disc).max(0.0), self.beta - height)
        }
    }

    /// The point of its edge at a length from its lower end. m
    pub fn edge_at(&self, along: f64) -> EdgePoint {
        if self.has_planes() {
            let slant = self.alpha.sqrt();
            let [grows, rises] = [(self.alpha - 1.0).max(0.0).sqrt() / slant, 1.0 / slant];
            EdgePoint { height: self.heights[0] + along * rises, normal: [rises, -grows] }
        } else {
            let (sine, cosine) = libm::sincos(along / self.round());
            EdgePoint { height: self.beta - self.round() * cosine, normal: [sine, -cosine] }
        }
    }

    /// Radius of its corner. m
    fn round(&self) -> f64 {
        self.radius - self.disc
    }

    /// Its corner, where it has a disc.
    fn grown(&self) -> Option<Corner> {
        (self.disc > 0.0).then(|| Corner { disc: self.disc, radius: self.round() })
    }

    /// Whether it has planes at its ends.
    fn has_planes(&self) -> bool {
        self.alpha > 0.0
    }

    /// The normal out of its side at a point y, not of unit length.
    pub fn normal(&self, y: &Vector3<f64>, axis: &Vector3<f64>) -> Vector3<f64> {
        if let Some(corner) = self.grown() {
            return corner.way_to(y, axis);
        }
        y - axis * (self.alpha * y.dot(axis) + self.beta)
    }

    /// Which surface of a corner a point of it is on.
    fn surface_at(&self, y: &Vector3<f64>, axis: &Vector3<f64>) -> Surface {
        let height = y.dot(axis);
        match height < self.beta {
            _ if (y - axis * height).norm() > self.disc => Surface::Side,
            true => Surface::Bottom,
            false => Surface::Top,
        }
    }

    /// Where a line `y + l d` comes in and by which surface, where that is no later than a place and it does not leave
    /// before 0.
    pub fn entry(&self, axis: &Vector3<f64>, y: &Vector3<f64>, d: &Vector3<f64>, until: f64) -> Option<(f64, Surface)> {
        if let Some(corner) = self.grown() {
            let at = corner.entry(&Line { axis, w: y, d, u: &Vector3::zeros() }, until)?;
            return Some((at, self.surface_at(&(y + d * at), axis)));
        }
        let Chord { ends, first } = self.chord(axis, y, d)?;
        (ends[1] >= 0.0 && ends[0] <= until).then_some((ends[0], first))
    }

    /// The part of a line `y + l d` inside, where there is one.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub fn chord(&self, axis: &Vector3<f64>, y: &Vector3<f64>, d: &Vector3<f64>) -> Option<Chord> {
        if let Some(corner) = self.grown() {
            let ends = corner.interval(&Line { axis, w: y, d, u: &Vector3::zeros() }, NOWHERE)?;
            return Some(Chord { ends, first: self.surface_at(&(y + d * ends[0]), axis) });
        }
        let (h, hd) = (y.dot(axis), d.dot(axis));
        let a = d.dot(d) - self.alpha * hd * hd;
        let b = y.dot(d) - self.alpha * h * hd - self.beta * hd;
        let c = y.dot(y) - self.alpha * h * h - 2.0 * self.beta * h - self.gamma;
        let Chord { ends: [mut low, mut high], mut first } = self.between_planes(h, hd, d)?;
        let scale = d.dot(d);
        if a.abs() <= 1e-13 * scale {
            // Along the side of a cone, or up a cylinder.
            if b.abs() <= 1e-13 * scale {
                if c > 0.0 {
                    return None;
                }
            } else if b > 0.0 {
                high = high.min(-c / (2.0 * b));
            } else {
                let side = -c / (2.0 * b);
                if side > low {
                    (low, first) = (side, Surface::Side);
                }
            }
        } else {
            let roots = roots(a, b, c);
            match (a > 0.0, roots) {
                (true, None) => return None,
                (true, Some([from, to])) => {
                    if from > low {
                        (low, first) = (from, Surface::Side);
                    }
                    high = high.min(to);
                }
                (false, None) => {}
                // Both nappes of a cone: the heights say which.
                (false, Some([to, from])) => {
                    if from < high && (from > low || to < low) {
                        if from > low {
                            (low, first) = (from, Surface::Side);
                        }
                    } else if to > low {
                        high = high.min(to);
                    } else {
                        return None;
                    }
                }
            }
        }
        (high > low).then_some(Chord { ends: [low, high], first })
    }

    /// The part of a line along d between the planes, from a height h that grows with hd along it.
    fn between_planes(&self, h: f64, hd: f64, d: &Vector3<f64>) -> Option<Chord> {
        let is_along = self.has_planes() && hd.abs() < 1e-14 * d.norm();
        if is_along && (h < self.heights[0] - TINY || h > self.heights[1] + TINY) {
            return None;
        }
        if is_along || !self.has_planes() {
            return Some(Chord { ends: [f64::NEG_INFINITY, f64::INFINITY], first: Surface::Side });
        }
        let [a, b] = self.heights.map(|end| (end - h) / hd);
        let first = if hd > 0.0 { Surface::Bottom } else { Surface::Top };
        Some(Chord { ends: [a.min(b), a.max(b)], first })
    }

    /// Widens an interval on a line to what the piece sweeps of it: `y = w + l d - m u` for m from 0 to 1.
    pub fn sweep(&self, line: &Line<'_>, ends: &mut [f64; 2]) {
        let (Line { axis, w, d, u }, known) = (*line, *ends);
        let mut take = |l: f64| *ends = [ends[0].min(l), ends[1].max(l)];
        if let Some(corner) = self.grown() {
            return corner.interval(line, known).into_iter().flatten().for_each(take);
        }
        for start in [*w, w - u] {
            if let Some(chord) = self.chord(axis, &start, d) {
                chord.ends.into_iter().for_each(&mut take);
            }
        }
        let (h, hd, hu) = (w.dot(axis), d.dot(axis), u.dot(axis));
        let alpha = self.alpha;
        let a = d.dot(d) - alpha * hd * hd;
        let b = alpha * hd * hu - d.dot(u);
        let c = u.dot(u) - alpha * hu * hu;
        let dd = w.dot(d) - alpha * h * hd - self.beta * hd;
        let e = alpha * h * hu - w.dot(u) + self.beta * hu;
        let f = w.dot(w) - alpha * h * h - 2.0 * self.beta * h - self.gamma;
        let is_high = |l: f64, m: f64| {
            let height = h + l * hd - m * hu;
            !self.has_planes() || (height >= self.heights[0] - TINY && height <= self.heights[1] + TINY)
        };
        let is_during = |m: f64| (-1e-12..=1.0 + 1e-12).contains(&m);
        // The silhouette, where Q does not change with m.
        if c.abs() > 1e-14 * u.dot(u) {
            let found = roots(a - b * b / c, dd - b * e / c, f - e * e / c);
            for l in found.into_iter().flatten() {
                let m = -(b * l + e) / c;
                if is_during(m) && is_high(l, m) {
                    take(l);
                }
            }
        }
        // The edges of the end planes.
        if !self.has_planes() {
            return;
        }
        for end in self.heights {
            if hd.abs() > 1e-9 {
                let (p, q) = ((end - h) / hd, hu / hd);
                let (qa, qb) = (a * q * q + 2.0 * b * q + c, a * p * q + b * p + dd * q + e);
                let qc = a * p * p + 2.0 * dd * p + f;
                for m in roots(qa, qb, qc).into_iter().flatten().filter(|m| is_during(*m)) {
                    take(p + q * m);
                }
            } else if hu.abs() > TINY {
                let m = (h - end) / hu;
                if is_during(m)
                    && let Some([from, to]) = roots(a, b * m + dd, c * m * m + 2.0 * e * m + f)
                {
                    take(from);
                    take(to);
                }
            }
        }
    }
}

/// The roots of `a x^2 + 2 b x + c`, ascending, where there are two.
fn roots(a: f64, b: f64, c: f64) -> Option<[f64; 2]> {
    let square = b * b - a * c;
    let is_real = square > 0.0 && a != 0.0;
    if !is_real {
        return None;
    }
    let q = -(b + square.sqrt().copysign(b));
    let (x, y) = (q / a, if q == 0.0 { -q / a } else { c / q });
    Some([x.min(y), x.max(y)])
}

#[cfg(test)]
mod tests;
