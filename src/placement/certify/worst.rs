//! The worst placement: an upper bound of what placements are worth, limits between neighbouring points dropped.
//!
//! Dropping limits lowers what a placement is worth, so this is no upper bound of values with the rate of beta or joint steps.

use super::above::{Over, Seen};
use super::bound::Bounded;
use super::prepare::{Unfit, certifiable, prepared};
use super::region::Region;
use super::search::{BATCH, Bound, End, ROUNDING, SMALLEST, State, Watch, widest};
use super::table::{Steps, Table};
use crate::placement::problem::Problem;
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

/// Steps of the coarsest tables, and their number: one level more than lower bounds have, for a first look.
const STEPS: Steps = Steps { length: 0.05, headings: 64 };
const LEVELS: usize = 5;
/// Boxes to begin with are cut to what tables can answer for, but no smaller than this, in terms of those of lower bounds.
const SMALL: f64 = 0.25;

struct Open {
    bound: f64,
    number: u64,
    region: Region,
    /// `None` for one not looked at yet.
    seen: Option<Arc<Seen>>,
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
    /// The greatest bound first; of equal ones those not looked at yet, and of these the older, but else the younger: what cannot
    /// be told apart is found by going down, not by cutting all of it.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_age = |a: &Self, b: &Self| match (&a.seen, &b.seen) {
            (Some(_), Some(_)) => a.number.cmp(&b.number),
            (None, None) => b.number.cmp(&a.number),
            (None, Some(_)) => Ordering::Greater,
            (Some(_), None) => Ordering::Less,
        };
        self.bound.total_cmp(&other.bound).then_with(|| by_age(self, other))
    }
}

/// Bounds from above what placements of a problem are worth with the limits between neighbouring points dropped, until none can
/// be worse than `value` ([`super::relaxed_value`] of the worst placement known, m) by more than `gap` (relative).
///
/// The rate of beta, joint steps, the limits of joints 1, 4 and 6 and the largest deflection of a point are relaxed, both in
/// which placements count and in what they are worth: see [`super::relaxed_value`]. The result does not depend on the number of
/// threads.
///
/// # Errors
/// Why the problem cannot be certified this way.
pub fn worst(problem: &Problem, value: f64, gap: f64, watch: &mut dyn Watch) -> Result<Bound, Unfit> {
    certifiable(problem)?;
    let compliances = problem.robot.constant_compliances().ok_or(Unfit::VaryingCompliance)?;
    let (bounded, whole) = prepared(problem, &compliances, false);
    let (extent, _) = bounded.table.grid();
    let bounded = Bounded { table: Table::new(extent, STEPS, LEVELS), ..bounded };
    let count = bounded.points.len() as f64;
    let ceiling = value * count * (1.0 + gap) * (1.0 - ROUNDING);
    let mut heap = BinaryHeap::new();
    let mut number = 0;
    for region in first(&bounded, whole) {
        number += 1;
        heap.push(Open { bound: f64::INFINITY, number, region, seen: None });
    }
    let mut nodes = 0;
    let mut stuck: Vec<Open> = Vec::new();
    let mut end = End::Reached;
    while let Some(first) = heap.peek() {
        let most_stuck = stuck.iter().map(|o| o.bound).fold(f64::NEG_INFINITY, f64::max);
        // Whatever becomes of the others, the bound stays there.
        if most_stuck >= first.bound {
            break;
        }
        if !watch.goes_on(&State { bound: first.bound / count, open: heap.len() + stuck.len(), nodes }) {
            end = End::Stopped;
            break;
        }
        let batch: Vec<Open> = std::iter::from_fn(|| heap.pop()).take(BATCH).collect();
        let results: Vec<Option<Vec<Open>>> = batch.par_iter().map(|open| children(&bounded, open, ceiling)).collect();
        for (open, children) in batch.into_iter().zip(results) {
            let Some(children) = children else {
                stuck.push(open);
                continue;
            };
            for child in children {
                nodes += 1;
                if child.bound > ceiling {
                    number += 1;
                    heap.push(Open { number, ..child });
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
    let highest = left.iter().map(|o| o.bound).fold(ceiling, f64::max);
    let open = left.iter().map(|o| (o.region, o.bound / count)).collect();
    Ok(Bound { value, bound: highest / count * (1.0 + ROUNDING), with_rate: false, nodes, end, open })
}

/// The boxes to begin with, together all of the cell.
fn first(bounded: &Bounded, whole: Region) -> Vec<Region> {
    let (mut open, mut out) = (vec![whole], Vec::new());
    while let Some(region) = open.pop() {
        match widest(&region) {
            _ if !bounded.yaws.allow(&region) => {}
            (_, size) if size <= SMALL || bounded.level(&region).is_some() => out.push(region),
            (side, _) => open.extend(region.split(side)),
        }
    }
    out
}

/// A box not looked at yet with its bound, or the halves of one with theirs; `None` where it is not to be cut further.
fn children(bounded: &Bounded, open: &Open, ceiling: f64) -> Option<Vec<Open>> {
    let (parts, seen) = match &open.seen {
        None => (vec![open.region], Arc::new(Seen::nothing(bounded))),
        Some(seen) => match widest(&open.region) {
            (_, size) if size <= SMALLEST => return None,
            (side, _) => (open.region.split(side).to_vec(), Arc::clone(seen)),
        },
    };
    let bound = |region: Region| match Over::new(bounded, &region) {
        Some(over) => {
            let glance = if open.seen.is_none() { over.glance(ceiling) } else { f64::INFINITY };
            if glance <= ceiling {
                return Open { bound: glance, number: 0, region, seen: None };
            }
            let (sum, seen) = over.above(&seen, ceiling);
            Open { bound: sum.min(open.bound), number: 0, region, seen: Some(Arc::new(seen)) }
        }
        None => Open { bound: open.bound, number: 0, region, seen: Some(Arc::clone(&seen)) },
    };
    Some(parts.into_iter().filter(|part| bounded.yaws.allow(part)).map(bound).collect())
}

#[cfg(test)]
mod tests;
