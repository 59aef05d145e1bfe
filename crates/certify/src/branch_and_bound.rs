//! Boxes of placements, most promising first: the search that bounds from below and from above share.

use super::keeps_open::KeepsOpen;
use super::load::Objective;
use super::model::Keeps;
use super::region::Region;
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use stead_numerics::monitor::{Monitor, Progress, Stop};
use stead_problem::criterion::Aggregate;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// A bound of the objective over all placements of the cell: a lower one ([`super::best()`]), or an upper one
/// ([`super::worst()`]).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bound {
    /// The figure that is compared with. m
    pub value: f64,
    /// The placement of that score, where the search from above met a worse one than it was given.
    pub met: Option<Placement>,
    /// No placement in the cell, with any posture scheme and any plan of beta, has a lower one, up to rounding; or, of
    /// the worst, none with its best plan has a higher one. m
    pub bound: f64,
    /// Whether the rate of beta was kept.
    pub with_rate: bool,
    /// Whether the limits on the turn of the spindle along the path were kept.
    pub with_turn: bool,
    /// Boxes bounded.
    pub nodes: usize,
    /// How the search ended.
    pub status: Status,
    /// Where it fell short of what was requested: what is known of the states of the boxes of least bound.
    pub keeps_open: Option<KeepsOpen>,
    /// Boxes that may hold placements better (of the worst: worse) than `value` by more than the gap requested, each
    /// with its own bound. m
    pub open: Vec<(Region, f64)>,
}

/// The open boxes of a part of a problem that is bounded by itself: of one orientation of the part, and of one segment.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct OpenIn {
    /// The name of the orientation, where there are several.
    pub orientation: Option<String>,
    /// The number of the segment, from 1, where segments are bounded one by one.
    pub segment: Option<usize>,
    /// How many boxes are open in it.
    pub boxes: usize,
}

/// How a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The gap requested is reached.
    Reached,
    /// What is left open is smaller than the tables can distinguish.
    Exhausted,
    /// Each segment is bounded at its own best placement, as closely as requested or as the tables can; that they share
    /// one is what is left.
    SegmentsApart,
    /// The time was over.
    TimeLimit,
    /// The memory was used up.
    Memory,
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
pub(super) const BATCH: usize = 64;
/// Half widths of the boxes that tables are first requested in detail: radius and height (m), yaw (rad).
const START: [f64; 3] = [0.009, 0.0125, 0.0157];
/// Boxes whose half widths are this much smaller are not cut further.
const SMALLEST: f64 = 1.0 / 256.0;
/// What rounding may have taken from a bound, relative to it.
const ROUNDING: f64 = 1e-9;

/// The side to cut a box at, and its half width in terms of the start.
pub(super) fn widest(region: &Region) -> (usize, f64) {
    let size = |k: usize| region.half[k] / START[k];
    (1..3).fold((0, size(0)), |(side, max), k| if size(k) > max { (k, size(k)) } else { (side, max) })
}

/// The halves of a box; `None` where it is not to be cut further.
pub(super) fn halves(region: &Region) -> Option<[Region; 2]> {
    let (side, size) = widest(region);
    (size > SMALLEST).then(|| region.split(side))
}

/// A box whose bound is known.
pub(super) struct Open<T> {
    /// What the points together do not get past in it.
    pub bound: f64,
    pub region: Region,
    /// What else is known of it.
    pub known: T,
}

/// What a search is for.
pub(super) struct BranchAndBound {
    /// From below, or from above.
    pub sense: Sense,
    /// The figure that is compared with. m
    pub value: f64,
    /// What is requested, relative to the value.
    pub gap: f64,
    /// What is kept of the limits on beta along the path: its rate, and the turn of the spindle.
    pub keeps: Keeps,
    /// How the costs of the points make up the value.
    pub objective: Objective,
    /// Memory for tables and boxes. Bytes
    pub memory: u64,
}

/// What a search is made of.
pub(super) struct Parts<T, P, U, B, C> {
    /// The boxes to begin with.
    pub start: Vec<Open<T>>,
    /// The number of boxes bounded before.
    pub nodes: usize,
    /// Those of a box, `None` where it is not to be cut further.
    pub of: P,
    /// What the tables take. Bytes
    pub used: U,
    /// What is known of a box takes. Bytes
    pub bytes: B,
    /// Counts what is known of the states of a box, and what takes its bound down.
    pub count: C,
}

/// A box in the queue.
struct Queued<T> {
    /// The bound, its sign changed where small bounds come first.
    rank: f64,
    /// Of equal ranks the greater one comes first.
    priority: u64,
    /// What is known of it takes.
    bytes: u64,
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
    /// Reports the state of the search: the bound (m), the boxes still open and those bounded so far. Returns why the
    /// search should end with what it has, if it should.
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

