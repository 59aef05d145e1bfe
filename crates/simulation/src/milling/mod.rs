//! Milling force from the actual chip thickness at every tooth and slice.
//!
//! The cutter is cut into slices along its axis. In every slice a tooth at psi (0 towards the wall, a quarter turn
//! along the feed) cuts what its ray has of the work between the surface left by earlier teeth and its own edge, h
//! thick. The force on the tool is the sum over slices dz and teeth of
//!
//! `h dz [K_t cos psi - K_r sin psi, K_t sin psi + K_r cos psi, K_a]`
//!
//! in down milling, where psi falls; in up milling K_t has the other sign. Frame: x along the feed, y along the outward
//! normal of the wall, z along the tool axis from the work to the spindle. (UMONS paper, eq. 13 and 14, with db = dz;
//! its tables print F_x and -F_y.)

mod limit;
#[cfg(test)]
mod tests;

pub use limit::{Limit, Limits};

use super::surface::{LANES, Node, Passes, Predecessor, Rays, Stock, ToothQuery, Trail, starts};
use std::f64::consts::TAU;
use stead_model::cutting::{Coefficients, CutError, Cutter, PassCut};
use stead_numerics::simd::{Instructions, Lanes, Simd, WithSimd};

/// Turns in a stretch of the trail.
const STRETCH: usize = 6;

/// Material removal in progress: the cutter, and the workpiece as it has cut it so far.
#[derive(Debug, Clone)]
pub struct MaterialRemoval {
    teeth: Vec<Edge>,
    /// Sine and cosine of each slice's lag, in the sense in which psi changes. Bundles are filled up with slices that
    /// cut nothing.
    lags: Vec<[[f64; LANES]; 2]>,
    /// Slices in the last bundle.
    rest: usize,
    stock: Stock,
    trail: Trail,
    passes: Passes,
    coefficients: Coefficients,
    slice: f64,
    slices: usize,
    largest: f64,
    smallest: f64,
    /// The farthest that the centre came along the feed in a turn. m
    advance: f64,
    sense: f64,
    turn: f64,
    instructions: Instructions,
}

/// A moment of which the chips are asked, with the widest instructions of the processor.
struct Moment<'a> {
    removal: &'a mut MaterialRemoval,
    time: f64,
    centre: [f64; 2],
}

impl WithSimd for Moment<'_> {
    type Number = f64;
    type Output = Chips;

    #[inline(always)]
    fn with_simd<S: Simd<Number = f64>>(self, simd: S) -> Chips {
        self.removal.chips(simd, self.time, self.centre)
    }
}

/// A tooth and those that pass before it.
#[derive(Debug, Clone)]
struct Edge {
    offset: f64,
    radius: f64,
    predecessors: Vec<Predecessor>,
    /// Sine and cosine of psi at its tip at each step of a turn.
    turn: Vec<[f64; 2]>,
}

/// The force at one moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Force {
    /// On the tool: feed, outward normal of the wall, tool axis. N
    pub on_tool: [f64; 3],
    /// The thickest chip. m
    pub chip: f64,
}

/// Sums over slices: h cos psi, h sin psi, h, and the largest h.
#[derive(Debug, Clone, Copy, Default)]
struct Chips {
    cosine: [f64; LANES],
    sine: [f64; LANES],
    sum: [f64; LANES],
    thickest: [f64; LANES],
}

impl MaterialRemoval {
    /// Before the first contact.
    ///
    /// # Errors
    /// [`CutError`] if the cutter cannot do the cut.
    #[cfg(test)]
    pub fn new(cutter: &Cutter, cut: &PassCut) -> Result<Self, CutError> {
        Self::with_room(cutter, cut, 0)
    }

