//! What moments on the tool add: how they move the tool centre point.
//!
//! With D = sum k_j v_j z_j^T the displacement under a moment m is `D m`, and a tangent ([`super::load`]) adds
//! `<D, W^T u m^T>`. D is not symmetric: in the plan it has a mean P, an antisymmetric part A and a pair that turns
//! twice as fast as the frame; its columns and rows along axis 1 are two pairs that turn with the frame.

use super::enclosure::Remainder;
use super::number::VARIABLES;

/// Functions modelled: P, A, (D_rr - D_tt) / 2, (D_rt + D_tr) / 2, D_rz, D_tz, D_zr, D_zt and D_zz.
pub(super) const MOMENTS: usize = 9;

/// Functions that turn together: the first, their number, and how many times as fast as the frame.
const GROUPS: [(usize, usize, f64); 6] = [(0, 1, 0.0), (1, 1, 0.0), (2, 2, 2.0), (4, 2, 1.0), (6, 2, 1.0), (8, 1, 0.0)];

/// An affine model of D around a node. 1/N
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct MomentModel {
    /// Value and gradient of each function at the node.
    pub values: [[f32; 4]; MOMENTS],
    /// What these leave out of each group.
    pub remainder: Remainder<{ GROUPS.len() }>,
}

impl MomentModel {
    /// Of values and gradients at a node, and second derivatives by pairs of variables (function, pair); `None` where
    /// they are not finite.
    pub fn new(values: [[f64; 4]; MOMENTS], half: [f64; 3], of_pair: impl Fn(usize, usize) -> f64) -> Option<Self> {
        let bends = std::array::from_fn(|pair| {
            GROUPS.map(|(first, count, _)| (first..first + count).map(|f| of_pair(f, pair).powi(2)).sum::<f64>().sqrt())
        });
        let size = |f: usize| values[f][0].abs() + (0..3).map(|k| values[f][k + 1].abs() * half[k]).sum::<f64>();
        let digits = GROUPS.map(|(first, count, _)| 1e-7 * (first..first + count).map(size).sum::<f64>());
        let remainder = Remainder::new(bends, digits)?;
        Some(Self { values: values.map(|v| v.map(|x| x as f32)), remainder })
    }
}

impl MomentModel {
    /// The largest that D can be within half widths of the node: the sum of its entries. 1/N
    pub fn size(&self, half: [f64; 3]) -> f64 {
        let up = |entry: &[f32; 4]| {
            let [value, slopes @ ..] = entry.map(f64::from);
            value.abs() + (0..3).map(|k| slopes[k].abs() * half[k]).sum::<f64>()
        };
        // Each function is in two entries at most.
        2.0 * (self.values.iter().map(up).sum::<f64>() + self.remainder.within(half).iter().sum::<f64>())
    }
}

/// What a tangent asks of D, in the radial frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct TurnedMoment {
    /// By what each function is multiplied. N m
    factors: [f64; MOMENTS],
    /// The length of the factors of each group. N m
    lengths: [f64; GROUPS.len()],
    /// Joint 1: value, slopes by r and chi, and what they leave out. m
    joint1: [f64; 4],
}

/// An affine model of what a moment adds, without the slopes of radius and direction by the box.
#[derive(Debug, Clone, Copy)]
pub(super) struct MomentPart {
    /// m
    pub value: f64,
    /// By radius, height and heading.
    pub by: [f64; VARIABLES],
    pub by_chi: f64,
    pub remainder: f64,
}

