//! Moves through the lines of a tile: what each sweeps, and what that adds to the sums.

use crate::cutting::{Moving, Tool};
use crate::lattice::{TileKey, TileLines, by_tile};
use crate::load::Sums;
use crate::moves::{Move, MoveKind};
use crate::quadrature::Quadrature;
use crate::reach::Reach;
use crate::solid_lines::{Body, tile_of};
use crate::sums::{Event, Found, GOUGE, Requested};
use crate::tile::{NANO, Tile, nanometres};
use crate::turn::{Arcs, TurnGrid};
use nalgebra::Vector3;
use rayon::prelude::*;
use std::cell::OnceCell;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

/// Points of a removed piece of a line, over its length in cells.
const POINTS: f64 = 2.5;
/// Points at which a removed piece of a line is looked at for a cut into the finished part.
const GOUGE_POINTS: f64 = 4.0;

/// What all tiles of a chunk have in common.
pub struct Job<'j> {
    pub tool: &'j Tool,
    pub moves: &'j [Move],
    pub reaches: Vec<Reach>,
    /// Of the holder, where there is one.
    pub held: Vec<Reach>,
    pub stock: &'j Body,
    pub part: Option<&'j Body>,
    pub cell: f64,
    pub quadrature: &'j Quadrature,
    pub requested: Requested,
    pub grid: &'j TurnGrid,
}

/// What comes of a tile.
#[derive(Default)]
pub struct OfTile {
    /// By node, which may be there several times.
    pub sums: Vec<(u32, Sums)>,
    pub turns: Vec<(u32, Arcs)>,
    pub events: BTreeMap<(Event, u32), f64>,
}

impl OfTile {
    fn add_event(&mut self, event: Event, one: &Move, volume: f64) {
        *self.events.entry((event, one.point)).or_default() += volume;
    }

    /// Adds it to what is found in all; arcs stay open until their turn has ended.
    pub fn add_to(self, found: &mut Found, open: &mut BTreeMap<u32, Arcs>) {
        for (node, sums) in &self.sums {
            found.sums[*node as usize].add(sums, 1.0);
        }
        for (node, arcs) in self.turns {
            match open.entry(node) {
                Entry::Vacant(place) => _ = place.insert(arcs),
                Entry::Occupied(mut place) => place.get_mut().add(&arcs),
            }
        }
        for (event, volume) in self.events {
            *found.events.entry(event).or_default() += volume;
        }
    }
}

/// What a move adds to the nodes of a tile, from the first that it meets to the last.
struct Window<T> {
    first: u32,
    entries: VecDeque<Option<T>>,
}

/// Entries at the end of a list in which a node is looked for.
const RECENT: usize = 8;

impl<T> Window<T> {
    fn empty() -> Self {
        Self { first: 0, entries: VecDeque::new() }
    }

    fn entry(&mut self, node: u32, new: impl FnOnce() -> T) -> Option<&mut T> {
        if self.entries.is_empty() {
            self.first = node;
        }
        while node < self.first {
            self.entries.push_front(None);
            self.first -= 1;
        }
        let place = (node - self.first) as usize;
        if place >= self.entries.len() {
            self.entries.resize_with(place + 1, || None);
        }
        self.entries.get_mut(place).map(|entry| entry.get_or_insert_with(new))
    }

    /// Moves all to a list by node: moves come back to a node after others, and then it may be there twice.
    fn flush(&mut self, list: &mut Vec<(u32, T)>, add: impl Fn(&mut T, &T)) {
        let found = (self.first..).zip(self.entries.drain(..));
        for (node, entry) in found.filter_map(|(node, entry)| Some((node, entry?))) {
            let from = list.len().saturating_sub(RECENT);
            match list[from..].iter_mut().rev().find(|(known, _)| *known == node) {
                Some((_, own)) => add(own, &entry),
                None => list.push((node, entry)),
            }
        }
    }
}

/// What is counted of a tile, and of the move that goes through it.
struct Counted {
    of_tile: OfTile,
    sums: Window<Sums>,
    turns: Window<Arcs>,
}

/// A tile while moves go through it.
struct Cutting<'t> {
    key: TileKey,
    lines: TileLines,
    tile: &'t mut Tile,
    /// The finished part in the tile, made when something of it is cut for the first time.
    of_part: OnceCell<Tile>,
    /// What is removed of a line, kept for the next. nm
    removed: Vec<[u32; 2]>,
}

