//! What a run through the moves of a path finds: sums of what is removed, and what should not happen.

use crate::load::Sums;
use crate::turn::Turn;
use std::collections::BTreeMap;

/// A cut into the finished part is one from this depth on. m
pub const GOUGE: f64 = 50e-6;

stead_numerics::worded! {
    /// What happens that should not, or that gives no force.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Event {
        /// A rapid move through the stock.
        Rapid = "rapid",
        /// The tool turns in place in the stock.
        InPlace = "in-place",
        /// A segment begins with the cutter in the stock.
        Before = "before",
        /// Something is cut above the flutes.
        AboveFlutes = "above-flutes",
        /// The middle of a cutter that is not centre-cutting is in the stock.
        DeadCentre = "dead-centre",
        /// Shank or holder is in the stock.
        Holder = "holder",
        /// The finished part is cut into.
        Gouge = "gouge",
    }
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
