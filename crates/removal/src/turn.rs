//! What goes on in a turn of the spindle: where along the edge and at which angles the teeth are in the stock, and the
//! largest force.
//!
//! An element of the cutter's surface dA = r dphi dl (phi the angle, l along the edge) that is in the stock all along a
//! length of path ds removes dV = (n . u) dA ds. So the sums of dV / ((n . u) r) over a field of angle and edge are the
//! share of it that is in the stock.

use crate::cutting::{Bit, Moving, Tool};
use crate::moves::PathMoves;
use nalgebra::Vector3;
use std::f64::consts::TAU;
use stead_model::cutting::Coefficients;

/// Angles of a turn.
const ANGLES: usize = 72;
/// Slices of the edge, at most.
const SLICES: usize = 24;
/// Positions of the spindle in which the force is looked at.
const POSITIONS: usize = 180;
/// The lag of the helix changes by no more over a part of a slice. rad
const LAG: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// A field of which less is in the stock is not.
const NOTHING: f64 = 0.02;
/// Likewise of a slice at all angles.
const NO_SLICE: f64 = 0.05;
/// A field whose chip is thinner than this share of the thickest is no part of the angles of the cut: the bottom of a
/// cutter that leans back by a hundredth of a degree is in the stock all around, with chips of nanometres.
const LEAST_CHIP: f64 = 0.01;

/// The load in a turn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turn {
    /// Largest norm of the force. N
    pub largest: f64,
    /// Angles between which teeth are in the stock, where they are. rad
    pub angles: Option<[f64; 2]>,
}

/// Sums of dV / ((n . u) r) and of the chip times it, by angle and slice.
#[derive(Debug, Clone)]
pub struct Arcs(Vec<[f32; 2]>);

impl Arcs {
    /// Adds a share of what a bit adds.
    pub fn put(&mut self, field: &Field, share: f64) {
        let [area, chip] = &mut self.0[field.number];
        *area += (field.sums[0] * share) as f32;
        *chip += (field.sums[1] * share) as f32;
    }

    /// Adds others.
    pub fn add(&mut self, other: &Self) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            *own = [own[0] + other[0], own[1] + other[1]];
        }
    }
}

/// The fields of angle and edge of a cutter.
#[derive(Debug, Clone)]
pub struct TurnGrid {
    slices: usize,
    slice: f64,
    per_slice: f64,
    clockwise: f64,
    angles: AngleTable,
}

/// What a bit adds to a field.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    number: usize,
    sums: [f64; 2],
}

/// A slice of the edge in the stock.
struct Slice {
    /// Share of its length that is in the stock.
    share: f64,
    /// Share of each angle, over that.
    angles: [f64; ANGLES],
    /// Chip per turn of a smooth surface at each angle. m
    chips: [f64; ANGLES],
    /// Radial and axial part of the normal.
    normal: [f64; 2],
    /// What the helix lags at the middle of each even part of it. rad
    lags: Vec<f64>,
}

impl TurnGrid {
    /// For a cutter and lines of the stock at a distance. m
    pub fn new(tool: &Tool, cell: f64) -> Self {
        let slice = (2.0 * cell).max(tool.edge / SLICES as f64);
        let slices = ((tool.edge / slice).ceil() as usize).max(1);
        let clockwise = -tool.cutter.rotation().sign();
        Self { slices, slice, per_slice: 1.0 / slice, clockwise, angles: AngleTable::new() }
    }

    /// No sums yet.
    pub fn arcs(&self) -> Arcs {
        Arcs(vec![[0.0; 2]; ANGLES * self.slices])
    }

    /// The field of a bit and what it adds there.
    pub fn field(&self, moving: &Moving<'_>, bit: &Bit) -> Field {
        let [ahead, left] = &moving.across;
        let (sine, cosine) = (bit.outward.dot(ahead), bit.outward.dot(left) * self.clockwise);
        let angle = self.angles.of(sine, cosine);
        let slice = ((bit.along_edge * self.per_slice) as usize).min(self.slices - 1);
        let over_radius = bit.sums.volume / bit.mean_radius;
        let sums = [over_radius / bit.speed.max(1e-6), over_radius * moving.one.feed_per_turn];
        Field { number: slice * ANGLES + angle, sums }
    }

