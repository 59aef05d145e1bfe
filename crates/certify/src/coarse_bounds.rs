//! What a path point costs at least, whatever the heading: minorants over radius, height and direction of the feed.

use super::arm::Arm;
use super::cell::Extent;
use super::compliance_table::{ComplianceTable, Steps};
use super::cost::{CORNERS, Direction, joined_sets};
use super::kind::{Kind, kinds};
use super::minorant::{Affine, Around, EMPTY, ModelledRegion, OfKind, ZERO, rounded};
use super::model::Model;
use super::region::{Point, PolarModel, Region};
use super::sliding_min::joined;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};
use stead_model::robot::PostureClass;
use stead_numerics::monitor::{Monitor, Stop};
use stead_problem::criterion::Aggregate;

/// Coarse tables, one for each kind of load, in ever coarser levels; and finer ones, of which a part is made when it is
/// first needed.
#[derive(Debug)]
pub(super) struct CoarseBounds {
    pub levels: Arc<[Level]>,
    finer: Arc<[FinerLevel]>,
    /// What the parts of the finer levels made so far take. bytes
    made: Arc<AtomicU64>,
    extent: Extent,
    steps: Steps,
    /// For each path point the number of its kind of load and how many times as large its own is; `None` where it is
    /// left out.
    kind_of: Vec<Option<(usize, f64)>>,
    kinds: Arc<[Kind]>,
}

#[derive(Debug, Clone)]
pub(super) struct Level {
    pub counts: [usize; 3],
    pub entries: Vec<Affine>,
}

/// A level with smaller steps than the coarsest one of the table of compliances.
#[derive(Debug)]
struct FinerLevel {
    /// The level of that table with the same steps.
    level: usize,
    counts: [usize; 3],
    /// Made when the first of them is needed.
    rows: OnceLock<Box<[Row]>>,
}

/// Of a radius and height the parts: a kind of load, and neighbouring directions of it.
type Row = OnceLock<Box<[Part]>>;

/// Neighbouring directions of one kind of load, each in all classes.
type Part = OnceLock<Box<[[Affine; 4]]>>;
/// Directions of a part.
const PART: usize = 16;
/// Finer levels.
const FINER: usize = 2;

/// Rows computed between two questions whether to go on.
const ROWS: usize = 64;

impl CoarseBounds {
    /// Makes them, unless `stop`, called repeatedly, returns a reason to stop before that; `monitor` is checked within
    /// long steps.
    ///
    /// # Errors
    /// The reason to stop.
    pub fn new(model: &Model, monitor: &Monitor, stop: impl Fn() -> Option<Stop>) -> Result<Self, Stop> {
        let (extent, steps) = model.table.grid();
        let (kinds, kind_of) = kinds(&model.points);
        let counts = model.table.counts(0);
        let mut entries = Vec::new();
        let numbers: Vec<usize> = (0..counts[0] * counts[1]).collect();
        for some in numbers.chunks(ROWS) {
            if let Some(stop) = stop() {
                return Err(stop);
            }
            let row = |row: &usize| match monitor.should_stop() {
                true => Vec::new(),
                false => part_of(model, &kinds, 0, [row / counts[1], row % counts[1]], 0..counts[2]),
            };
            let rows: Vec<Vec<Affine>> = some.par_iter().with_max_len(1).map(row).collect();
            entries.extend(rows.into_iter().flatten());
        }
        let mut levels = vec![Level { counts, entries }];
        let mut half = half_of(&model.table, 0);
        for _ in 0..2 {
            let next = levels.last().map(|level| level.coarser(half, kinds.len(), monitor));
            if let Some(stop) = stop() {
                return Err(stop);
            }
            levels.extend(next);
            half = half.map(|h| 2.0 * h);
        }
        let finest = FINER.min(model.table.depth().saturating_sub(1));
        let finer = |level| FinerLevel { level, counts: model.table.counts(level), rows: OnceLock::new() };
        let finer = (1..=finest).map(finer).collect();
        let (levels, kinds) = (levels.into(), kinds.into());
        Ok(Self { levels, finer, made: Arc::default(), extent, steps, kind_of, kinds })
    }

    /// The same tables for some of the path points.
    pub fn on_points(&self, points: Range<usize>) -> Self {
        Self {
            levels: Arc::clone(&self.levels),
            finer: Arc::clone(&self.finer),
            made: Arc::clone(&self.made),
            kinds: Arc::clone(&self.kinds),
            kind_of: self.kind_of[points].to_vec(),
            ..*self
        }
    }