/// A removed piece of a line along an axis, by where it begins and ends from the start of the line. m
struct Removed<'o> {
    axis: usize,
    start: &'o Vector3<f64>,
    ends: [f64; 2],
}

impl Removed<'_> {
    fn at(&self, along: f64) -> Vector3<f64> {
        let mut point = *self.start;
        point[self.axis] += along;
        point
    }
}

impl Job<'_> {
    /// The tiles that the moves reach, with the holder too where there is one, each with the numbers of its moves.
    pub fn tiles_met(&self) -> Vec<(TileKey, Vec<u32>)> {
        let whole = |(index, reach): (usize, &Reach)| {
            let held = self.held.get(index).filter(|held| !held.is_empty());
            let whole = held.map_or(*reach, |held| reach.with(held));
            (!whole.is_empty()).then_some((index as u32, whole.0))
        };
        by_tile(self.reaches.iter().enumerate().filter_map(whole), self.cell).into_iter().collect()
    }

    /// Takes moves through tiles, each by itself; those not met before are made.
    pub fn cut_all(&self, met: &[(TileKey, Vec<u32>)], tiles: &mut BTreeMap<TileKey, Tile>) -> Vec<OfTile> {
        let before: Vec<Option<Tile>> = met.iter().map(|(key, _)| tiles.remove(key)).collect();
        let cut = |((key, indices), before): (&(TileKey, Vec<u32>), Option<Tile>)| {
            let mut tile = before.unwrap_or_else(|| tile_of(self.stock, &self.stock.extent, self.cell, *key));
            let of_tile = self.cut(*key, indices, &mut tile);
            ((*key, tile), of_tile)
        };
        let (after, of_tiles): (Vec<_>, Vec<_>) = met.par_iter().zip(before).map(cut).unzip();
        tiles.extend(after);
        of_tiles
    }

    /// Takes moves through a tile, in the order of the path.
    fn cut(&self, key: TileKey, indices: &[u32], tile: &mut Tile) -> OfTile {
        let mut counted = Counted { of_tile: OfTile::default(), sums: Window::empty(), turns: Window::empty() };
        let lines = TileLines::new(key, self.cell, self.stock.extent[0][key.0]);
        let mut cutting = Cutting { key, lines, tile, of_part: OnceCell::new(), removed: Vec::new() };
        for index in indices {
            let (one, reach) = (&self.moves[*index as usize], &self.reaches[*index as usize]);
            if !reach.is_empty() {
                self.remove(one, reach, &mut cutting, &mut counted);
            }
            counted.sums.flush(&mut counted.of_tile.sums, |own, other| own.add(other, 1.0));
            counted.turns.flush(&mut counted.of_tile.turns, Arcs::add);
            // Shank and holder cut nothing: one grid of lines tells whether they are in the stock.
            let held = self.held.get(*index as usize).filter(|held| !held.is_empty());
            if let Some(held) = held.filter(|_| self.requested != Requested::Removal && key.0 == one.axis.iamax()) {
                self.hold(one, held, &cutting, &mut counted.of_tile);
            }
        }
        counted.of_tile
    }

    /// The ends of what a move reaches along an axis, from the lower end of the stock. nm
    fn along(&self, reach: &Reach, axis: usize) -> [u32; 2] {
        reach.0[axis].map(|end| nanometres(end - self.stock.extent[0][axis]))
    }

    /// Removes what a move sweeps of the lines of a tile, and counts it.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn remove(&self, one: &Move, reach: &Reach, cutting: &mut Cutting<'_>, counted: &mut Counted) {
        let Cutting { key, lines, tile, of_part, removed } = cutting;
        let axis = key.0;
        let (d, along) = (Vector3::ith(axis, 1.0), self.along(reach, axis));
        let moving = Moving::new(self.tool, one, self.cell);
        let is_counted = self.requested != Requested::Removal && !self.tool.cuts_along(one, axis);
        lines.within(&reach.0, &mut |number, start| {
            if !tile.meets(number, along) {
                return;
            }
            let Some(swept) = one.extent(&self.tool.pieces, start, &d) else { return };
            removed.clear();
            tile.remove(number, swept.map(nanometres), removed);
            if !is_counted {
                return;
            }
            let metres = |ends: [u32; 2]| Removed { axis, start, ends: ends.map(|end| f64::from(end) / NANO) };
            for ends in &*removed {
                self.count(&moving, &metres(*ends), counted);
                let Some(part) = self.part else { continue };
                let of_part = of_part.get_or_init(|| tile_of(part, &self.stock.extent, self.cell, *key));
                for [from, to] in of_part.intervals(number) {
                    let (from, to) = (from.max(ends[0]), to.min(ends[1]));
                    if to > from {
                        self.gouge(part, &moving, &metres([from, to]), &mut counted.of_tile);
                    }
                }
            }
        });
    }

    /// Counts what shank and holder meet of the lines of a tile.
    fn hold(&self, one: &Move, held: &Reach, cutting: &Cutting<'_>, of_tile: &mut OfTile) {
        let axis = cutting.key.0;
        let (d, along) = (Vector3::ith(axis, 1.0), self.along(held, axis));
        cutting.lines.within(&held.0, &mut |number, start| {
            if !cutting.tile.meets(number, along) {
                return;
            }
            for piece in &self.tool.holder {
                let Some(swept) = one.extent(std::slice::from_ref(piece), start, &d) else { continue };
                let [low, high] = swept.map(nanometres);
                let within = |[from, to]: [u32; 2]| f64::from(to.min(high).saturating_sub(from.max(low)));
                let met: f64 = cutting.tile.intervals(number).map(within).sum();
                if met > 0.0 {
                    of_tile.add_event(Event::Holder, one, met / NANO * self.cell * self.cell);
                }
            }
        });
    }

    /// Counts a removed piece of a line.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn count(&self, moving: &Moving<'_>, removed: &Removed<'_>, counted: &mut Counted) {
        let Counted { of_tile, sums: of_nodes, turns: of_turns } = counted;
        let (cell, one, [low, high]) = (self.cell, moving.one, removed.ends);
        // A piece may be thin and yet be cut all along the move.
        for (share, weight) in self.quadrature.of(POINTS * (high - low).max(one.by.norm()) / cell) {
            let point = removed.at(low + (high - low) * share);
            let volume = cell * cell * (high - low) * weight;
            let Some(bit) = moving.bit(&point, removed.axis, volume) else { continue };
            let mut event = |event: Event| of_tile.add_event(event, one, bit.sums.volume);
            match one.kind {
                MoveKind::Rapid => event(Event::Rapid),
                MoveKind::InPlace => event(Event::InPlace),
                MoveKind::Start => event(Event::Before),
                MoveKind::Feed if bit.when < 0.0 => event(Event::Before),
                MoveKind::Feed => {
                    if bit.height > self.tool.flute_length {
                        event(Event::AboveFlutes);
                    }
                    if bit.is_below && bit.radius < self.tool.dead_centre {
                        event(Event::DeadCentre);
                    }
                    for (node, part) in shares(one.nodes, bit.when) {
                        if part > 0.0
                            && let Some(sums) = of_nodes.entry(node, Sums::default)
                        {
                            sums.add(&bit.sums, part);
                        }
                    }
                    if self.requested == Requested::Turns {
                        let field = self.grid.field(moving, &bit);
                        for (node, part) in shares(one.turns, bit.when) {
                            if part > 0.0
                                && let Some(arcs) = of_turns.entry(node, || self.grid.arcs())
                            {
                                arcs.put(&field, part);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Counts what is cut off the finished part, where it is deep: farther than the tolerance from its surface along
    /// every axis.
    fn gouge(&self, part: &Body, moving: &Moving<'_>, removed: &Removed<'_>, of_tile: &mut OfTile) {
        let [low, high] = removed.ends;
        let piece = (high - low) / GOUGE_POINTS;
        for number in 0..GOUGE_POINTS as usize {
            let point = removed.at(low + piece * (number as f64 + 0.5));
            if part.depth(&point, self.cell) <= GOUGE {
                continue;
            }
            if let Some(bit) = moving.bit(&point, removed.axis, piece * self.cell * self.cell) {
                of_tile.add_event(Event::Gouge, moving.one, bit.sums.volume);
            }
        }
    }
}

/// The two nodes about a time of a move that goes from one place among nodes to another, with the share of each.
fn shares(ends: [f64; 2], when: f64) -> [(u32, f64); 2] {
    let at = ends[0] + (ends[1] - ends[0]) * when.min(1.0);
    let node = at as u32;
    let part = at - f64::from(node);
    [(node, 1.0 - part), (node + 1, part)]
}
