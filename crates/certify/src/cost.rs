//! What one path point costs at least or at most, over a box of placements and a cell of heading, from an affine
//! function of the placement.

use super::compliance_table::AffineModel;
use super::region::{Point, PolarModel, Region};

/// The corners of a box.
pub(super) const CORNERS: usize = 8;

/// One path point over one box: everything that does not change from cell to cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointCost {
    pub placed: PolarModel,
    /// f2, f2 cos 2chi + f1 sin 2chi, f1 cos 2chi - f2 sin 2chi and the length of (f1, f2). N
    f2: f64,
    a: f64,
    b: f64,
    length: f64,
    /// f3, f3 sin chi and f3 cos chi. N
    vertical: [f64; 3],
    /// Joint 1: value, slopes by r and chi, and what they leave out. m
    joint1: [f64; 4],
    half: [f64; 3],
}

impl PointCost {
    /// With the compliance of joint 1 (rad/(N m)).
    pub fn new(point: &Point, placed: PolarModel, first: f64) -> Self {
        let [f1, f2, f3] = point.force;
        let (sine, cosine) = libm::sincos(placed.chi);
        let (s2, c2) = (2.0 * sine * cosine, cosine * cosine - sine * sine);
        let (a, b) = (f2 * c2 + f1 * s2, f1 * c2 - f2 * s2);
        let length = libm::hypot(f1, f2);
        let (r, [h_r, _, h_chi]) = (placed.r, placed.reach);
        let far = r + h_r;
        let swing = 2.0 * length * h_chi;
        let remainder = first
            * (0.5 * ((f2 + a).abs() + swing) * h_r * h_r
                + 2.0 * far * (b.abs() + swing) * h_r * h_chi
                + far * far * (a.abs() + swing) * h_chi * h_chi);
        let joint1 = [first * r * r * 0.5 * (f2 + a), first * r * (f2 + a), first * r * r * b, remainder];
        Self { placed, f2, a, b, length, vertical: [f3, f3 * sine, f3 * cosine], joint1, half: placed.reach }
    }

    /// What a node says about the normal part of the deflection, in a cell of heading of that half width (rad): `off`
    /// is where the point is from the node, in radius and height.
    #[inline(always)]
    fn model(&self, known: &AffineModel, off: [f64; 2], half_cell: f64) -> NormalPart {
        let p = &self.placed;
        let [h_r, h_z, h_chi] = self.half;
        let (a, b) = (self.a, self.b);
        let get = |f: usize, k: usize| f64::from(known.values[f][k]);
        let at = |f: usize| get(f, 0) + get(f, 1) * off[0] + get(f, 2) * off[1];
        let (d1, d2) = (at(1), at(2));
        let [j_value, j_r, j_chi, j_rest] = self.joint1;
        let mut value = self.f2 * at(0) - a * d1 + b * d2 + j_value;
        let by = |k: usize| self.f2 * get(0, k) - a * get(1, k) + b * get(2, k);
        let (mut by_r, mut by_z, mut by_heading) = (by(1) + j_r, by(2), by(3));
        let mut by_chi = -2.0 * (b * d1 + a * d2) + j_chi;
        let remainder_d = f64::from(known.remainder[1]);
        // How far (d1, d2) moves, at most: the sum of magnitudes is not below the length.
        let gradient = |k: usize| get(1, k).abs() + get(2, k).abs();
        let moved = gradient(1) * h_r + gradient(2) * h_z + gradient(3) * half_cell + 2.0 * remainder_d;
        let mut remainder = f64::from(known.remainder[0]) * self.f2.abs()
            + remainder_d * self.length
            + 2.0 * self.length * h_chi * (moved + h_chi * (d1.abs() + d2.abs() + moved))
            + j_rest;
        let [f3, sine, cosine] = self.vertical;
        if f3 != 0.0 {
            let by = |k: usize| get(4, k) * cosine - get(3, k) * sine;
            let (cr, ct) = (at(3), at(4));
            value += ct * cosine - cr * sine;
            (by_r, by_z, by_heading) = (by_r + by(1), by_z + by(2), by_heading + by(3));
            by_chi -= cr * cosine + ct * sine;
            let gradient = |k: usize| get(3, k).abs() + get(4, k).abs();
            let remainder_v = f64::from(known.remainder[2]);
            let moved = gradient(1) * h_r + gradient(2) * h_z + gradient(3) * half_cell + 2.0 * remainder_v;
            remainder += f3.abs() * (remainder_v + h_chi * (moved + 0.5 * h_chi * (cr.abs() + ct.abs() + moved)));
        }
        remainder += by_r.abs() * p.remainder_r + by_chi.abs() * p.remainder_chi;
        let slope =
            [by_r * p.slope_r[0] + by_chi * p.slope_chi[0], by_z, by_r * p.slope_r[1] + by_chi * p.slope_chi[1]];
        NormalPart { value, by_heading, slope, remainder }
    }

    /// Least costs at the corners of the box, in a cell of heading of that half width (rad): `off` is where the point
    /// is from the node, in radius and height. m
    #[inline]
    pub fn min_cost(&self, known: &AffineModel, off: [f64; 2], half_cell: f64, region: &Region) -> [f64; CORNERS] {
        let NormalPart { value, by_heading, slope, remainder } = self.model(known, off, half_cell);
        let min = value.abs() - remainder - by_heading.abs() * half_cell;
        if min <= 0.0 {
            return [0.0; CORNERS];
        }
        let sign = if value < 0.0 { -1.0 } else { 1.0 };
        corners(min, [0, 1, 2].map(|k| sign * slope[k] * region.half[k]))
    }

    /// Values at the corners of the box of a convex function of the placement that is above the cost: above the least
    /// of the costs in the cell (with `choice`), which takes all the cell to be allowed, or above all of them. m
    ///
    /// With the heading h from the middle of the cell, |c| is at most |affine(placement) + slope h| + remainder; the
    /// least of that over |h| <= `half_cell` and the greatest are both convex.
    #[inline]
    pub fn max_cost(
        &self,
        known: &AffineModel,
        off: [f64; 2],
        half_cell: f64,
        region: &Region,
        choice: bool,
    ) -> [f64; CORNERS] {
        let NormalPart { value, by_heading, slope, remainder } = self.model(known, off, half_cell);
        let free = by_heading.abs() * half_cell;
        let all = corners(value, [0, 1, 2].map(|k| slope[k] * region.half[k]));
        all.map(|c| remainder + if choice { (c.abs() - free).max(0.0) } else { c.abs() + free })
    }
}

/// An affine model of the normal part of the deflection over a box of placements and a cell of heading.
#[derive(Debug, Clone, Copy)]
struct NormalPart {
    /// At the middle of the box and of the cell. m
    value: f64,
    /// Slope by the heading. m/rad
    by_heading: f64,
    /// Slopes by radius, height and yaw of the box.
    slope: [f64; 3],
    /// How far the normal part is from it, at most. m
    remainder: f64,
}

/// Values at the corners of a box of an affine function: at the middle, and how much it changes to the upper sides.
#[inline(always)]
fn corners(middle: f64, [x, y, z]: [f64; 3]) -> [f64; CORNERS] {
    let (low, high) = (middle - z, middle + z);
    [low - x - y, low + x - y, low - x + y, low + x + y, high - x - y, high + x - y, high - x + y, high + x + y]
}
