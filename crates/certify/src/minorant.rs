//! Affine functions below what a path point costs, whatever the heading.

use super::arm::Arm;
use super::compliance_table::{AffineModel, ComplianceTable, Node};
use super::cost::{Direction, Known, NOTHING, of_joint1};
use super::enclosure::{FUNCTIONS, REMAINDERS};
use super::kind::Kind;
use super::load::{Load, Tangent, Yielding};
use super::moment::{MomentModel, MomentPart};
use super::number::VARIABLES;
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

/// An affine function a little lower, in fewer digits.
pub(super) fn rounded(value: f64, slope: [f64; 3], half: [f64; 3]) -> Affine {
    let size = value.abs() + (0..3).map(|k| slope[k].abs() * half[k] * 4.0).sum::<f64>();
    let value = value - 1e-6 * size;
    if value <= 0.0 { ZERO } else { Affine { value: value as f32, slope: slope.map(|s| s as f32) } }
}

/// Second-order parts larger than this share of the compliance are cut up, down to the finest of these levels.
const COARSE: f64 = 0.3;
const COARSE_LEVELS: usize = 4;

/// What the model of a node leaves out, in the plan or of what is vertical.
fn coarseness(known: &AffineModel, half: [f64; 3]) -> f64 {
    let [m, d, v, zz] = known.remainder.within(half);
    (m + d).max(v + zz)
}

/// The nodes of a table in one class, as regions about a radius and height.
pub(super) struct Around<'a> {
    pub arm: &'a Arm,
    pub table: &'a ComplianceTable,
    pub class: PostureClass,
    /// m
    pub node: [f64; 2],
}

impl Around<'_> {
    /// The regions around a node, cut up where their models are coarse; false where nothing is known of one.
    pub fn collect(&self, level: usize, at: [usize; 2], cell: usize, out: &mut Vec<ModelledRegion>) -> bool {
        let Self { arm, table, class, node } = *self;
        let finest = level + 1 == COARSE_LEVELS.min(table.depth());
        let half = table.half(level);
        let (node_at, moments) = table.nodes_at(arm, level, at).known(cell, class);
        match node_at {
            Node::Empty => return true,
            Node::Unknown if finest => return false,
            Node::Known(known) if finest || coarseness(known, half) <= COARSE * arm.typical_compliance() => {
                let [r, z] = table.place(level, at);
                let off = [r - node[0], z - node[1]];
                out.push(ModelledRegion::new((known, moments), half, [r, arm.joint1], off));
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
                known &= self.collect(level + 1, [i, j], part, out);
            }
        }
        known
    }
}

/// A region of headings, radii and heights: an affine model of the compliances with what it leaves out.
pub(super) struct ModelledRegion {
    values: [[f64; 4]; FUNCTIONS],
    remainder: [f64; REMAINDERS],
    /// How long (d1, d2) and the vertical compliances can get, and how far they can move.
    max_size: [f64; 2],
    moved: [f64; 2],
    /// How it yields to moments, where some act.
    moments: Option<MomentModel>,
    half: [f64; 3],
    r: f64,
    /// Compliance of joint 1. rad/(N m)
    first: f64,
    /// Radius and height less those of the node. m
    off: [f64; 2],
}

impl ModelledRegion {
    /// Of a model about a radius (m), with a compliance of joint 1 (rad/(N m)), within `half` of its place, which is
    /// `off` the node.
    pub fn new(known: Known<'_>, half: [f64; 3], of: [f64; 2], off: [f64; 2]) -> Self {
        let ((known, moments), [r, first]) = (known, of);
        let values = known.values.map(|v| v.map(f64::from));
        let remainder = known.remainder.within(half);
        // Slopes change by at most what twice the second-order sum says.
        let of = |a: usize, b: usize, remainder: f64| {
            let moved = (0..3).map(|k| libm::hypot(values[a][k + 1], values[b][k + 1]) * half[k]).sum::<f64>()
                + 2.0 * remainder;
            (libm::hypot(values[a][0], values[b][0]) + moved, moved)
        };
        let (d, v) = (of(1, 2, remainder[1]), of(3, 4, remainder[2]));
        Self {
            values,
            remainder,
            max_size: [d.0, v.0],
            moved: [d.1, v.1],
            moments: moments.copied(),
            half,
            r,
            first,
            off,
        }
    }

