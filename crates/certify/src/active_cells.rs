//! Which cells of heading are still of interest.

/// Which cells of heading are still of interest: for each point and class one bit a cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ActiveCells {
    /// Level of the table whose cells they are.
    pub level: usize,
    count: usize,
    words: Vec<u64>,
}

impl ActiveCells {
    /// All cells of the coarsest level, `count` in a turn, a multiple of 64.
    pub fn full(points: usize, count: usize) -> Self {
        Self { level: 0, count, words: vec![u64::MAX; points * 4 * (count / 64)] }
    }

    pub fn cells(&self, point: usize, class: usize) -> impl Iterator<Item = usize> + '_ {
        let per = self.count / 64;
        let words = &self.words[(point * 4 + class) * per..][..per];
        words.iter().enumerate().flat_map(|(w, word)| {
            let mut left = *word;
            std::iter::from_fn(move || {
                if left == 0 {
                    return None;
                }
                let bit = left.trailing_zeros() as usize;
                left &= left - 1;
                Some(w * 64 + bit)
            })
        })
    }

    pub fn clear(&mut self, point: usize, class: usize, cell: usize) {
        let per = self.count / 64;
        self.words[(point * 4 + class) * per + cell / 64] &= !(1 << (cell % 64));
    }

    pub fn clear_all(&mut self, point: usize, class: usize) {
        let per = self.count / 64;
        self.words[(point * 4 + class) * per..][..per].fill(0);
    }

    /// The same with cells half as wide.
    pub fn halved(&self) -> Self {
        let spread = |word: u32| (0..32).filter(|bit| word >> bit & 1 == 1).fold(0u64, |out, bit| out | 3 << (2 * bit));
        let words = self.words.iter().flat_map(|w| [spread(*w as u32), spread((*w >> 32) as u32)]).collect();
        Self { level: self.level + 1, count: self.count * 2, words }
    }

    /// What it takes. bytes
    pub fn bytes(&self) -> u64 {
        size_of_val(self.words.as_slice()) as u64
    }

    /// Cells in a turn.
    pub fn count(&self) -> usize {
        self.count
    }
}
