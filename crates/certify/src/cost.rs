//! What one path point costs at least or at most, over a box of placements and a cell of heading, from an affine
//! function of the placement.
//!
//! A [`Tangent`] makes of the affine model of the compliance an affine model of a lower bound of the score: its value
//! in the middle, its slopes, and how far the compliance can make it differ.

use super::compliance_table::AffineModel;
use super::load::Load;
use super::load::{Tangent, Yielding};
use super::moment::{MOMENTS, MomentModel, MomentPart, TurnedMoment, moved};
use super::region::{Point, PolarModel, Region};
use stead_problem::criterion::{Aggregate, Over};

/// What a node tells: how it yields to forces and, where some moment acts, to moments.
pub(super) type Known<'a> = (&'a AffineModel, Option<&'a MomentModel>);

/// The corners of a box.
pub(super) const CORNERS: usize = 8;

/// What of its uncertainty a bound does not count, to see what that takes away: nothing of it, what models leave out,
/// or the width of cells of heading too. Only the first gives a bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Without {
    Nothing,
    Remainders,
    Headings,
}

/// One path point over one box: everything that does not change from cell to cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointCost<'a> {
    pub placed: PolarModel,
    load: &'a Load,
    /// Compliance of joint 1. rad/(N m)
    first: f64,
    /// Sine and cosine of the direction of the load's frame against the azimuth, and of twice that.
    direction: Direction,
    /// The tangent, where it is the same at every state.
    fixed: Option<Turned>,
    without: Without,
}

/// Sine and cosine of an angle chi, and of twice that.
#[derive(Debug, Clone, Copy)]
pub(super) struct Direction {
    sine: f64,
    cosine: f64,
    sine2: f64,
    cosine2: f64,
}

/// A tangent in the radial frame, and what joint 1 adds to it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turned {
    /// By what m, d1, d2, c_rz, c_tz and c_zz are multiplied. N
    pub factors: [f64; 6],
    /// Lengths of (d1, d2)'s factors and of (c_rz, c_tz)'s. N
    pub lengths: [f64; 2],
    /// Joint 1 and the part: value, slopes by r and chi, and what they leave out. m
    pub joint1: [f64; 4],
    /// What it asks of the displacement under a moment, where one acts.
    pub moment: Option<TurnedMoment>,
}

impl Direction {
    pub fn new(chi: f64) -> Self {
        let (sine, cosine) = libm::sincos(chi);
        Self { sine, cosine, sine2: 2.0 * sine * cosine, cosine2: cosine * cosine - sine * sine }
    }

    /// The compliance at a point in the frame of its load, that of the part included: from m, d1, d2, c_rz, c_tz and
    /// c_zz in the radial frame, and what joint 1 adds at radius r. m/N
    #[inline(always)]
    pub fn seen(&self, values: [f64; 6], load: &Load, r: f64, first: f64) -> Yielding {
        let [m, d1, d2, cr, ct, zz] = values;
        let half = 0.5 * first * r * r;
        let (d1, Self { sine, cosine, sine2, cosine2 }) = (d1 - half, self);
        let d = [d1 * cosine2 + d2 * sine2, d2 * cosine2 - d1 * sine2];
        load.with_part(Yielding { m: m + half, d, v: [cr * cosine + ct * sine, ct * cosine - cr * sine], zz })
    }

    /// The displacement under the moment of a load, in the frame of the load: by the functions of [`MomentModel`] in
    /// the radial frame. m
    pub fn moved(&self, values: [f64; MOMENTS], load: &Load, r: f64, first: f64) -> [f64; 3] {
        moved(values, load.moment, (self.sine, self.cosine), r, first)
    }

    /// A tangent of a load in the radial frame, for radii within `half[0]` of r and directions within `half[1]`;
    /// `first` is the compliance of joint 1 (rad/(N m)).
    #[inline(always)]
    pub fn turned(&self, tangent: &Tangent, load: &Load, r: f64, half: [f64; 2], first: f64) -> Turned {
        let (factors, lengths) = self.factors(tangent);
        let moment = || TurnedMoment::new(tangent.along, load.moment, (self.sine, self.cosine), r, half, first);
        let mut joint1 = of_joint1(&factors, lengths[0], r, half, first);
        joint1[0] += load.of_part(tangent);
        Turned { factors, lengths, joint1, moment: load.has_moment().then(moment) }
    }

