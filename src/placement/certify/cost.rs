//! What one path point costs at least, over a box of placements and a cell of beta, as an affine function of the placement.

use super::arm::{Arm, CONSTRAINTS, Yield};
use super::number::{PAIR, PAIRS, Slope};
use super::region::{Placed, Point, Region};
use super::table::{FUNCTIONS, Known};
use crate::placement::kernel::lanes::{Lanes, Mask, WIDTH};
use crate::robot::PostureClass;

/// The corners of a box.
pub(super) const CORNERS: usize = 8;

/// A force against the direction of the feed, at one path point over one box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Load {
    pub force: [f64; 3],
    /// f2 cos 2chi + f1 sin 2chi and f1 cos 2chi - f2 sin 2chi.
    a: f64,
    b: f64,
    sine: f64,
    cosine: f64,
    /// Their length, sqrt(f1^2 + f2^2).
    length: f64,
}

impl Load {
    pub fn new(point: &Point, placed: &Placed) -> Self {
        let [f1, f2, _] = point.force;
        let (sine, cosine) = libm::sincos(placed.chi);
        let (s2, c2) = (2.0 * sine * cosine, cosine * cosine - sine * sine);
        let (a, b) = (f2 * c2 + f1 * s2, f1 * c2 - f2 * s2);
        Self { force: point.force, a, b, sine, cosine, length: libm::hypot(f1, f2) }
    }
}

/// Four states around which a box and a cell of beta lie.
pub(super) struct States<'a> {
    pub arm: &'a Arm,
    pub class: PostureClass,
    /// Compliance of joint 1. rad/(N m)
    pub first: f64,
    /// Which way the heading turns with beta.
    pub sense: f64,
    pub region: &'a Region,
    pub placed: &'a Placed,
    pub load: &'a Load,
    /// Half the width of a cell of beta. rad
    pub half_cell: f64,
}

impl States<'_> {
    /// Least costs at the corners of the box, from a node of the table: `off` is where the middle of the box is from it.
    #[inline]
    pub fn from_node(&self, known: &Known, off: [f64; 3]) -> [f64; CORNERS] {
        let p = self.placed;
        let [h_r, h_z, h_chi] = p.reach;
        let h_heading = h_chi + self.half_cell;
        let half = [h_r, h_z, h_heading];
        let Load { force: [_, f2, f3], a, b, sine, cosine, length } = *self.load;
        let (r, first) = (p.r, self.first);
        let get = |f: usize, k: usize| f64::from(known.values[f][k]);
        let at = |f: usize| get(f, 0) + get(f, 1) * off[0] + get(f, 2) * off[1] + get(f, 3) * off[2];
        let (d1, d2) = (at(1), at(2));
        let mut value = f2 * at(0) - a * d1 + b * d2 + first * r * r * 0.5 * (f2 + a);
        let mut by: [f64; 3] = std::array::from_fn(|k| f2 * get(0, k + 1) - a * get(1, k + 1) + b * get(2, k + 1));
        by[0] += first * r * (f2 + a);
        let mut by_chi = -2.0 * b * d1 - 2.0 * a * d2 + first * r * r * b;
        let rest_of = |f: usize| f64::from(known.rest[f]);
        let mut rest = rest_of(0) * f2.abs() + rest_of(1) * length;
        let moved = (0..3).map(|k| libm::sqrt(get(1, k + 1) * get(1, k + 1) + get(2, k + 1) * get(2, k + 1)) * half[k]).sum::<f64>();
        let in_plane = libm::sqrt(d1 * d1 + d2 * d2) + moved + 2.0 * rest_of(1);
        // The compliance's move is in the slopes; that it moves while the feed turns is not.
        rest += 2.0 * length * h_chi * (moved + 2.0 * rest_of(1)) + 2.0 * length * h_chi * h_chi * in_plane;
        if f3 != 0.0 {
            let (cr, ct) = (at(3), at(4));
            value += f3 * (ct * cosine - cr * sine);
            for k in 0..3 {
                by[k] += f3 * (get(4, k + 1) * cosine - get(3, k + 1) * sine);
            }
            by_chi -= f3 * (cr * cosine + ct * sine);
            let moved = (0..3).map(|k| libm::hypot(get(3, k + 1), get(4, k + 1)) * half[k]).sum::<f64>() + 2.0 * rest_of(2);
            rest += f3.abs() * (rest_of(2) + h_chi * moved + 0.5 * h_chi * h_chi * (libm::hypot(cr, ct) + moved));
        }
        rest += by[0].abs() * p.rest_r + (by[2] + by_chi).abs() * p.rest_chi;
        let far = r + h_r;
        rest += first
            * (0.5 * ((f2 + a).abs() + 2.0 * length * h_chi) * h_r * h_r
                + 2.0 * far * (b.abs() + 2.0 * length * h_chi) * h_r * h_chi
                + far * far * (a.abs() + 2.0 * length * h_chi) * h_chi * h_chi);
        let turning = by[2] + by_chi;
        let slope = [
            by[0] * p.slope_r[0] + turning * p.slope_chi[0],
            by[1],
            by[0] * p.slope_r[1] + turning * p.slope_chi[1],
        ];
        let least = value.abs() - rest - by[2].abs() * self.half_cell;
        if least <= 0.0 {
            return [0.0; CORNERS];
        }
        let sign = if value < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = [0, 1, 2].map(|k| sign * slope[k] * self.region.half[k]);
        std::array::from_fn(|corner| {
            let signed = |k: usize, v: f64| if corner >> k & 1 == 1 { v } else { -v };
            least + signed(0, x) + signed(1, y) + signed(2, z)
        })
    }
}

