//! Cells of the place of the tool centre point, each cut into eight: what the score of a point there is at least,
//! whatever the turn of the spindle.
//!
//! A cell begins with the turns of the cell that it is part of, with what is known of them there. Those that make the
//! bound low are evaluated again over the smaller cell and half the turn, until that no longer changes the bound: most
//! turns never are.

use super::super::arm::Arm;
use super::super::interval_simd::WIDTH;
use super::super::kind::Kind;
use super::super::minorant::{Affine, EMPTY, ZERO, rounded};
use super::states::{Known, known_over};
use std::f64::consts::PI;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use stead_model::robot::PostureClass;

/// Half width of the largest cells (m), and ranges of the turn there. Cells of a level are half as wide as those of the
/// level before, and so are its ranges.
pub(super) const LARGEST: f64 = 0.05;
const TURNS: usize = 64;
/// Levels of cells.
pub(super) const LEVELS: usize = 8;

/// One tool axis: the arm with it, kinds of load, and the cells.
#[derive(Debug)]
pub(super) struct Cells {
    arm: Arm,
    /// Compliance of joint 1. rad/(N m)
    first: f64,
    kinds: Vec<Kind>,
    /// The corner of the least x, y and z. m
    corner: [f64; 3],
    counts: [usize; 3],
    largest: Vec<Cell>,
    /// What was made so far takes. bytes
    made: AtomicU64,
}

#[derive(Debug, Default)]
struct Cell {
    classes: [OnceLock<Box<Made>>; 4],
    parts: OnceLock<Box<[Cell; 8]>>,
}

/// What is known of a cell in one posture class.
#[derive(Debug)]
struct Made {
    /// Below the score of each kind of load, whatever the turn.
    below: Box<[Affine]>,
    /// Which of the turns of the cell that it is part of were evaluated again, in their order.
    replaced: Box<[u32]>,
    /// Those in their place, and what each kind of load costs there: below all of the cell.
    turns: Box<[Turn]>,
    of_turns: Box<[Affine]>,
}

/// A range of the turn: the level whose width it has, and its number.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    level: u8,
    number: u16,
}

/// A range of the turn in a cell that is being made.
struct Candidate {
    turn: Turn,
    /// Its number among the turns of the cell that this one is part of; `None` once evaluated here.
    inherited: Option<u32>,
}

/// Turns of a cell, and of each and each kind of load the value in the middle of the cell and slopes.
#[derive(Default)]
struct Candidates {
    turns: Vec<Candidate>,
    of: Vec<(f64, [f64; 3])>,
}

impl Turn {
    /// Middle and half width. rad
    fn range(self) -> (f64, f64) {
        let half = PI / (TURNS << self.level) as f64;
        (half * (2 * usize::from(self.number) + 1) as f64, half)
    }

    fn halves(self) -> [Self; 2] {
        [0, 1].map(|k| Self { level: self.level + 1, number: 2 * self.number + k })
    }
}

/// Half the width of the cells of a level. m
pub(super) fn half_of(level: usize) -> f64 {
    LARGEST / (1u64 << level) as f64
}

impl Cells {
    /// For tool centre points up to a radius, between two heights (m).
    pub fn new(arm: Arm, first: f64, kinds: Vec<Kind>, radius: f64, height: (f64, f64)) -> Self {
        let corner = [-radius, -radius, height.0];
        let counts = [2.0 * radius, 2.0 * radius, height.1 - height.0].map(|w| (w / (2.0 * LARGEST)) as usize + 1);
        let largest: Vec<Cell> = std::iter::repeat_with(Cell::default).take(counts.iter().product()).collect();
        let made = AtomicU64::new(size_of_val(largest.as_slice()) as u64);
        Self { arm, first, kinds, corner, counts, largest, made }
    }

    /// What cells of that extent take while nothing is known of them. bytes
    pub fn bytes(radius: f64, height: (f64, f64)) -> u64 {
        // In f64: a cell may be so large that whole numbers overflow.
        let along = |width: f64| (width / (2.0 * LARGEST)).floor() + 1.0;
        (along(2.0 * radius).powi(2) * along(height.1 - height.0) * size_of::<Cell>() as f64) as u64
    }