    /// See [`Turned::factors`] and [`Turned::lengths`].
    #[inline(always)]
    pub fn factors(&self, tangent: &Tangent) -> ([f64; 6], [f64; 2]) {
        let Tangent { plane, turning: [q, w], vertical: [v1, v2], axial, .. } = *tangent;
        let Self { sine, cosine, sine2, cosine2 } = *self;
        let (x, y) = (q * cosine2 - w * sine2, q * sine2 + w * cosine2);
        let vertical = [v1 * cosine - v2 * sine, v1 * sine + v2 * cosine];
        ([plane, x, y, vertical[0], vertical[1], axial], [(q * q + w * w).sqrt(), (v1 * v1 + v2 * v2).sqrt()])
    }
}

/// See [`Turned::joint1`].
#[inline(always)]
pub(super) fn of_joint1(factors: &[f64; 6], length: f64, r: f64, half: [f64; 2], first: f64) -> [f64; 4] {
    let ([plane, x, y, ..], [h_r, h_chi]) = (*factors, half);
    let far = r + h_r;
    let swing = 2.0 * length * h_chi;
    // r^2 (S11 + S22 - x) / 2, the tangential part of S.
    let remainder = first
        * (0.5 * ((plane - x).abs() + swing) * h_r * h_r
            + 2.0 * far * (y.abs() + swing) * h_r * h_chi
            + far * far * (x.abs() + swing) * h_chi * h_chi);
    [first * r * r * 0.5 * (plane - x), first * r * (plane - x), first * r * r * y, remainder]
}

impl Turned {
    /// Whether entries of the compliance out of the plan count.
    #[inline(always)]
    pub fn is_vertical(&self) -> bool {
        self.lengths[1] != 0.0 || self.factors[5] != 0.0
    }
}

/// An affine model over a box of placements and a cell of heading.
#[derive(Debug, Clone, Copy)]
struct Linear {
    /// At the middle of the box and of the cell. m
    value: f64,
    /// Slope by the heading. m/rad
    by_heading: f64,
    /// Slopes by radius, height and yaw of the box.
    slope: [f64; 3],
    /// How far what is modelled is from it, at most. m
    remainder: f64,
}

impl<'a> PointCost<'a> {
    /// With the compliance of joint 1 (rad/(N m)).
    pub fn new(point: &'a Point, placed: PolarModel, first: f64) -> Self {
        Self::of(&point.load, placed, first)
    }

    /// The same with less of its uncertainty.
    pub fn without(self, without: Without) -> Self {
        Self { without, ..self }
    }

    fn of(load: &'a Load, placed: PolarModel, first: f64) -> Self {
        let direction = Direction::new(placed.chi + load.turn);
        let half = [placed.reach[0], placed.reach[2]];
        let fixed = load.is_linear().then(|| direction.turned(&load.of_first(), load, placed.r, half, first));
        Self { placed, load, first, direction, fixed, without: Without::Nothing }
    }

