//! Moves through the lines of a tile: what each sweeps, and what that adds to the sums.

use crate::cutting::{Moving, Tool};
use crate::lattice::{TileKey, TileLines};
use crate::moves::{Move, MoveKind};
use crate::piece::Piece;
use crate::quadrature::Quadrature;
use crate::solid_lines::{Body, tile_of};
use crate::sums::{Event, Found, GOUGE, Requested, Sums};
use crate::tile::{NANO, Tile};
use crate::turn::{Arcs, TurnGrid};
use nalgebra::Vector3;
use std::cell::OnceCell;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

/// Points of a removed piece of a line, over its length in cells.
const POINTS: f64 = 2.5;
/// Points at which a removed piece of a line is looked at for a cut into the finished part.
const GOUGE_POINTS: f64 = 4.0;

/// A box about what is swept, inside the stock, by axis. m
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach(pub [[f64; 2]; 3]);

impl Reach {
    pub fn is_empty(&self) -> bool {
        self.0.iter().any(|[low, high]| low >= high)
    }

    pub fn with(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        Self([0, 1, 2].map(|k| [self.0[k][0].min(other.0[k][0]), self.0[k][1].max(other.0[k][1])]))
    }
}

/// How far a cutter reaches about its axis, and along it.
pub struct Size {
    radius: f64,
    heights: [f64; 2],
}

impl Size {
    pub fn of(pieces: &[Piece]) -> Self {
        let radius = pieces.iter().map(|piece| piece.radius).fold(0.0, f64::max);
        let low = pieces.iter().map(|piece| piece.heights[0]).fold(f64::INFINITY, f64::min);
        let high = pieces.iter().map(|piece| piece.heights[1]).fold(0.0, f64::max);
        Self { radius, heights: [low, high] }
    }
}

/// What all tiles of a chunk have in common.
pub struct Job<'j> {
    pub tool: &'j Tool,
    pub moves: &'j [Move],
    pub reaches: &'j [Reach],
    /// Of the holder, where there is one.
    pub held: &'j [Reach],
    pub extent: &'j [Vector3<f64>; 2],
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

