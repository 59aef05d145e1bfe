//! What a path point costs at least, whatever the heading: minorants over radius, height and direction of the feed.

use super::compliance_table::{Extent, Steps};
use super::minorant::{Affine, EMPTY, ModelledRegion, ZERO, below_all, collect, minorant};
use super::model::Model;
use super::region::{Point, Region};
use rayon::prelude::*;
use std::f64::consts::TAU;
use stead_model::robot::PostureClass;
use stead_numerics::monitor::{Monitor, Stop};

/// Coarse tables, one for each kind of force, in ever coarser levels.
#[derive(Debug, Clone)]
pub(super) struct CoarseBounds {
    pub levels: Vec<Level>,
    extent: Extent,
    steps: Steps,
    /// For each path point the number of its force; `None` where it is left out.
    force_of: Vec<Option<usize>>,
    forces: usize,
}

#[derive(Debug, Clone)]
pub(super) struct Level {
    pub counts: [usize; 3],
    pub entries: Vec<Affine>,
}

/// Kinds of force that have a table: the most frequent ones.
const MAX_FORCES: usize = 12;
/// Rows computed between two questions whether to go on.
const ROWS: usize = 64;
/// Kinds of force counted: a task may have as many as points.
const MAX_COUNTED: usize = 1000;

impl CoarseBounds {
    /// Makes them, unless `stop`, called repeatedly, returns a reason to stop before that; `monitor` is checked within
    /// long steps.
    ///
    /// # Errors
    /// The reason to stop.
    pub fn new(model: &Model, monitor: &Monitor, stop: impl Fn() -> Option<Stop>) -> Result<Self, Stop> {
        let (extent, steps) = model.table.grid();
        let kinds = kinds(&model.points);
        let force_of = model.points.iter().map(|p| kinds.iter().position(|f| same(f, &p.force))).collect();
        let counts = counts(extent, steps);
        let mut entries = Vec::new();
        let numbers: Vec<usize> = (0..counts[0] * counts[1]).collect();
        for some in numbers.chunks(ROWS) {
            if let Some(stop) = stop() {
                return Err(stop);
            }
            let row = |row: &usize| match monitor.should_stop() {
                true => Vec::new(),
                false => row_of(model, &kinds, [row / counts[1], row % counts[1]], steps),
            };
            let rows: Vec<Vec<Affine>> = some.par_iter().map(row).collect();
            entries.extend(rows.into_iter().flatten());
        }
        let mut levels = vec![Level { counts, entries }];
        let mut half = [steps.length, steps.length, TAU / steps.headings as f64];
        for _ in 0..2 {
            let next = levels.last().map(|level| level.coarser(half, kinds.len(), monitor));
            if let Some(stop) = stop() {
                return Err(stop);
            }
            levels.extend(next);
            half = half.map(|h| 2.0 * h);
        }
        Ok(Self { levels, extent, steps, force_of, forces: kinds.len() })
    }

    /// What they take. bytes
    pub fn bytes(extent: Extent, steps: Steps, points: &[Point]) -> u64 {
        // In f64: a cell may be so large that whole numbers overflow.
        let along = |(from, to): (f64, f64)| ((to - from) / steps.length).ceil() + 1.0;
        let nodes = along(extent.radius) * along(extent.height) * steps.headings as f64;
        (nodes * (4 * kinds(points).len() * size_of::<Affine>()) as f64 * 8.0 / 7.0) as u64
    }

    /// A lower bound of the sum over all points, the rate of beta dropped; infinite where nothing is feasible. `None`
    /// for a box too large for the tables. A point that may be near axis 1 costs nothing.
    pub fn lower_bound(&self, model: &Model, region: &Region) -> Option<f64> {
        let mut totals = [0.0; 8];
        let [a, b, g] = region.half;
        let heading = TAU / self.steps.headings as f64;
        for span in &model.segments {
            let mut sums = [[0.0f64; 4]; 4];
            for point in span.clone() {
                let Some(force) = self.force_of[point] else { continue };
                let Some(p) = model.placed(point, region) else { continue };
                let ratio =
                    (p.reach[0] / self.steps.length).max(p.reach[1] / self.steps.length).max(p.reach[2] / heading)
                        * 2.0;
                let number = if ratio <= 1.0 {
                    0
                } else if ratio <= 2.0 {
                    1
                } else if ratio <= 4.0 {
                    2
                } else {
                    return None;
                };
                let level = &self.levels[number];
                let size = (1usize << number) as f64;
                let (length, turn) = (self.steps.length * size, heading * size);
                let along = [(p.r, self.extent.radius.0), (p.z, self.extent.height.0)]
                    .map(|(value, from)| (value - from) / length + 0.5);
                let [i, j] = along.map(|k| k as usize);
                if along.iter().any(|k| *k < 0.0) || i >= level.counts[0] || j >= level.counts[1] {
                    return None;
                }
                let chi = p.chi.rem_euclid(TAU);
                let k = (chi / turn + 0.5) as usize;
                let off = [
                    p.r - self.extent.radius.0 - length * i as f64,
                    p.z - self.extent.height.0 - length * j as f64,
                    chi - turn * k as f64,
                ];
                let at =
                    (((i * level.counts[1] + j) * level.counts[2] + k % level.counts[2]) * self.forces + force) * 4;
                for class in 0..4 {
                    let e = &level.entries[at + class];
                    let s = e.slope.map(f64::from);
                    let sum = &mut sums[class];
                    sum[0] += f64::from(e.value) + s[0] * off[0] + s[1] * off[1] + s[2] * off[2]
                        - s[0].abs() * p.remainder_r
                        - s[2].abs() * p.remainder_chi;
                    sum[1] += s[0] * p.slope_r[0] + s[2] * p.slope_chi[0];
                    sum[2] += s[1];
                    sum[3] += s[0] * p.slope_r[1] + s[2] * p.slope_chi[1];
                }
            }
            for (corner, total) in totals.iter_mut().enumerate() {
                let sign = |k: usize| if corner >> k & 1 == 1 { 1.0 } else { -1.0 };
                let at = |s: &[f64; 4]| s[0] + sign(0) * a * s[1] + sign(1) * b * s[2] + sign(2) * g * s[3];
                *total += sums.iter().map(at).fold(f64::INFINITY, f64::min);
            }
        }
        Some(totals.iter().copied().fold(f64::INFINITY, f64::min))
    }
}

