//! Moves through the stock, line by line: what each removes, and the mean force that this takes.
//!
//! A surface element dA of the cutter at the radius r is passed by a tooth once in `2 pi / N`, and what flows through
//! it in a turn is the volume that it removes. So the mean force over a turn is a sum over the removed volume dV, and
//! nothing has to be decided about engagement (tooth law as in [`Coefficients`](stead_model::cutting::Coefficients); n
//! out of the cutter, t along the motion of the tooth, s = t x n up its edge):
//!
//! ```text
//! F_chip = f_rev / ds  sum dV (-K_r n - K_t t + K_a s) / (2 pi r)
//! F_edge = N / ds      sum dV / (n . u) (-K_re n - K_te t) / (2 pi r)
//! ```
//!
//! with f_rev the feed per turn, ds the length of path and u the displacement of the surface point per length of path.
//! A bit of line along an axis counts with the square of the normal's part along it: the weights of the three grids add
//! up to one.

use crate::cutting::Tool;
use crate::job::Job;
use crate::lattice::{self, TILE, TileKey, others};
use crate::moves::PathMoves;
use crate::quadrature::Quadrature;
use crate::reach::Size;
use crate::solid_lines::{Body, origin, tile_of};
use crate::sums::{Found, Requested};
use crate::tile::{NANO, Tile};
use crate::turn::{Arcs, Turn, TurnGrid};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::collections::BTreeMap;
use stead_numerics::monitor::{Monitor, Progress, Stop};

/// Moves that all tiles go through before the next ones.
const CHUNK: usize = 4096;
/// Tiles by thread that are cut before their sums are added up, so that few of them are held.
const BATCH: usize = 8;
/// Nodes of turns that they reach over, at most.
const CHUNK_TURNS: f64 = 128.0;

/// The stock while it is cut.
#[derive(Debug, Clone)]
pub struct Workpiece {
    /// The stock before.
    pub body: Body,
    part: Option<Body>,
    /// Distance of neighbouring lines. m
    pub cell: f64,
    tiles: BTreeMap<TileKey, Tile>,
}

impl Workpiece {
    /// Stock that is not cut yet, by lines at a distance (m), with the finished part that may be in it.
    pub fn new(body: Body, part: Option<Body>, cell: f64) -> Self {
        Self { body, part, cell, tiles: BTreeMap::new() }
    }

    /// Goes through moves one after the other. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// A stop that the monitor asks for.
    pub fn cut(
        &mut self,
        tool: &Tool,
        path: &PathMoves,
        requested: Requested,
        stage: &'static str,
        monitor: &Monitor,
    ) -> Result<Found, Stop> {
        let moves = &path.moves;
        let mut found = Found::empty(path.counts, requested);
        let quadrature = Quadrature::default();
        let [size, of_holder] = [&tool.pieces, &tool.holder].map(|pieces| Size::of(pieces));
        let grid = TurnGrid::new(tool, self.cell);
        let mut open: BTreeMap<u32, Arcs> = BTreeMap::new();
        let mut start = 0;
        while start < moves.len() {
            monitor.go_on()?;
            let most = (start + CHUNK).min(moves.len());
            let far = moves[start].turns[0] + CHUNK_TURNS;
            let end = (start + 1..most).find(|next| moves[*next].turns[1] > far).unwrap_or(most);
            let chunk = &moves[start..end];
            let reaches = |size: &Size| chunk.iter().map(|one| one.reach(size, &self.body.extent)).collect();
            let job = Job {
                tool,
                moves: chunk,
                reaches: reaches(&size),
                held: if tool.holder.is_empty() { Vec::new() } else { reaches(&of_holder) },
                stock: &self.body,
                part: self.part.as_ref(),
                cell: self.cell,
                quadrature: &quadrature,
                requested,
                grid: &grid,
            };
            let met = job.tiles_met();
            // A chunk of few moves may meet many tiles: of it as many moves count as done as of its tiles are.
            let mut known = 0;
            for batch in met.chunks(BATCH * rayon::current_num_threads()) {
                monitor.go_on()?;
                let done = start + (end - start) * known / met.len();
                monitor.report(Progress::Steps { stage, done, total: moves.len() });
                known += batch.len();
                for of_tile in job.cut_all(batch, &mut self.tiles) {
                    of_tile.add_to(&mut found, &mut open);
                }
            }
            let still = moves.get(end).map_or(u32::MAX, |next| next.turns[0].floor() as u32);
            let later = open.split_off(&still);
            let ended: Vec<(u32, Turn)> = std::mem::replace(&mut open, later)
                .into_par_iter()
                .map(|(node, arcs)| (node, grid.turn(tool, &arcs, path, node as usize)))
                .collect();
            for (node, turn) in ended {
                found.turns[node as usize] = turn;
            }
            start = end;
        }
        Ok(found)
    }

    /// The lines of a tile before they are cut.
    fn whole(&self, key: TileKey) -> Tile {
        tile_of(&self.body, &self.body.extent, self.cell, key)
    }

    /// What is removed, by the lines along each axis (m3), and how many of them have lost something.
    pub fn removed(&self) -> [(usize, f64); 3] {
        let mut removed = [(0, 0.0); 3];
        for (key, tile) in &self.tiles {
            let whole = self.whole(*key);
            let (count, volume) = &mut removed[key.0];
            for line in 0..(TILE * TILE) as usize {
                let lost = whole.length(line) - tile.length(line);
                *count += usize::from(lost > 0.0);
                *volume += lost / NANO * self.cell * self.cell;
            }
        }
        removed
    }

    /// The share of lines whose surface is no body's, and where one of them runs.
    pub fn unsound(&self) -> Option<(f64, Vector3<f64>)> {
        let of_tile = |(key, tile): (&TileKey, &Tile)| tile.unsound.first().map(|line| (*key, *line));
        let (key, line) = self.tiles.iter().find_map(of_tile)?;
        let count: usize = self.tiles.values().map(|tile| tile.unsound.len()).sum();
        let all = self.tiles.len() as f64 * (TILE * TILE) as f64;
        Some((count as f64 / all, origin(&self.body.extent, self.cell, key, line)))
    }

    /// Tiles that were met.
    #[cfg(test)]
    pub fn tile_count(&self) -> usize {
        self.tiles.len()
    }

    /// What is left of the line of the lattice nearest to a place, along an axis: intervals (m). Tiles that are not cut
    /// are made once for lines that are asked for in rows.
    pub fn left_of(&self, axis: usize, at: &Vector3<f64>, made: &mut BTreeMap<TileKey, Tile>) -> Vec<[f64; 2]> {
        let [a, b] = others(axis);
        let (x, y) = (at[a] / self.cell, at[b] / self.cell);
        let (i, j) = lattice::nearest(x, y);
        let key = (axis, i.div_euclid(TILE), j.div_euclid(TILE));
        let line = (i.rem_euclid(TILE) * TILE + j.rem_euclid(TILE)) as usize;
        let low = self.body.extent[0][axis];
        let metres = |[from, to]: [u32; 2]| [low + f64::from(from) / NANO, low + f64::from(to) / NANO];
        if let Some(tile) = self.tiles.get(&key) {
            return tile.intervals(line).map(metres).collect();
        }
        if !self.body.is_by_tile() {
            let o = origin(&self.body.extent, self.cell, key, line);
            return self.body.line(key, &o).intervals.into_iter().map(|ends| ends.map(|end| low + end)).collect();
        }
        made.retain(|(of, row, _), _| *of == axis && (row - key.1).abs() <= 1);
        made.entry(key).or_insert_with(|| self.whole(key)).intervals(line).map(metres).collect()
    }
}
