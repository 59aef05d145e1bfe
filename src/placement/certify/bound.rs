//! A lower bound of what any placement of a box is worth, with the rate of beta: dynamic programming over cells of beta at
//! the corners of the box.
//!
//! Every cell costs an affine function of the placement, a way through the cells their sum, the best way the least of these:
//! a concave function, so its least value over the box is at a corner. Ways are taken from cell to cell where some beta of
//! the one is within the rate of some beta of the other.

use super::arm::Arm;
use super::cost::{CORNERS, Load, States};
use super::number::PAIRS;
use super::region::{Point, Region};
use super::table::{FUNCTIONS, Node, Table};
use crate::placement::kernel::lanes::{Lanes, WIDTH};
use crate::robot::PostureClass;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// What is to be bounded, prepared.
#[derive(Debug)]
pub(super) struct Bounded {
    pub arm: Arm,
    pub table: Table,
    pub extent: super::table::Extent,
    pub points: Vec<Point>,
    pub segments: Vec<Range<usize>>,
    /// Largest change of beta from the point before. rad; infinite without the rate
    pub rates: Vec<f64>,
    /// Compliance of joint 1. rad/(N m)
    pub first: f64,
    /// Which way the heading turns with beta.
    pub sense: f64,
}

/// Which cells of beta are still of interest: for each point and class one bit a cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tube {
    /// Cells in a turn, a power of two not below 64.
    pub count: usize,
    words: Vec<u64>,
}

impl Tube {
    pub fn full(points: usize) -> Self {
        Self { count: 256, words: vec![u64::MAX; points * 16] }
    }

    fn cells(&self, point: usize, class: usize) -> impl Iterator<Item = usize> + '_ {
        let per = self.count / 64;
        let words = &self.words[(point * 4 + class) * per..][..per];
        words.iter().enumerate().flat_map(|(w, word)| {
            let mut left = *word;
            std::iter::from_fn(move || {
                if left == 0 {
                    return None;
                }
                let bit = left.trailing_zeros() as usize;
                left &= left - 1;
                Some(w * 64 + bit)
            })
        })
    }

    fn clear(&mut self, point: usize, class: usize, cell: usize) {
        let per = self.count / 64;
        self.words[(point * 4 + class) * per + cell / 64] &= !(1 << (cell % 64));
    }

    fn clear_all(&mut self, point: usize, class: usize) {
        let per = self.count / 64;
        self.words[(point * 4 + class) * per..][..per].fill(0);
    }

    /// The same with cells half as wide.
    pub fn halved(&self) -> Self {
        let spread = |word: u32| {
            let mut out = 0u64;
            for bit in 0..32 {
                if word >> bit & 1 == 1 {
                    out |= 3 << (2 * bit);
                }
            }
            out
        };
        let words = self.words.iter().flat_map(|w| [spread(*w as u32), spread((*w >> 32) as u32)]).collect();
        Self { count: self.count * 2, words }
    }

    pub fn len(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }
}

/// Space of one thread.
#[derive(Debug, Default, Clone)]
pub(super) struct Space {
    costs: Vec<[f64; CORNERS]>,
    forward: Vec<[f64; CORNERS]>,
    alive: Vec<(usize, usize, Vec<u32>)>,
}

#[derive(Debug, Clone)]
pub(super) struct Evaluated {
    /// Least sum of the scores; infinite where nothing is feasible. m
    pub sum: f64,
    pub tube: Tube,
    pub states: usize,
}

const NOTHING: [f64; CORNERS] = [f64::INFINITY; CORNERS];

impl Bounded {
    pub fn debug(&self, region: &Region) {
        let half_cell = PI / 256.0;
        for (point, p) in self.points.iter().enumerate().step_by(10) {
            let Some(placed) = p.over(region) else { println!("{point} none"); continue };
            let load = Load::new(p, &placed);
            for class in PostureClass::ALL {
                let states = States { arm: &self.arm, class, first: self.first, sense: self.sense, region, placed: &placed, load: &load, half_cell };
                let level = self.table.level(states.half());
                let mut tally = [0; 4];
                let mut least = f64::INFINITY;
                let mut rests = vec![];
                if let Some(level) = level {
                    for cell in 0..256 {
                        let heading = placed.chi + self.sense * (2 * cell + 1) as f64 * half_cell;
                        let (node, off) = self.table.at(&self.arm, level, placed.r, placed.z, heading.rem_euclid(TAU), class);
                        match node {
                            Node::Empty => tally[0] += 1,
                            Node::Unknown => tally[1] += 1,
                            Node::Known(k) => { tally[2] += 1; let c = states.from_node(k, off); let m = c.iter().copied().fold(f64::INFINITY, f64::min); if m <= 0.0 { tally[3] += 1 } least = least.min(m); rests.push(k.rest[0] + k.rest[1]); }
                        }
                    }
                }
                println!("{point} r {:.3} z {:.3} half {:?} level {level:?} {class:?} empty {} unknown {} known {} zero {} least {:.2} um rests {:.2e} {:.2e}", placed.r, placed.z, states.half(), tally[0], tally[1], tally[2], tally[3], least * 1e6, rests.iter().copied().fold(f32::INFINITY, f32::min), rests.iter().copied().fold(0.0, f32::max));
            }
        }
    }