/// The most frequent forces.
fn kinds(points: &[Point]) -> Vec<[f64; 3]> {
    let mut forces: Vec<([f64; 3], usize)> = Vec::new();
    for p in points {
        match forces.iter().position(|(f, _)| same(f, &p.force)) {
            Some(at) => forces[at].1 += 1,
            None if forces.len() < MAX_COUNTED => forces.push((p.force, 1)),
            None => {}
        }
    }
    forces.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    forces.truncate(MAX_FORCES);
    forces.into_iter().map(|(force, _)| force).collect()
}

fn counts(extent: Extent, steps: Steps) -> [usize; 3] {
    let along = |(from, to): (f64, f64)| ((to - from) / steps.length).ceil() as usize + 1;
    [along(extent.radius), along(extent.height), steps.headings]
}

/// Whether two forces differ by rounding only.
fn same(a: &[f64; 3], b: &[f64; 3]) -> bool {
    let size = a.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-13 * size)
}

impl Level {
    fn coarser(&self, half: [f64; 3], forces: usize, monitor: &Monitor) -> Self {
        let [n0, n1, n2] = self.counts;
        let counts = [n0.div_ceil(2) + usize::from(n0 % 2 == 0), n1.div_ceil(2) + usize::from(n1 % 2 == 0), n2 / 2];
        let rows: Vec<Vec<Affine>> = (0..counts[0] * counts[1])
            .into_par_iter()
            .map(|row| {
                let (i, j) = (row / counts[1], row % counts[1]);
                let near = |k: usize, n: usize| (2 * k).saturating_sub(1)..(2 * k + 2).min(n);
                let mut out = Vec::with_capacity(counts[2] * forces * 4);
                if monitor.should_stop() {
                    return out;
                }
                for k in 0..counts[2] {
                    for kind in 0..forces * 4 {
                        let children = || {
                            near(i, n0).flat_map(move |i2| near(j, n1).map(move |j2| (i2, j2))).flat_map(
                                move |(i2, j2)| {
                                    (0..3).map(move |d| {
                                        let k2 = (2 * k + d + n2 - 1) % n2;
                                        let e = self.entries[((i2 * n1 + j2) * n2 + k2) * forces * 4 + kind];
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

/// All directions of the feed, forces and classes at one radius and height.
fn row_of(model: &Model, forces: &[[f64; 3]], at: [usize; 2], steps: Steps) -> Vec<Affine> {
    let (arm, table, first) = (&model.arm, &model.table, model.first);
    let node = table.place(0, at);
    let step = TAU / steps.headings as f64;
    let half = [steps.length, steps.length, step];
    let mut out = vec![EMPTY; steps.headings * forces.len() * 4];
    // sin and cos of the directions of the feed.
    let directions: Vec<(f64, f64)> = (0..steps.headings).map(|k| libm::sincos(step * k as f64)).collect();
    for class in PostureClass::ALL {
        let mut found: Vec<ModelledRegion> = Vec::new();
        let mut unknown = false;
        for cell in 0..steps.headings {
            unknown |= !collect(arm, table, 0, at, cell, node, class, &mut found);
        }
        for (number, force) in forces.iter().enumerate() {
            for (k, (sine, cosine)) in directions.iter().enumerate() {
                let place = (k * forces.len() + number) * 4 + class.index();
                if unknown {
                    out[place] = ZERO;
                    continue;
                }
                out[place] = minorant(&found, *force, (*sine, *cosine), first, half);
            }
        }
    }
    out
}