    /// The finest level whose entries answer for a box so many times as large as the coarsest steps of the table of
    /// compliances: its number, below zero a finer one, above zero a coarser one; and its steps in terms of these.
    fn finest(&self, ratio: f64) -> Option<(i32, f64)> {
        let (mut number, mut size) = (-(self.finer.len() as i32), self.smallest());
        while ratio > size {
            (number, size) = (number + 1, 2.0 * size);
        }
        (number < self.levels.len() as i32).then_some((number, size))
    }

    /// The finer level of a number below zero.
    fn finer_level(&self, number: i32) -> &FinerLevel {
        &self.finer[number.unsigned_abs() as usize - 1]
    }

    /// Numbers of radii, heights and directions of a level.
    fn counts(&self, number: i32) -> [usize; 3] {
        match usize::try_from(number) {
            Ok(number) => self.levels[number].counts,
            Err(_) => self.finer_level(number).counts,
        }
    }

    /// Places for what is made when it is needed.
    fn places<T>(&self, count: usize) -> Box<[OnceLock<T>]> {
        let places: Box<[OnceLock<T>]> = std::iter::repeat_with(OnceLock::new).take(count).collect();
        self.made.fetch_add(size_of_val(&*places) as u64, Ordering::Relaxed);
        places
    }

    /// The entries of a level at a radius, height and direction, of a kind of load, in all classes.
    #[inline]
    fn entries(&self, model: &Model, number: i32, at: [usize; 3], kind: usize) -> &[Affine] {
        let [i, j, k] = at;
        if let Ok(number) = usize::try_from(number) {
            let level = &self.levels[number];
            let at = (((i * level.counts[1] + j) * level.counts[2] + k) * self.kinds.len() + kind) * 4;
            return &level.entries[at..at + 4];
        }
        let FinerLevel { level, counts, rows } = self.finer_level(number);
        let parts = counts[2] / PART;
        let rows = rows.get_or_init(|| self.places(counts[0] * counts[1]));
        let row = rows[i * counts[1] + j].get_or_init(|| self.places(self.kinds.len() * parts));
        let part = row[kind * parts + k / PART].get_or_init(|| {
            let first = k / PART * PART;
            let kinds = std::slice::from_ref(&self.kinds[kind]);
            let part = part_of(model, kinds, *level, [i, j], first..first + PART);
            let part: Box<[[Affine; 4]]> = part.chunks_exact(4).map(|e| [e[0], e[1], e[2], e[3]]).collect();
            self.made.fetch_add(size_of_val(&*part) as u64, Ordering::Relaxed);
            part
        });
        &part[k % PART]
    }

    /// The size of boxes that the finest level is for, in terms of those that the table of compliances begins with.
    pub fn smallest(&self) -> f64 {
        0.5_f64.powi(self.finer.len() as i32)
    }

    /// What was made so far of the finer levels. bytes
    pub fn used(&self) -> u64 {
        self.made.load(Ordering::Relaxed)
    }

    /// What they take. bytes
    pub fn bytes(extent: Extent, steps: Steps, points: &[Point]) -> u64 {
        // In f64: a cell may be so large that whole numbers overflow.
        let along = |(from, to): (f64, f64)| ((to - from) / steps.length).ceil() + 1.0;
        let nodes = along(extent.radius) * along(extent.height) * steps.headings as f64;
        (nodes * (4 * kinds(points).0.len() * size_of::<Affine>()) as f64 * 8.0 / 7.0) as u64
    }