    /// Bounds a box from below; cells through which every way costs `ceiling` (m, sum) or more leave the tube.
    pub fn below(&self, region: &Region, tube: &Tube, ceiling: f64) -> Evaluated {
        let count = tube.count;
        let half_cell = PI / count as f64;
        let cell_angle = |k: usize| (2 * k + 1) as f64 * half_cell;
        let mut tube = tube.clone();
        let mut states = 0;
        let placed: Vec<_> = self.points.iter().map(|p| p.over(region)).collect();
        let mut totals = [0.0; CORNERS];
        let mut all: Vec<Ways> = Vec::new();
        let mut bests = Vec::new();
        let mut window = Window::new(count);
        for (segment, span) in self.segments.iter().enumerate() {
            let mut best = NOTHING;
            for class in PostureClass::ALL {
                let mut ways = Ways { segment, class: class.index(), costs: Vec::new(), sums: Vec::new(), cells: Vec::new() };
                let mut end = NOTHING;
                for (place, point) in span.clone().enumerate() {
                    let cells = self.cells(region, point, &placed[point], class, &mut tube, half_cell, &cell_angle);
                    states += cells.len();
                    let mut sums = vec![NOTHING; count];
                    let mut costs = vec![NOTHING; count];
                    let mut kept = Vec::with_capacity(cells.len());
                    end = NOTHING;
                    if place > 0 {
                        window.least(&ways.sums[place - 1], self.steps(point, half_cell));
                    }
                    for (cell, cost) in cells {
                        let sum = if place == 0 { cost } else { plus(&window.out[cell], &cost) };
                        if sum[0] < f64::INFINITY {
                            (sums[cell], costs[cell]) = (sum, cost);
                            least(&mut end, &sum);
                            kept.push(cell as u32);
                        } else {
                            tube.clear(point, class.index(), cell);
                        }
                    }
                    ways.sums.push(sums);
                    ways.costs.push(costs);
                    ways.cells.push(kept);
                    if end[0] == f64::INFINITY {
                        break;
                    }
                }
                if end[0] == f64::INFINITY {
                    for point in span.clone() {
                        tube.clear_all(point, class.index());
                    }
                    continue;
                }
                least(&mut best, &end);
                all.push(ways);
            }
            if best[0] == f64::INFINITY {
                return Evaluated { sum: f64::INFINITY, tube, states };
            }
            totals = plus(&totals, &best);
            bests.push(best);
        }
        let sum = totals.iter().copied().fold(f64::INFINITY, f64::min);
        if sum >= ceiling {
            return Evaluated { sum, tube, states };
        }
        // From the ends back: what leads to no good leaves the tube.
        for ways in &all {
            let span = &self.segments[ways.segment];
            let others: [f64; CORNERS] = std::array::from_fn(|k| totals[k] - bests[ways.segment][k]);
            let mut after = vec![NOTHING; count];
            for place in (0..span.len()).rev() {
                let point = span.start + place;
                if place + 1 < span.len() {
                    window.least(&after, self.steps(point + 1, half_cell));
                }
                let mut next = vec![NOTHING; count];
                for cell in ways.cells[place].iter().map(|c| *c as usize) {
                    let onward = if place + 1 == span.len() { [0.0; CORNERS] } else { window.out[cell] };
                    let sum = &ways.sums[place][cell];
                    let through = (0..CORNERS).map(|k| sum[k] + onward[k] + others[k]).fold(f64::INFINITY, f64::min);
                    if through >= ceiling {
                        tube.clear(point, ways.class, cell);
                    } else {
                        next[cell] = plus(&onward, &ways.costs[place][cell]);
                    }
                }
                after = next;
            }
        }
        Evaluated { sum, tube, states }
    }

    /// How many cells a way may step to either side, to `point` from the one before.
    fn steps(&self, point: usize, half_cell: f64) -> usize {
        let steps = self.rates[point] / (2.0 * half_cell) * (1.0 + 1e-9) + 1e-9;
        if steps >= PI / half_cell { (PI / half_cell) as usize } else { steps as usize + 1 }
    }

