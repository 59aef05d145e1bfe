//! Best first over boxes of placements.

use super::bound::{Bounded, Evaluated};
use super::prepare::{Unfit, certifiable, prepared};
use super::reduced::Reduced;
use super::region::Region;
use super::tube::Tube;
use crate::placement::problem::Problem;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// How far the search has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// No placement has a mean score below, or, of the worst, above. m
    pub bound: f64,
    /// Boxes still open.
    pub open: usize,
    /// Boxes bounded so far.
    pub nodes: usize,
}

/// The caller's side of a certificate. Called from one thread.
pub trait Watch {
    /// Takes the state of the search; false to end it with what it has.
    fn goes_on(&mut self, state: &State) -> bool;
}

/// A bound of what placements of the cell are worth: a lower one ([`best`]), or an upper one ([`super::worst()`]).
#[derive(Debug, Clone, PartialEq)]
pub struct Bound {
    /// The mean score that was compared with. m
    pub value: f64,
    /// No placement in the cell, with any posture scheme and any plan of beta, has a mean score below, up to rounding; or, of the
    /// worst, none with its best plan has a mean score above. m
    pub bound: f64,
    /// Whether the rate of beta was kept.
    pub with_rate: bool,
    /// Boxes bounded.
    pub nodes: usize,
    /// Why the search ended.
    pub end: End,
    /// Boxes that may hold placements better (of the worst: worse) than `value` by more than the gap asked for, each with its
    /// own bound. m
    pub open: Vec<(Region, f64)>,
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// The gap asked for is reached.
    Reached,
    /// The caller ended it.
    Stopped,
    /// What is left open is smaller than the tables can tell apart.
    Exhausted,
}

impl Bound {
    /// How much better (of the worst: worse) than the value a placement may be, relative to the value.
    pub fn gap(&self) -> f64 {
        (1.0 - self.bound / self.value).abs()
    }
}

/// Boxes taken at once; the result depends on it, so it is fixed.
pub(super) const BATCH: usize = 64;
/// Half widths of the boxes that tables are first asked for in detail: radius and height (m), yaw (rad).
pub(super) const START: [f64; 3] = [0.009, 0.0125, 0.0157];
/// Boxes whose half widths are this much smaller are not cut further.
pub(super) const SMALLEST: f64 = 1.0 / 256.0;
/// What rounding may have taken from a bound, relative to it.
pub(super) const ROUNDING: f64 = 1e-9;

struct Open {
    bound: f64,
    number: u64,
    region: Region,
    tube: Arc<Tube>,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    /// The least bound first, of equal ones the younger: what cannot be told apart is found by going down, not by cutting all of it.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(self.number.cmp(&other.number))
    }
}

