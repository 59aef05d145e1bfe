//! What a pass remembers of the ways to its states.

use stead_model::robot::PostureClass;
use stead_problem::evaluate::batch::{KernelNumber, StateGrid};

/// The ways by which states were reached, and the costs from which they can be found again.
#[derive(Debug, Clone)]
pub(super) struct Record<E = f64> {
    pub count: usize,
    /// Number of steps whose ways are kept.
    pub block: usize,
    /// For each step of a block and each class the shifts to the predecessors, over beta.
    pub ways: Vec<i16>,
    /// For the first point of each block and each class the costs over beta; nothing of segments of one block.
    pub costs: Vec<E>,
    /// For each knot of the segment last gone through and each class the costs over beta up to there; nothing of long
    /// segments.
    pub reached: Vec<E>,
    /// Whether these are kept of the segment that is gone through.
    pub keeps_reached: bool,
    /// For each knot and each class whether the shift to the predecessor is left to be found again from them.
    pub without_way: Vec<bool>,
}

/// Costs of all knots are kept of segments with no more numbers than this.
const MAX_REACHED: usize = 1 << 21;

/// Segments whose ways take no more numbers than this are kept whole.
const MAX_WAYS: usize = 1 << 25;

impl<E: KernelNumber> Record<E> {
    /// For segments of up to `longest` points with `count` values of beta.
    pub fn new(longest: usize, count: usize) -> Self {
        Self::with_capacity_of(longest, count, MAX_WAYS)
    }

    /// The same with at most so many numbers kept, if a block may be that short.
    pub fn with_capacity_of(longest: usize, count: usize, max_numbers: usize) -> Self {
        let block = (max_numbers / (4 * count)).max(longest.isqrt()).max(1).min(longest.max(1));
        Self {
            count,
            block,
            ways: vec![0; block * 4 * count],
            costs: Vec::new(),
            reached: Vec::new(),
            keeps_reached: false,
            without_way: Vec::new(),
        }
    }

    /// Begins a segment of so many knots, or one of which nothing is to be found again.
    pub fn begin(&mut self, knots: Option<usize>) {
        self.costs.clear();
        self.reached.clear();
        self.without_way.clear();
        self.keeps_reached = knots.is_some_and(|knots| knots * 4 * self.count <= MAX_REACHED);
    }

    /// The row for the way to the point at `place` of its segment.
    pub fn way(&mut self, place: usize, class: PostureClass) -> &mut [i16] {
        let row = place.wrapping_sub(1) % self.block;
        &mut self.ways[(row * 4 + class.index()) * self.count..][..self.count]
    }

    /// Leaves the way to a knot to be found again from the costs up to the one before.
    pub fn leave_way(&mut self, knot: usize, class: PostureClass) {
        let place = knot * 4 + class.index();
        self.without_way.resize(self.without_way.len().max(place + 1), false);
        self.without_way[place] = true;
    }

    /// Whether the way to a knot is kept.
    pub fn has_way(&self, knot: usize, class: PostureClass) -> bool {
        self.without_way.get(knot * 4 + class.index()) != Some(&true)
    }

    /// Whether a block begins at this place of a segment of `length` points.
    pub fn begins(&self, place: usize, length: usize) -> bool {
        length > self.block + 1 && place.is_multiple_of(self.block)
    }

    /// Adds the costs of all classes at a knot.
    pub fn keep(costs: &mut Vec<E>, states: &StateGrid<E>) {
        for class in PostureClass::ALL {
            if states.is_alive(class) {
                costs.extend_from_slice(states.inner_scores(class));
            } else {
                costs.resize(costs.len() + states.count(), E::of(f64::INFINITY));
            }
        }
    }

    /// The costs over beta of a class up to a knot, without regard to flips and turns, where they are kept: signed,
    /// infinite where a state is not reached.
    pub fn reached(&self, knot: usize, class: PostureClass) -> Option<&[E]> {
        self.reached.get((knot * 4 + class.index()) * self.count..)?.get(..self.count)
    }

    /// The costs at the beginning of a block.
    pub fn kept(&self, block: usize, class: PostureClass) -> &[E] {
        &self.costs[(block * 4 + class.index()) * self.count..][..self.count]
    }
}