    /// What was made so far takes. bytes
    pub fn used(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// The numbers of the cells of a level along one side that hold anything between two places (m).
    pub fn between(&self, level: usize, side: usize, from: f64, to: f64) -> (usize, usize) {
        let last = (self.counts[side] << level) - 1;
        let number = |at: f64| (((at - self.corner[side]) / (2.0 * half_of(level))).max(0.0) as usize).min(last);
        (number(from), number(to))
    }

    /// The middle of a cell along one side. m
    pub fn middle(&self, level: usize, side: usize, number: usize) -> f64 {
        self.corner[side] + half_of(level) * (2 * number + 1) as f64
    }

    /// Below the score of each kind of load in a cell, about its middle, in one class.
    pub fn below(&self, level: usize, at: [usize; 3], class: PostureClass) -> &[Affine] {
        let [i, j, k] = at.map(|number| number >> level);
        let mut cell = &self.largest[(i * self.counts[1] + j) * self.counts[2] + k];
        let mut path: [Option<&Made>; LEVELS] = [None; LEVELS];
        for depth in 0..=level {
            let here = at.map(|number| number >> (level - depth));
            if depth > 0 {
                let parts = cell.parts.get_or_init(|| {
                    self.made.fetch_add(size_of::<[Cell; 8]>() as u64, Ordering::Relaxed);
                    Box::default()
                });
                cell = &parts[(here[0] & 1) << 2 | (here[1] & 1) << 1 | here[2] & 1];
            }
            let made = cell.classes[class.index()].get_or_init(|| self.made_of(&path[..depth], here, class));
            path[depth] = Some(made);
        }
        path[level].map_or(&[], |made| &made.below)
    }

    /// What is known of a cell of the level after those of `path`, the cells that it is part of.
    fn made_of(&self, path: &[Option<&Made>], at: [usize; 3], class: PostureClass) -> Box<Made> {
        let level = path.len();
        let middle: [f64; 3] = std::array::from_fn(|side| self.middle(level, side, at[side]));
        let half = half_of(level);
        let mut all = Candidates::default();
        if level == 0 {
            for first in (0..TURNS).step_by(WIDTH) {
                let turns: [Turn; WIDTH] = std::array::from_fn(|k| Turn { level: 0, number: (first + k) as u16 });
                self.evaluate(&mut all, &turns, middle, half, class);
            }
        } else {
            all = self.inherited(path, at, middle);
            let mut kind = 0;
            while kind < self.kinds.len() {
                let low = all.lowest(kind, self.kinds.len(), half, level);
                if low.is_empty() {
                    kind += 1;
                    continue;
                }
                let turns = low.iter().flat_map(|k| all.turns[*k].turn.halves());
                let mut four = [None; WIDTH];
                four.iter_mut().zip(turns).for_each(|(to, turn)| *to = Some(turn));
                // From the back, so that the first number stays what it is.
                let mut numbers = low;
                numbers.sort_unstable_by(|a, b| b.cmp(a));
                numbers.iter().for_each(|number| all.remove(*number, self.kinds.len()));
                let turns: Vec<Turn> = four.into_iter().flatten().collect();
                self.evaluate(&mut all, &turns, middle, half, class);
            }
        }
        self.finish(all, path, half)
    }

    /// Evaluates ranges of the turn over a cell: four at most.
    fn evaluate(&self, all: &mut Candidates, turns: &[Turn], middle: [f64; 3], half: f64, class: PostureClass) {
        let Some(last) = turns.last() else { return };
        // Ranges evaluated together may differ in width: those of the same width each time.
        for width in turns.iter().map(|turn| turn.level).fold(Vec::new(), |mut all: Vec<u8>, level| {
            if !all.contains(&level) {
                all.push(level);
            }
            all
        }) {
            let some: Vec<Turn> = turns.iter().copied().filter(|turn| turn.level == width).collect();
            let place = std::array::from_fn(|k| {
                let turn = some.get(k).unwrap_or(last);
                [middle[0], middle[1], middle[2], turn.range().0]
            });
            let half = [half, half, half, some[0].range().1];
            let known = known_over((&self.arm, self.first), &place, half, class);
            for (turn, known) in some.iter().zip(known) {
                let of = |kind: &Kind| match &known {
                    Known::Yields(states) => states.below(kind, half),
                    _ => ZERO,
                };
                if known != Known::Empty {
                    all.turns.push(Candidate { turn: *turn, inherited: None });
                    let wide = |e: Affine| (f64::from(e.value), e.slope.map(f64::from));
                    all.of.extend(self.kinds.iter().map(|kind| wide(of(kind))));
                }
            }
        }
    }

    /// The turns of the cell that this one is part of.
    fn inherited(&self, path: &[Option<&Made>], at: [usize; 3], middle: [f64; 3]) -> Candidates {
        let kinds = self.kinds.len();
        let level = path.len();
        // Of each cell on the way down: whose turns are left.
        let mut left: Vec<(usize, usize)> = Vec::new();
        for (depth, made) in path.iter().enumerate() {
            let Some(made) = made else { continue };
            let mut replaced = made.replaced.iter().peekable();
            let mut number = 0;
            left.retain(|_| {
                let is_replaced = replaced.next_if(|k| **k == number).is_some();
                number += 1;
                !is_replaced
            });
            left.extend((0..made.turns.len()).map(|k| (depth, k)));
        }
        let mut all = Candidates::default();
        for (number, (depth, k)) in left.into_iter().enumerate() {
            let Some(made) = path[depth] else { continue };
            let own = at.map(|number| number >> (level - depth));
            let off: [f64; 3] = std::array::from_fn(|side| middle[side] - self.middle(depth, side, own[side]));
            all.turns.push(Candidate { turn: made.turns[k], inherited: Some(number as u32) });
            for e in &made.of_turns[k * kinds..(k + 1) * kinds] {
                let slope = e.slope.map(f64::from);
                let moved: f64 = (0..3).map(|side| slope[side] * off[side]).sum();
                all.of.push((f64::from(e.value) + moved, slope));
            }
        }
        all
    }

    fn finish(&self, all: Candidates, path: &[Option<&Made>], half: f64) -> Box<Made> {
        let kinds = self.kinds.len();
        let below: Box<[Affine]> = (0..kinds).map(|kind| all.below(kind, kinds, half)).collect();
        // Inherited turns that are no longer there, in their order.
        let mut is_left = vec![false; Self::count(path)];
        all.turns.iter().filter_map(|candidate| candidate.inherited).for_each(|k| is_left[k as usize] = true);
        let replaced = (0..is_left.len() as u32).filter(|k| !is_left[*k as usize]).collect();
        let own = || all.turns.iter().enumerate().filter(|(_, candidate)| candidate.inherited.is_none());
        let turns = own().map(|(_, candidate)| candidate.turn).collect();
        let narrow = |(value, slope): &(f64, [f64; 3])| Affine { value: *value as f32, slope: slope.map(|s| s as f32) };
        let of_turns = own().flat_map(|(k, _)| all.of[k * kinds..(k + 1) * kinds].iter().map(narrow)).collect();
        let made = Box::new(Made { below, replaced, turns, of_turns });
        let bytes = size_of::<Made>()
            + size_of_val(&*made.below)
            + size_of_val(&*made.replaced)
            + size_of_val(&*made.turns)
            + size_of_val(&*made.of_turns);
        self.made.fetch_add(bytes as u64, Ordering::Relaxed);
        made
    }

    /// Turns that a cell after those of `path` begins with.
    fn count(path: &[Option<&Made>]) -> usize {
        path.iter().flatten().fold(0, |count, made| count - made.replaced.len() + made.turns.len())
    }
}

impl Candidates {
    fn remove(&mut self, number: usize, kinds: usize) {
        self.turns.swap_remove(number);
        let last = self.of.len() - kinds;
        for kind in 0..kinds {
            self.of.swap(number * kinds + kind, last + kind);
        }
        self.of.truncate(last);
    }

