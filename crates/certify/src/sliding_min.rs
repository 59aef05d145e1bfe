//! Sums at the corners of a box, and the least of neighbouring ones.

use super::cost::CORNERS;
use stead_problem::criterion::Aggregate;

/// No way.
pub(super) const INFINITE: [f64; CORNERS] = [f64::INFINITY; CORNERS];

/// Corner by corner the sum.
#[inline]
pub(super) fn plus(a: &[f64; CORNERS], b: &[f64; CORNERS]) -> [f64; CORNERS] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Corner by corner what two parts of a way cost together.
#[inline]
pub(super) fn joined(aggregate: Aggregate, a: &[f64; CORNERS], b: &[f64; CORNERS]) -> [f64; CORNERS] {
    match aggregate {
        Aggregate::Mean | Aggregate::Rms => plus(a, b),
        Aggregate::Max => std::array::from_fn(|k| a[k].max(b[k])),
    }
}

/// Corner by corner the lesser, into the first.
#[inline]
pub(super) fn min_into(a: &mut [f64; CORNERS], b: &[f64; CORNERS]) {
    for k in 0..CORNERS {
        a[k] = if b[k] < a[k] { b[k] } else { a[k] };
    }
}

/// Least values over a range of neighbours, around the circle.
#[derive(Default)]
pub(super) struct SlidingMin {
    /// For each target the least of its neighbours; infinite where it has none.
    pub out: Vec<[f64; CORNERS]>,
    /// The least of the sources from each one on, up to where the window was when this was made.
    onward: Vec<[f64; CORNERS]>,
}

impl SlidingMin {
    /// Into `out`: for each target cell k the least value of the source cells from k + low to k + high, the two of
    /// `steps`, in a circle of `count` cells. Both lists grow.
    ///
    /// The window moves up from target to target, over the sources and then over them again a turn later. It is two
    /// parts: of the one, the least from each source on is kept, of the other, the least of all.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub fn compute(
        &mut self,
        cells: &[u16],
        values: &[[f64; CORNERS]],
        steps: (isize, isize),
        count: usize,
        targets: &[u16],
    ) {
        let ((low, high), number) = (steps, cells.len());
        let width = (high - low + 1).max(0) as usize;
        self.out.clear();
        if number == 0 || width == 0 {
            self.out.resize(targets.len(), INFINITE);
            return;
        }
        if width >= count {
            let least = values.iter().fold(INFINITE, |mut least, value| {
                min_into(&mut least, value);
                least
            });
            self.out.resize(targets.len(), least);
            return;
        }
        self.onward.resize(number, INFINITE);
        let shift = low.rem_euclid(count as isize) as usize;
        // Source number k a turn, or two, later. Numbers grow by one at a time: no division.
        let (mut turn_from, mut turn_to) = (Turn::default(), Turn::default());
        let (mut middle, mut back) = (0, INFINITE);
        for target in targets {
            let from = usize::from(*target) + shift;
            while usize::from(cells[turn_to.at]) + turn_to.turns * count < from + width {
                min_into(&mut back, &values[turn_to.at]);
                turn_to.step(number);
            }
            while turn_from.number < turn_to.number && usize::from(cells[turn_from.at]) + turn_from.turns * count < from
            {
                turn_from.step(number);
            }
            if turn_from.number >= middle {
                // The first part is used up: the second becomes the first.
                (middle, back) = (turn_to.number, INFINITE);
                let mut least = INFINITE;
                let mut at = turn_to.at;
                for _ in turn_from.number..turn_to.number {
                    at = if at == 0 { number - 1 } else { at - 1 };
                    min_into(&mut least, &values[at]);
                    self.onward[at] = least;
                }
            }
            let mut least = back;
            if turn_from.number < middle {
                min_into(&mut least, &self.onward[turn_from.at]);
            }
            self.out.push(least);
        }
    }
}

/// A source of a circle gone through again and again.
#[derive(Default)]
struct Turn {
    /// Sources before it, those of earlier turns included.
    number: usize,
    /// Which source it is.
    at: usize,
    turns: usize,
}

impl Turn {
    fn step(&mut self, sources: usize) {
        (self.number, self.at) = (self.number + 1, self.at + 1);
        if self.at == sources {
            (self.at, self.turns) = (0, self.turns + 1);
        }
    }
}
