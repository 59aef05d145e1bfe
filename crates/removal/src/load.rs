//! The load at a point of a path, and what is cut there.

use stead_model::task::Wrench;

/// Mean load over a turn at a point of the path, at the programmed feed, and what is cut there. In the workpiece frame,
/// moments about the tool centre point. In air by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
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
}

/// What is removed in one place, or the sums of it about a node of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sums {
    /// Removed volume. m3
    pub volume: f64,
    /// The part of the mean force that grows with the feed, and of its moment about the tool centre point, integrated
    /// over the path. N m, N m2
    pub chip: Wrench,
    /// The part of the edges.
    pub edge: Wrench,
    /// Lowest and highest height that cuts. m
    pub heights: [f64; 2],
    /// Thickest chip. m
    pub thickest: f64,
}

impl Default for Sums {
    fn default() -> Self {
        let [chip, edge] = [Wrench::default(); 2];
        Self { volume: 0.0, chip, edge, heights: [f64::INFINITY, f64::NEG_INFINITY], thickest: 0.0 }
    }
}

impl Sums {
    /// Adds a share of other sums.
    pub fn add(&mut self, other: &Self, share: f64) {
        self.volume += other.volume * share;
        self.chip.force += other.chip.force * share;
        self.chip.moment += other.chip.moment * share;
        self.edge.force += other.edge.force * share;
        self.edge.moment += other.edge.moment * share;
        self.heights = [self.heights[0].min(other.heights[0]), self.heights[1].max(other.heights[1])];
        self.thickest = self.thickest.max(other.thickest);
    }
}
