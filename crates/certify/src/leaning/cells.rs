//! Cells of the place of the tool centre point, each cut into eight: what the score of a point there is at least,
//! whatever the turn of the spindle.
//!
//! What is known of a cell is known piece by piece: boxes of the place and a range of the turn. A cell begins with the
//! pieces of the cell that it is part of. Those that make the bound low are cut up where they bend most, until they are
//! good enough for the size of the cell: most pieces never are.

use super::super::arm::Arm;
use super::super::cell::Extent;
use super::super::interval_simd::WIDTH;
use super::super::kind::Kind;
use super::super::minorant::{Affine, EMPTY, rounded};
use super::super::number::LEANING;
use super::piece::{LARGEST, Piece, TURNS, half_of};
use super::states::{Below, Known, TURN, known_over};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use stead_model::robot::PostureClass;

/// Levels of cells.
pub(super) const LEVELS: usize = 8;
/// Levels on which what costs enough is not cut up further.
const COARSE: usize = 2;
/// Pieces cut up for one cell.
const CUTS: usize = 400;

/// One tool axis: the arm with it, kinds of load, and the cells.
#[derive(Debug)]
pub(super) struct Cells {
    pub arm: Arm,
    kinds: Vec<Kind>,
    /// What a load of size 1 costs where most placements are of no interest: more need not be known at first. m
    enough: f64,
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
    /// Which of the pieces that the cell began with were cut up.
    replaced: Box<[u32]>,
    /// What they were cut into, and what each kind of load costs there, about the middle of each piece.
    pieces: Box<[Piece]>,
    of_pieces: Box<[Affine]>,
}

/// A piece of a cell that is being made.
struct Candidate {
    piece: Piece,
    /// Its number among the pieces that the cell began with; `None` of one evaluated for this cell.
    inherited: Option<u32>,
    /// The middle of what it shares with the cell from the middle of the cell, and half widths of that. m
    off: [f64; 3],
    half: [f64; 3],
}

/// Pieces of a cell; of each and each kind of load the value in the middle of what it shares with the cell, and slopes.
struct Candidates {
    /// The number of kinds.
    kinds: usize,
    all: Vec<Candidate>,
    of: Vec<(f64, [f64; 3])>,
}

