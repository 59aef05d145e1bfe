//! Affine functions below what a path point costs, whatever the heading.

use super::arm::Arm;
use super::compliance_table::{AffineModel, ComplianceTable, FUNCTIONS, Node};
use super::number::VARIABLES;
use std::f64::consts::TAU;
use stead_model::robot::PostureClass;

/// An affine function about a node, below what a point costs in one posture class within a step of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Affine {
    /// At the node. m
    pub value: f32,
    /// By radius, height and direction of the feed.
    pub slope: [f32; VARIABLES],
}

/// Nothing is feasible.
pub(super) const EMPTY: Affine = Affine { value: f32::INFINITY, slope: [0.0; VARIABLES] };
/// Nothing is known.
pub(super) const ZERO: Affine = Affine { value: 0.0, slope: [0.0; VARIABLES] };

/// An affine function below several, each true within `half` of its own middle.
pub(super) fn below_all(
    once: impl Iterator<Item = ([f64; 3], Affine)>,
    again: impl Iterator<Item = ([f64; 3], Affine)>,
    half: [f64; 3],
) -> Affine {
    let lowest = once.filter(|(_, e)| e.value < f32::INFINITY).min_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let Some((_, lowest)) = lowest else { return EMPTY };
    if lowest == ZERO {
        return ZERO;
    }
    let slope = lowest.slope.map(f64::from);
    let mut value = f64::INFINITY;
    for (off, e) in again.filter(|(_, e)| e.value < f32::INFINITY) {
        let mut v = f64::from(e.value);
        for k in 0..3 {
            v -= slope[k] * off[k] + (f64::from(e.slope[k]) - slope[k]).abs() * half[k];
        }
        value = value.min(v);
    }
    rounded(value, slope, half)
}

fn rounded(value: f64, slope: [f64; 3], half: [f64; 3]) -> Affine {
    let size = value.abs() + (0..3).map(|k| slope[k].abs() * half[k] * 4.0).sum::<f64>();
    let value = value - 1e-6 * size;
    if value <= 0.0 { ZERO } else { Affine { value: value as f32, slope: slope.map(|s| s as f32) } }
}

/// Second-order parts larger than this share of the compliance are cut up, down to the finest level.
const COARSE: f64 = 0.3;

/// The regions around a node, cut up where their models are coarse; false where nothing is known of one.
#[expect(clippy::too_many_arguments, reason = "one node and all it is cut from")]
pub(super) fn collect(
    arm: &Arm,
    table: &ComplianceTable,
    level: usize,
    at: [usize; 2],
    cell: usize,
    node: [f64; 2],
    class: PostureClass,
    out: &mut Vec<ModelledRegion>,
) -> bool {
    let finest = level + 1 == table.depth();
    match table.node(arm, level, at, cell, class) {
        Node::Empty => return true,
        Node::Unknown if finest => return false,
        Node::Known(known)
            if finest || f64::from(known.remainder[0] + known.remainder[1]) <= COARSE * arm.typical_compliance() =>
        {
            let half = [table.length(level), table.length(level), 0.5 * TAU / table.headings(level) as f64];
            let place = table.place(level, at);
            out.push(ModelledRegion::new(known, half, place[0], [place[0] - node[0], place[1] - node[1]]));
            return true;
        }
        _ => {}
    }
    let mut known = true;
    for (down, left) in [(true, true), (true, false), (false, true), (false, false)] {
        let side = |k: usize, low: bool| if low { (2 * k).checked_sub(1) } else { Some(2 * k + 1) };
        let (Some(i), Some(j)) = (side(at[0], down), side(at[1], left)) else { continue };
        if !table.holds(level + 1, [i, j]) {
            continue;
        }
        for part in [2 * cell, 2 * cell + 1] {
            known &= collect(arm, table, level + 1, [i, j], part, node, class, out);
        }
    }
    known
}

/// A region of headings, radii and heights: an affine model of the compliances with what it leaves out.
pub(super) struct ModelledRegion {
    values: [[f64; 4]; FUNCTIONS],
    remainder: [f64; 3],
    /// How long (d1, d2) and the vertical compliances can get, and how far they can move.
    max_size: [f64; 2],
    moved: [f64; 2],
    half: [f64; 3],
    r: f64,
    /// Radius and height less those of the node. m
    off: [f64; 2],
}