    /// A lower bound of what all points cost together, the rate of beta dropped; infinite where nothing is feasible.
    /// `None` for a box too large for the tables. A point that may be near axis 1 costs nothing.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub fn lower_bound(&self, model: &Model, region: &Region) -> Option<f64> {
        let mut totals = [0.0; CORNERS];
        let aggregate = model.objective.aggregate;
        let [a, b, g] = region.half;
        for span in &model.segments {
            let mut sums = [[0.0f64; 4]; 4];
            for point in span.clone() {
                let Some((kind, size_of_load)) = self.kind_of[point] else { continue };
                let Some(p) = model.placed(point, region) else { continue };
                let Near { number, at, off } = self.nearest(&p, model.points[point].load.turn)?;
                for (sum, e) in sums.iter_mut().zip(self.entries(model, number, at, kind)) {
                    if e.value == f32::INFINITY {
                        sum[0] = f64::INFINITY;
                    } else {
                        add(aggregate, sum, least_over(e, size_of_load, off, &p), region);
                    }
                }
            }
            let mut best = [f64::INFINITY; CORNERS];
            for (corner, best) in best.iter_mut().enumerate() {
                let sign = |k: usize| if corner >> k & 1 == 1 { 1.0 } else { -1.0 };
                let at = |s: &[f64; 4]| s[0] + sign(0) * a * s[1] + sign(1) * b * s[2] + sign(2) * g * s[3];
                *best = sums.iter().map(at).fold(f64::INFINITY, f64::min);
            }
            totals = joined(aggregate, &totals, &best);
        }
        Some(totals.iter().copied().fold(f64::INFINITY, f64::min))
    }

    /// The entries that answer for a point over a box, of a load turned against its feed (rad); `None` where none does.
    #[inline(always)]
    fn nearest(&self, p: &PolarModel, load_turn: f64) -> Option<Near> {
        let heading = TAU / self.steps.headings as f64;
        let ratio =
            (p.reach[0] / self.steps.length).max(p.reach[1] / self.steps.length).max(p.reach[2] / heading) * 2.0;
        let (number, size) = self.finest(ratio)?;
        let counts = self.counts(number);
        let (length, turn) = (self.steps.length * size, heading * size);
        let from = [self.extent.radius.0, self.extent.height.0];
        let along = [(p.r, from[0]), (p.z, from[1])].map(|(value, from)| (value - from) / length + 0.5);
        let [i, j] = along.map(|k| k as usize);
        if along.iter().any(|k| *k < 0.0) || i >= counts[0] || j >= counts[1] {
            return None;
        }
        let chi = (p.chi + load_turn).rem_euclid(TAU);
        let k = (chi / turn + 0.5) as usize;
        let off = [p.r - from[0] - length * i as f64, p.z - from[1] - length * j as f64, chi - turn * k as f64];
        Some(Near { number, at: [i, j, k % counts[2]], off })
    }
}

/// The entries nearest to a point.
struct Near {
    /// The number of their level.
    number: i32,
    at: [usize; 3],
    /// The point less the node, in radius, height (m) and direction of the load (rad).
    off: [f64; 3],
}

/// Below the score of a point everywhere in a box, by an entry for loads of size 1 that is `off` the point: at the
/// middle of the box, and slopes by its sides.
#[inline(always)]
fn least_over(e: &Affine, size_of_load: f64, off: [f64; 3], p: &PolarModel) -> (f64, [f64; 3]) {
    let s = e.slope.map(|slope| size_of_load * f64::from(slope));
    let least = size_of_load * f64::from(e.value) + s[0] * off[0] + s[1] * off[1] + s[2] * off[2]
        - s[0].abs() * p.remainder_r
        - s[2].abs() * p.remainder_chi;
    let by = |side: usize| s[0] * p.slope_r[side] + s[2] * p.slope_chi[side];
    (least, [by(0), s[1], by(1)])
}

/// Adds the score of a point, below which an affine function over a box is, to what others cost: at the middle, and
/// slopes.
#[inline(always)]
fn add(aggregate: Aggregate, sum: &mut [f64; 4], below: (f64, [f64; 3]), region: &Region) {
    let (least, slopes) = below;
    match aggregate {
        Aggregate::Mean => {
            sum[0] += least;
            (0..3).for_each(|k| sum[k + 1] += slopes[k]);
        }
        // The tangent of the square, which is above it nowhere.
        Aggregate::Rms if least > 0.0 => {
            sum[0] += least * least;
            (0..3).for_each(|k| sum[k + 1] += 2.0 * least * slopes[k]);
        }
        Aggregate::Rms => {}
        // Of the largest of several affine functions the least need not be at a corner.
        Aggregate::Max => {
            let spread = (0..3).map(|k| slopes[k].abs() * region.half[k]).sum::<f64>();
            sum[0] = sum[0].max(least - spread);
        }
    }
}