    /// What a node says of a tangent, in a cell of heading of that half width (rad): `off` is where the point is from
    /// the node, in radius and height.
    #[inline(always)]
    fn model(&self, turned: &Turned, known: Known<'_>, off: [f64; 2], half_cell: f64) -> Linear {
        let (p, (known, moments)) = (&self.placed, known);
        let [h_r, h_z, h_chi] = p.reach;
        let [plane, x, y, g, h, axial] = turned.factors;
        let get = |f: usize, k: usize| f64::from(known.values[f][k]);
        let at = |f: usize| get(f, 0) + get(f, 1) * off[0] + get(f, 2) * off[1];
        let (d1, d2) = (at(1), at(2));
        let [j_value, j_r, j_chi, j_rest] = turned.joint1;
        let mut value = plane * at(0) + x * d1 + y * d2 + j_value;
        let by = |k: usize| plane * get(0, k) + x * get(1, k) + y * get(2, k);
        let (mut by_r, mut by_z, mut by_heading) = (by(1) + j_r, by(2), by(3));
        let mut by_chi = 2.0 * (x * d2 - y * d1) + j_chi;
        let length = turned.lengths[0];
        // Of the node, only what is between it and the box counts.
        let within = [off[0].abs() + h_r, off[1].abs() + h_z, half_cell];
        let rest = known.remainder.within(within);
        // How far (d1, d2) moves, at most: the sum of magnitudes is not below the length.
        let gradient = |k: usize| get(1, k).abs() + get(2, k).abs();
        let moved = gradient(1) * h_r + gradient(2) * h_z + gradient(3) * half_cell + 2.0 * rest[1];
        let mut remainder = rest[0] * plane.abs()
            + rest[1] * length
            + 2.0 * length * h_chi * (moved + h_chi * (d1.abs() + d2.abs() + moved))
            + j_rest;
        if turned.is_vertical() {
            let by = |k: usize| g * get(3, k) + h * get(4, k) + axial * get(5, k);
            let (cr, ct) = (at(3), at(4));
            value += g * cr + h * ct + axial * at(5);
            (by_r, by_z, by_heading) = (by_r + by(1), by_z + by(2), by_heading + by(3));
            by_chi += g * ct - h * cr;
            let gradient = |k: usize| get(3, k).abs() + get(4, k).abs();
            let moved = gradient(1) * h_r + gradient(2) * h_z + gradient(3) * half_cell + 2.0 * rest[2];
            remainder += turned.lengths[1] * (rest[2] + h_chi * (moved + 0.5 * h_chi * (cr.abs() + ct.abs() + moved)))
                + axial.abs() * rest[3];
        }
        if let (Some(turned), Some(known)) = (&turned.moment, moments) {
            let part = turned.part(known, off, p.reach, half_cell);
            let MomentPart { by: [r, z, heading], .. } = part;
            (value, by_chi, remainder) = (value + part.value, by_chi + part.by_chi, remainder + part.remainder);
            (by_r, by_z, by_heading) = (by_r + r, by_z + z, by_heading + heading);
        }
        remainder += by_r.abs() * p.remainder_r + by_chi.abs() * p.remainder_chi;
        let slope =
            [by_r * p.slope_r[0] + by_chi * p.slope_chi[0], by_z, by_r * p.slope_r[1] + by_chi * p.slope_chi[1]];
        if self.without >= Without::Remainders {
            remainder = 0.0;
        }
        if self.without == Without::Headings {
            by_heading = 0.0;
        }
        Linear { value, by_heading, slope, remainder }
    }

    /// The same point with another compliance of joint 1 (rad/(N m)).
    pub fn with_first(&self, first: f64) -> Self {
        Self { without: self.without, ..Self::of(self.load, self.placed, first) }
    }

    /// An affine function of the placement below the score, in a cell of heading of that half width (rad): `off` is
    /// where the point is from the node, in radius and height. Its value in the middle of the box (m), and slopes; zero
    /// where the score may be.
    #[inline]
    pub fn least(&self, known: Known<'_>, off: [f64; 2], half_cell: f64, region: &Region) -> (f64, [f64; 3]) {
        let (min, slope) = match &self.fixed {
            Some(turned) => {
                let Linear { value, by_heading, slope, remainder } = self.model(turned, known, off, half_cell);
                let sign = if value < 0.0 { -1.0 } else { 1.0 };
                (value.abs() - remainder - by_heading.abs() * half_cell, slope.map(|s| sign * s))
            }
            None if self.load.is_zero() => return NOTHING,
            None => self.min_score(known, off, half_cell, region),
        };
        if min <= 0.0 { NOTHING } else { (min, slope) }
    }

    /// Least costs at the corners of the box, as [`Self::least`] and [`cost_at_corners`].
    #[cfg(test)]
    pub fn min_cost(
        &self,
        known: Known<'_>,
        off: [f64; 2],
        half_cell: f64,
        region: &Region,
        aggregate: Aggregate,
    ) -> [f64; CORNERS] {
        cost_at_corners(self.least(known, off, half_cell, region), region, aggregate)
    }

