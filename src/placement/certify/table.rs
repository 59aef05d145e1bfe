//! Bounds of all second derivatives over the whole cell, and which of its parts no arm posture can reach.
//!
//! Nodes lie on a grid over radius, height and heading; each speaks for everything within one grid step of it in every
//! direction, so that one node answers for any region of up to half a step around any state. Coarser levels are made from
//! finer ones for larger regions.

use super::arm::{Arm, CONSTRAINTS, Yield};
use super::number::{Enclosure, Interval, PAIR, PAIRS, Slope};
use crate::placement::kernel::lanes::{Lanes, WIDTH};
use crate::robot::PostureClass;
use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

/// Functions bounded: m, the length of (d1, d2), that of the vertical compliances, and the constraints.
pub(super) const FUNCTIONS: usize = 3 + CONSTRAINTS;

/// What is known of the states around a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Node<'a> {
    /// None of them is allowed.
    Empty,
    /// Nothing is known of them.
    Unknown,
    /// How they yield.
    Known(&'a Known),
}

/// How the states around a node yield.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Known {
    /// Magnitudes of the second derivatives.
    pub second: [[f32; PAIRS]; FUNCTIONS],
    /// Value and gradient of m, d1, d2 and the vertical compliances at the node.
    pub values: [[f32; 4]; 5],
    /// What these leave out, anywhere around the node: of m, (d1, d2) and the vertical compliances.
    pub rest: [f32; 3],
    /// Whether all the states are sure to be allowed.
    pub sure: bool,
}

/// The extent of a table: what placements of the cell can ask for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    /// Radius, from and to. m
    pub radius: (f64, f64),
    /// Height, from and to. m
    pub height: (f64, f64),
}

/// Steps of the finest level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Steps {
    /// Radius and height. m
    pub length: f64,
    /// Number of headings, a power of two.
    pub headings: usize,
}

/// Nodes of ever finer levels, made when they are first asked for.
#[derive(Debug)]
pub(super) struct Table {
    extent: Extent,
    steps: Steps,
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    counts: [usize; 3],
    blocks: Vec<OnceLock<Box<[Made; WIDTH]>>>,
}

/// What one node says of one class.
#[derive(Debug, Clone, Copy)]
enum Made {
    Empty,
    Unknown,
    Known(Known),
}

impl Table {
    pub fn new(extent: Extent, steps: Steps, levels: usize) -> Self {
        let levels = (0..levels)
            .map(|level| {
                let length = steps.length / (1u64 << level) as f64;
                let along = |(from, to): (f64, f64)| ((to - from) / length).ceil() as usize + 1;
                let counts = [along(extent.radius), along(extent.height), steps.headings << level];
                let blocks = counts[0] * counts[1] * counts[2].div_ceil(WIDTH) * 4;
                Level { counts, blocks: std::iter::repeat_with(OnceLock::new).take(blocks).collect() }
            })
            .collect();
        Self { levels, extent, steps }
    }

    /// Number of levels.
    pub fn depth(&self) -> usize {
        self.levels.len()
    }

    /// The finest level whose nodes answer for regions of that half size; `None` for larger ones.
    pub fn level(&self, half: [f64; 3]) -> Option<usize> {
        let heading = TAU / self.steps.headings as f64;
        let ratio = (half[0] / self.steps.length).max(half[1] / self.steps.length).max(half[2] / heading) * 2.0;
        (0..self.levels.len()).rev().find(|level| ratio * (1u64 << level) as f64 <= 1.0 + 1e-9)
    }