    /// The load of a turn from the sums of a node.
    pub fn turn(&self, tool: &Tool, arcs: &Arcs, path: &PathMoves, node: usize) -> Turn {
        let leg = path.legs.partition_point(|leg| leg.turns.first <= node).saturating_sub(1);
        let Some(leg) = path.legs.get(leg) else { return Turn::default() };
        let spacing = leg.length / leg.turns.intervals as f64;
        let is_end = node == leg.turns.first || node == leg.turns.first + leg.turns.intervals;
        let length = if is_end { spacing / 2.0 } else { spacing };
        let field = length * self.slice * TAU / ANGLES as f64;
        let slices: Vec<Slice> =
            (0..self.slices).filter_map(|number| self.slice_of(tool, arcs, number, field)).collect();
        if slices.is_empty() {
            return Turn::default();
        }
        let largest =
            (0..POSITIONS).map(|position| self.force(tool, &slices, position as f64 / POSITIONS as f64 * TAU).norm());
        Turn { largest: largest.fold(0.0, f64::max), angles: Some(angles(&slices)) }
    }

    fn slice_of(&self, tool: &Tool, arcs: &Arcs, number: usize, field: f64) -> Option<Slice> {
        let sums = &arcs.0[number * ANGLES..(number + 1) * ANGLES];
        let covered = |angle: usize| (f64::from(sums[angle][0]) / field).min(1.0);
        let share = (0..ANGLES).map(covered).fold(0.0, f64::max);
        if share < NO_SLICE {
            return None;
        }
        let edge = tool.edge_at((number as f64 + 0.5) * self.slice);
        let mut slice = Slice {
            share,
            angles: [0.0; ANGLES],
            chips: [0.0; ANGLES],
            normal: edge.normal,
            lags: self.lags(tool, number),
        };
        for angle in 0..ANGLES {
            let of_all = covered(angle) / share;
            if of_all > NOTHING {
                slice.angles[angle] = of_all;
                slice.chips[angle] = f64::from(sums[angle][1]) / f64::from(sums[angle][0]);
            }
        }
        Some(slice)
    }

    /// What the helix lags along a slice, in parts in which it changes by little. rad
    fn lags(&self, tool: &Tool, number: usize) -> Vec<f64> {
        let at = |along: f64| tool.cutter.lag(tool.edge_at((number as f64 + along) * self.slice).height);
        let parts = ((at(1.0) - at(0.0)).abs() / LAG).ceil().clamp(1.0, 8.0);
        (0..parts as usize).map(|part| at((part as f64 + 0.5) / parts)).collect()
    }

    /// Force with the first tooth at an angle: along feed, left of it and axis. N
    fn force(&self, tool: &Tool, slices: &[Slice], position: f64) -> Vector3<f64> {
        let k: Coefficients = tool.cutter.coefficients();
        let teeth = tool.cutter.teeth();
        let mut sum = Vector3::zeros();
        for (number, offset) in tool.cutter.offsets().into_iter().enumerate() {
            for (slice, lag) in slices.iter().flat_map(|slice| slice.lags.iter().map(move |lag| (slice, lag))) {
                let phi = (position + offset - lag).rem_euclid(TAU);
                let Some(chip_per_turn) = slice.at(phi) else { continue };
                // The thinnest of what the teeth before have left.
                let (mut turned, mut chip) = (0.0, f64::INFINITY);
                for back in 1..=teeth.len() {
                    turned += teeth[(number + teeth.len() + 1 - back) % teeth.len()].pitch;
                    let before = teeth[(number + teeth.len() - back % teeth.len()) % teeth.len()].radius;
                    let runout = (teeth[number].radius - before) * slice.normal[0];
                    chip = f64::min(chip, chip_per_turn * turned / TAU + runout);
                }
                if chip <= 0.0 {
                    continue;
                }
                let width = slice.share * self.slice / slice.lags.len() as f64;
                let (sine, cosine) = libm::sincos(phi);
                let outward = Vector3::new(sine, cosine * self.clockwise, 0.0);
                let motion = Vector3::new(cosine, -sine * self.clockwise, 0.0);
                let [radial, axial] = slice.normal;
                let n = outward * radial + Vector3::z() * axial;
                let s = Vector3::z() * radial - outward * axial;
                sum += (n * -(k.radial * chip + k.radial_edge) - motion * (k.tangential * chip + k.tangential_edge)
                    + s * (k.axial * chip))
                    * width;
            }
        }
        sum
    }
}

