//! A tool path as moves, and the places along it where forces are summed.
//!
//! A leg is a stretch of a segment without a corner or a change of feed. It has nodes at even distances; what is cut
//! between two nodes is shared between them linearly. The load at a point of the path is that of the nodes about it, in
//! the legs that end or begin there.

use crate::operation::{AirPoint, Operation};
use nalgebra::Vector3;
use stead_model::task::{PathPoint, ToolPath};

/// Whether a move cuts or should not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MoveKind {
    /// A move of the path along which the tool centre point moves.
    Feed,
    /// A turn of the tool in place.
    InPlace,
    /// A rapid move.
    Rapid,
    /// The cutter put down where a segment begins to which no moves are known to lead.
    Start,
}

/// A move of the tool: a straight line, while the tool axis turns by a small angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// The tool centre point in the middle of the move, in the workpiece frame. m
    pub middle: Vector3<f64>,
    /// The tool axis in the middle, from the work to the spindle.
    pub axis: Vector3<f64>,
    /// By how much the tool centre point moves. m
    pub by: Vector3<f64>,
    /// By how much the axis turns, as a rotation vector. rad
    pub turn: Vector3<f64>,
    /// What it is for.
    pub kind: MoveKind,
    /// Feed per turn of the spindle. m
    pub feed_per_turn: f64,
    /// The point of the path at which it ends, or, of a rapid move, to which it leads.
    pub point: u32,
    /// Where it begins and ends among the nodes of the sums.
    pub nodes: [f64; 2],
    /// Where among the nodes of the turns of the spindle.
    pub turns: [f64; 2],
}

/// A stretch of the path with even nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Its length. m
    pub length: f64,
    /// Number of its first node of the sums, and intervals between its nodes.
    pub nodes: Nodes,
    /// Likewise of the turns of the spindle.
    pub turns: Nodes,
    /// Whether a move of it is far enough from the tool axis that there is a wall.
    pub has_wall: bool,
}

/// The nodes of a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nodes {
    /// Number of the first one.
    pub first: usize,
    /// Intervals between them: one less than there are.
    pub intervals: usize,
}

/// A place in a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegPlace {
    /// Number of the leg.
    pub leg: usize,
    /// Length of path from its start. m
    pub along: f64,
}

/// A tool path as moves.
#[derive(Debug, Clone, PartialEq)]
pub struct PathMoves {
    /// The moves in order.
    pub moves: Vec<Move>,
    /// The legs in order.
    pub legs: Vec<Leg>,
    /// For every point of the path its place in the leg that ends there and in that which begins there or goes on.
    pub places: Vec<[Option<LegPlace>; 2]>,
    /// Half the length of path that the load at a point is the mean of. m
    pub window: f64,
    /// Nodes of the sums in all, and of the turns.
    pub counts: [usize; 2],
}

/// Turns of the path beyond this are corners. rad
const CORNER: f64 = 20.0 * std::f64::consts::PI / 180.0;
/// Feeds that differ by more begin a new leg. Relative
const SAME_FEED: f64 = 0.01;
/// Moves turn the tool axis by no more. rad
const TURN: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// How far above its place a cutter is put down from. m
const PUT_DOWN: f64 = 1e-6;
/// Shorter ways are none. m
const NO_WAY: f64 = 1e-9;
/// Sine of the smallest angle between feed and tool axis at which there is a wall: what a task accepts for a scored
/// point, and room for rounding.
const NO_WALL: f64 = 0.089;
/// Distance of nodes of the turns of the spindle. m
const TURN_NODES: f64 = 4e-3;

/// Half the length of path that the load at a point is the mean of. m
pub fn window_for(cell: f64) -> f64 {
    (1.5 * cell).max(0.75e-3)
}

/// Whether the way to a point is far enough from the tool axis that there is a wall.
pub fn has_wall(path: &ToolPath, to: usize) -> bool {
    let [from, to] = [to - 1, to].map(|point| &path.points()[point]);
    let way = to.position - from.position;
    [from, to].iter().all(|end| way.cross(&end.axis).norm() > NO_WALL * way.norm())
}

/// The place of the tool at a point of a path.
fn place_of(path: &ToolPath, point: usize) -> AirPoint {
    let PathPoint { position, axis, .. } = path.points()[point];
    AirPoint { position, axis }
}

impl PathMoves {
    /// The moves of an operation, with loads that are the mean over a window on either side (m).
    pub fn new(operation: &Operation, window: f64) -> Self {
        let mut all = Self { moves: Vec::new(), legs: Vec::new(), places: Vec::new(), window, counts: [0, 0] };
        let path = &operation.path;
        all.places = vec![[None; 2]; path.points().len()];
        let at = |point: usize| place_of(path, point);
        for (number, range) in path.segments().iter().enumerate() {
            let rapids = operation.rapids.get(number).map_or(&[][..], Vec::as_slice);
            if !rapids.is_empty() {
                let before = range.start.checked_sub(1).map(at);
                let way = before.into_iter().chain(rapids.iter().copied()).chain([at(range.start)]);
                all.rapid(way, range.start);
            } else {
                all.start(at(range.start), range.start);
            }
            let mut from = range.start;
            while from + 1 < range.end {
                from = all.leg(operation, from, range.end);
            }
        }
        let end = path.points().len() - 1;
        if let Some(rapids) = operation.rapids.get(path.segments().len()).filter(|rapids| !rapids.is_empty()) {
            all.rapid(std::iter::once(at(end)).chain(rapids.iter().copied()), end);
        }
        all
    }