    /// What is known of all states of a class around the node nearest to a state; radius and height must be in the extent.
    #[inline]
    pub fn at(&self, arm: &Arm, level: usize, r: f64, z: f64, heading: f64, class: PostureClass) -> (Node<'_>, [f64; 3]) {
        let stored = &self.levels[level];
        let length = self.steps.length / (1u64 << level) as f64;
        let place = |value: f64, from: f64, count: usize| {
            let k = (value - from) / length + 0.5;
            if k < 0.0 { None } else { Some(k as usize).filter(|k| *k < count) }
        };
        let (Some(i), Some(j)) =
            (place(r, self.extent.radius.0, stored.counts[0]), place(z, self.extent.height.0, stored.counts[1]))
        else {
            return (Node::Unknown, [0.0; 3]);
        };
        let count = stored.counts[2];
        let turns = heading * (count as f64 / TAU);
        let nearest = (turns + 0.5).floor();
        let off = [
            r - self.extent.radius.0 - length * i as f64,
            z - self.extent.height.0 - length * j as f64,
            (turns - nearest) * (TAU / count as f64),
        ];
        let k = (nearest as i64).rem_euclid(count as i64) as usize;
        let block = ((i * stored.counts[1] + j) * count.div_ceil(WIDTH) + k / WIDTH) * 4 + class.index();
        let made = stored.blocks[block].get_or_init(|| {
            let r = self.extent.radius.0 + length * i as f64;
            let z = self.extent.height.0 + length * j as f64;
            let step = TAU / count as f64;
            Box::new(made_block(arm, r, z, step, k / WIDTH * WIDTH, length, class))
        });
        let node = match &made[k % WIDTH] {
            Made::Empty => Node::Empty,
            Made::Unknown => Node::Unknown,
            Made::Known(known) => Node::Known(known),
        };
        (node, off)
    }

    pub fn tally(&self) -> [usize; 6] {
        let mut out = [0; 6];
        for made in self.levels[0].blocks.iter().filter_map(|b| b.get()).flat_map(|b| b.iter()) {
            match made {
                Made::Empty => out[0] += 1,
                Made::Unknown => out[1] += 1,
                Made::Known(k) => {
                    let rest = (k.rest[0] + k.rest[1]) as f64 * 95e6;
                    let bin = if rest < 2.0 { 0 } else if rest < 20.0 { 1 } else { 2 };
                    out[2 + bin] += 1;
                    if k.sure { out[5] += 1 }
                }
            }
        }
        out
    }

    /// Number of blocks made, level by level.
    pub fn made(&self) -> Vec<usize> {
        self.levels.iter().map(|l| l.blocks.iter().filter(|b| b.get().is_some()).count()).collect()
    }
}

/// Neighbouring headings of one class at one radius and height.
fn made_block(arm: &Arm, r: f64, z: f64, step: f64, start: usize, length: f64, class: PostureClass) -> [Made; WIDTH] {
    let half = [length, length, step];
    let heading = |k: usize| step * (start + k) as f64;
    let ends: [_; WIDTH] = std::array::from_fn(|k| sine_cosine_over(heading(k) - step, heading(k) + step));
    let middle: [_; WIDTH] = std::array::from_fn(|k| libm::sincos(heading(k)));
    let (sine, cosine) = Enclosure::heading(
        [Lanes(middle.map(|m| m.0)), Lanes(middle.map(|m| m.1))],
        [
            Interval::between(Lanes(ends.map(|e| e.0.0)), Lanes(ends.map(|e| e.0.1))),
            Interval::between(Lanes(ends.map(|e| e.1.0)), Lanes(ends.map(|e| e.1.1))),
        ],
        half,
    );
    let radius = Enclosure::variable(Lanes::splat(r), 0, half);
    let y = arm.evaluate(radius, Enclosure::variable(Lanes::splat(z), 1, half), sine, cosine, class);
    std::array::from_fn(|k| {
        let made = made_of(arm, &y, k, half);
        let is_open = !matches!(made, Made::Empty | Made::Known(Known { sure: true, .. }));
        if is_open && !has_allowed(arm, [r, z, heading(k)], half, class) && is_empty(arm, [r, z, heading(k)], half, class, DEPTH) { Made::Empty } else { made }
    })
}