impl Level {
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn coarser(&self, half: [f64; 3], kinds: usize, monitor: &Monitor) -> Self {
        let [n0, n1, n2] = self.counts;
        let counts = [n0.div_ceil(2) + usize::from(n0 % 2 == 0), n1.div_ceil(2) + usize::from(n1 % 2 == 0), n2 / 2];
        let rows: Vec<Vec<Affine>> = (0..counts[0] * counts[1])
            .into_par_iter()
            .map(|row| {
                let (i, j) = (row / counts[1], row % counts[1]);
                let near = |k: usize, n: usize| (2 * k).saturating_sub(1)..(2 * k + 2).min(n);
                let mut out = Vec::with_capacity(counts[2] * kinds * 4);
                if monitor.should_stop() {
                    return out;
                }
                for k in 0..counts[2] {
                    for kind in 0..kinds * 4 {
                        let children = || {
                            near(i, n0).flat_map(move |i2| near(j, n1).map(move |j2| (i2, j2))).flat_map(
                                move |(i2, j2)| {
                                    (0..3).map(move |d| {
                                        let k2 = (2 * k + d + n2 - 1) % n2;
                                        let e = self.entries[((i2 * n1 + j2) * n2 + k2) * kinds * 4 + kind];
                                        let off =
                                            [i2 as f64 - 2.0 * i as f64, j2 as f64 - 2.0 * j as f64, d as f64 - 1.0];
                                        ([off[0] * half[0], off[1] * half[1], off[2] * half[2]], e)
                                    })
                                },
                            )
                        };
                        out.push(below_all(children(), children(), half));
                    }
                }
                out
            })
            .collect();
        Self { counts, entries: rows.into_iter().flatten().collect() }
    }
}

/// An affine function below several, each true within `half` of its own middle.
pub(super) fn below_all(
    once: impl Iterator<Item = ([f64; 3], Affine)>,
    again: impl Iterator<Item = ([f64; 3], Affine)>,
    half: [f64; 3],
) -> Affine {
    let lowest = once.filter(|(_, e)| e.value < f32::INFINITY).min_by(|a, b| a.1.value.total_cmp(&b.1.value));
    let Some((_, lowest)) = lowest else { return EMPTY };
    if lowest == ZERO {
        return ZERO;
    }
    let slope = lowest.slope.map(f64::from);
    let mut value = f64::INFINITY;
    for (off, e) in again.filter(|(_, e)| e.value < f32::INFINITY) {
        let mut v = f64::from(e.value);
        for k in 0..3 {
            v -= slope[k] * off[k] + (f64::from(e.slope[k]) - slope[k]).abs() * half[k];
        }
        value = value.min(v);
    }
    rounded(value, slope, half)
}

/// How far from a node of a level of the table of compliances its entry is true, in radius, height and direction of the
/// load.
fn half_of(table: &ComplianceTable, level: usize) -> [f64; 3] {
    let [r, z, heading] = table.half(level);
    [r, z, 2.0 * heading]
}

/// Some directions of kinds of load, in all classes, at a radius and height of a level of the table of compliances.
fn part_of(model: &Model, kinds: &[Kind], level: usize, at: [usize; 2], some: Range<usize>) -> Vec<Affine> {
    let of = |arm, table| part_of_set(arm, table, kinds, level, at, some.clone());
    let own = of(&model.arm, &model.table);
    let others = model.others.iter().map(|set| of(&set.arm, &set.table));
    let mut sets: Vec<Vec<Affine>> = std::iter::once(own).chain(others).collect();
    if sets.len() == 1 {
        return sets.swap_remove(0);
    }
    let joined = |entry: usize| {
        let mut all = sets.iter().map(|set| set[entry]);
        if all.clone().any(|e| e == EMPTY) {
            return EMPTY;
        }
        let wide = |e: Affine| (f64::from(e.value), e.slope.map(f64::from));
        let wide: Vec<_> = all.by_ref().map(wide).collect();
        let (value, slope) = joined_sets(model.over, wide.into_iter());
        rounded(value, slope, half_of(&model.table, level))
    };
    (0..sets[0].len()).map(joined).collect()
}

/// The same under one set of stiffness: an arm, and its table.
fn part_of_set(
    arm: &Arm,
    table: &ComplianceTable,
    kinds: &[Kind],
    level: usize,
    at: [usize; 2],
    some: Range<usize>,
) -> Vec<Affine> {
    let node = table.place(level, at);
    let half = half_of(table, level);
    let mut out = vec![EMPTY; some.len() * kinds.len() * 4];
    let directions: Vec<Direction> = some.map(|k| Direction::new(half[2] * k as f64)).collect();
    for class in PostureClass::ALL {
        let mut found: Vec<ModelledRegion> = Vec::new();
        let mut unknown = false;
        let around = Around { arm, table, class, node };
        for cell in 0..table.headings(level) {
            unknown |= !around.collect(level, at, cell, &mut found);
        }
        for (number, kind) in kinds.iter().enumerate() {
            // What the coarsest level leaves open is bounded by much that takes longer.
            let mut of_kind = OfKind::new(&found, kind, level == 0);
            for (k, direction) in directions.iter().enumerate() {
                let below = if unknown { ZERO } else { of_kind.minorant(direction, half) };
                out[(k * kinds.len() + number) * 4 + class.index()] = below;
            }
        }
    }
    out
}
