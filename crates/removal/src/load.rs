//! The load at a point of a path, and what is cut there.

use stead_model::task::Wrench;

/// Mean load over a turn at a point of the path, at the programmed feed, and what is cut there. In the workpiece frame,
/// moments about the tool centre point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointForces {
    /// Whether the point was added between two of the path.
    pub is_added: bool,
    /// The part that grows with the feed. N, N m
    pub chip: Wrench,
    /// The part that does not: of the edges. N, N m
    pub edge: Wrench,
    /// Largest norm of the force over a turn; nothing where nothing is cut. N
    pub largest: f64,
    /// Removed volume over length of path. m2
    pub removed: f64,
    /// Lowest and highest height above the tool centre point that cuts, where something does. m
    pub heights: Option<[f64; 2]>,
    /// The angles of a turn between which a tooth cuts (0 where it moves along the feed, as in
    /// [`Engagement`](stead_model::cutting::Engagement)), where something is cut. rad
    pub angles: Option<[f64; 2]>,
    /// Thickest chip. m
    pub chip_thickness: f64,
}

impl PointForces {
    /// Force and moment at a feed over the programmed one.
    pub fn at_feed(&self, share: f64) -> Wrench {
        Wrench { force: self.chip.force * share + self.edge.force, moment: self.chip.moment * share + self.edge.moment }
    }

    /// In air.
    pub(crate) fn nothing() -> Self {
        Self {
            is_added: false,
            chip: Wrench::zero(),
            edge: Wrench::zero(),
            largest: 0.0,
            removed: 0.0,
            heights: None,
            angles: None,
            chip_thickness: 0.0,
        }
    }
}
