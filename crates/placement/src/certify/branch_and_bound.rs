//! Boxes of placements, most promising first: the search that bounds from below and from above share.

use super::region::Region;
use crate::sense::Sense;
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use stead_numerics::monitor::{Monitor, Progress, Stop};

/// A bound of the objective over all placements of the cell: a lower one ([`super::best()`]), or an upper one ([`super::worst()`]).
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// How the search ended.
    pub status: Status,
    /// Boxes that may hold placements better (of the worst: worse) than `value` by more than the gap asked for, each with its
    /// own bound. m
    pub open: Vec<(Region, f64)>,
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The gap asked for is reached.
    Reached,
    /// What is left open is smaller than the tables can tell apart.
    Exhausted,
    /// The time was over.
    TimeLimit,
    /// The caller ended it.
    Interrupted,
}

impl From<Stop> for Status {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::Asked => Self::Interrupted,
            Stop::Deadline => Self::TimeLimit,
        }
    }
}

impl Bound {
    /// How much better (of the worst: worse) than the value a placement may be, relative to the value.
    pub fn gap(&self) -> f64 {
        (1.0 - self.bound / self.value).abs()
    }
}

/// Boxes taken at once; the result depends on it, so it is fixed.
const BATCH: usize = 64;
/// Half widths of the boxes that tables are first asked for in detail: radius and height (m), yaw (rad).
const START: [f64; 3] = [0.009, 0.0125, 0.0157];
/// Boxes whose half widths are this much smaller are not cut further.
const SMALLEST: f64 = 1.0 / 256.0;
/// What rounding may have taken from a bound, relative to it.
const ROUNDING: f64 = 1e-9;

/// The side to cut a box at, and its half width in terms of the start.
pub(super) fn widest(region: &Region) -> (usize, f64) {
    let size = |k: usize| region.half[k] / START[k];
    (1..3).fold((0, size(0)), |(side, most), k| if size(k) > most { (k, size(k)) } else { (side, most) })
}

/// The halves of a box; `None` where it is not to be cut further.
pub(super) fn halves(region: &Region) -> Option<[Region; 2]> {
    let (side, size) = widest(region);
    (size > SMALLEST).then(|| region.split(side))
}

/// A box whose bound is known.
pub(super) struct Open<T> {
    /// What the sum over the points does not get past in it. m
    pub bound: f64,
    pub region: Region,
    /// What else is known of it.
    pub known: T,
}

/// What a search is for.
pub(super) struct BranchAndBound {
    /// From below, or from above.
    pub sense: Sense,
    /// The mean score that is compared with. m
    pub value: f64,
    /// What is asked for, relative to the value.
    pub gap: f64,
    /// Whether the rate of beta is kept.
    pub with_rate: bool,
    /// Number of path points.
    pub points: usize,
}

/// A box in the queue.
struct Queued<T> {
    /// The bound, its sign changed where small bounds come first.
    rank: f64,
    /// Of equal ranks the greater one comes first.
    priority: u64,
    open: Open<T>,
}

impl<T> PartialEq for Queued<T> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl<T> Eq for Queued<T> {}

impl<T> PartialOrd for Queued<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<T> Ord for Queued<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.rank.total_cmp(&other.rank).then(self.priority.cmp(&other.priority))
    }
}

impl BranchAndBound {
    /// Reports the state of the search: the bound (m), the boxes still open and those bounded so far. Returns why the search
    /// should end with what it has, if it should.
    pub fn report(&self, monitor: &Monitor, bound: f64, open: usize, nodes: usize) -> Option<Stop> {
        let stage = match self.sense {
            Sense::Min => "certifying best",
            Sense::Max => "certifying worst",
        };
        monitor.report(Progress::Bound { stage, value: self.value, bound, gap: self.gap, open, nodes });
        monitor.stop()
    }

    /// 1 where great bounds come first, -1 where small ones do.
    fn sign(&self) -> f64 {
        match self.sense {
            Sense::Min => -1.0,
            Sense::Max => 1.0,
        }
    }

    /// What the sum over the points has to get past for a box to be of interest. m
    pub fn ceiling(&self) -> f64 {
        let sign = self.sign();
        self.value * self.points as f64 * (1.0 + sign * self.gap) * (1.0 - sign * ROUNDING)
    }

    /// Goes from boxes to their parts until no bound is past the ceiling, the caller ends it, or the bound can no longer change.
    ///
    /// `nodes` is the number of boxes bounded before; `parts` gives those of a box, `None` where it is not to be cut further.
    /// Where bounds are the same, the younger box comes first: boxes that tables cannot distinguish are found by going down, not by cutting
    /// all of it. Only from above, where nothing is known of them yet, the boxes to begin with come before, in the order given.
    /// The result does not depend on the number of threads.
    pub fn explore<T: Send + Sync>(
        &self,
        start: Vec<Open<T>>,
        mut nodes: usize,
        monitor: &Monitor,
        parts: impl Fn(&Open<T>) -> Option<Vec<Open<T>>> + Sync,
    ) -> Bound {
        let (sign, count) = (self.sign(), self.points as f64);
        let ceiling = sign * self.ceiling();
        let queued = |open: Open<T>, priority: u64| Queued { rank: sign * open.bound, priority, open };
        let mut number = 0;
        let mut heap = BinaryHeap::new();
        for open in start {
            number += 1;
            heap.push(queued(open, if self.sense == Sense::Min { number } else { u64::MAX - number }));
        }
        let mut stuck: Vec<Queued<T>> = Vec::new();
        let mut status = Status::Reached;
        while let Some(first) = heap.peek() {
            // Whatever becomes of the others, the bound stays there.
            if stuck.iter().any(|stuck| stuck.rank >= first.rank) {
                break;
            }
            if let Some(stop) = self.report(monitor, first.open.bound / count, heap.len() + stuck.len(), nodes) {
                status = stop.into();
                break;
            }
            let batch: Vec<_> = std::iter::from_fn(|| heap.pop()).take(BATCH).collect();
            let results: Vec<_> = batch.par_iter().map(|queued| parts(&queued.open)).collect();
            for (whole, parts) in batch.into_iter().zip(results) {
                let Some(parts) = parts else {
                    stuck.push(whole);
                    continue;
                };
                nodes += parts.len();
                for part in parts {
                    number += 1;
                    let part = queued(part, number);
                    if part.rank > ceiling {
                        heap.push(part);
                    }
                }
            }
        }
        if status == Status::Reached && !stuck.is_empty() {
            status = Status::Exhausted;
        }
        let mut left = heap.into_sorted_vec();
        left.reverse();
        left.extend(stuck);
        let farthest = left.iter().map(|queued| queued.rank).fold(ceiling, f64::max);
        let bound = sign * farthest / count * (1.0 + sign * ROUNDING);
        let open = left.iter().map(|queued| (queued.open.region, queued.open.bound / count)).collect();
        Bound { value: self.value, bound, with_rate: self.with_rate, nodes, status, open }
    }
}
