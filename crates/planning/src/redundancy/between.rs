//! What the points between two knots add to the cost, for each change of beta over the run.
//!
//! Scores between values of the grid are interpolated linearly; a value beside a state that is not allowed is not
//! allowed.

use stead_model::robot::PostureClass;
use stead_numerics::simd::{Instructions, Lanes, Simd, WithSimd};
use stead_problem::criterion::Aggregate;
use stead_problem::evaluate::batch::KernelNumber;
use stead_problem::sense::Sense;

/// Beta values nearer to the grid than this are on it. Steps of the grid
const ON_GRID: f64 = 1e-9;

/// How costs are joined.
#[derive(Debug, Clone, Copy)]
pub(super) struct Joining {
    /// Whether costs are minimised or maximised.
    pub sense: Sense,
    /// How the costs of points make up that of a path.
    pub aggregate: Aggregate,
}

impl Joining {
    /// Two signed costs together, infinite where one of them is.
    #[inline(always)]
    fn join<S: Simd>(self, simd: S, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
        match (self.aggregate, self.sense) {
            (Aggregate::Mean | Aggregate::Rms, _) => a + b,
            (Aggregate::Max, Sense::Min) => a.max(b),
            (Aggregate::Max, Sense::Max) => {
                let infinity = Lanes::splat(simd, f64::INFINITY);
                (a.less(infinity) & b.less(infinity)).select(a.min(b), infinity)
            }
        }
    }
}

/// The costs of one posture class over the run so far: a row over beta at its end for each change.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between<'s, E> {
    costs: &'s [E],
    stride: usize,
    /// The smallest change.
    min: i32,
    joining: Joining,
}

impl<'s, E> Between<'s, E> {
    /// The row for the shift to a predecessor.
    #[inline(always)]
    pub fn row(&self, shift: isize) -> &'s [E] {
        let number = (-shift - self.min as isize) as usize;
        &self.costs[number * self.stride..][..self.stride]
    }

    /// Two costs together.
    #[inline(always)]
    pub fn join<S: Simd>(&self, simd: S, a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
        self.joining.join(simd, a, b)
    }
}

/// Room for the costs of four posture classes.
#[derive(Debug, Clone)]
pub(super) struct RunCosts<E> {
    data: Vec<E>,
    changes: usize,
    stride: usize,
    instructions: Instructions,
}

impl<E: KernelNumber> RunCosts<E> {
    /// For so many changes, and rows as long as those of the states.
    pub fn new(changes: usize, stride: usize, instructions: Instructions) -> Self {
        Self { data: vec![E::of(0.0); 4 * changes * stride], changes, stride, instructions }
    }

    /// The costs of a class for changes from `min` upwards.
    pub fn of(&self, class: PostureClass, min: i32, joining: Joining) -> Between<'_, E> {
        let size = self.changes * self.stride;
        Between { costs: &self.data[class.index() * size..][..size], stride: self.stride, min, joining }
    }

    /// Adds a point's scores, with beta beside that at the end of the run by `offsets`.
    pub fn add(
        &mut self,
        class: PostureClass,
        row: CyclicRow<'_, E>,
        offsets: impl Iterator<Item = f64>,
        is_first: bool,
        joining: Joining,
    ) {
        let size = self.changes * self.stride;
        let rows = self.data[class.index() * size..][..size].chunks_exact_mut(self.stride);
        for (costs, offset) in rows.zip(offsets) {
            self.instructions.run(Add { costs, row, offset, is_first, joining });
        }
    }
}

/// Scores over beta, continued cyclically by `pad` values on both sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct CyclicRow<'s, E> {
    pub scores: &'s [E],
    pub pad: usize,
}

struct Add<'s, E> {
    costs: &'s mut [E],
    row: CyclicRow<'s, E>,
    offset: f64,
    is_first: bool,
    joining: Joining,
}

impl<E: KernelNumber> WithSimd for Add<'_, E> {
    type Number = E;
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd<Number = E>>(self, simd: S) {
        let Self { costs, row: CyclicRow { scores, pad }, offset, is_first, joining } = self;
        let floor = (offset + ON_GRID).floor();
        let part = offset - floor;
        let (here, there) = (Lanes::splat(simd, 1.0 - part), Lanes::splat(simd, part));
        let infinity = Lanes::splat(simd, f64::INFINITY);
        let shift = floor as isize;
        let lanes = Lanes::<S>::COUNT;
        // The rows end with room for a batch of lanes that runs over.
        let count = scores.len() - 2 * pad - lanes;
        for start in (pad..pad + count).step_by(lanes) {
            let place = start.wrapping_add_signed(shift);
            let score = Lanes::load(simd, scores, place);
            let score = match part <= ON_GRID {
                true => score,
                false => score * here + Lanes::load(simd, scores, place + 1) * there,
            };
            let own = match joining.sense {
                Sense::Min => score,
                Sense::Max => score.less(infinity).select(-score, infinity),
            };
            let sum = if is_first { own } else { joining.join(simd, Lanes::load(simd, costs, start), own) };
            sum.store(costs, start);
        }
    }
}
