//! Which cells of heading are still of interest.

/// Which cells of heading are still of interest: for each point and class ranges of neighbouring cells.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ActiveCells {
    /// Level of the table whose cells they are.
    pub level: usize,
    count: usize,
    /// Where the ranges of each point and class end; those of the next begin there.
    ends: Vec<u32>,
    /// The first cell of each range, and that after its last.
    ranges: Vec<[u16; 2]>,
}

impl ActiveCells {
    /// All cells of the coarsest level, `count` in a turn.
    pub fn full(points: usize, count: usize) -> Self {
        let ranges = vec![[0, count as u16]; 4 * points];
        Self { level: 0, count, ends: (1..=4 * points as u32).collect(), ranges }
    }

    /// Those of a level with `count` cells in a turn: growing ones of each point, class by class.
    pub fn of<'a>(level: usize, count: usize, lists: impl Iterator<Item = &'a [u16]>) -> Self {
        let mut out = Self { level, count, ends: Vec::with_capacity(lists.size_hint().0), ranges: Vec::new() };
        for cells in lists {
            let start = out.ranges.len();
            for cell in cells {
                match out.ranges[start..].last_mut() {
                    Some(range) if range[1] == *cell => range[1] += 1,
                    _ => out.ranges.push([*cell, cell + 1]),
                }
            }
            out.ends.push(out.ranges.len() as u32);
        }
        out
    }

    pub fn cells(&self, point: usize, class: usize) -> impl Iterator<Item = u16> + '_ {
        let place = 4 * point + class;
        let start = if place == 0 { 0 } else { self.ends[place - 1] };
        self.ranges[start as usize..self.ends[place] as usize].iter().flat_map(|[from, to]| *from..*to)
    }

    /// The same with cells half as wide.
    pub fn halved(&self) -> Self {
        let ranges = self.ranges.iter().map(|range| range.map(|cell| 2 * cell)).collect();
        Self { level: self.level + 1, count: self.count * 2, ends: self.ends.clone(), ranges }
    }

    /// What it takes. bytes
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.ends.as_slice()) + size_of_val(self.ranges.as_slice())) as u64
    }

    /// Cells in a turn.
    pub fn count(&self) -> usize {
        self.count
    }
}
