//! How the arm yields all over the cell: nodes over radius, height and heading, made when they are first requested.
//!
//! A node speaks for everything within one step of it in radius and height, so that one of them answers for any region
//! of up to half a step around any state, and within half a step in heading: headings are cut into cells once and for
//! all. It says that none of its states is allowed, or gives an affine model of the compliances with what that leaves
//! out.

use super::arm::{Arm, ArmCompliance};
use super::cell::Extent;
use super::enclosure::{Enclosure, FUNCTIONS, Interval, REMAINDERS, Remainder, ValueRange, bends, digits};
use super::interval_simd::{Lanes, WIDTH};
use super::moment::{MOMENTS, MomentModel};
use super::region::PolarModel;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use stead_model::robot::PostureClass;

/// What is known of the states around a node.
#[expect(clippy::large_enum_variant, reason = "sixteen at a time, in one allocation")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Node {
    /// None of them is allowed.
    Empty,
    /// Nothing is known of them.
    Unknown,
    /// How they yield.
    Known(AffineModel),
}

/// An affine model of the states around a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AffineModel {
    /// Value and gradient of m, d1, d2, c_rz, c_tz and c_zz at the node.
    pub values: [[f32; 4]; FUNCTIONS],
    /// What these leave out: of m, of the length of (d1, d2), of that of (c_rz, c_tz), and of c_zz.
    pub remainder: Remainder<REMAINDERS>,
    /// Whether all the states are sure to be allowed.
    pub sure: bool,
}

/// Steps of the coarsest level; each level has half the steps of the one before.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steps {
    /// Radius and height. m
    pub length: f64,
    /// Number of cells of heading, a power of two, 64 or more.
    pub headings: usize,
}

/// Neighbouring headings made at once.
const CHUNK: usize = 16;

#[derive(Debug)]
pub(super) struct ComplianceTable {
    extent: Extent,
    steps: Steps,
    levels: Vec<Level>,
    /// What the chunks made so far take. bytes
    made: AtomicU64,
}

/// Nodes that are made when the first of them is needed; `None` where all of them are empty.
type Chunk = OnceLock<Option<Box<Nodes>>>;
/// The chunks of one radius and height, class by class within each range of headings.
type Place = OnceLock<Box<[Chunk]>>;
/// Neighbouring places to each side of a block.
const BLOCK: usize = 16;

/// Neighbouring nodes, and how they yield to moments, where some act.
#[derive(Debug)]
struct Nodes {
    nodes: [Node; CHUNK],
    moments: Option<Box<[Option<MomentModel>; CHUNK]>>,
}

#[derive(Debug)]
struct Level {
    counts: [usize; 3],
    /// The places, in blocks, each allocated when one of them is needed: all of them together may be gigabytes, which
    /// take seconds to set up.
    blocks: Vec<OnceLock<Box<[Place]>>>,
}

impl Level {
    /// Number of blocks along the heights.
    fn blocks_up(&self) -> usize {
        self.counts[1].div_ceil(BLOCK)
    }
}

/// The nodes of one radius and height.
#[derive(Clone, Copy)]
pub(super) struct NodesAt<'a> {
    table: &'a ComplianceTable,
    arm: &'a Arm,
    level: usize,
    at: [usize; 2],
    chunks: &'a [Chunk],
}

impl ComplianceTable {
    pub fn new(extent: Extent, steps: Steps, levels: usize) -> Self {
        let levels = (0..levels)
            .map(|level| {
                let length = steps.length / (1u64 << level) as f64;
                let along = |(from, to): (f64, f64)| ((to - from) / length).ceil() as usize + 1;
                let counts = [along(extent.radius), along(extent.height), steps.headings << level];
                let blocks = counts[0].div_ceil(BLOCK) * counts[1].div_ceil(BLOCK);
                Level { counts, blocks: std::iter::repeat_with(OnceLock::new).take(blocks).collect() }
            })
            .collect();
        Self { levels, extent, steps, made: AtomicU64::new(0) }
    }

    /// What it takes with what was made so far. bytes
    pub fn used(&self) -> u64 {
        let empty: usize = self.levels.iter().map(|level| size_of_val(level.blocks.as_slice())).sum();
        empty as u64 + self.made.load(Ordering::Relaxed)
    }