    /// An affine model by radius, height and direction of the load of `<C, S>` in the region, for directions within
    /// `h_chi` (rad), without what moments add; `vertical` where entries of C out of the plan count.
    #[inline(always)]
    fn model(&self, turned: &([f64; 6], [f64; 2]), is_vertical: bool, h_chi: f64) -> AroundRegion {
        let (factors, lengths) = turned;
        let [plane, x, y, g, h, axial] = *factors;
        let [length, vertical] = *lengths;
        let [j_value, j_r, j_chi, j_rest] = of_joint1(factors, length, self.r, [self.half[0], h_chi], self.first);
        let mut of: [f64; 4] =
            std::array::from_fn(|k| plane * self.values[0][k] + x * self.values[1][k] + y * self.values[2][k]);
        let mut by_chi = 2.0 * (x * self.values[2][0] - y * self.values[1][0]) + j_chi;
        let mut remainder = self.remainder[0] * plane.abs()
            + self.remainder[1] * length
            + h_chi * 2.0 * length * self.moved[0]
            + h_chi * h_chi * 2.0 * length * self.max_size[0]
            + j_rest;
        if is_vertical {
            let [cr, ct] = [3, 4].map(|f| self.values[f][0]);
            for (k, of) in of.iter_mut().enumerate() {
                *of += g * self.values[3][k] + h * self.values[4][k] + axial * self.values[5][k];
            }
            by_chi += g * ct - h * cr;
            remainder += self.remainder[2] * vertical
                + self.remainder[3] * axial.abs()
                + h_chi * vertical * self.moved[1]
                + h_chi * h_chi * 0.5 * vertical * self.max_size[1];
        }
        let [value, by_r, by_z, by_heading] = of;
        AroundRegion { value: value + j_value, slopes: [by_r + j_r, by_z, by_chi], by_heading, remainder }
    }

    /// An affine function by radius, height and direction of the load below `<C, S>` everywhere in the region, for
    /// directions within `h_chi` (rad): its value at the middle (m), and slopes.
    #[inline(always)]
    fn least(&self, tangent: &Tangent, load: &Load, direction: &Direction, h_chi: f64) -> (f64, [f64; 3]) {
        let turned = direction.turned(tangent, load, self.r, [self.half[0], h_chi], self.first);
        let AroundRegion { value, slopes, by_heading, remainder } =
            self.model(&(turned.factors, turned.lengths), true, h_chi);
        let value = value + load.of_part(tangent) - remainder;
        // The heading is free within its cell.
        let (Some(turned), Some(known)) = (&turned.moment, &self.moments) else {
            return (value - by_heading.abs() * self.half[2], slopes);
        };
        let MomentPart { value: more, by: [r, z, heading], by_chi, remainder } =
            turned.part(known, [0.0; 2], [self.half[0], self.half[1], h_chi], self.half[2]);
        let free = (by_heading + heading).abs() * self.half[2];
        (value + more - remainder - free, [slopes[0] + r, slopes[1] + z, slopes[2] + by_chi])
    }

    /// The same below the absolute value of what is linear in C, with factors in the radial frame and what the part
    /// adds.
    #[inline(always)]
    fn least_absolute(
        &self,
        turned: &([f64; 6], [f64; 2]),
        of_part: f64,
        is_vertical: bool,
        h_chi: f64,
    ) -> (f64, [f64; 3]) {
        let AroundRegion { value, slopes, by_heading, remainder } = self.model(turned, is_vertical, h_chi);
        let value = value + of_part;
        let sign = if value < 0.0 { -1.0 } else { 1.0 };
        (value.abs() - remainder - by_heading.abs() * self.half[2], slopes.map(|slope| sign * slope))
    }