impl Job<'_> {
    /// Takes moves through a tile, in the order of the path.
    pub fn cut(&self, key: TileKey, indices: &[u32], tile: &mut Tile) -> OfTile {
        let mut counted = Counted { of_tile: OfTile::default(), sums: Window::empty(), turns: Window::empty() };
        let (axis, ..) = key;
        let cell = self.cell;
        let mut d = Vector3::zeros();
        d[axis] = 1.0;
        // Made when something of the tile is cut for the first time.
        let of_part: OnceCell<Tile> = OnceCell::new();
        let mut removed = Vec::new();
        let lines = TileLines::new(key, cell, self.extent[0][axis]);
        let nano = |end: f64| ((end - self.extent[0][axis]) * NANO).round().clamp(0.0, f64::from(u32::MAX)) as u32;
        for index in indices {
            let (one, reach) = (&self.moves[*index as usize], &self.reaches[*index as usize]);
            let moving = Moving::new(self.tool, one, cell);
            let is_counted = self.requested != Requested::Removal && !self.tool.cuts_along(one, axis);
            if !reach.is_empty() {
                let along = reach.0[axis].map(nano);
                lines.within(&reach.0, &mut |number, o| {
                    if !tile.meets(number, along) {
                        return;
                    }
                    let Some(swept) = one.extent(&self.tool.pieces, o, &d) else { return };
                    let swept = swept.map(|end| (end * NANO).round().clamp(0.0, f64::from(u32::MAX)) as u32);
                    removed.clear();
                    tile.remove(number, swept, &mut removed);
                    if !is_counted {
                        return;
                    }
                    for ends in &removed {
                        self.count(&moving, axis, o, ends.map(|end| f64::from(end) / NANO), &mut counted);
                        let Some(part) = self.part else { continue };
                        let lines = of_part.get_or_init(|| tile_of(part, self.extent, cell, key));
                        for [from, to] in lines.intervals(number) {
                            let (from, to) = (from.max(ends[0]), to.min(ends[1]));
                            if to > from {
                                self.gouge(
                                    part,
                                    &moving,
                                    axis,
                                    o,
                                    [from, to].map(|end| f64::from(end) / NANO),
                                    &mut counted.of_tile,
                                );
                            }
                        }
                    }
                });
            }
            counted.sums.flush(&mut counted.of_tile.sums, |own, other| own.add(other, 1.0));
            counted.turns.flush(&mut counted.of_tile.turns, Arcs::add);
            // Shank and holder cut nothing: one grid of lines tells whether they are in the stock.
            let Some(held) = self.held.get(*index as usize).filter(|held| !held.is_empty()) else { continue };
            if self.requested == Requested::Removal || axis != one.axis.iamax() {
                continue;
            }
            let along = held.0[axis].map(nano);
            lines.within(&held.0, &mut |number, o| {
                if !tile.meets(number, along) {
                    return;
                }
                for piece in &self.tool.holder {
                    let Some(swept) = one.extent(std::slice::from_ref(piece), o, &d) else { continue };
                    let [low, high] = swept.map(|end| (end * NANO).round().clamp(0.0, f64::from(u32::MAX)) as u32);
                    let met: f64 = tile
                        .intervals(number)
                        .map(|[from, to]| f64::from(to.min(high).saturating_sub(from.max(low))))
                        .sum();
                    if met > 0.0 {
                        *counted.of_tile.events.entry((Event::Holder, one.point)).or_default() +=
                            met / NANO * cell * cell;
                    }
                }
            });
        }
        counted.of_tile
    }

    /// Counts a removed piece of a line.
    fn count(&self, moving: &Moving<'_>, axis: usize, o: &Vector3<f64>, [low, high]: [f64; 2], counted: &mut Counted) {
        let Counted { of_tile, sums: of_nodes, turns: of_turns } = counted;
        let (cell, one) = (self.cell, moving.one);
        // A piece may be thin and yet be cut all along the move.
        for (share, weight) in self.quadrature.of(POINTS * (high - low).max(one.by.norm()) / cell) {
            let mut point = *o;
            point[axis] += low + (high - low) * share;
            let Some(bit) = moving.bit(&point, axis, cell * cell * (high - low) * weight) else { continue };
            let mut event = |event: Event| *of_tile.events.entry((event, one.point)).or_default() += bit.volume;
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
                    let when = bit.when.min(1.0);
                    let teeth = self.tool.cutter.teeth().len() as f64;
                    let of_bit = Sums::of(&bit, one.feed_per_turn / teeth * bit.speed);
                    let at = |[from, to]: [f64; 2]| {
                        let at = from + (to - from) * when;
                        let node = at as u32;
                        (node, at - f64::from(node))
                    };
                    let (node, part) = at(one.nodes);
                    for (node, part) in [(node, 1.0 - part), (node + 1, part)] {
                        if part > 0.0
                            && let Some(sums) = of_nodes.entry(node, Sums::default)
                        {
                            sums.add(&of_bit, part);
                        }
                    }
                    if self.requested == Requested::Turns {
                        let field = self.grid.field(moving, &bit);
                        let (node, part) = at(one.turns);
                        for (node, part) in [(node, 1.0 - part), (node + 1, part)] {
                            if part > 0.0 {
                                let arcs = of_turns.entry(node, || self.grid.arcs());
                                arcs.into_iter().for_each(|arcs| arcs.put(&field, part));
                            }
                        }
                    }
                }
            }
        }
    }

    /// Counts what is cut off the finished part, where it is deep: farther than the tolerance from its surface along
    /// every axis.
    fn gouge(
        &self,
        part: &Body,
        moving: &Moving<'_>,
        axis: usize,
        o: &Vector3<f64>,
        [low, high]: [f64; 2],
        of_tile: &mut OfTile,
    ) {
        let piece = (high - low) / GOUGE_POINTS;
        for number in 0..GOUGE_POINTS as usize {
            let mut point = *o;
            point[axis] += low + piece * (number as f64 + 0.5);
            if part.depth(&point, self.cell) <= GOUGE {
                continue;
            }
            if let Some(bit) = moving.bit(&point, axis, piece * self.cell * self.cell) {
                *of_tile.events.entry((Event::Gouge, moving.one.point)).or_default() += bit.volume;
            }
        }
    }
}

impl Move {
    /// By how much a point of the cutter moves. m
    pub fn displacement(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.by + self.turn.cross(&(point - self.middle))
    }

    /// A box about what it sweeps of a cutter of this size, inside the stock.
    pub(crate) fn reach(&self, size: &Size, [min, max]: &[Vector3<f64>; 2]) -> Reach {
        let turned = self.turn.norm() * libm::hypot(size.heights[1], size.radius);
        Reach([0, 1, 2].map(|k| {
            let half = self.by[k].abs() / 2.0;
            let ends = size.heights.map(|height| height * self.axis[k]);
            let wide = size.radius * ((1.0 - self.axis[k] * self.axis[k]).max(0.0).sqrt() + 1e-9) + turned;
            let low = self.middle[k] - half + ends[0].min(ends[1]) - wide;
            let high = self.middle[k] + half + ends[0].max(ends[1]) + wide;
            [low.max(min[k]), high.min(max[k])]
        }))
    }

    /// The interval of a line `o + l d` that the pieces sweep, where there is one.
    pub(crate) fn extent(&self, pieces: &[Piece], o: &Vector3<f64>, d: &Vector3<f64>) -> Option<[f64; 2]> {
        let by = |u: &Vector3<f64>| {
            let w = o - self.middle + u / 2.0;
            let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
            // From above: what shank and side reach, a corner need not be asked for.
            pieces.iter().rev().for_each(|piece| piece.sweep(&self.axis, &w, d, u, &mut ends));
            (ends[0] < ends[1]).then_some(ends)
        };
        let ends = by(&self.by)?;
        if self.turn == Vector3::zeros() {
            return Some(ends);
        }
        // Each end with the displacement of its own.
        let [low, high] = ends.map(|end| by(&self.displacement(&(o + d * end))));
        let ends = [low?[0], high?[1]];
        (ends[0] < ends[1]).then_some(ends)
    }
}