impl Cells {
    /// For tool centre points up to a radius, between two heights (m).
    pub fn new(arm: Arm, kinds: Vec<Kind>, enough: f64, radius: f64, height: (f64, f64)) -> Self {
        let corner = [-radius, -radius, height.0];
        let counts = [2.0 * radius, 2.0 * radius, height.1 - height.0].map(|w| (w / (2.0 * LARGEST)) as usize + 1);
        let largest: Vec<Cell> = std::iter::repeat_with(Cell::default).take(counts.iter().product()).collect();
        let made = AtomicU64::new(size_of_val(largest.as_slice()) as u64);
        Self { arm, kinds, enough, corner, counts, largest, made }
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

    /// The middle of a piece along one of the variables. m, rad
    fn middle_of(&self, piece: &Piece, k: usize) -> f64 {
        let from = if k == TURN { 0.0 } else { self.corner[k] };
        from + piece.half(k) * f64::from(2 * u32::from(piece.number[k]) + 1)
    }

    /// Below the score of each kind of load in a cell, about its middle, in one class.
    pub fn below(&self, level: usize, at: [usize; 3], class: PostureClass) -> &[Affine] {
        self.path(level, at, class)[level].map_or(&[], |made| &made.below)
    }

    /// What is known of a cell in one class, and before it of the cells that it is part of, the largest first.
    fn path(&self, level: usize, at: [usize; 3], class: PostureClass) -> [Option<&Made>; LEVELS] {
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
        path
    }

    /// The pieces in an eighth of a cell in one class: middles and half widths of each.
    pub fn pieces(
        &self,
        level: usize,
        at: [usize; 3],
        class: PostureClass,
    ) -> impl Iterator<Item = ([f64; LEANING], [f64; LEANING])> {
        let path = self.path(level, at, class);
        let all = self.inherited(&path[..=level], at.map(|number| 2 * number)).all;
        let region = |piece: Piece| std::array::from_fn(|k| (self.middle_of(&piece, k), piece.half(k)));
        all.into_iter().map(move |one| {
            let sides: [(f64, f64); LEANING] = region(one.piece);
            (sides.map(|side| side.0), sides.map(|side| side.1))
        })
    }

    /// What is known of a cell of the level after those of `path`, the cells that it is part of.
    fn made_of(&self, path: &[Option<&Made>], at: [usize; 3], class: PostureClass) -> Box<Made> {
        let (level, kinds) = (path.len(), self.kinds.len());
        let mut all = self.inherited(path, at);
        let begun = all.all.len();
        if level == 0 {
            let whole = Piece {
                level: [0; LEANING],
                number: [at[0] as u16, at[1] as u16, at[2] as u16, 0],
                order: [0, 1, 2, 3],
                share: 1.0,
                sure: false,
            };
            for first in (0..TURNS).step_by(WIDTH) {
                let mut pieces = [whole; WIDTH];
                pieces.iter_mut().enumerate().for_each(|(k, piece)| piece.number[TURN] = (first + k) as u16);
                self.evaluate(&mut all, &pieces, level, at, class);
            }
        }
        let (mut cuts, enough) = (0, if level < COARSE { self.enough } else { f64::INFINITY });
        for kind in 0..kinds {
            while let Some(number) = all.to_cut(kind, level, enough).filter(|_| cuts < CUTS) {
                cuts += 1;
                let piece = all.all[number].piece.within(level, at);
                all.remove(number);
                self.evaluate(&mut all, &piece.cut(level), level, at, class);
            }
        }
        self.finish(&all, begun, half_of(level))
    }

    /// Evaluates four pieces of the same size for a cell of a level; what is not allowed anywhere is left out, and so
    /// are repetitions.
    fn evaluate(
        &self,
        all: &mut Candidates,
        pieces: &[Piece; WIDTH],
        level: usize,
        at: [usize; 3],
        class: PostureClass,
    ) {
        let place = pieces.map(|piece| std::array::from_fn(|k| self.middle_of(&piece, k)));
        let half: [f64; LEANING] = std::array::from_fn(|k| pieces[0].half(k));
        let known = known_over(&self.arm, &place, half, class);
        for (k, (piece, known)) in pieces.iter().zip(known).enumerate() {
            if known == Known::Empty || pieces[..k].contains(piece) {
                continue;
            }
            let mut piece = Piece { share: 0.0, sure: false, ..*piece };
            let mut bends = half;
            let first = self.kinds.len() * all.all.len();
            for kind in &self.kinds {
                let below = match &known {
                    Known::Yields(states) => states.below(kind, half),
                    _ => Below::NOTHING,
                };
                piece.share = piece.share.max(below.share);
                if let Known::Yields(states) = &known {
                    (piece.sure, bends) = (states.sure, states.bends);
                    bends[TURN] += below.turning;
                }
                let Affine { value, slope } = below.affine;
                all.of.push((f64::from(value), slope.map(f64::from)));
            }
            debug_assert_eq!(all.of.len() - first, self.kinds.len());
            piece.order.sort_by(|a, b| bends[usize::from(*b)].total_cmp(&bends[usize::from(*a)]));
            all.push(piece, None, self, level, at);
        }
    }

    /// The pieces of the cell that this one is part of.
    fn inherited(&self, path: &[Option<&Made>], at: [usize; 3]) -> Candidates {
        let (level, kinds) = (path.len(), self.kinds.len());
        let mut left: Vec<(&Made, usize)> = Vec::new();
        for (depth, made) in path.iter().enumerate() {
            let Some(made) = made else { continue };
            let here = at.map(|number| number >> (level - depth));
            let mut replaced = made.replaced.iter().peekable();
            let mut number = 0;
            left.retain(|(of, k)| {
                if !of.pieces[*k].meets(depth, here) {
                    return false;
                }
                let is_replaced = replaced.next_if(|k| **k == number).is_some();
                number += 1;
                !is_replaced
            });
            left.extend((0..made.pieces.len()).map(|k| (*made, k)));
        }
        left.retain(|(of, k)| of.pieces[*k].meets(level, at));
        let mut all = Candidates { kinds, all: Vec::new(), of: Vec::new() };
        for (number, (made, k)) in left.into_iter().enumerate() {
            let piece = made.pieces[k];
            let shared = piece.within(level, at);
            let off: [f64; 3] = std::array::from_fn(|k| self.middle_of(&shared, k) - self.middle_of(&piece, k));
            for e in &made.of_pieces[k * kinds..(k + 1) * kinds] {
                let slope = e.slope.map(f64::from);
                let moved: f64 = (0..3).map(|side| slope[side] * off[side]).sum();
                all.of.push((f64::from(e.value) + moved, slope));
            }
            all.push(piece, Some(number as u32), self, level, at);
        }
        all
    }

    /// `begun` is the number of pieces that the cell began with.
    fn finish(&self, all: &Candidates, begun: usize, half: f64) -> Box<Made> {
        let kinds = self.kinds.len();
        let below: Box<[Affine]> = (0..kinds).map(|kind| all.below(kind, half)).collect();
        let mut is_left = vec![false; begun];
        all.all.iter().filter_map(|candidate| candidate.inherited).for_each(|k| is_left[k as usize] = true);
        let replaced = (0..begun as u32).filter(|k| !is_left[*k as usize]).collect();
        let own = || all.all.iter().enumerate().filter(|(_, candidate)| candidate.inherited.is_none());
        let pieces = own().map(|(_, candidate)| candidate.piece).collect();
        let narrow = |(value, slope): &(f64, [f64; 3])| Affine { value: *value as f32, slope: slope.map(|s| s as f32) };
        let of_pieces = own().flat_map(|(k, _)| all.of[k * kinds..(k + 1) * kinds].iter().map(narrow)).collect();
        let made = Box::new(Made { below, replaced, pieces, of_pieces });
        let bytes = size_of::<Made>()
            + size_of_val(&*made.below)
            + size_of_val(&*made.replaced)
            + size_of_val(&*made.pieces)
            + size_of_val(&*made.of_pieces);
        self.made.fetch_add(bytes as u64, Ordering::Relaxed);
        made
    }
}

/// What cells take for so many tool axes while nothing is known of them. bytes
pub(in super::super) fn bytes(extent: Extent, axes: usize) -> u64 {
    // In f64: a cell may be so large that whole numbers overflow.
    let along = |width: f64| (width / (2.0 * LARGEST)).floor() + 1.0;
    let height = extent.height.1 - extent.height.0;
    let one = (along(2.0 * extent.radius.1).powi(2) * along(height) * size_of::<Cell>() as f64) as u64;
    one.saturating_mul(axes as u64)
}

impl Candidates {
    /// A piece for a cell; its bounds are in `of` already.
    fn push(&mut self, piece: Piece, inherited: Option<u32>, cells: &Cells, level: usize, at: [usize; 3]) {
        let shared = piece.within(level, at);
        let off = std::array::from_fn(|k| cells.middle_of(&shared, k) - cells.middle(level, k, at[k]));
        let half = std::array::from_fn(|k| shared.half(k));
        self.all.push(Candidate { piece, inherited, off, half });
    }

