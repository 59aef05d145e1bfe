//! What a path point costs at least, whatever the heading: minorants over radius, height and direction of the feed.

use super::arm::Arm;
use super::bound::Bounded;
use super::number::VARIABLES;
use super::region::{Point, Region};
use super::table::{Extent, FUNCTIONS, Known, Node, Steps, Table};
use crate::robot::PostureClass;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// An affine function about a node, below what a point costs in one posture class within a step of it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Affine {
    value: f32,
    slope: [f32; VARIABLES],
}

const EMPTY: Affine = Affine { value: f32::INFINITY, slope: [0.0; VARIABLES] };
const ZERO: Affine = Affine { value: 0.0, slope: [0.0; VARIABLES] };

/// Reduced tables, one for each kind of force, in ever coarser levels.
#[derive(Debug, Clone)]
pub(super) struct Reduced {
    levels: Vec<Level>,
    extent: Extent,
    steps: Steps,
    /// For each path point the number of its force; `None` where it is left out.
    force_of: Vec<Option<usize>>,
    forces: usize,
}

#[derive(Debug, Clone)]
struct Level {
    counts: [usize; 3],
    entries: Vec<Affine>,
}

/// Kinds of force looked at: the most frequent ones.
const MOST_FORCES: usize = 12;
/// Kinds of force counted: a task may have as many as points.
const MOST_LOOKED_AT: usize = 1000;

impl Reduced {
    pub fn new(bounded: &Bounded) -> Self {
        let (extent, steps) = bounded.table.grid();
        let kinds = kinds(&bounded.points);
        let force_of = bounded.points.iter().map(|p| kinds.iter().position(|f| same(f, &p.force))).collect();
        let counts = counts(extent, steps);
        let rows: Vec<Vec<Affine>> = (0..counts[0] * counts[1])
            .into_par_iter()
            .map(|row| row_of(bounded, &kinds, [row / counts[1], row % counts[1]], steps))
            .collect();
        let mut levels = vec![Level { counts, entries: rows.into_iter().flatten().collect() }];
        let mut half = [steps.length, steps.length, TAU / steps.headings as f64];
        for _ in 0..2 {
            let next = levels.last().map(|level| level.coarser(half, kinds.len()));
            levels.extend(next);
            half = half.map(|h| 2.0 * h);
        }
        Self { levels, extent, steps, force_of, forces: kinds.len() }
    }

    /// What they take. bytes
    pub fn bytes(extent: Extent, steps: Steps, points: &[Point]) -> u64 {
        // In f64: a cell may be so large that whole numbers overflow.
        let along = |(from, to): (f64, f64)| ((to - from) / steps.length).ceil() + 1.0;
        let nodes = along(extent.radius) * along(extent.height) * steps.headings as f64;
        (nodes * (4 * kinds(points).len() * size_of::<Affine>()) as f64 * 8.0 / 7.0) as u64
    }