/// Bounds from below what placements of a problem are worth, until no placement can be better than `value` (mean score, m)
/// by more than `gap` (relative).
///
/// Limits between neighbouring points other than the rate of beta, and those of joints 1, 4 and 6, are relaxed; without
/// `with_rate` that of beta as well. The result does not depend on the number of threads.
///
/// # Errors
/// Why the problem cannot be certified this way.
pub fn best(problem: &Problem, value: f64, gap: f64, with_rate: bool, watch: &mut dyn Watch) -> Result<Bound, Unfit> {
    certifiable(problem)?;
    let compliances = problem.robot.constant_compliances().ok_or(Unfit::VaryingCompliance)?;
    let (bounded, whole) = prepared(problem, &compliances, with_rate);
    // Of no placement anything is known until the tables are made.
    let unknown = State { bound: 0.0, open: 1, nodes: 0 };
    let Some(reduced) = Reduced::new(&bounded, || watch.goes_on(&unknown)) else {
        return Ok(Bound { value, bound: 0.0, with_rate, nodes: 0, end: End::Stopped, open: vec![(whole, 0.0)] });
    };
    let count = bounded.points.len() as f64;
    let ceiling = value * count * (1.0 - gap) * (1.0 + ROUNDING);
    let mut heap = BinaryHeap::new();
    let mut nodes = 0;
    let tube = Arc::new(Tube::full(bounded.points.len(), bounded.table.headings(0)));
    let mut number = 0;
    for (bound, region) in survivors(&bounded, &reduced, whole, ceiling, &mut nodes) {
        number += 1;
        heap.push(Open { bound, number, region, tube: Arc::clone(&tube) });
    }
    drop(reduced);
    let mut stuck: Vec<Open> = Vec::new();
    let mut end = End::Reached;
    while let Some(first) = heap.peek() {
        let least_stuck = stuck.iter().map(|o| o.bound).fold(f64::INFINITY, f64::min);
        // Whatever becomes of the others, the bound stays there.
        if least_stuck <= first.bound {
            break;
        }
        let lowest = first.bound;
        let state = State { bound: lowest / count, open: heap.len() + stuck.len(), nodes };
        if !watch.goes_on(&state) {
            end = End::Stopped;
            break;
        }
        let batch: Vec<Open> = std::iter::from_fn(|| heap.pop()).take(BATCH).collect();
        let results: Vec<Option<Vec<(Region, Evaluated)>>> =
            batch.par_iter().map(|open| children(&bounded, open, ceiling)).collect();
        for (open, children) in batch.into_iter().zip(results) {
            let Some(children) = children else {
                stuck.push(open);
                continue;
            };
            for (region, e) in children {
                nodes += 1;
                let bound = e.sum.max(open.bound);
                if bound < ceiling {
                    number += 1;
                    heap.push(Open { bound, number, region, tube: Arc::new(e.tube) });
                }
            }
        }
    }
    if end == End::Reached && !stuck.is_empty() {
        end = End::Exhausted;
    }
    let mut left = heap.into_sorted_vec();
    left.reverse();
    left.extend(stuck);
    let lowest = left.iter().map(|o| o.bound).fold(ceiling, f64::min);
    let open = left.iter().map(|o| (o.region, o.bound / count)).collect();
    Ok(Bound { value, bound: lowest / count * (1.0 - ROUNDING), with_rate, nodes, end, open })
}

/// The boxes that the reduced tables leave open.
fn survivors(
    bounded: &Bounded,
    reduced: &Reduced,
    whole: Region,
    ceiling: f64,
    nodes: &mut usize,
) -> Vec<(f64, Region)> {
    let mut open = vec![whole];
    let mut left = Vec::new();
    while !open.is_empty() {
        *nodes += open.len();
        let bounds: Vec<Option<f64>> = open.par_iter().map(|region| reduced.below(bounded, region)).collect();
        let mut next = Vec::new();
        for (region, bound) in open.iter().zip(bounds) {
            if bound.is_some_and(|bound| bound >= ceiling) || !bounded.yaws.allow(region) {
                continue;
            }
            match widest(region) {
                (_, size) if size <= 1.0 => left.push((bound.unwrap_or(0.0).max(0.0), *region)),
                (side, _) => next.extend(region.split(side)),
            }
        }
        open = next;
    }
    left
}

/// The side to cut a box at, and its half width in terms of the start.
pub(super) fn widest(region: &Region) -> (usize, f64) {
    let size = |k: usize| region.half[k] / START[k];
    (1..3).fold((0, size(0)), |(side, most), k| if size(k) > most { (k, size(k)) } else { (side, most) })
}

/// The halves of a box with their bounds; `None` where it is not to be cut further.
fn children(bounded: &Bounded, open: &Open, ceiling: f64) -> Option<Vec<(Region, Evaluated)>> {
    let (side, size) = widest(&open.region);
    if size <= SMALLEST {
        return None;
    }
    let halves = open.region.split(side).into_iter().filter(|half| bounded.yaws.allow(half));
    let bounds = halves.map(|half| {
        let level = bounded.level(&half).unwrap_or(0);
        let mut tube = (*open.tube).clone();
        while tube.level < level {
            tube = tube.halved();
        }
        let found = bounded.below(&half, &tube, ceiling);
        (half, found)
    });
    Some(bounds.collect())
}
