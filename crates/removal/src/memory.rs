//! What the lines of a stock take of the memory, before they are made.

use crate::cutting::Tool;
use crate::error::ForcesError;
use crate::lattice::{TILE, TileKey, tiles, tiles_within};
use crate::load::Sums;
use crate::moves::{PathMoves, window_for};
use crate::operation::{ForcesProblem, Operation};
use crate::reach::{Reach, Size};
use crate::tile::Tile;
use crate::turn::Turn;
use nalgebra::Vector3;
use std::collections::HashSet;

/// Coarser cells, over the diameter of the widest cutter, say nothing of a cut.
const COARSEST: f64 = 4.0;
/// How far above the smallest cell that fits is one that is named.
const NEAR: f64 = 1.01;
/// A tile with its place in the tree. bytes
const TILE_BYTES: usize = (TILE * TILE) as usize * size_of::<[u32; 4]>() + size_of::<(TileKey, Tile)>();
/// A node of the sums, of two runs, and one of the turns. bytes
const NODE_BYTES: [usize; 2] = [2 * size_of::<Sums>(), size_of::<Turn>()];

/// Refuses cells whose lines and sums would not fit into the memory.
pub fn check(problem: &ForcesProblem, extent: &[Vector3<f64>; 2], cell: f64) -> Result<(), ForcesError> {
    let operations = || problem.before.iter().chain([&problem.operation]);
    let paths: Vec<([Option<Size>; 2], PathMoves)> =
        operations().map(|operation| moves(operation, extent, cell)).collect();
    let allowed = problem.memory;
    let needed = |cell: f64, allowed: f64| bytes(&paths, extent, cell, allowed);
    if needed(cell, allowed).is_some() {
        return Ok(());
    }
    let widest = operations().map(|operation| operation.mill.cutter.diameter()).fold(0.0, f64::max);
    let coarsest = cell.max(widest / COARSEST);
    let fits = needed(coarsest, allowed).map(|_| {
        let (mut low, mut high) = (cell, coarsest);
        while high > low * NEAR {
            let middle = (low * high).sqrt();
            *(if needed(middle, allowed).is_some() { &mut high } else { &mut low }) = middle;
        }
        // Up, to a figure that can be typed.
        (high * 1e6).ceil() / 1e6
    });
    let known = fits.unwrap_or(coarsest);
    let of_known = needed(known, f64::INFINITY).unwrap_or(f64::INFINITY);
    // What is finer takes tiles with its square.
    let needed = (of_known * (known / cell).powi(2)).max(allowed);
    Err(ForcesError::Memory { cell, needed, allowed, fits })
}

/// The moves of an operation with the sizes of its cutter and of its holder.
fn moves(operation: &Operation, extent: &[Vector3<f64>; 2], cell: f64) -> ([Option<Size>; 2], PathMoves) {
    let tool = Tool::new(&operation.mill, (extent[1] - extent[0]).norm());
    let sizes = [&tool.pieces, &tool.holder].map(|pieces| (!pieces.is_empty()).then(|| Size::of(pieces)));
    (sizes, PathMoves::new(operation, window_for(cell)))
}

/// What tiles and nodes take, where it is no more than allowed. bytes
fn bytes(paths: &[([Option<Size>; 2], PathMoves)], extent: &[Vector3<f64>; 2], cell: f64, allowed: f64) -> Option<f64> {
    let nodes = paths.last().map_or([0, 0], |(_, path)| path.counts);
    let mut bytes = nodes.iter().zip(NODE_BYTES).map(|(count, bytes)| (count * bytes) as f64).sum::<f64>();
    let mut met: HashSet<TileKey> = HashSet::new();
    for (sizes, path) in paths {
        let mut last = None;
        for one in &path.moves {
            let reaches = sizes.iter().flatten().map(|size| one.reach(size, extent)).filter(|reach| !reach.is_empty());
            let Some(Reach(whole)) = reaches.reduce(|a, b| a.with(&b)) else { continue };
            // Most moves meet the tiles of the one before.
            let of_sides = whole.map(|side| tiles(side, cell));
            if last.as_ref() == Some(&of_sides) {
                continue;
            }
            for key in tiles_within(&whole, cell) {
                if met.insert(key) {
                    bytes += TILE_BYTES as f64;
                }
                if bytes > allowed {
                    return None;
                }
            }
            last = Some(of_sides);
        }
    }
    (bytes <= allowed).then_some(bytes)
}