    /// What the nodes of the coarsest level take at most. bytes
    pub fn bytes(extent: Extent, steps: Steps) -> u64 {
        // In f64: a cell may be so large that whole numbers overflow.
        let along = |(from, to): (f64, f64)| ((to - from) / steps.length).ceil() + 1.0;
        let chunks = along(extent.radius) * along(extent.height) * (steps.headings / CHUNK * 4) as f64;
        (chunks * (size_of::<Chunk>() + size_of::<Nodes>()) as f64) as u64
    }

    /// Adds what something new takes.
    fn count<T>(&self, made: &[T]) {
        self.made.fetch_add(size_of_val(made) as u64, Ordering::Relaxed);
    }

    /// Radii and heights, and steps.
    pub fn grid(&self) -> (Extent, Steps) {
        (self.extent, self.steps)
    }

    /// Numbers of radii, heights and cells of heading at a level.
    pub fn counts(&self, level: usize) -> [usize; 3] {
        self.levels[level].counts
    }

    /// Number of levels.
    pub fn depth(&self) -> usize {
        self.levels.len()
    }

    /// Number of cells of heading at a level.
    pub fn headings(&self, level: usize) -> usize {
        self.steps.headings << level
    }

    /// Steps in radius and height at a level. m
    pub fn length(&self, level: usize) -> f64 {
        self.steps.length / (1u64 << level) as f64
    }

    /// The finest level whose nodes answer for regions of that half size in radius and height; `None` for larger ones.
    pub fn level(&self, half: f64) -> Option<usize> {
        (0..self.levels.len()).rev().find(|level| self.answers(*level, [half, half]))
    }

    /// Whether the nodes of a level answer for everything within those distances of a radius and height.
    pub fn answers(&self, level: usize, reach: [f64; 2]) -> bool {
        reach[0].max(reach[1]) <= 0.5 * self.length(level) * (1.0 + 1e-9)
    }

    /// The node nearest to a radius and height, and how far they are from it; `None` outside the table.
    #[inline]
    pub fn nearest(&self, level: usize, r: f64, z: f64) -> Option<([usize; 2], [f64; 2])> {
        let length = self.length(level);
        let place = |value: f64, from: f64, count: usize| {
            let k = (value - from) / length + 0.5;
            if k < 0.0 { None } else { Some(k as usize).filter(|k| *k < count) }
        };
        let counts = &self.levels[level].counts;
        let (i, j) = (place(r, self.extent.radius.0, counts[0])?, place(z, self.extent.height.0, counts[1])?);
        let [at_r, at_z] = self.place(level, [i, j]);
        Some(([i, j], [r - at_r, z - at_z]))
    }

    /// Radius and height of a node. m
    pub fn place(&self, level: usize, at: [usize; 2]) -> [f64; 2] {
        let length = self.length(level);
        [self.extent.radius.0 + length * at[0] as f64, self.extent.height.0 + length * at[1] as f64]
    }

    /// Whether there is such a node.
    pub fn holds(&self, level: usize, at: [usize; 2]) -> bool {
        self.levels.get(level).is_some_and(|l| at[0] < l.counts[0] && at[1] < l.counts[1])
    }

    /// What a node of a level speaks for: half widths in radius, height (m) and heading (rad).
    pub fn half(&self, level: usize) -> [f64; 3] {
        [self.length(level), self.length(level), PI / self.headings(level) as f64]
    }

    /// Middle of a cell of heading. rad
    pub fn heading(&self, level: usize, cell: usize) -> f64 {
        TAU / self.headings(level) as f64 * (cell as f64 + 0.5)
    }