    /// By how much the scores of the loads of a kind can differ from that of its own: what the norms of C and D make of
    /// the differences in force, moment and part. m
    #[inline(never)]
    fn spread(&self, kind: &Kind) -> f64 {
        let far = self.r + self.half[0];
        let up = |f: usize, remainder: f64| {
            let [value, slopes @ ..] = self.values[f];
            value.abs() + (0..3).map(|k| slopes[k].abs() * self.half[k]).sum::<f64>() + remainder
        };
        let [d, v] = self.max_size;
        let largest = Yielding { m: up(0, self.remainder[0]), d: [d, 0.0], v: [v, 0.0], zz: up(5, self.remainder[3]) };
        let part = kind.load.part.map_or(0.0, |part| part.size());
        let c = largest.size() + self.first * far * far + part;
        let d = self.moments.map_or(0.0, |moments| moments.size(self.half) + self.first * far);
        // Loads of a kind have forces of size 1.
        let by_part = kind.part_spread * (1.0 + kind.load.error);
        kind.load.most_scored() * (c * kind.force_spread + d * kind.moment_spread + by_part)
    }

    /// The same below the score: by the sharp tangents at the middle, or by one that is nearly sharp.
    #[inline(always)]
    fn least_score(&self, load: &Load, direction: &Direction, h_chi: f64, is_sharp: bool) -> (f64, [f64; 3]) {
        let seen = direction.seen(self.values.map(|value| value[0]), load, self.r, self.first);
        let by_moment = self.moments.map_or([0.0; 3], |known| {
            direction.moved(known.values.map(|value| f64::from(value[0])), load, self.r, self.first)
        });
        let least = |tangent: &Tangent| self.least(tangent, load, direction, h_chi);
        if !is_sharp {
            return least(&load.near_tangent(&seen, by_moment));
        }
        if load.is_linear() {
            let tangent = load.of_first();
            // With the sign that the value has.
            let sign = if tangent.with(&seen, by_moment) < 0.0 { -1.0 } else { 1.0 };
            return least(&tangent.times(sign));
        }
        let (sharp, of_error) = load.tangents(&seen, by_moment);
        let found = least(&sharp);
        match of_error.map(|tangent| least(&tangent)) {
            Some(other) if other.0 > found.0 => other,
            _ => found,
        }
    }
}

/// An affine model over a region: see [`ModelledRegion::model`].
struct AroundRegion {
    /// At the middle. m
    value: f64,
    /// By radius, height and direction of the load.
    slopes: [f64; 3],
    by_heading: f64,
    /// How far what is modelled is from it, at most. m
    remainder: f64,
}

/// What a kind of load costs at least in each of some regions.
pub(super) struct OfKind<'a> {
    found: &'a [ModelledRegion],
    kind: &'a Kind,
    is_sharp: bool,
    /// By how much the scores of the loads of the kind can differ from that of its own, region by region. m
    spreads: Vec<f64>,
    /// At the middle of each region (m), and slopes.
    least: Vec<(f64, [f64; 3])>,
}

/// Regions evaluated again with sharp tangents, at most.
const SHARPENED: usize = 24;

impl<'a> OfKind<'a> {
    /// With tangents that are sharp in every region, or only in those that keep a bound low.
    pub fn new(found: &'a [ModelledRegion], kind: &'a Kind, is_sharp: bool) -> Self {
        let is_spread = kind.force_spread != 0.0 || kind.moment_spread != 0.0 || kind.part_spread != 0.0;
        let of = |region: &ModelledRegion| if is_spread { region.spread(kind) } else { 0.0 };
        Self { found, kind, is_sharp, spreads: found.iter().map(of).collect(), least: Vec::with_capacity(found.len()) }
    }