/// The value of c in the middle and its slopes by radius, height, yaw and beta, and what they leave out. N-free: m
#[derive(Debug, Clone, Copy)]
pub(super) struct Model {
    pub value: Lanes,
    pub slope: [Lanes; 4],
    pub rest: Lanes,
}

impl States<'_> {
    /// How far each of r, z, heading gets from the middle.
    pub fn half(&self) -> [f64; 3] {
        let [r, z, chi] = self.placed.reach;
        [r, z, chi + self.half_cell]
    }

    #[inline(always)]
    pub fn evaluate(&self, sine: Lanes, cosine: Lanes) -> Yield<Slope> {
        let r = Slope::variable(Lanes::splat(self.placed.r), 0);
        let z = Slope::variable(Lanes::splat(self.placed.z), 1);
        let (sine, cosine) = Slope::heading(sine, cosine);
        self.arm.evaluate(r, z, sine, cosine, self.class)
    }

    /// Slopes by radius, height, yaw and beta from those by r, z, heading (and chi, which moves with the heading).
    #[inline(always)]
    fn chained(&self, by_r: Lanes, by_z: Lanes, by_heading: Lanes, by_chi: Lanes) -> [Lanes; 4] {
        let p = self.placed;
        let turning = by_heading + by_chi;
        [
            by_r * p.slope_r[0] + turning * p.slope_chi[0],
            by_z,
            by_r * p.slope_r[1] + turning * p.slope_chi[1],
            by_heading * self.sense,
        ]
    }

    /// Where some constraint is sure to fail all over the box and the cells.
    #[inline(always)]
    pub fn fails(&self, y: &Yield<Slope>, second: &[[Lanes; PAIRS]; FUNCTIONS]) -> Mask {
        let half = self.half();
        let p = self.placed;
        let [a, b, g] = self.region.half;
        let zero = Lanes::splat(0.0);
        let high: [Lanes; CONSTRAINTS] = std::array::from_fn(|c| {
            let f = &y.constraints[c];
            let slope = self.chained(f.gradient[0], f.gradient[1], f.gradient[2], zero);
            let mut most = f.value
                + slope[0].abs() * a
                + slope[1].abs() * b
                + slope[2].abs() * g
                + slope[3].abs() * self.half_cell
                + f.gradient[0].abs() * p.rest_r
                + f.gradient[2].abs() * p.rest_chi;
            for (k, (i, j)) in PAIR.iter().enumerate() {
                let factor = if i == j { 0.5 } else { 1.0 };
                most = most + second[3 + c][k] * (factor * half[*i] * half[*j]);
            }
            most
        });
        let negative = |c: usize| high[c].less(zero);
        let [at_elbow, at_wrist, _] = y.regular;
        let mut fails = negative(0) & at_elbow | (negative(5) | negative(6)) & at_wrist | negative(7) & y.conditioned;
        for joint in 0..2 {
            let (one, other) = (negative(1 + 2 * joint), negative(2 + 2 * joint));
            fails = match self.arm.is_wide(joint) {
                None => fails,
                Some(true) => fails | one & other & at_wrist,
                Some(false) => fails | (one | other) & at_wrist,
            };
        }
        fails
    }

    /// The model of c around the four states.
    #[inline(always)]
    pub fn model(&self, y: &Yield<Slope>, second: &[[Lanes; PAIRS]; FUNCTIONS]) -> Model {
        let half = self.half();
        let h_chi = self.placed.reach[2];
        let Load { force: [_, f2, f3], a, b, sine, cosine, length } = *self.load;
        let (r, first) = (self.placed.r, self.first);
        let (m, d1, d2) = (&y.m, &y.d1, &y.d2);
        let mut value = m.value * f2 - d1.value * a + d2.value * b + first * r * r * 0.5 * (f2 + a);
        let mut by: [Lanes; 3] =
            std::array::from_fn(|k| m.gradient[k] * f2 - d1.gradient[k] * a + d2.gradient[k] * b);
        by[0] = by[0] + first * r * (f2 + a);
        let mut by_chi = d1.value * (-2.0 * b) - d2.value * (2.0 * a) + first * r * r * b;
        if f3 != 0.0 {
            let [cr, ct] = &y.vertical;
            value = value + (ct.value * cosine - cr.value * sine) * f3;
            for k in 0..3 {
                by[k] = by[k] + (ct.gradient[k] * cosine - cr.gradient[k] * sine) * f3;
            }
            by_chi = by_chi - (cr.value * cosine + ct.value * sine) * f3;
        }
        let slope = self.chained(by[0], by[1], by[2], by_chi);
        // Second derivatives by r, z and heading.
        let mut rest = by[0].abs() * self.placed.rest_r + (by[2] + by_chi).abs() * self.placed.rest_chi;
        for (k, (i, j)) in PAIR.iter().enumerate() {
            let factor = if i == j { 0.5 } else { 1.0 };
            let mut most = second[0][k] * f2.abs() + second[1][k] * length;
            if f3 != 0.0 {
                most = most + second[2][k] * f3.abs();
            }
            rest = rest + most * (factor * half[*i] * half[*j]);
        }
        // How far first derivatives, and then values, of the compliances get from those in the middle.
        let moved = |f: usize, k: usize| {
            PAIR.iter().enumerate().fold(Lanes::splat(0.0), |sum, (p, (i, j))| {
                if *i == k {
                    sum + second[f][p] * half[*j]
                } else if *j == k {
                    sum + second[f][p] * half[*i]
                } else {
                    sum
                }
            })
        };
        let length_of = |x: Lanes, y: Lanes| (x * x + y * y).sqrt();
        let mut in_plane = length_of(d1.value, d2.value);
        let mut vertical = length_of(y.vertical[0].value, y.vertical[1].value);
        for k in 0..3 {
            let gradient = length_of(d1.gradient[k], d2.gradient[k]) + moved(1, k);
            in_plane = in_plane + gradient * half[k];
            rest = rest + gradient * (2.0 * length * half[k] * h_chi);
            if f3 != 0.0 {
                let gradient = length_of(y.vertical[0].gradient[k], y.vertical[1].gradient[k]) + moved(2, k);
                vertical = vertical + gradient * half[k];
                rest = rest + gradient * (f3.abs() * half[k] * h_chi);
            }
        }
        rest = rest + in_plane * (2.0 * length * h_chi * h_chi);
        if f3 != 0.0 {
            rest = rest + vertical * (0.5 * f3.abs() * h_chi * h_chi);
        }
        // Joint 1.
        let far = r + half[0];
        let (a_most, b_most) = (a.abs() + 2.0 * length * h_chi, b.abs() + 2.0 * length * h_chi);
        let joint1 = first
            * (0.5 * ((f2 + a).abs() + 2.0 * length * h_chi) * half[0] * half[0]
                + 2.0 * far * b_most * half[0] * h_chi
                + far * far * a_most * h_chi * h_chi);
        Model { value, slope, rest: rest + joint1 }
    }
}

impl Model {
    /// Least costs at the corners of the box, for each of the four states: an affine minorant of |c| taken there.
    #[inline(always)]
    pub fn corners(&self, region: &Region, half_cell: f64) -> [[f64; CORNERS]; WIDTH] {
        let margin = self.slope[3].abs() * half_cell + self.rest;
        let zero = Lanes::splat(0.0);
        let least = self.value.abs() - margin;
        let above = zero.less(least);
        let sign = Lanes::splat(1.0).with_sign_of(self.value);
        let base = above.select(least, zero);
        let slope: [Lanes; 3] =
            std::array::from_fn(|k| above.select(self.slope[k] * sign * region.half[k], zero));
        std::array::from_fn(|lane| {
            std::array::from_fn(|corner| {
                (0..3).fold(base.0[lane], |sum, k| {
                    if corner >> k & 1 == 1 { sum + slope[k].0[lane] } else { sum - slope[k].0[lane] }
                })
            })
        })
    }
}
