//! Sums at the corners of a box, and the least of neighbouring ones.

use super::cost::CORNERS;
use stead_planning::criterion::Aggregate;

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
pub(super) struct SlidingMin {
    pub out: Vec<[f64; CORNERS]>,
    scratch: Vec<[f64; CORNERS]>,
}

impl SlidingMin {
    pub fn new(count: usize) -> Self {
        Self { out: vec![INFINITE; count], scratch: vec![INFINITE; count] }
    }

    /// Into `out`: for each cell k the least of those from k + low to k + high. By doubling: least of 1, 2, 4 ...
    /// neighbours.
    pub fn compute(&mut self, values: &[[f64; CORNERS]], low: isize, high: isize) {
        let count = values.len();
        let width = ((high - low + 1).max(0) as usize).min(count);
        if width == 0 {
            self.out.fill(INFINITE);
            return;
        }
        self.scratch.copy_from_slice(values);
        let mut size = 1;
        while 2 * size <= width {
            for k in 0..count {
                let mut best = self.scratch[k];
                min_into(&mut best, &self.scratch[(k + size) % count]);
                self.out[k] = best;
            }
            std::mem::swap(&mut self.out, &mut self.scratch);
            size *= 2;
        }
        let shift = low.rem_euclid(count as isize) as usize;
        for k in 0..count {
            let from = (k + shift) % count;
            let mut best = self.scratch[from];
            min_into(&mut best, &self.scratch[(from + width - size) % count]);
            self.out[k] = best;
        }
    }
}