    /// Below what all of the states cost, for directions of the load within `half` of one.
    pub fn minorant(&mut self, direction: &Direction, half: [f64; 3]) -> Affine {
        if self.found.is_empty() {
            return EMPTY;
        }
        let (load, h_chi) = (&self.kind.load, half[2]);
        let first = load.of_first();
        let (turned, of_part) = (direction.factors(&first), load.of_part(&first));
        let score = |region: &ModelledRegion, is_sharp| region.least_score(load, direction, h_chi, is_sharp);
        let sharp = |region: &ModelledRegion| score(region, true);
        // Without errors of the force the one is as sharp as the other.
        let is_above_zero = if !self.is_sharp && !load.is_single() && load.error > 0.0 {
            let is_above_zero = self.each(|region| score(region, false), sharp);
            if is_above_zero {
                self.sharpen(h_chi, sharp);
            }
            is_above_zero
        } else if !load.is_linear() || load.has_moment() {
            self.each(sharp, |_| NOTHING)
        } else if turned.1[1] != 0.0 || turned.0[5] != 0.0 {
            self.each(|region| region.least_absolute(&turned, of_part, true, h_chi), |_| NOTHING)
        } else {
            self.each(|region| region.least_absolute(&turned, of_part, false, h_chi), |_| NOTHING)
        };
        if !is_above_zero {
            return ZERO;
        }
        let (value, slope, _) = self.below(h_chi);
        rounded(value, slope, half)
    }

    /// What `of` says of each region, and where that is not above zero `otherwise`; false once neither is.
    // Out of line: each use is a loop that fits into the registers.
    #[inline(never)]
    fn each(
        &mut self,
        of: impl Fn(&ModelledRegion) -> (f64, [f64; 3]),
        otherwise: impl Fn(&ModelledRegion) -> (f64, [f64; 3]),
    ) -> bool {
        self.least.clear();
        for (region, spread) in self.found.iter().zip(&self.spreads) {
            let mut least = of(region);
            if least.0 <= *spread {
                least = otherwise(region);
            }
            if least.0 <= *spread {
                return false;
            }
            self.least.push((least.0 - spread, least.1));
        }
        true
    }

    /// With `of`, sharper, in the regions that keep the bound low.
    #[inline(never)]
    fn sharpen(&mut self, h_chi: f64, of: impl Fn(&ModelledRegion) -> (f64, [f64; 3])) {
        let mut sharpened = [usize::MAX; SHARPENED];
        for number in 0..SHARPENED {
            let (_, _, keeping) = self.below(h_chi);
            let Some(region) = keeping.into_iter().find(|region| !sharpened[..number].contains(region)) else { break };
            let (value, slopes) = of(&self.found[region]);
            self.least[region] = (value - self.spreads[region], slopes);
            sharpened[number] = region;
        }
    }

    /// An affine function below all of the regions: its value at the node (m), slopes, and the regions that slopes and
    /// value are of.
    #[inline(always)]
    fn below(&self, h_chi: f64) -> (f64, [f64; 3], [usize; 2]) {
        let mut lowest = 0;
        for (number, least) in self.least.iter().enumerate() {
            if least.0 < self.least[lowest].0 {
                lowest = number;
            }
        }
        let slope = self.least[lowest].1;
        let (mut value, mut limiting) = (f64::INFINITY, lowest);
        for (number, (s, (least, slopes))) in self.found.iter().zip(&self.least).enumerate() {
            let spread = [s.half[0], s.half[1], h_chi];
            let shifted = slope[0] * s.off[0] + slope[1] * s.off[1];
            let here = least - shifted - (0..3).map(|k| (slopes[k] - slope[k]).abs() * spread[k]).sum::<f64>();
            if here < value {
                (value, limiting) = (here, number);
            }
        }
        (value, slope, [lowest, limiting])
    }
}