    /// The nodes that answer for a point over a box, and how far it is from them in radius and height (m); `None` where
    /// none do.
    #[inline]
    pub fn answer<'a>(&'a self, arm: &'a Arm, level: usize, placed: &PolarModel) -> Option<(NodesAt<'a>, [f64; 2])> {
        let answers = self.answers(level, [placed.reach[0], placed.reach[1]]);
        let (at, off) = self.nearest(level, placed.r, placed.z).filter(|_| answers)?;
        Some((self.nodes_at(arm, level, at), off))
    }

    /// The nodes of a radius and height.
    #[inline]
    pub fn nodes_at<'a>(&'a self, arm: &'a Arm, level: usize, at: [usize; 2]) -> NodesAt<'a> {
        let stored = &self.levels[level];
        let [i, j] = at;
        let places = stored.blocks[i / BLOCK * stored.blocks_up() + j / BLOCK].get_or_init(|| {
            let places: Box<[Place]> = std::iter::repeat_with(OnceLock::new).take(BLOCK * BLOCK).collect();
            self.count(&places);
            places
        });
        let chunks = places[i % BLOCK * BLOCK + j % BLOCK].get_or_init(|| {
            let chunks: Box<[Chunk]> =
                std::iter::repeat_with(OnceLock::new).take(stored.counts[2] / CHUNK * 4).collect();
            self.count(&chunks);
            chunks
        });
        NodesAt { table: self, arm, level, at, chunks }
    }

    /// The nodes of neighbouring cells of heading from `first` on.
    fn made(&self, arm: &Arm, level: usize, at: [usize; 2], first: usize, class: PostureClass) -> Option<Box<Nodes>> {
        let (half, [r, z]) = (self.half(level), self.place(level, at));
        let moments = arm.has_moments.then(|| Box::new([None; CHUNK]));
        let mut nodes = Box::new(Nodes { nodes: [Node::Empty; CHUNK], moments });
        let place = |cell: usize| [r, z, self.heading(level, first + cell)];
        let is_empty = |start: usize| are_empty(arm, &std::array::from_fn(|k| place(start + k)), half, class);
        let empty: [[bool; WIDTH]; CHUNK / WIDTH] = std::array::from_fn(|number| is_empty(number * WIDTH));
        let left: Vec<usize> = (0..CHUNK).filter(|cell| !empty[cell / WIDTH][cell % WIDTH]).collect();
        for some in left.chunks(WIDTH) {
            let places = std::array::from_fn(|k| place(some[k.min(some.len() - 1)]));
            for (cell, (node, moment)) in some.iter().zip(known_over(arm, &places, half, class)) {
                nodes.nodes[*cell] = node;
                if let Some(moments) = &mut nodes.moments {
                    moments[*cell] = moment;
                }
            }
        }
        if nodes.nodes.iter().all(|node| *node == Node::Empty) {
            return None;
        }
        self.count(std::slice::from_ref(nodes.as_ref()));
        nodes.moments.iter().for_each(|moments| self.count(moments.as_slice()));
        Some(nodes)
    }
}

impl<'a> NodesAt<'a> {
    /// Radius and height of the nodes (m), and the middle of a cell of heading (rad).
    pub fn place(&self, cell: usize) -> [f64; 3] {
        let [r, z] = self.table.place(self.level, self.at);
        [r, z, self.table.heading(self.level, cell)]
    }

    /// The node of a cell of heading, and how it yields to moments, where some act.
    #[inline]
    pub fn known(&self, cell: usize, class: PostureClass) -> (&'a Node, Option<&'a MomentModel>) {
        let Self { table, arm, level, at, chunks } = *self;
        let nodes = chunks[cell / CHUNK * 4 + class.index()]
            .get_or_init(|| table.made(arm, level, at, cell / CHUNK * CHUNK, class));
        match nodes {
            None => (&Node::Empty, None),
            Some(nodes) => {
                let moments = nodes.moments.as_ref().and_then(|moments| moments[cell % CHUNK].as_ref());
                (&nodes.nodes[cell % CHUNK], moments)
            }
        }
    }
}

/// The same without what is known of moments.
#[cfg(test)]
pub(super) fn nodes_over(arm: &Arm, place: &[[f64; 3]; WIDTH], half: [f64; 3], class: PostureClass) -> [Node; WIDTH] {
    known_over(arm, place, half, class).map(|made| made.0)
}

/// A node, and how it yields to moments, where some act.
type Made = (Node, Option<MomentModel>);

/// What is known of four regions (radius, height, heading) of those half widths.
pub(super) fn known_over(arm: &Arm, place: &[[f64; 3]; WIDTH], half: [f64; 3], class: PostureClass) -> [Made; WIDTH] {
    match enclosed(arm, place, half, class) {
        None => [(Node::Empty, None); WIDTH],
        Some(y) => std::array::from_fn(|k| judged(arm, &y, k, half)),
    }
}