impl TurnedMoment {
    /// Of `W^T u` and the moment in the frame of the load, which has this direction (sine and cosine) against the
    /// azimuth, for radii within `half[0]` of r and directions within `half[1]`; `first` is the compliance of joint 1
    /// (rad/(N m)).
    pub fn new(a: [f64; 3], m: [f64; 3], direction: (f64, f64), r: f64, half: [f64; 2], first: f64) -> Self {
        let ((sine, cosine), [h_r, h_chi]) = (direction, half);
        let own = [
            a[0] * m[0] + a[1] * m[1],
            a[1] * m[0] - a[0] * m[1],
            a[0] * m[0] - a[1] * m[1],
            a[0] * m[1] + a[1] * m[0],
            a[0] * m[2],
            a[1] * m[2],
            a[2] * m[0],
            a[2] * m[1],
            a[2] * m[2],
        ];
        let (sine2, cosine2) = (2.0 * sine * cosine, cosine * cosine - sine * sine);
        let (mut factors, mut lengths) = (own, [0.0; GROUPS.len()]);
        for (length, (at, count, order)) in lengths.iter_mut().zip(GROUPS) {
            if count == 1 {
                *length = own[at].abs();
                continue;
            }
            let (s, c) = if order == 2.0 { (sine2, cosine2) } else { (sine, cosine) };
            let (q, w) = (own[at], own[at + 1]);
            (factors[at], factors[at + 1]) = (q * c - w * s, q * s + w * c);
            *length = (q * q + w * w).sqrt();
        }
        // D_tz = k_1 r.
        let remainder = first * lengths[3] * h_chi * (h_r + 0.5 * (r + h_r) * h_chi);
        let joint1 = [first * r * factors[5], first * factors[5], first * r * factors[4], remainder];
        Self { factors, lengths, joint1 }
    }

    /// What is known of it where the state is `off` the node in radius and height, within `reach` of that in radius,
    /// height and direction, and within half a cell of heading (rad).
    pub fn part(&self, known: &MomentModel, off: [f64; 2], reach: [f64; 3], half_cell: f64) -> MomentPart {
        let [h_r, h_z, h_chi] = reach;
        let [value, by_r, by_chi, remainder] = self.joint1;
        let rest = known.remainder.within([off[0].abs() + h_r, off[1].abs() + h_z, half_cell]);
        let mut part = MomentPart { value, by: [by_r, 0.0, 0.0], by_chi, remainder };
        for (group, (first, count, order)) in GROUPS.into_iter().enumerate() {
            let (length, remainder) = (self.lengths[group], rest[group]);
            if length == 0.0 {
                continue;
            }
            let (mut size, mut gradient, mut here) = (0.0, [0.0; 3], [0.0; 2]);
            for f in first..first + count {
                let [value, r, z, heading] = known.values[f].map(f64::from);
                let at = value + r * off[0] + z * off[1];
                here[f - first] = at;
                size += at.abs();
                part.value += self.factors[f] * at;
                for (k, slope) in [r, z, heading].into_iter().enumerate() {
                    part.by[k] += self.factors[f] * slope;
                    gradient[k] += slope.abs();
                }
            }
            part.remainder += remainder * length;
            if count == 2 {
                let (x, y) = (self.factors[first], self.factors[first + 1]);
                part.by_chi += order * (x * here[1] - y * here[0]);
                let moved = gradient[0] * h_r + gradient[1] * h_z + gradient[2] * half_cell + 2.0 * remainder;
                part.remainder += order * length * h_chi * (moved + 0.5 * order * h_chi * (size + moved));
            }
        }
        part
    }
}

/// The displacement under a moment, both in the frame of a load of this direction (sine and cosine): by the functions
/// of D in the radial frame, and what joint 1 adds at radius r. m
pub(super) fn moved(values: [f64; MOMENTS], m: [f64; 3], direction: (f64, f64), r: f64, first: f64) -> [f64; 3] {
    let ([p, a, d0, d1, rz, tz, zr, zt, zz], (sine, cosine)) = (values, direction);
    let tz = tz + first * r;
    // The first axis of the load is at chi against the radial direction.
    let (x, y, z) = (m[0] * cosine - m[1] * sine, m[0] * sine + m[1] * cosine, m[2]);
    let (radial, tangential) = ((p + d0) * x + (d1 - a) * y + rz * z, (d1 + a) * x + (p - d0) * y + tz * z);
    [radial * cosine + tangential * sine, tangential * cosine - radial * sine, zr * x + zt * y + zz * z]
}