impl ModelledRegion {
    /// Of a model about a radius, within `half` of its place, which is `off` the node.
    pub fn new(known: &AffineModel, half: [f64; 3], r: f64, off: [f64; 2]) -> Self {
        let values = known.values.map(|v| v.map(f64::from));
        let remainder = known.remainder.map(f64::from);
        // Slopes change by at most what twice the second-order sum says.
        let of = |a: usize, b: usize, remainder: f64| {
            let moved = (0..3).map(|k| libm::hypot(values[a][k + 1], values[b][k + 1]) * half[k]).sum::<f64>()
                + 2.0 * remainder;
            (libm::hypot(values[a][0], values[b][0]) + moved, moved)
        };
        let (d, v) = (of(1, 2, remainder[1]), of(3, 4, remainder[2]));
        Self { values, remainder, max_size: [d.0, v.0], moved: [d.1, v.1], half, r, off }
    }
}

/// Below what all of the states cost, for a force and a direction of the feed (sine and cosine) within `half` of the
/// node.
pub(super) fn minorant(
    found: &[ModelledRegion],
    force: [f64; 3],
    (sine, cosine): (f64, f64),
    first: f64,
    half: [f64; 3],
) -> Affine {
    if found.is_empty() {
        return EMPTY;
    }
    let [f1, f2, f3] = force;
    let (s2, c2) = (2.0 * sine * cosine, cosine * cosine - sine * sine);
    let (a, b) = (f2 * c2 + f1 * s2, f1 * c2 - f2 * s2);
    let length = libm::hypot(f1, f2);
    let h_chi = half[2];
    let model = |s: &ModelledRegion| {
        let (r, h_r) = (s.r, s.half[0]);
        let far = r + h_r;
        let joint1 = first
            * (0.5 * ((f2 + a).abs() + 2.0 * length * h_chi) * h_r * h_r
                + 2.0 * far * (b.abs() + 2.0 * length * h_chi) * h_r * h_chi
                + far * far * (a.abs() + 2.0 * length * h_chi) * h_chi * h_chi);
        let of = |k: usize| {
            let v = |f: usize| s.values[f][k];
            f2 * v(0) - a * v(1) + b * v(2) + f3 * (cosine * v(4) - sine * v(3))
        };
        let value = of(0) + first * r * r * 0.5 * (f2 + a);
        let by_r = of(1) + first * r * (f2 + a);
        let by_chi = -2.0 * b * s.values[1][0] - 2.0 * a * s.values[2][0] + first * r * r * b
            - f3 * (cosine * s.values[3][0] + sine * s.values[4][0]);
        let remainder = s.remainder[0] * f2.abs() + s.remainder[1] * length + s.remainder[2] * f3.abs()
            + h_chi * (2.0 * length * s.moved[0] + f3.abs() * s.moved[1])
            + h_chi * h_chi * (2.0 * length * s.max_size[0] + 0.5 * f3.abs() * s.max_size[1])
            + joint1
            // The heading is free within its cell.
            + of(3).abs() * s.half[2];
        let sign = if value < 0.0 { -1.0 } else { 1.0 };
        (value.abs() - remainder, [by_r * sign, of(2) * sign, by_chi * sign])
    };
    let mut lowest = (f64::INFINITY, [0.0; 3]);
    for s in found {
        let m = model(s);
        if m.0 < lowest.0 {
            lowest = m;
        }
    }
    if lowest.0 <= 0.0 {
        return ZERO;
    }
    let slope = lowest.1;
    let mut value = f64::INFINITY;
    for s in found {
        let m = model(s);
        let spread = [s.half[0], s.half[1], h_chi];
        let shifted = slope[0] * s.off[0] + slope[1] * s.off[1];
        value = value.min(m.0 - shifted - (0..3).map(|k| (m.1[k] - slope[k]).abs() * spread[k]).sum::<f64>());
    }
    rounded(value, slope, half)
}
