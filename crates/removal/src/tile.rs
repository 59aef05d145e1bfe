//! What is left of the lines of a tile.

use crate::lattice::TILE;
use std::collections::BTreeMap;

/// Nanometres in a metre: ends of intervals are whole numbers, so that comparisons are exact.
pub const NANO: f64 = 1e9;

/// A length (m) in whole nanometres.
pub fn nanometres(length: f64) -> u32 {
    (length * NANO).round().clamp(0.0, f64::from(u32::MAX)) as u32
}

/// What is removed and no longer than this is not told, and what is left and no longer is nothing: it is rounding. nm
const SLIVER: u32 = 10;

/// Ascending intervals of each line, in nanometres from the lower end of the stock.
#[derive(Debug, Clone)]
pub struct Tile {
    /// Two intervals for each line, without length where there is none.
    lines: Vec<[u32; 4]>,
    /// The others, where there are more.
    more: BTreeMap<usize, Vec<[u32; 2]>>,
    /// Lines of the tile whose intervals are not sound.
    pub unsound: Vec<usize>,
}

impl Tile {
    /// All lines alike, from 0 to a length.
    pub fn full(length: u32) -> Self {
        Self { lines: vec![[0, length, 0, 0]; (TILE * TILE) as usize], more: BTreeMap::new(), unsound: Vec::new() }
    }

    /// Nothing.
    pub fn empty() -> Self {
        Self::full(0)
    }

    /// The intervals of a line.
    pub fn intervals(&self, line: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
        let [a, b, c, d] = self.lines[line];
        let more = self.more.get(&line).into_iter().flatten().copied();
        [[a, b], [c, d]].into_iter().chain(more).filter(|[from, to]| to > from)
    }

    /// Sets the intervals of a line.
    pub fn set(&mut self, line: usize, intervals: &[[u32; 2]]) {
        let at = |k: usize| intervals.get(k).copied().unwrap_or_default();
        let ([a, b], [c, d]) = (at(0), at(1));
        self.lines[line] = [a, b, c, d];
        if intervals.len() > 2 {
            self.more.insert(line, intervals[2..].to_vec());
        } else if !self.more.is_empty() {
            self.more.remove(&line);
        }
    }

    /// Whether something is left of a line within an interval.
    pub fn meets(&self, line: usize, span: [u32; 2]) -> bool {
        let is_met = |from: u32, to: u32| to.min(span[1]) > from.max(span[0]);
        let [a, b, c, d] = self.lines[line];
        is_met(a, b)
            || is_met(c, d)
            || !self.more.is_empty()
                && self.more.get(&line).is_some_and(|more| more.iter().any(|[from, to]| is_met(*from, *to)))
    }

    /// Removes an interval from a line; what it removes is added to a list, but for slivers. Those are removed all the
    /// same, so that what is left does not depend on the steps in which it is reached.
    pub fn remove(&mut self, line: usize, span: [u32; 2], removed: &mut Vec<[u32; 2]>) {
        if !self.meets(line, span) {
            return;
        }
        let mut left: [[u32; 2]; 2] = Default::default();
        let (mut count, mut more) = (0, Vec::new());
        let mut keep = |from: u32, to: u32| {
            if to > from.saturating_add(SLIVER) {
                match left.get_mut(count) {
                    Some(place) => *place = [from, to],
                    None => more.push([from, to]),
                }
                count += 1;
            }
        };
        for [from, to] in self.intervals(line) {
            let (start, end) = (from.max(span[0]), to.min(span[1]));
            if end <= start {
                keep(from, to);
                continue;
            }
            if end > start.saturating_add(SLIVER) {
                removed.push([start, end]);
            }
            keep(from, start);
            keep(end, to);
        }
        let [[a, b], [c, d]] = left;
        self.lines[line] = [a, b, c, d];
        if !more.is_empty() {
            self.more.insert(line, more);
        } else if !self.more.is_empty() {
            self.more.remove(&line);
        }
    }

    /// What is left of a line. nm
    pub fn length(&self, line: usize) -> f64 {
        self.intervals(line).map(|[from, to]| f64::from(to - from)).sum()
    }
}