    /// The same with room for a number of steps.
    ///
    /// # Errors
    /// [`CutError`] if the cutter cannot do the cut.
    pub fn with_room(cutter: &Cutter, cut: &PassCut, steps: usize) -> Result<Self, CutError> {
        cut.check(cutter)?;
        if cutter.coefficients().has_edge_forces() {
            return Err(CutError::EdgeForces);
        }
        let sense = cut.section.sense();
        let slice = cut.section.axial_depth / cut.slices as f64;
        let lags = (0..cut.slices.div_ceil(LANES)).map(|bundle| {
            let [mut sines, mut cosines] = [[0.0; LANES]; 2];
            for lane in 0..LANES {
                let height = ((bundle * LANES + lane) as f64 + 0.5) * slice;
                (sines[lane], cosines[lane]) = libm::sincos(sense * cutter.lag(height.min(cut.section.axial_depth)));
            }
            [sines, cosines]
        });
        let top = if cut.section.is_slot(cutter) { f64::INFINITY } else { cut.section.radial_depth };
        Ok(Self {
            teeth: edges(cutter, cut),
            lags: lags.collect(),
            rest: (cut.slices - 1) % LANES + 1,
            stock: Stock { length: cut.length, top },
            trail: Trail::with_room(steps, STRETCH * cut.steps_per_turn),
            passes: Passes::default(),
            coefficients: cutter.coefficients(),
            slice,
            slices: cut.slices,
            largest: cutter.largest_radius(),
            smallest: cutter.smallest_radius(),
            advance: 0.0,
            sense,
            turn: cut.steps_per_turn as f64,
            instructions: Instructions::best(),
        })
    }

    /// The force at a time (in steps) with the tool centre at a place (m), in the work left by what was
    /// [remembered](Self::remember).
    pub fn force(&mut self, time: f64, centre: [f64; 2]) -> Force {
        let chips = self.instructions.run(Moment { removal: self, time, centre });
        let sum = |parts: [f64; LANES]| parts.iter().sum::<f64>() * self.slice;
        let (cosines, sines) = (sum(chips.cosine), sum(chips.sine));
        let Coefficients { tangential, radial, axial, .. } = self.coefficients;
        let tangential = -self.sense * tangential;
        let on_tool =
            [tangential * cosines - radial * sines, tangential * sines + radial * cosines, axial * sum(chips.sum)];
        Force { on_tool, chip: chips.thickest.iter().fold(0.0, |thickest, &chip| chip.max(thickest)) }
    }

    /// The chips of all teeth: the same to the last bit with any instructions of the processor, since nothing is fused
    /// or reordered.
    #[inline(always)]
    fn chips<S: Simd<Number = f64>>(&mut self, simd: S, time: f64, centre: [f64; 2]) -> Chips {
        let mut chips = Chips::default();
        let ledge = self.ledge();
        let last = self.lags.len() - 1;
        for edge in &self.teeth {
            let tip = edge.tip(time, self.turn, self.sense);
            let query = ToothQuery {
                trail: &self.trail,
                predecessors: &edge.predecessors,
                largest: self.largest,
                turn: self.turn,
                time,
                centre,
                steps_per_radian: self.sense * self.turn / TAU,
            };
            self.passes.reset();
            for (bundle, lags) in self.lags.iter().enumerate() {
                let mut rays = Rays::lagging(simd, tip, lags);
                if !rays.enter(simd, &self.stock, centre, edge.radius, ledge) {
                    continue;
                }
                if bundle == last {
                    rays.to[self.rest..].fill(-1.0);
                }
                self.passes.clear(simd, &query, &mut rays);
                chips.add(simd, &rays);
            }
        }
        chips
    }

    /// Above this height nothing is left behind the tool centre: every place there was passed, within an advance, by an
    /// edge at its lowest, and up to the top of the work by an edge at its highest. Infinite where work may have been
    /// left above the tool, as in a slot, and if the tool did not come from outside the work. m
    fn ledge(&self) -> f64 {
        match (self.trail.nodes().first(), self.trail.extents().last()) {
            (Some(first), Some(extent)) if first.place[0] < -self.largest => {
                let cleared = self.smallest - self.advance * self.advance / self.smallest;
                if self.stock.top <= extent.bottom + cleared { extent.top - cleared } else { f64::INFINITY }
            }
            _ => f64::INFINITY,
        }
    }