    fn rapid(&mut self, way: impl Iterator<Item = AirPoint>, point: usize) {
        let places: Vec<AirPoint> = way.collect();
        for pair in places.windows(2) {
            self.straight(pair[0], pair[1], |part| Move { kind: MoveKind::Rapid, point: point as u32, ..part });
        }
    }

    /// Puts the cutter down: what it then stands in is none of what the segment cuts.
    fn start(&mut self, at: AirPoint, point: usize) {
        let above = AirPoint { position: at.position + at.axis * PUT_DOWN, ..at };
        self.straight(above, at, |part| Move { kind: MoveKind::Start, point: point as u32, ..part });
    }

    /// Adds a leg, or a turn in place, from a point on; where it ends.
    fn leg(&mut self, operation: &Operation, from: usize, end: usize) -> usize {
        let path = &operation.path;
        let at = |point: usize| place_of(path, point);
        let way = |to: usize| path.points()[to].position - path.points()[to - 1].position;
        if way(from + 1).norm() < NO_WAY {
            let kind = MoveKind::InPlace;
            self.straight(at(from), at(from + 1), |part| Move { kind, point: from as u32 + 1, ..part });
            return from + 1;
        }
        let feed = |to: usize| path.feed(to).unwrap_or_default();
        let goes_on = |to: usize| {
            let (a, b) = (way(to), way(to + 1));
            b.norm() >= NO_WAY
                && libm::atan2(a.cross(&b).norm(), a.dot(&b)) < CORNER
                && (feed(to) - feed(to + 1)).abs() <= SAME_FEED * feed(to)
        };
        let last = (from + 1..end).find(|to| *to + 1 >= end || !goes_on(*to)).unwrap_or(end - 1);
        let length: f64 = (from + 1..=last).map(|to| way(to).norm()).sum();
        let node = self.window / 3.0;
        let intervals = |step: f64| ((length / step).round() as usize).max(1);
        let [sums, turns] = [node, TURN_NODES].map(intervals);
        let nodes = Nodes { first: self.counts[0], intervals: sums };
        let turns = Nodes { first: self.counts[1], intervals: turns };
        self.counts = [nodes.first + nodes.intervals + 1, turns.first + turns.intervals + 1];
        let leg = self.legs.len();
        let has_wall = (from + 1..=last).any(|to| has_wall(path, to));
        self.legs.push(Leg { length, nodes, turns, has_wall });
        let mut along = 0.0;
        self.places[from][1] = Some(LegPlace { leg, along });
        for to in from + 1..=last {
            let step = way(to).norm();
            let start = along;
            along = if to == last { length } else { along + step };
            let end = along;
            self.places[to][0] = Some(LegPlace { leg, along });
            let place = |share: f64, nodes: Nodes| {
                nodes.first as f64 + (start + (end - start) * share) / length * nodes.intervals as f64
            };
            let feed_per_turn = feed(to) / operation.spindle_speed;
            self.straight(at(to - 1), at(to), |part| Move {
                kind: MoveKind::Feed,
                point: to as u32,
                feed_per_turn,
                nodes: part.nodes.map(|share| place(share, nodes)),
                turns: part.nodes.map(|share| place(share, turns)),
                ..part
            });
        }
        last
    }

    /// Adds a straight move in parts that turn the tool axis by little. What is made of a part gets in `nodes` the
    /// shares of the whole at which it begins and ends.
    fn straight(&mut self, from: AirPoint, to: AirPoint, make: impl Fn(Move) -> Move) {
        let cross = from.axis.cross(&to.axis);
        let angle = libm::atan2(cross.norm(), from.axis.dot(&to.axis));
        let about = cross.try_normalize(1e-12).unwrap_or_else(Vector3::zeros);
        let parts = (angle / TURN).ceil().max(1.0);
        let axis = |share: f64| {
            let (sine, cosine) = libm::sincos(angle * share);
            from.axis * cosine + about.cross(&from.axis) * sine
        };
        let by = (to.position - from.position) / parts;
        for part in 0..parts as usize {
            let part = part as f64;
            self.moves.push(make(Move {
                middle: from.position + by * (part + 0.5),
                axis: axis((part + 0.5) / parts),
                by,
                turn: about * (angle / parts),
                kind: MoveKind::Feed,
                feed_per_turn: 0.0,
                point: 0,
                nodes: [part / parts, (part + 1.0) / parts],
                turns: [self.counts[1] as f64; 2],
            }));
        }
    }

    /// The places of a point and the one after it, where they are in one leg.
    pub fn leg_between(&self, point: usize) -> Option<[LegPlace; 2]> {
        let end = self.places.get(point + 1)?[0]?;
        let start = self.places[point].iter().flatten().find(|place| place.leg == end.leg)?;
        Some([*start, end])
    }
}

impl Leg {
    /// Weights of nodes of the sums for the load at a place: those of their sums over those of their lengths.
    pub fn weights(&self, along: f64, window: f64) -> impl Iterator<Item = (usize, f64)> + Clone {
        let spacing = self.length / self.nodes.intervals as f64;
        let nearest = |place: f64| (place / spacing).clamp(0.0, self.nodes.intervals as f64);
        let range = nearest(along - window).floor() as usize..=nearest(along + window).ceil() as usize;
        let (first, intervals) = (self.nodes.first, self.nodes.intervals);
        // A smooth bell: it does not see how the volume is sampled along the path.
        let bell = move |node: usize| {
            let off = (node as f64 * spacing - along) / window;
            let inside = (1.0 - off * off).max(1e-6);
            inside * inside
        };
        let length = move |node: usize| if node == 0 || node == intervals { spacing / 2.0 } else { spacing };
        let sum: f64 = range.clone().map(|node| bell(node) * length(node)).sum();
        range.map(move |node| (first + node, bell(node) / sum))
    }
}