    fn remove(&mut self, number: usize) {
        let kinds = self.kinds;
        self.all.swap_remove(number);
        let last = self.of.len() - kinds;
        for kind in 0..kinds {
            self.of.swap(number * kinds + kind, last + kind);
        }
        self.of.truncate(last);
    }

    /// The piece that costs least under one kind of load, and how little that is.
    fn least(&self, kind: usize) -> Option<(usize, f64)> {
        let low = |number: usize| {
            let ((value, slope), half) = (self.of[number * self.kinds + kind], self.all[number].half);
            value - (0..3).map(|k| slope[k].abs() * half[k]).sum::<f64>()
        };
        let all = (0..self.all.len()).map(|number| (number, low(number)));
        all.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// What a function with these slopes may be in the middle of the cell, not to be above a piece anywhere in it.
    fn left(&self, number: usize, kind: usize, slope: [f64; 3]) -> f64 {
        let ((value, own), Candidate { off, half, .. }) = (self.of[number * self.kinds + kind], &self.all[number]);
        value - (0..3).map(|k| (own[k] - slope[k]).abs() * half[k] + slope[k] * off[k]).sum::<f64>()
    }

    /// The piece that limits the bound of a kind of load with slopes like these.
    fn limiting(&self, kind: usize, slope: [f64; 3]) -> Option<(usize, f64)> {
        let all = (0..self.all.len()).map(|number| (number, self.left(number, kind, slope)));
        all.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// A piece that keeps the bound of a kind of load below `enough`, and is not good enough for cells of this level.
    fn to_cut(&self, kind: usize, level: usize, enough: f64) -> Option<usize> {
        let (least, _) = self.least(kind).filter(|least| least.1 < enough)?;
        let is_open = |number: &usize| !self.all[*number].piece.is_fine(level);
        let limiting = || self.limiting(kind, self.of[least * self.kinds + kind].1).map(|found| found.0);
        Some(least).filter(is_open).or_else(|| limiting().filter(is_open))
    }

    /// Below all pieces for one kind of load.
    fn below(&self, kind: usize, half: f64) -> Affine {
        let Some((least, _)) = self.least(kind) else { return EMPTY };
        let slope = self.of[least * self.kinds + kind].1;
        let value = self.limiting(kind, slope).map_or(f64::INFINITY, |found| found.1);
        rounded(value, slope, [half; 3])
    }
}