    /// Of one kind of load the number of the turn that costs least, and for each turn what is left of it where slopes
    /// are those of that one.
    fn least(&self, kind: usize, kinds: usize, half: f64) -> Option<(usize, [f64; 3])> {
        let of = |number: usize| self.of[number * kinds + kind];
        let low = |number: usize| {
            let (value, slope) = of(number);
            value - slope.iter().map(|s| s.abs() * half).sum::<f64>()
        };
        let numbers = 0..self.turns.len();
        let least = numbers.map(|number| (number, low(number))).min_by(|a, b| a.1.total_cmp(&b.1))?.0;
        Some((least, of(least).1))
    }

    /// What is left of a turn where slopes are these.
    fn left(&self, place: usize, slope: [f64; 3], half: f64) -> f64 {
        let (value, own) = self.of[place];
        value - (0..3).map(|k| (own[k] - slope[k]).abs() * half).sum::<f64>()
    }

    /// One or two turns that keep the bound of a kind of load low and were not evaluated in this cell with its width.
    fn lowest(&self, kind: usize, kinds: usize, half: f64, level: usize) -> Vec<usize> {
        let Some((least, slope)) = self.least(kind, kinds, half) else { return Vec::new() };
        let is_open = |number: usize| {
            let Candidate { turn, inherited } = &self.turns[number];
            inherited.is_some() || usize::from(turn.level) < level
        };
        let left = |number: usize| self.left(number * kinds + kind, slope, half);
        let bound = (0..self.turns.len()).map(left).fold(f64::INFINITY, f64::min);
        let is_low = |number: usize| number == least || left(number) <= bound;
        if !(0..self.turns.len()).any(|number| is_low(number) && is_open(number)) {
            return Vec::new();
        }
        let mut open: Vec<usize> = (0..self.turns.len()).filter(|number| is_open(*number)).collect();
        let rank = |number: &usize| (!is_low(*number), left(*number));
        open.sort_by(|a, b| rank(a).0.cmp(&rank(b).0).then(rank(a).1.total_cmp(&rank(b).1)));
        open.truncate(2);
        open
    }

    /// Below all turns for one kind of load.
    fn below(&self, kind: usize, kinds: usize, half: f64) -> Affine {
        let Some((_, slope)) = self.least(kind, kinds, half) else { return EMPTY };
        let value = (0..self.turns.len()).map(|number| self.left(number * kinds + kind, slope, half));
        rounded(value.fold(f64::INFINITY, f64::min), slope, [half; 3])
    }
}