    /// The least score in the middle of the box, and its slopes: by the tangents at the middle of box and cell.
    // Out of line: it would crowd the loop over cells of scores whose tangent is fixed.
    #[inline(never)]
    fn min_score(&self, known: Known<'_>, off: [f64; 2], half_cell: f64, region: &Region) -> (f64, [f64; 3]) {
        let p = &self.placed;
        let middle = |entry: &[f32; 4]| {
            let [value, by_r, by_z, _] = entry.map(f64::from);
            value + by_r * off[0] + by_z * off[1]
        };
        let at = std::array::from_fn(|f| middle(&known.0.values[f]));
        let by_moment = match known.1 {
            None => [0.0; 3],
            Some(moments) => {
                let at = std::array::from_fn(|f| middle(&moments.values[f]));
                self.direction.moved(at, self.load, p.r, self.first)
            }
        };
        let (sharp, of_error) = self.load.tangents(&self.direction.seen(at, self.load, p.r, self.first), by_moment);
        let least = |tangent: &Tangent| {
            let half = [p.reach[0], p.reach[2]];
            let turned = self.direction.turned(tangent, self.load, p.r, half, self.first);
            let Linear { value, by_heading, slope, remainder } = self.model(&turned, known, off, half_cell);
            (value - remainder - by_heading.abs() * half_cell, slope)
        };
        let size = |(min, slope): &(f64, [f64; 3])| min - (0..3).map(|k| slope[k].abs() * region.half[k]).sum::<f64>();
        let found = least(&sharp);
        match of_error.map(|tangent| least(&tangent)) {
            // Of the two the one that is larger where it is least.
            Some(other) if size(&other) > size(&found) => other,
            _ => found,
        }
    }

    /// Values at the corners of the box of a convex function of the placement that is above the cost: above the least
    /// of the costs in the cell (with `choice`), which takes all the cell to be allowed, or above all of them. For
    /// scores that are the absolute value of a linear function; infinite for others. m
    ///
    /// With the heading h from the middle of the cell, |c| is at most |affine(placement) + slope h| + remainder; the
    /// least of that over |h| <= `half_cell` and the greatest are both convex.
    #[inline]
    pub fn max_cost(
        &self,
        known: Known<'_>,
        off: [f64; 2],
        half_cell: f64,
        region: &Region,
        choice: bool,
    ) -> [f64; CORNERS] {
        let Some(turned) = &self.fixed else { return [f64::INFINITY; CORNERS] };
        let Linear { value, by_heading, slope, remainder } = self.model(turned, known, off, half_cell);
        let free = by_heading.abs() * half_cell;
        let all = corners(value, [0, 1, 2].map(|k| slope[k] * region.half[k]));
        all.map(|c| remainder + if choice { (c.abs() - free).max(0.0) } else { c.abs() + free })
    }
}

/// Of a score nothing is known but that it is none below zero.
pub(super) const NOTHING: (f64, [f64; 3]) = (0.0, [0.0; 3]);

/// Costs at the corners of a box of a score that is nowhere below an affine function (its value in the middle, m, and
/// slopes). For the largest score, the least of it over the box at every corner. m, for the root of the mean of squares
/// m^2
#[inline]
pub(super) fn cost_at_corners(below: (f64, [f64; 3]), region: &Region, aggregate: Aggregate) -> [f64; CORNERS] {
    let (min, slope) = below;
    if min <= 0.0 {
        return [0.0; CORNERS];
    }
    let sides = std::array::from_fn(|k| slope[k] * region.half[k]);
    match aggregate {
        Aggregate::Mean => corners(min, sides),
        // The tangent of the square, which is above it nowhere.
        Aggregate::Rms => corners(min * min, sides.map(|side| 2.0 * min * side)),
        // Of the largest of several affine functions the least need not be at a corner.
        Aggregate::Max => [(min - sides.iter().map(|side| side.abs()).sum::<f64>()).max(0.0); CORNERS],
    }
}

/// An affine function below the score of a point, from such functions below its scores under several sets of stiffness.
#[inline]
pub(super) fn joined_sets(over: Over, all: impl ExactSizeIterator<Item = (f64, [f64; 3])>) -> (f64, [f64; 3]) {
    let share = 1.0 / all.len() as f64;
    all.reduce(|a, b| match over {
        Over::Worst => {
            if b.0 > a.0 {
                b
            } else {
                a
            }
        }
        Over::Mean | Over::Regret => (a.0 + b.0, std::array::from_fn(|k| a.1[k] + b.1[k])),
    })
    .map_or(NOTHING, |sum| match over {
        Over::Worst => sum,
        Over::Mean | Over::Regret => (sum.0 * share, sum.1.map(|slope| slope * share)),
    })
}

/// Values at the corners of a box of an affine function: at the middle, and how much it changes to the upper sides.
#[inline(always)]
fn corners(middle: f64, sides: [f64; 3]) -> [f64; CORNERS] {
    let [x, y, z] = sides;
    let (low, high) = (middle - z, middle + z);
    [low - x - y, low + x - y, low - x + y, low + x + y, high - x - y, high + x - y, high - x + y, high + x + y]
}