impl Slice {
    /// Chip per turn at an angle, where the slice is in the stock: of an angle that is in part, the part beside its
    /// fuller neighbour.
    fn at(&self, phi: f64) -> Option<f64> {
        let place = phi / TAU * ANGLES as f64;
        let angle = (place as usize).min(ANGLES - 1);
        let share = self.angles[angle];
        let within = place - angle as f64;
        let (before, after) = (self.angles[(angle + ANGLES - 1) % ANGLES], self.angles[(angle + 1) % ANGLES]);
        let is_in = if before >= after { within < share } else { within > 1.0 - share };
        (share > 0.0 && is_in).then_some(self.chips[angle])
    }
}

/// The angles between which some slice cuts a chip: all but the widest gap. rad
fn angles(slices: &[Slice]) -> [f64; 2] {
    let step = TAU / ANGLES as f64;
    let thickest = slices.iter().flat_map(|slice| slice.chips).fold(0.0, f64::max);
    let mut covered = [0.0_f64; ANGLES];
    for slice in slices {
        for ((own, other), chip) in covered.iter_mut().zip(&slice.angles).zip(&slice.chips) {
            if *chip >= LEAST_CHIP * thickest {
                *own = own.max(*other);
            }
        }
    }
    let is_open = |angle: usize| covered[angle % ANGLES] == 0.0;
    let gap = |from: usize| (from..from + ANGLES).take_while(|angle| is_open(*angle)).count();
    let starts = (0..ANGLES).filter(|angle| is_open(*angle) && !is_open(angle + ANGLES - 1));
    let widest = starts.map(|from| (gap(from), from)).max_by_key(|(wide, from)| (*wide, ANGLES - from));
    let Some((wide, from)) = widest else { return [0.0, TAU] };
    let first = (from + wide) % ANGLES;
    let last = (from + ANGLES - 1) % ANGLES;
    let entry = (first as f64 + 1.0 - covered[first].min(1.0)) * step;
    let mut exit = (last as f64 + covered[last].min(1.0)) * step;
    if exit < entry {
        exit += TAU;
    }
    [entry, exit]
}

/// Tells the angle of a direction without an arc tangent: by a table over the way around a square.
#[derive(Debug, Clone)]
struct AngleTable(Vec<u8>);

/// Entries of the table for each side.
const SIDE: usize = 512;

impl AngleTable {
    fn new() -> Self {
        let number = |entry: usize| {
            let at = (entry as f64 + 0.5) / SIDE as f64;
            let (side, along) = (at.floor(), at - at.floor());
            let (sine, cosine) = match side as usize {
                0 => (along, 1.0 - along),
                1 => (1.0 - along, -along),
                2 => (-along, along - 1.0),
                _ => (along - 1.0, along),
            };
            let phi = libm::atan2(sine, cosine).rem_euclid(TAU);
            ((phi / TAU * ANGLES as f64) as usize).min(ANGLES - 1) as u8
        };
        Self((0..4 * SIDE).map(number).collect())
    }

    /// The number of the angle of a direction.
    fn of(&self, sine: f64, cosine: f64) -> usize {
        let sum = sine.abs() + cosine.abs();
        if sum == 0.0 {
            return 0;
        }
        let along = match (sine >= 0.0, cosine >= 0.0) {
            (true, true) => sine / sum,
            (true, false) => 1.0 - cosine / sum,
            (false, false) => 2.0 - sine / sum,
            (false, true) => 3.0 + cosine / sum,
        };
        usize::from(self.0[((along * SIDE as f64) as usize).min(4 * SIDE - 1)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_angles_is_the_arc_tangent_but_at_the_ends_of_an_angle() {
        let table = AngleTable::new();
        for k in 0..7200 {
            let phi = (f64::from(k) + 0.5) / 7200.0 * TAU;
            let place = phi / TAU * ANGLES as f64;
            let (sine, cosine) = libm::sincos(phi);
            let found = table.of(sine * 0.7, cosine * 0.7);
            let is_near_an_end = (place - place.round()).abs() < 0.05;
            assert!(found == place as usize || is_near_an_end, "{phi} {found}");
        }
        assert_eq!(table.of(0.0, 0.0), 0);
    }
}