    /// What the points have to cost together for a box to be of interest.
    pub fn ceiling(&self) -> f64 {
        let sign = self.sign();
        let farther = |sum: f64| sum * (1.0 + sign * self.gap) * (1.0 - sign * ROUNDING);
        let sum = farther(self.objective.sum(self.value));
        // A sum of squares grows with the square of its root.
        if self.objective.aggregate == Aggregate::Rms { farther(sum) } else { sum }
    }

    /// The bound of a search that was stopped before anything was known: none.
    pub fn not_begun(&self, whole: Region, stop: Stop) -> Bound {
        self.found(None, 0.0, 0, stop.into(), vec![(whole, 0.0)])
    }

    fn found(
        &self,
        met: Option<Placement>,
        bound: f64,
        nodes: usize,
        status: Status,
        open: Vec<(Region, f64)>,
    ) -> Bound {
        let Keeps { with_rate, with_turn } = self.keeps;
        Bound { value: self.value, met, bound, with_rate, with_turn, nodes, status, keeps_open: None, open }
    }

    /// The bound where the points together do not get past `sum`.
    fn rounded(&self, sum: f64) -> f64 {
        self.objective.value(sum) * (1.0 + self.sign() * ROUNDING)
    }

    /// What a search from below that ended like this has found: the points come to `sum` at least.
    pub fn ended(&self, sum: f64, nodes: usize, status: Status, open: Vec<(Region, f64)>) -> Bound {
        self.found(None, self.rounded(sum.min(self.ceiling())), nodes, status, open)
    }

    /// Goes from boxes to their parts until no bound is past the ceiling, the caller ends it, the memory is used up, or
    /// the bound can no longer change.
    ///
    /// Where bounds are the same, the younger box comes first: boxes that tables cannot distinguish are found by going
    /// down, not by cutting all of it. Only from above, where nothing is known of them yet, the boxes to begin with
    /// come before, in the order given. Where boxes are left that tables cannot distinguish, `improve` is asked for a
    /// value further out than the one compared with, from among them; with one the search goes on. The result does not
    /// depend on the number of threads. Where it ends by itself before what was requested, what keeps boxes open is
    /// counted.
    pub fn explore<T: Send + Sync>(
        mut self,
        mut parts: Parts<
            T,
            impl Fn(&Open<T>) -> Option<Vec<Open<T>>> + Sync,
            impl Fn() -> u64 + Sync,
            impl Fn(&T) -> u64 + Sync,
            impl Fn(&mut KeepsOpen, &Region, &T) + Sync,
        >,
        monitor: &Monitor,
        mut improve: impl FnMut(&[Region]) -> Option<(f64, Placement)>,
    ) -> Bound {
        let mut queue = Queue::new(self.sign(), self.sense, std::mem::take(&mut parts.start));
        let (mut nodes, mut met) = (parts.nodes, None);
        let status = loop {
            if let Err(status) = self.refine(&mut queue, &mut nodes, monitor, &parts) {
                break status;
            }
            if queue.stuck.is_empty() {
                break Status::Reached;
            }
            match improve(&queue.most_stuck()) {
                Some((value, placement)) => {
                    (self.value, met) = (value, Some(placement));
                    queue.keep_past(self.sign() * self.ceiling());
                }
                None => break monitor.stop().map_or(Status::Exhausted, Status::from),
            }
        };
        let sign = self.sign();
        let left = queue.left();
        let farthest = left.iter().map(|queued| queued.rank).fold(sign * self.ceiling(), f64::max);
        let bound = self.rounded(sign * farthest);
        let value = |queued: &Queued<T>| self.objective.value(queued.open.bound);
        let open = left.iter().map(|queued| (queued.open.region, value(queued))).collect();
        let mut found = self.found(met, bound, nodes, status, open);
        if !matches!(status, Status::Reached | Status::Interrupted) {
            let known: Vec<T> = left.into_iter().map(|queued| queued.open.known).collect();
            let seconds = |kept: KeepsOpen| kept.seconds.filter(|_| status == Status::TimeLimit);
            let kept = KeepsOpen::of(&found.open, &known, parts.count);
            found.keeps_open = kept.map(|kept| KeepsOpen { seconds: seconds(kept), ..kept });
        }
        found
    }