/// Whether one of a few states of a region is allowed.
fn has_allowed(arm: &Arm, at: [f64; 3], half: [f64; 3], class: PostureClass) -> bool {
    let side = |k: usize, bit: usize| (if k >> bit & 1 == 1 { 0.95 } else { -0.95 }) * half[bit];
    let place = |k: usize| [at[0] + side(k, 0), at[1] + side(k, 1), at[2] + side(k, 2)];
    (0..8).step_by(WIDTH).any(|group| {
        let place: [[f64; 3]; WIDTH] = std::array::from_fn(|k| place((group + k) % 8));
        let middle = place.map(|p| libm::sincos(p[2]));
        let (sine, cosine) = Slope::heading(Lanes(middle.map(|m| m.0)), Lanes(middle.map(|m| m.1)));
        let radius = Slope::variable(Lanes(place.map(|p| p[0])), 0);
        let height = Slope::variable(Lanes(place.map(|p| p[1])), 1);
        let y = arm.evaluate(radius, height, sine, cosine, class);
        (0..WIDTH).any(|k| {
            let holds = |c: usize| y.constraints[c].value.0[k] >= 0.0;
            y.conditioned.lane(k)
                && [0, 5, 6, 7].into_iter().all(holds)
                && (0..2).all(|joint| match arm.is_wide(joint) {
                    None => true,
                    Some(true) => holds(1 + 2 * joint) || holds(2 + 2 * joint),
                    Some(false) => holds(1 + 2 * joint) && holds(2 + 2 * joint),
                })
        })
    })
}

/// How often an undecided node is cut into eight.
const DEPTH: usize = 2;

/// Whether no state of a region is allowed: its eight parts are looked at, and theirs, until one stays undecided.
fn is_empty(arm: &Arm, at: [f64; 3], half: [f64; 3], class: PostureClass, depth: usize) -> bool {
    let part = half.map(|h| 0.5 * h);
    let side = |k: usize, bit: usize| if k >> bit & 1 == 1 { part[bit] } else { -part[bit] };
    let corner = |k: usize| [at[0] + side(k, 0), at[1] + side(k, 1), at[2] + side(k, 2)];
    (0..8).step_by(WIDTH).all(|group| {
        let place: [[f64; 3]; WIDTH] = std::array::from_fn(|k| corner((group + k) % 8));
        let ends = place.map(|p| sine_cosine_over(p[2] - part[2], p[2] + part[2]));
        let middle = place.map(|p| libm::sincos(p[2]));
        let (sine, cosine) = Enclosure::heading(
            [Lanes(middle.map(|m| m.0)), Lanes(middle.map(|m| m.1))],
            [
                Interval::between(Lanes(ends.map(|e| e.0.0)), Lanes(ends.map(|e| e.0.1))),
                Interval::between(Lanes(ends.map(|e| e.1.0)), Lanes(ends.map(|e| e.1.1))),
            ],
            part,
        );
        let radius = Enclosure::variable(Lanes(place.map(|p| p[0])), 0, part);
        let height = Enclosure::variable(Lanes(place.map(|p| p[1])), 1, part);
        let y = arm.evaluate(radius, height, sine, cosine, class);
        (0..WIDTH.min(8)).all(|k| {
            is_forbidden(arm, &y, k) || depth > 1 && is_empty(arm, place[k], part, class, depth - 1)
        })
    })
}

/// Whether some constraint is sure to fail all over a region.
fn is_forbidden(arm: &Arm, y: &Yield<Enclosure>, lane: usize) -> bool {
    let high = |c: usize| y.constraints[c].value.high().0[lane];
    let [at_elbow, at_wrist, _] = y.regular.map(|mask| mask.lane(lane));
    let conditioned = y.conditioned.lane(lane);
    let one = [(0, at_elbow), (5, at_wrist), (6, at_wrist), (7, conditioned)];
    one.iter().any(|(c, usable)| *usable && high(*c) < 0.0)
        || (0..2).any(|joint| {
            let (a, b) = (high(1 + 2 * joint) < 0.0, high(2 + 2 * joint) < 0.0);
            at_wrist && arm.is_wide(joint).is_some_and(|wide| if wide { a && b } else { a || b })
        })
}