    /// The cells of one point and class that are not sure to be impossible, with their costs at the corners.
    #[allow(clippy::too_many_arguments)]
    fn cells(
        &self,
        region: &Region,
        point: usize,
        placed: &Option<super::region::Placed>,
        class: PostureClass,
        tube: &mut Tube,
        half_cell: f64,
        cell_angle: &impl Fn(usize) -> f64,
    ) -> Vec<(usize, [f64; CORNERS])> {
        let mut out = Vec::new();
        let wanted: Vec<usize> = tube.cells(point, class.index()).collect();
        let Some(placed) = placed else {
            return wanted.into_iter().map(|cell| (cell, [0.0; CORNERS])).collect();
        };
        let load = Load::new(&self.points[point], placed);
        let states = States {
            arm: &self.arm,
            class,
            first: self.first,
            sense: self.sense,
            region,
            placed,
            load: &load,
            half_cell,
        };
        let Some(level) = self.table.level(states.half()) else {
            return wanted.into_iter().map(|cell| (cell, [0.0; CORNERS])).collect();
        };
        let direct = level + 1 == self.table.depth();
        let mut batch: Vec<(usize, &[[f32; PAIRS]; FUNCTIONS], bool)> = Vec::with_capacity(WIDTH);
        let run = |batch: &mut Vec<(usize, &[[f32; PAIRS]; FUNCTIONS], bool)>,
                       out: &mut Vec<(usize, [f64; CORNERS])>,
                       tube: &mut Tube| {
            let Some(first) = batch.first().copied() else { return };
            let filled = batch.len();
            batch.resize(WIDTH, first);
            let (mut sine, mut cosine) = ([0.0; WIDTH], [0.0; WIDTH]);
            for (k, (cell, _, _)) in batch.iter().enumerate() {
                (sine[k], cosine[k]) = libm::sincos(placed.chi + self.sense * cell_angle(*cell));
            }
            let second: [[Lanes; PAIRS]; FUNCTIONS] = std::array::from_fn(|f| {
                std::array::from_fn(|p| Lanes(std::array::from_fn(|k| f64::from(batch[k].1[f][p]))))
            });
            let y = states.evaluate(Lanes(sine), Lanes(cosine));
            let fails = states.fails(&y, &second);
            let corners = states.model(&y, &second).corners(region, half_cell);
            for (k, (cell, _, sure)) in batch.iter().enumerate().take(filled) {
                if !sure && fails.lane(k) {
                    tube.clear(point, class.index(), *cell);
                } else if y.regular[2].lane(k) {
                    out.push((*cell, corners[k]));
                } else {
                    out.push((*cell, [0.0; CORNERS]));
                }
            }
            batch.clear();
        };
        for cell in wanted {
            let heading = placed.chi + self.sense * cell_angle(cell);
            let (node, off) = self.table.at(&self.arm, level, placed.r, placed.z, heading.rem_euclid(TAU), class);
            match node {
                Node::Empty => tube.clear(point, class.index(), cell),
                Node::Unknown => out.push((cell, [0.0; CORNERS])),
                Node::Known(known) if !direct => out.push((cell, states.from_node(known, off))),
                Node::Known(known) => {
                    batch.push((cell, &known.second, known.sure));
                    if batch.len() == WIDTH {
                        run(&mut batch, &mut out, tube);
                    }
                }
            }
        }
        run(&mut batch, &mut out, tube);
        out.sort_unstable_by_key(|(cell, _)| *cell);
        out
    }
}

/// The ways through one segment in one class: for each of its points the costs of the cells, and the least sums up to them.
struct Ways {
    segment: usize,
    class: usize,
    costs: Vec<Vec<[f64; CORNERS]>>,
    sums: Vec<Vec<[f64; CORNERS]>>,
    cells: Vec<Vec<u32>>,
}

fn plus(a: &[f64; CORNERS], b: &[f64; CORNERS]) -> [f64; CORNERS] {
    std::array::from_fn(|k| a[k] + b[k])
}

fn least(a: &mut [f64; CORNERS], b: &[f64; CORNERS]) {
    for k in 0..CORNERS {
        a[k] = a[k].min(b[k]);
    }
}

/// Least values within a number of steps to either side, around the circle.
struct Window {
    out: Vec<[f64; CORNERS]>,
    scratch: Vec<[f64; CORNERS]>,
}

impl Window {
    fn new(count: usize) -> Self {
        Self { out: vec![NOTHING; count], scratch: vec![NOTHING; count] }
    }

    /// Into `out`: for each cell the least of those up to `steps` away. By doubling: least of 1, 2, 4 ... neighbours.
    fn least(&mut self, values: &[[f64; CORNERS]], steps: usize) {
        let count = values.len();
        let width = (2 * steps + 1).min(count);
        self.scratch.copy_from_slice(values);
        let mut size = 1;
        while 2 * size <= width {
            for k in 0..count {
                self.out[k] = self.scratch[k];
                let other = self.scratch[(k + size) % count];
                least(&mut self.out[k], &other);
            }
            std::mem::swap(&mut self.out, &mut self.scratch);
            size *= 2;
        }
        for k in 0..count {
            let from = (k + count - steps.min(count / 2)) % count;
            self.out[k] = self.scratch[from];
            let other = self.scratch[(from + width - size) % count];
            least(&mut self.out[k], &other);
        }
    }
}
