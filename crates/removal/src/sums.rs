//! What a run through the moves of a path finds: sums of what is removed, and what should not happen.

use crate::cutting::Bit;
use crate::turn::Turn;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// A cut into the finished part is one from this depth on. m
pub const GOUGE: f64 = 50e-6;

/// Sums of what is removed about a node of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sums {
    /// Removed volume. m3
    pub volume: f64,
    /// Integral of the chip part of the mean force over the path. N m
    pub chip_force: Vector3<f64>,
    /// Of its moment about the tool centre point. N m2
    pub chip_moment: Vector3<f64>,
    /// Integral of the edge part of the mean force over the path. N m
    pub edge_force: Vector3<f64>,
    /// Of its moment about the tool centre point. N m2
    pub edge_moment: Vector3<f64>,
    /// Lowest and highest height that cuts. m
    pub heights: [f64; 2],
    /// Thickest chip. m
    pub chip: f64,
}

impl Default for Sums {
    fn default() -> Self {
        let zero = Vector3::zeros();
        Self {
            volume: 0.0,
            chip_force: zero,
            chip_moment: zero,
            edge_force: zero,
            edge_moment: zero,
            heights: [f64::INFINITY, f64::NEG_INFINITY],
            chip: 0.0,
        }
    }
}

impl Sums {
    /// Adds a share of other sums.
    pub fn add(&mut self, other: &Self, share: f64) {
        self.volume += other.volume * share;
        self.chip_force += other.chip_force * share;
        self.chip_moment += other.chip_moment * share;
        self.edge_force += other.edge_force * share;
        self.edge_moment += other.edge_moment * share;
        self.heights = [self.heights[0].min(other.heights[0]), self.heights[1].max(other.heights[1])];
        self.chip = self.chip.max(other.chip);
    }

    /// Those of one bit, with the thickness of its chip (m).
    pub fn of(bit: &Bit, chip: f64) -> Self {
        Self {
            volume: bit.volume,
            chip_force: bit.chip_force,
            chip_moment: bit.chip_moment,
            edge_force: bit.edge_force,
            edge_moment: bit.edge_moment,
            heights: [bit.height; 2],
            chip,
        }
    }
}

/// What happens that should not, or that gives no force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Event {
    /// A rapid move through the stock.
    Rapid,
    /// The tool turns in place in the stock.
    InPlace,
    /// A segment begins with the cutter in the stock.
    Before,
    /// Something is cut above the flutes.
    AboveFlutes,
    /// The middle of a cutter that is not centre-cutting is in the stock.
    DeadCentre,
    /// Shank or holder is in the stock.
    Holder,
    /// The finished part is cut into.
    Gouge,
}

/// Volume (m3) by event and point of the path.
pub type Events = BTreeMap<(Event, u32), f64>;

/// What is requested of a run through the moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Requested {
    /// Only that the stock is cut.
    Removal,
    /// Forces.
    Forces,
    /// Forces, and what goes on in a turn of the spindle.
    Turns,
}

/// What a run through the moves finds.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// By node of the sums.
    pub sums: Vec<Sums>,
    /// By node of the turns.
    pub turns: Vec<Turn>,
    /// What happens that should not.
    pub events: Events,
}

impl Found {
    /// Nothing yet, at so many nodes of the sums and of the turns.
    pub fn empty(counts: [usize; 2], requested: Requested) -> Self {
        let nodes = |number: usize, is_wanted: bool| if is_wanted { counts[number] + 1 } else { 0 };
        Self {
            sums: vec![Sums::default(); nodes(0, requested != Requested::Removal)],
            turns: vec![Turn::default(); nodes(1, requested == Requested::Turns)],
            events: Events::new(),
        }
    }
}