    /// Cuts boxes until none is left, or the bound stays where boxes are that are not to be cut further.
    ///
    /// # Errors
    /// Why it ended before that.
    fn refine<T: Send + Sync>(
        &self,
        queue: &mut Queue<T>,
        nodes: &mut usize,
        monitor: &Monitor,
        parts: &Parts<
            T,
            impl Fn(&Open<T>) -> Option<Vec<Open<T>>> + Sync,
            impl Fn() -> u64 + Sync,
            impl Fn(&T) -> u64 + Sync,
            impl Fn(&mut KeepsOpen, &Region, &T) + Sync,
        >,
    ) -> Result<(), Status> {
        let ceiling = self.sign() * self.ceiling();
        while let Some(first) = queue.heap.peek() {
            // Whatever becomes of the others, the bound stays there.
            if queue.stuck.iter().any(|stuck| stuck.rank >= first.rank) {
                break;
            }
            let bound = self.objective.value(first.open.bound);
            if let Some(stop) = self.report(monitor, bound, queue.heap.len() + queue.stuck.len(), *nodes) {
                return Err(stop.into());
            }
            if (parts.used)().saturating_add(queue.bytes) > self.memory {
                return Err(Status::Memory);
            }
            let batch: Vec<_> = std::iter::from_fn(|| queue.heap.pop()).take(BATCH).collect();
            // What a box comes to after the caller has asked to stop says nothing: it stays as it was.
            let of = |queued: &Queued<T>| match monitor.stop() {
                Some(stop) => Err(stop),
                None => Ok((parts.of)(&queued.open)).and_then(|cut| monitor.stop().map_or(Ok(cut), Err)),
            };
            // One by one: a box may take as long as many others, and a thread that has sixteen in hand at the end keeps
            // the other waiting.
            let results: Vec<_> = batch.par_iter().with_max_len(1).map(of).collect();
            let mut stopped = None;
            for (whole, cut) in batch.into_iter().zip(results) {
                let cut = match cut {
                    Ok(cut) => cut,
                    Err(stop) => {
                        stopped = Some(stop);
                        queue.heap.push(whole);
                        continue;
                    }
                };
                let Some(cut) = cut else {
                    queue.stuck.push(whole);
                    continue;
                };
                queue.bytes -= whole.bytes;
                *nodes += cut.len();
                for part in cut {
                    let bytes = (parts.bytes)(&part.known);
                    queue.push(part, bytes, ceiling);
                }
            }
            if let Some(stop) = stopped {
                return Err(stop.into());
            }
        }
        Ok(())
    }
}

/// The boxes of a search.
struct Queue<T> {
    sign: f64,
    /// Boxes met so far.
    number: u64,
    heap: BinaryHeap<Queued<T>>,
    /// Boxes that are not to be cut further.
    stuck: Vec<Queued<T>>,
    /// What is known of all of them takes; the boxes to begin with share it.
    bytes: u64,
}

/// Boxes among which a value further out is sought at a time.
const SOUGHT: usize = 4;

impl<T> Queue<T> {
    fn new(sign: f64, sense: Sense, start: Vec<Open<T>>) -> Self {
        let mut queue = Self { sign, number: 0, heap: BinaryHeap::new(), stuck: Vec::new(), bytes: 0 };
        for open in start {
            queue.number += 1;
            let priority = if sense == Sense::Min { queue.number } else { u64::MAX - queue.number };
            queue.heap.push(Queued { rank: sign * open.bound, priority, bytes: 0, open });
        }
        queue
    }

    /// Adds a box, if it is past the ceiling.
    fn push(&mut self, open: Open<T>, bytes: u64, ceiling: f64) {
        self.number += 1;
        let queued = Queued { rank: self.sign * open.bound, priority: self.number, bytes, open };
        if queued.rank > ceiling {
            self.bytes += bytes;
            self.heap.push(queued);
        }
    }

    /// The boxes not to be cut further that are farthest out.
    fn most_stuck(&self) -> Vec<Region> {
        let mut stuck: Vec<&Queued<T>> = self.stuck.iter().collect();
        stuck.sort_by(|a, b| b.cmp(a));
        stuck.into_iter().take(SOUGHT).map(|queued| queued.open.region).collect()
    }

    /// Leaves out boxes that are not past a ceiling.
    fn keep_past(&mut self, ceiling: f64) {
        self.stuck.retain(|queued| queued.rank > ceiling);
        self.heap.retain(|queued| queued.rank > ceiling);
        self.bytes = self.stuck.iter().chain(&self.heap).map(|queued| queued.bytes).sum();
    }

    /// All of them, the farthest out first, then those that are not to be cut further.
    fn left(self) -> Vec<Queued<T>> {
        let mut left = self.heap.into_sorted_vec();
        left.reverse();
        left.extend(self.stuck);
        left
    }
}