    /// A lower bound of the sum over all points, the rate of beta dropped; infinite where nothing is feasible. `None`
    /// for a box too large for the tables.
    pub fn below(&self, bounded: &Bounded, region: &Region) -> Option<f64> {
        let mut totals = [0.0; 8];
        let [a, b, g] = region.half;
        let heading = TAU / self.steps.headings as f64;
        for span in &bounded.segments {
            let mut sums = [[0.0f64; 4]; 4];
            for point in span.clone() {
                let Some(force) = self.force_of[point] else { continue };
                let p = bounded.points[point].over(region)?;
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
                let i = ((p.r - self.extent.radius.0) / length + 0.5) as usize;
                let j = ((p.z - self.extent.height.0) / length + 0.5) as usize;
                if i >= level.counts[0] || j >= level.counts[1] {
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
                        - s[0].abs() * p.rest_r
                        - s[2].abs() * p.rest_chi;
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
            None if forces.len() < MOST_LOOKED_AT => forces.push((p.force, 1)),
            None => {}
        }
    }
    forces.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    forces.truncate(MOST_FORCES);
    forces.into_iter().map(|(force, _)| force).collect()
}

fn counts(extent: Extent, steps: Steps) -> [usize; 3] {
    let along = |(from, to): (f64, f64)| ((to - from) / steps.length).ceil() as usize + 1;
    [along(extent.radius), along(extent.height), steps.headings]
}

fn same(a: &[f64; 3], b: &[f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + a.abs()))
}

impl Level {
    fn coarser(&self, half: [f64; 3], forces: usize) -> Self {
        let [n0, n1, n2] = self.counts;
        let counts = [n0.div_ceil(2) + usize::from(n0 % 2 == 0), n1.div_ceil(2) + usize::from(n1 % 2 == 0), n2 / 2];
        let rows: Vec<Vec<Affine>> = (0..counts[0] * counts[1])
            .into_par_iter()
            .map(|row| {
                let (i, j) = (row / counts[1], row % counts[1]);
                let near = |k: usize, n: usize| (2 * k).saturating_sub(1)..(2 * k + 2).min(n);
                let mut out = Vec::with_capacity(counts[2] * forces * 4);
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

/// An affine function below several, each true within `half` of its own middle.
fn below_all(
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

fn rounded(value: f64, slope: [f64; 3], half: [f64; 3]) -> Affine {
    let size = value.abs() + (0..3).map(|k| slope[k].abs() * half[k] * 4.0).sum::<f64>();
    let value = value - 1e-6 * size;
    if value <= 0.0 { ZERO } else { Affine { value: value as f32, slope: slope.map(|s| s as f32) } }
}

/// All directions of the feed, forces and classes at one radius and height.
fn row_of(bounded: &Bounded, forces: &[[f64; 3]], at: [usize; 2], steps: Steps) -> Vec<Affine> {
    let (arm, table, first) = (&bounded.arm, &bounded.table, bounded.first);
    let node = table.place(0, at);
    let step = TAU / steps.headings as f64;
    let half = [steps.length, steps.length, step];
    let mut out = vec![EMPTY; steps.headings * forces.len() * 4];
    // sin and cos of the directions of the feed.
    let directions: Vec<(f64, f64)> = (0..steps.headings).map(|k| libm::sincos(step * k as f64)).collect();
    for class in PostureClass::ALL {
        let mut found: Vec<State> = Vec::new();
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

/// Second-order parts larger than this share of the compliance are cut up, down to the finest level.
const COARSE: f64 = 0.3;

/// The regions around a node, cut up where their models are coarse; false where nothing is known of one.
#[expect(clippy::too_many_arguments, reason = "one node and all it is cut from")]
fn collect(
    arm: &Arm,
    table: &Table,
    level: usize,
    at: [usize; 2],
    cell: usize,
    node: [f64; 2],
    class: PostureClass,
    out: &mut Vec<State>,
) -> bool {
    let finest = level + 1 == table.depth();
    match table.node(arm, level, at, cell, class) {
        Node::Empty => return true,
        Node::Unknown if finest => return false,
        Node::Known(known) if finest || f64::from(known.rest[0] + known.rest[1]) <= COARSE * arm.typical() => {
            let half = [table.length(level), table.length(level), 0.5 * TAU / table.headings(level) as f64];
            let place = table.place(level, at);
            out.push(State::new(known, half, place[0], [place[0] - node[0], place[1] - node[1]]));
            return true;
        }
        _ => {}
    }
    let mut known = true;
    for (down, left) in [(true, true), (true, false), (false, true), (false, false)] {
        let side = |k: usize, low: bool| if low { (2 * k).checked_sub(1) } else { Some(2 * k + 1) };
        let (Some(i), Some(j)) = (side(at[0], down), side(at[1], left)) else { continue };
        if !table.holds(level + 1, [i, j]) {
            continue;
        }
        for part in [2 * cell, 2 * cell + 1] {
            known &= collect(arm, table, level + 1, [i, j], part, node, class, out);
        }
    }
    known
}

/// A region of headings, radii and heights: an affine model of the compliances with what it leaves out.
struct State {
    values: [[f64; 4]; FUNCTIONS],
    rest: [f64; 3],
    /// How long (d1, d2) and the vertical compliances can get, and how far they can move.
    most: [f64; 2],
    moved: [f64; 2],
    half: [f64; 3],
    r: f64,
    /// Radius and height less those of the node. m
    off: [f64; 2],
}

impl State {
    fn new(known: &Known, half: [f64; 3], r: f64, off: [f64; 2]) -> Self {
        let values = known.values.map(|v| v.map(f64::from));
        let rest = known.rest.map(f64::from);
        // Slopes change by at most what twice the second-order sum says.
        let of = |a: usize, b: usize, rest: f64| {
            let moved =
                (0..3).map(|k| libm::hypot(values[a][k + 1], values[b][k + 1]) * half[k]).sum::<f64>() + 2.0 * rest;
            (libm::hypot(values[a][0], values[b][0]) + moved, moved)
        };
        let (d, v) = (of(1, 2, rest[1]), of(3, 4, rest[2]));
        Self { values, rest, most: [d.0, v.0], moved: [d.1, v.1], half, r, off }
    }
}

fn minorant(found: &[State], force: [f64; 3], (sine, cosine): (f64, f64), first: f64, half: [f64; 3]) -> Affine {
    if found.is_empty() {
        return EMPTY;
    }
    let [f1, f2, f3] = force;
    let (s2, c2) = (2.0 * sine * cosine, cosine * cosine - sine * sine);
    let (a, b) = (f2 * c2 + f1 * s2, f1 * c2 - f2 * s2);
    let length = libm::hypot(f1, f2);
    let h_chi = half[2];
    let model = |s: &State| {
        let (r, h_r) = (s.r, s.half[0]);
        let far = r + h_r;
        let joint1 = first
            * (0.5 * ((f2 + a).abs() + 2.0 * length * h_chi) * h_r * h_r
                + 2.0 * far * (b.abs() + 2.0 * length * h_chi) * h_r * h_chi
                + far * far * (a.abs() + 2.0 * length * h_chi) * h_chi * h_chi);
        let of = |k: usize| {
            let v = |f: usize| s.values[f][k];
            f2 * v(0) - a * v(1) + b * v(2) + f3 * (cosine * v(4) - sine * v(3))
        };
        let value = of(0) + first * r * r * 0.5 * (f2 + a);
        let by_r = of(1) + first * r * (f2 + a);
        let by_chi = -2.0 * b * s.values[1][0] - 2.0 * a * s.values[2][0] + first * r * r * b
            - f3 * (cosine * s.values[3][0] + sine * s.values[4][0]);
        let rest = s.rest[0] * f2.abs() + s.rest[1] * length + s.rest[2] * f3.abs()
            + h_chi * (2.0 * length * s.moved[0] + f3.abs() * s.moved[1])
            + h_chi * h_chi * (2.0 * length * s.most[0] + 0.5 * f3.abs() * s.most[1])
            + joint1
            // The heading is free within its cell.
            + of(3).abs() * s.half[2];
        let sign = if value < 0.0 { -1.0 } else { 1.0 };
        (value.abs() - rest, [by_r * sign, of(2) * sign, by_chi * sign])
    };
    let mut lowest = (f64::INFINITY, [0.0; 3]);
    for s in found {
        let m = model(s);
        if m.0 < lowest.0 {
            lowest = m;
        }
    }
    if lowest.0 <= 0.0 {
        return ZERO;
    }
    let slope = lowest.1;
    let mut value = f64::INFINITY;
    for s in found {
        let m = model(s);
        let spread = [s.half[0], s.half[1], h_chi];
        let shifted = slope[0] * s.off[0] + slope[1] * s.off[1];
        value = value.min(m.0 - shifted - (0..3).map(|k| (m.1[k] - slope[k]).abs() * spread[k]).sum::<f64>());
    }
    rounded(value, slope, half)
}
