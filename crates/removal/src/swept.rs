//! Stock from the path: what a cutter sweeps on its scored moves, less what a smaller one would.

use crate::cutting::Tool;
use crate::lattice::{TILE, TileKey, TileLines, by_tile};
use crate::moves::{Move, MoveKind, PathMoves, has_wall};
use crate::operation::{Operation, PathStock};
use crate::piece::Piece;
use crate::profile::Profile;
use crate::reach::{Reach, Size};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Intervals that are no farther apart are one: rounding. m
const TOGETHER: f64 = 1e-8;
/// Any window: what is asked for are the moves.
const WINDOW: f64 = 1e-3;

/// What the stock of a path is made of.
#[derive(Debug, Clone)]
pub struct Swept {
    added: Arc<Sweep>,
    /// What the operation before has taken.
    taken: Option<Arc<Sweep>>,
    /// m
    pub extent: [Vector3<f64>; 2],
}

/// Moves of a cutter, and which of them the lines of a tile can meet.
#[derive(Debug)]
struct Sweep {
    pieces: Vec<Piece>,
    moves: Vec<Move>,
    reaches: Vec<Reach>,
    by_tile: BTreeMap<TileKey, Vec<u32>>,
}

impl Swept {
    /// The stock of the path of an operation, in tiles of cells; nothing where no scored move has a wall.
    pub fn new(operation: &Operation, stock: &PathStock, cell: f64) -> Option<Self> {
        let profile = operation.mill.profile();
        let all = PathMoves::new(operation, WINDOW).moves;
        let feeds = || all.iter().filter(|one| one.kind == MoveKind::Feed);
        let path = &operation.path;
        let is_scored = |one: &&Move| path.is_scored(one.point as usize) && has_wall(path, one.point as usize);
        let scored: Vec<Move> = feeds().filter(is_scored).copied().collect();
        let pieces = profile.below(stock.height(&profile));
        let size = Size::of(&pieces);
        let anywhere = [f64::NEG_INFINITY, f64::INFINITY].map(Vector3::repeat);
        let reaches = scored.iter().map(|one| one.reach(&size, &anywhere));
        let Reach(whole) = reaches.reduce(|a, b| a.with(&b))?;
        let extent = [0, 1].map(|end| Vector3::from(whole.map(|side| side[end])));
        let taken = stock.layer.map(|layer| {
            let height = (extent[1] - extent[0]).norm();
            let pieces = Tool::of_profile(&profile.smaller(layer), &operation.mill, height).pieces;
            let raised = feeds().map(|one| Move { middle: one.middle + one.axis * layer, ..*one }).collect();
            Arc::new(Sweep::new(pieces, raised, &extent, cell))
        });
        Some(Self { added: Arc::new(Sweep::new(pieces, scored, &extent, cell)), taken, extent })
    }

    /// The intervals of all lines of a tile, ascending, from the start of each. m
    pub fn lines(&self, key: TileKey, cell: f64) -> Vec<Vec<[f64; 2]>> {
        let lines = TileLines::new(key, cell, self.extent[0][key.0]);
        let added = self.added.lines(key, &lines);
        let Some(taken) = &self.taken else { return added };
        added.iter().zip(taken.lines(key, &lines)).map(|(added, taken)| less(added, &taken)).collect()
    }

    /// The intervals of a line from `o`. m
    pub fn line(&self, key: TileKey, o: &Vector3<f64>) -> Vec<[f64; 2]> {
        let added = self.added.line(key, o);
        match &self.taken {
            Some(taken) => less(&added, &taken.line(key, o)),
            None => added,
        }
    }
}

impl PathStock {
    /// How high above the tip it goes, where nothing is stated up to the end of the corner, and at least a layer. m
    fn height(&self, profile: &Profile) -> f64 {
        let corner = profile.corner * (1.0 - libm::sin(profile.taper));
        self.depth.unwrap_or(corner.max(self.layer.unwrap_or_default()))
    }
}

impl Sweep {
    fn new(pieces: Vec<Piece>, moves: Vec<Move>, extent: &[Vector3<f64>; 2], cell: f64) -> Self {
        let size = Size::of(&pieces);
        let reaches: Vec<Reach> = moves.iter().map(|one| one.reach(&size, extent)).collect();
        let met = (0..).zip(&reaches).filter(|(_, reach)| !reach.is_empty());
        let by_tile = by_tile(met.map(|(number, reach)| (number, reach.0)), cell);
        Self { pieces, moves, reaches, by_tile }
    }

    fn met(&self, key: TileKey) -> impl Iterator<Item = (&Move, &Reach)> {
        let numbers = self.by_tile.get(&key).into_iter().flatten();
        numbers.map(|number| (&self.moves[*number as usize], &self.reaches[*number as usize]))
    }

    fn lines(&self, key: TileKey, lines: &TileLines) -> Vec<Vec<[f64; 2]>> {
        let d = Vector3::ith(key.0, 1.0);
        let mut all = vec![Vec::new(); (TILE * TILE) as usize];
        for (one, reach) in self.met(key) {
            lines.within(&reach.0, &mut |number, o| {
                if let Some(interval) = one.extent(&self.pieces, o, &d) {
                    put(&mut all[number], interval);
                }
            });
        }
        all.into_iter().map(together).collect()
    }

    fn line(&self, key: TileKey, o: &Vector3<f64>) -> Vec<[f64; 2]> {
        let d = Vector3::ith(key.0, 1.0);
        let mut all = Vec::new();
        for interval in self.met(key).filter_map(|(one, _)| one.extent(&self.pieces, o, &d)) {
            put(&mut all, interval);
        }
        together(all)
    }
}

/// Adds an interval, to the last one where they meet: moves come one after the other.
fn put(all: &mut Vec<[f64; 2]>, span: [f64; 2]) {
    match all.last_mut() {
        Some(last) if span[0] <= last[1] + TOGETHER && span[1] >= last[0] - TOGETHER => {
            *last = [last[0].min(span[0]), last[1].max(span[1])]
        }
        _ => all.push(span),
    }
}

/// Ascending, and those that meet as one.
fn together(mut all: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    all.dedup_by(|next, last| {
        let meets = next[0] <= last[1] + TOGETHER;
        if meets {
            last[1] = last[1].max(next[1]);
        }
        meets
    });
    all
}

/// What is left of ascending intervals where others are taken away.
fn less(all: &[[f64; 2]], taken: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut left = Vec::new();
    for [low, high] in all {
        let mut from = *low;
        for [start, end] in taken.iter().filter(|[start, end]| *end > *low && *start < *high) {
            if *start > from {
                left.push([from, *start]);
            }
            from = from.max(*end);
        }
        if from < *high {
            left.push([from, *high]);
        }
    }
    left
}