/// In which of four regions (radius, height, heading) no state is allowed, as far as intervals for values alone tell:
/// of most of those that are empty, without their derivatives.
fn are_empty(arm: &Arm, place: &[[f64; 3]; WIDTH], half: [f64; 3], class: PostureClass) -> [bool; WIDTH] {
    let (sine, cosine) = ValueRange::turning(place.map(|p| p[2]), half[2]);
    let side =
        |k: usize| ValueRange::over(Interval { middle: Lanes(place.map(|p| p[k])), radius: Lanes::splat(half[k]) });
    match arm.evaluate(side(0), side(1), sine, cosine, class) {
        None => [true; WIDTH],
        Some(y) => std::array::from_fn(|lane| y.violated.lane(lane)),
    }
}

/// The closed form over four regions (radius, height, heading).
pub(super) fn enclosed(
    arm: &Arm,
    place: &[[f64; 3]; WIDTH],
    half: [f64; 3],
    class: PostureClass,
) -> Option<ArmCompliance<Enclosure>> {
    let (sine, cosine) = Enclosure::heading(place.map(|p| p[2]), half);
    let radius = <Enclosure>::variable(Lanes(place.map(|p| p[0])), 0, half);
    let height = Enclosure::variable(Lanes(place.map(|p| p[1])), 1, half);
    arm.evaluate(radius, height, sine, cosine, class)
}

fn judged(arm: &Arm, y: &ArmCompliance<Enclosure>, lane: usize, half: [f64; 3]) -> Made {
    if y.violated.lane(lane) {
        return (Node::Empty, None);
    }
    if !y.regular.lane(lane) {
        return (Node::Unknown, None);
    }
    let sure = arm.is_sure(y, lane);
    let functions = [&y.m, &y.d1, &y.d2, &y.vertical[0], &y.vertical[1], &y.axial];
    let of = |f: &Enclosure| {
        let f = f.middle();
        [f.value.0[lane], f.gradient[0].0[lane], f.gradient[1].0[lane], f.gradient[2].0[lane]]
    };
    let values = functions.map(of);
    let Some(remainder) = Remainder::new(bends(&functions, lane), digits(&functions, lane, half)) else {
        return (Node::Unknown, None);
    };
    let known = Node::Known(AffineModel { values: values.map(|v| v.map(|x| x as f32)), remainder, sure });
    let Some(moments) = &y.moments else { return (known, None) };
    let values: [[f64; 4]; MOMENTS] = std::array::from_fn(|f| of(&moments[f]));
    let max_second = |f: usize, p: usize| moments[f].second[p].magnitude().0[lane];
    match MomentModel::new(values, half, max_second) {
        Some(moments) => (known, Some(moments)),
        None => (Node::Unknown, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stead_problem::testing::five_segments;

    /// A cell 4 m wide and 2 m high has gigabytes of chunks. Setting them up takes seconds, without a look at the time
    /// limit.
    #[test]
    fn a_table_takes_memory_only_where_it_is_used() {
        let problem = five_segments();
        let extent = Extent { radius: (0.3, 4.3), height: (-1.0, 1.0) };
        let steps = Steps { length: 0.025, headings: 128 };
        let table = ComplianceTable::new(extent, steps, 6);
        let empty = table.used();
        assert!(empty < 10_000_000, "{empty}");
        let arm = Arm::new(&problem, &problem.robot, extent.radius.0);
        let nodes = table.nodes_at(&arm, 3, [400, 100]);
        let all = PostureClass::ALL.into_iter().flat_map(|class| (0..1024).map(move |cell| (cell, class)));
        let found = all.filter(|(cell, class)| *nodes.known(*cell, *class).0 != Node::Empty).count();
        let chunks = found.div_ceil(CHUNK)..=found.min(1024 / CHUNK * 4);
        let fixed = BLOCK * BLOCK * size_of::<Place>() + 1024 / CHUNK * 4 * size_of::<Chunk>();
        let made = (table.used() - empty) as usize - fixed;
        assert_eq!(made % size_of::<Nodes>(), 0);
        assert!(found > 0 && chunks.contains(&(made / size_of::<Nodes>())), "{found} {made}");
    }
}