    /// Where the tool centre is at the end of the next step, the first time at step 0: what it swept is gone. The tool
    /// has to be outside the work in its first turn: passes within a radian of the start are not known.
    pub fn remember(&mut self, node: Node) {
        let nodes = self.trail.nodes();
        if let Some(before) = nodes.len().checked_sub(self.turn as usize).and_then(|index| nodes.get(index)) {
            self.advance = self.advance.max((node.place[0] - before.place[0]).abs());
        }
        self.trail.push(node);
    }

    /// By how much the force may change with the place of the tool, at most: all teeth in the work over the whole
    /// depth. N/m
    pub fn stiffness(&self) -> f64 {
        let Coefficients { tangential, radial, .. } = self.coefficients;
        (tangential.abs() + radial.abs()) * self.slice * self.slices as f64 * self.teeth.len() as f64
    }

    /// The way of the tool centre, when all is done.
    pub fn into_trail(self) -> Trail {
        self.trail
    }

    /// The way of the tool centre so far.
    #[cfg(test)]
    pub fn trail(&self) -> &Trail {
        &self.trail
    }
}

fn edges(cutter: &Cutter, cut: &PassCut) -> Vec<Edge> {
    let teeth = cutter.teeth();
    let (turn, sense) = (cut.steps_per_turn as f64, cut.section.sense());
    let edges = cutter.offsets().into_iter().enumerate().map(|(own, offset)| {
        let mut delay = 0.0;
        let predecessors = (0..teeth.len()).map(|back| {
            let [follower, tooth] = [back, back + 1].map(|back| teeth[(own + 2 * teeth.len() - back) % teeth.len()]);
            delay += follower.pitch / TAU * turn;
            Predecessor { delay, spacing: tooth.pitch / TAU * turn, radius: tooth.radius }
        });
        let steps = (0..cut.steps_per_turn).map(|step| psi(step as f64, turn, sense, offset));
        Edge { offset, radius: teeth[own].radius, predecessors: predecessors.collect(), turn: steps.collect() }
    });
    edges.collect()
}

/// Sine and cosine of a tip's psi at a time within the first turn, in steps.
fn psi(time: f64, turn: f64, sense: f64, offset: f64) -> [f64; 2] {
    let (sine, cosine) = libm::sincos(sense * (time / turn * TAU - offset));
    [sine, cosine]
}

impl Edge {
    /// Sine and cosine of psi at its tip at a time, in steps.
    #[inline(always)]
    fn tip(&self, time: f64, turn: f64, sense: f64) -> [f64; 2] {
        let within = time - (time / turn).floor() * turn;
        let step = within as i64;
        match self.turn.get(step as usize) {
            Some(tip) if step as f64 == within => *tip,
            _ => psi(within, turn, sense, self.offset),
        }
    }
}

impl Chips {
    #[inline(always)]
    fn add<S: Simd<Number = f64>>(&mut self, simd: S, rays: &Rays) {
        for start in starts::<S>() {
            let chip = Lanes::load(simd, &rays.to, start) - Lanes::load(simd, &rays.from, start);
            let chip = chip.max(chip.all(0.0));
            add(simd, chip * Lanes::load(simd, &rays.cosine, start), &mut self.cosine, start);
            add(simd, chip * Lanes::load(simd, &rays.sine, start), &mut self.sine, start);
            add(simd, chip, &mut self.sum, start);
            Lanes::load(simd, &self.thickest, start).max(chip).store(&mut self.thickest, start);
        }
    }
}

#[inline(always)]
fn add<S: Simd<Number = f64>>(simd: S, parts: Lanes<S>, sums: &mut [f64; LANES], start: usize) {
    (Lanes::load(simd, sums, start) + parts).store(sums, start);
}