fn made_of(arm: &Arm, y: &Yield<Enclosure>, lane: usize, half: [f64; 3]) -> Made {
    let low = |c: usize| y.constraints[c].value.low().0[lane];
    let high = |c: usize| y.constraints[c].value.high().0[lane];
    // Each constraint can be judged where what it is made of is regular.
    let [at_elbow, at_wrist, regular] = y.regular.map(|mask| mask.lane(lane));
    if [(0, at_elbow), (5, at_wrist), (6, at_wrist), (7, y.conditioned.lane(lane))].iter().any(|(c, usable)| *usable && high(*c) < 0.0) {
        return Made::Empty;
    }
    let mut sure = y.conditioned.lane(lane) && [0, 5, 6, 7].iter().all(|c| low(*c) >= 0.0);
    for joint in 0..2 {
        let (a, b) = (1 + 2 * joint, 2 + 2 * joint);
        match arm.is_wide(joint) {
            None => {}
            Some(wide) => {
                let (lost_a, lost_b) = (high(a) < 0.0, high(b) < 0.0);
                if at_wrist && (if wide { lost_a && lost_b } else { lost_a || lost_b }) {
                    return Made::Empty;
                }
                let (sure_a, sure_b) = (low(a) >= 0.0, low(b) >= 0.0);
                sure &= if wide { sure_a || sure_b } else { sure_a && sure_b };
            }
        }
    }
    if !regular {
        return Made::Unknown;
    }
    let most = |e: &Enclosure, p: usize| e.second[p].magnitude().0[lane];
    let both = |a: &Enclosure, b: &Enclosure, p: usize| libm::hypot(most(a, p), most(b, p));
    let mut second = [[0.0f32; PAIRS]; FUNCTIONS];
    let mut finite = true;
    for p in 0..PAIRS {
        let mut put = |second: &mut [[f32; PAIRS]; FUNCTIONS], f: usize, value: f64| {
            finite &= value < 1e30;
            second[f][p] = (value * (1.0 + 1e-6)) as f32 + f32::MIN_POSITIVE;
        };
        put(&mut second, 0, most(&y.m, p));
        put(&mut second, 1, both(&y.d1, &y.d2, p));
        put(&mut second, 2, both(&y.vertical[0], &y.vertical[1], p));
        for c in 0..CONSTRAINTS - 1 {
            put(&mut second, 3 + c, most(&y.constraints[c], p));
        }
        let known = y.conditioned.lane(lane);
        second[2 + CONSTRAINTS][p] = if known { (most(&y.constraints[7], p) * (1.0 + 1e-6)) as f32 } else { f32::INFINITY };
    }
    if !finite {
        return Made::Unknown;
    }
    let values = [&y.m, &y.d1, &y.d2, &y.vertical[0], &y.vertical[1]].map(|f| {
        let f = f.middle();
        [f.value.0[lane], f.gradient[0].0[lane], f.gradient[1].0[lane], f.gradient[2].0[lane]]
    });
    let rest = [0, 1, 2].map(|f| {
        let sum = |p: usize, (i, j): (usize, usize)| f64::from(second[f][p]) * half[i] * half[j] * if i == j { 0.5 } else { 1.0 };
        let curved = PAIR.iter().enumerate().map(|(p, pair)| sum(p, *pair)).sum::<f64>();
        // And what is lost by writing the values with fewer digits.
        let functions: &[usize] = [&[0][..], &[1, 2], &[3, 4]][f];
        let size = functions.iter().map(|v| values[*v][0].abs() + (0..3).map(|k| values[*v][k + 1].abs() * half[k]).sum::<f64>());
        ((curved + 1e-7 * size.sum::<f64>()) * (1.0 + 1e-6)) as f32
    });
    Made::Known(Known { second, values: values.map(|v| v.map(|x| x as f32)), rest, sure })
}

/// Least and largest sine and cosine between two angles less than a turn apart. rad
fn sine_cosine_over(from: f64, to: f64) -> ((f64, f64), (f64, f64)) {
    let (s0, c0) = libm::sincos(from);
    let (s1, c1) = libm::sincos(to);
    // Whether an angle of that kind (plus whole turns) is between.
    let holds = |angle: f64| ((to - angle) / TAU).floor() > ((from - angle) / TAU).floor();
    let range = |a: f64, b: f64, top: f64| {
        let high = if holds(top) { 1.0 } else { a.max(b) };
        let low = if holds(top + PI) { -1.0 } else { a.min(b) };
        (low, high)
    };
    (range(s0, s1, PI / 2.0), range(c0, c1, 0.0))
}
