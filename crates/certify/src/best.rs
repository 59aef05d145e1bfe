//! The best placement: a lower bound of the objective.

use super::active_cells::ActiveCells;
use super::branch_and_bound::{Bound, BranchAndBound, Open, Parts, halves, widest};
use super::cell::whole;
use super::coarse_bounds::CoarseBounds;
use super::cost::Without;
use super::keeps_open::{KeepsOpen, some_points};
use super::leaning;
use super::model::Model;
use super::region::Region;
use super::requirements::Leaf;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use stead_numerics::monitor::{Monitor, Stop};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;

/// Bounds the objective of all placements from below: see [`super::best()`].
pub(super) fn bound_of(leaf: &Leaf, value: f64, settings: &CertificateSettings, monitor: &Monitor) -> Bound {
    match leaf.leans {
        true => leaning::best(&leaf.problem, &leaf.pieces, value, settings, monitor),
        false => upright(leaf, value, settings, monitor),
    }
}

/// The same of an upright tool.
fn upright(leaf: &Leaf, value: f64, settings: &CertificateSettings, monitor: &Monitor) -> Bound {
    let CertificateSettings { gap, memory, .. } = *settings;
    let (spent, threads) = (Spent::default(), rayon::current_num_threads() as u64);
    let since = Instant::now();
    let (model, whole) = (Model::of(&leaf.problem, &leaf.pieces), whole(&leaf.problem));
    let Model { keeps, objective, .. } = model;
    let search = BranchAndBound { sense: Sense::Min, value, gap, keeps, objective, memory };
    // Of no placement anything is known until the tables are made.
    let ceiling = search.ceiling();
    let coarse = CoarseBounds::new(&model, monitor, || search.report(monitor, 0.0, 1, 0));
    let begun = coarse.and_then(|coarse| {
        let left = survivors(&model, &coarse, whole, ceiling, monitor)?;
        Ok((coarse, left))
    });
    let (coarse, (left, nodes)) = match begun {
        Ok(begun) => begun,
        Err(stop) => return search.not_begun(whole, stop),
    };
    spent.add(TABLES, threads, since);
    let full = Arc::new(ActiveCells::full(model.points.len(), model.table.headings(0)));
    // Parts of finer tables are for many boxes each: for a few the cells of heading take less time.
    let since = Instant::now();
    let at_once = left.len() < MANY || with_cells_at_once(&model, &coarse, &left, ceiling, monitor);
    spent.add(CELLS, threads, since);
    let known = at_once.then(|| Arc::clone(&full));
    let start = left.into_iter().map(|(bound, region)| Open { bound, region, known: known.clone() }).collect();
    let all = Parts {
        start,
        nodes,
        of: |open: &Open<Known>| spent.on_parts(|| parts(&model, &coarse, open, ceiling, monitor)),
        used: || model.used() + coarse.used(),
        bytes: |active: &Known| active.as_ref().map_or(0, |active| active.bytes()),
        count: |counted: &mut KeepsOpen, region: &Region, known: &Known| {
            count_box(&model, counted, region, known, value);
            counted.seconds = Some(spent.seconds());
        },
    };
    search.explore(all, monitor, |_| None)
}

/// Counts what is known of the states of a box, and what takes its bound down.
pub(super) fn count_box(model: &Model, counted: &mut KeepsOpen, region: &Region, known: &Known, value: f64) {
    let full = || Arc::new(ActiveCells::full(model.points.len(), model.table.headings(0)));
    let active = known.clone().unwrap_or_else(full);
    some_points(model.points.len()).for_each(|point| counted.add_point(model, region, &active, point));
    let open = Open { bound: 0.0, region: *region, known: None };
    let own = known.clone().or_else(|| with_cells(model, &open, f64::INFINITY, &Monitor::silent()).known);
    counted.add_sums(own.and_then(|active| sums(model, region, &active, value)));
}

/// What the points come to at least in a box, in terms of the value: as its bound has it, without what models leave
/// out, and without the width of cells of heading too.
fn sums(model: &Model, region: &Region, active: &ActiveCells, value: f64) -> Option<[f64; 3]> {
    let sums = [Without::Nothing, Without::Remainders, Without::Headings].map(|without| {
        let found = model.lower_bound_without(without, region, active, f64::INFINITY, &Monitor::silent());
        model.objective.value(found.sum) / value
    });
    sums.iter().all(|sum| sum.is_finite()).then_some(sums)
}

/// The time of all threads, by what it went into.
#[derive(Default)]
pub(super) struct Spent([AtomicU64; 2]);

/// Coarse tables with their finer levels.
pub(super) const TABLES: usize = 0;
/// Cells of heading.
const CELLS: usize = 1;

impl Spent {
    /// Adds the time of so many threads.
    pub fn add(&self, part: usize, threads: u64, since: Instant) {
        self.0[part].fetch_add(threads * since.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    /// Adds the time that the parts of a box take.
    pub fn on_parts(&self, parts: impl FnOnce() -> Option<Vec<Open<Known>>>) -> Option<Vec<Open<Known>>> {
        let since = Instant::now();
        let parts = parts();
        // A box of which no cells were known may be bounded by them now.
        let is_by_cells = parts.iter().flatten().any(|part| part.known.is_some());
        self.add(if is_by_cells { CELLS } else { TABLES }, 1, since);
        parts
    }

    /// s
    pub fn seconds(&self) -> [f64; 2] {
        self.0.each_ref().map(|nanoseconds| nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9)
    }
}

/// The boxes that the coarse tables leave open, each with its bound, and how many were bounded.
///
/// # Errors
/// Why the caller ended it.
fn survivors(
    model: &Model,
    coarse: &CoarseBounds,
    whole: Region,
    ceiling: f64,
    monitor: &Monitor,
) -> Result<(Vec<(f64, Region)>, usize), Stop> {
    let (mut open, mut left, mut nodes) = (vec![whole], Vec::new(), 0);
    while !open.is_empty() {
        if let Some(stop) = monitor.stop() {
            return Err(stop);
        }
        nodes += open.len();
        // Where the caller asks to stop nothing is known, which is a bound too.
        let bound = |region| if monitor.should_stop() { None } else { coarse.lower_bound(model, region) };
        let bounds: Vec<Option<f64>> = open.par_iter().map(bound).collect();
        let mut next = Vec::new();
        for (region, bound) in open.iter().zip(bounds) {
            if bound.is_some_and(|bound| bound >= ceiling) || !model.yaws.allow(region) {
                continue;
            }
            match widest(region) {
                (_, size) if size <= 1.0 => left.push((bound.unwrap_or(0.0).max(0.0), *region)),
                (side, _) => next.extend(region.split(side)),
            }
        }
        open = next;
    }
    Ok((left, nodes))
}

/// Boxes left by the coarse tables from which on their finer levels are used.
const MANY: usize = 500;

/// Whether cells of heading are worth using at once, as a sample of the boxes that the coarse tables leave shows: they
/// have to exclude a good part of them, of which the coarse tables do not exclude enough parts. Cells know every load
/// as it is, and the limits on beta; coarse tables do not.
fn with_cells_at_once(
    model: &Model,
    coarse: &CoarseBounds,
    left: &[(f64, Region)],
    ceiling: f64,
    monitor: &Monitor,
) -> bool {
    if left.len() * model.points.len() > AFFORDABLE {
        return false;
    }
    let mut ranked: Vec<_> = left.iter().collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let some: Vec<_> = (0..SAMPLE).filter_map(|k| ranked.get(k * ranked.len() / SAMPLE)).enumerate().collect();
    let count = |of: &(dyn Fn(usize, &(f64, Region)) -> bool + Sync)| {
        some.par_iter().with_max_len(1).filter(|(k, open)| of(*k, open)).count()
    };
    // Of each box one of its eighths, in turn.
    let is_left = |k: usize, (_, region): &(f64, Region)| {
        let part = (0..3).fold(*region, |part, cut| halves(&part).map_or(part, |two| two[k >> cut & 1]));
        model.yaws.allow(&part) && coarse.lower_bound(model, &part).is_none_or(|bound| bound < ceiling)
    };
    let is_excluded = |_: usize, (bound, region): &(f64, Region)| {
        let open = Open { bound: *bound, region: *region, known: None };
        with_cells(model, &open, ceiling, monitor).bound >= ceiling
    };
    8 * count(&is_left) > some.len() && count(&is_excluded) * WORTH >= some.len()
}

/// Boxes tried with cells of heading, and one in how many these have to exclude.
const SAMPLE: usize = 32;
const WORTH: usize = 4;
/// Boxes times path points up to which cells at once take no more than some half a minute.
const AFFORDABLE: usize = 600_000;

/// The cells of heading that are still of interest in a box, once they are used.
pub(super) type Known = Option<Arc<ActiveCells>>;

/// The halves of a box with their bounds; `None` where it is not to be cut further.
///
/// As long as the coarse tables have a level for the halves their bound is by these alone, which takes a thousandth of
/// the time. Then come the cells of heading, and with them the limits on beta.
pub(super) fn parts(
    model: &Model,
    coarse: &CoarseBounds,
    open: &Open<Known>,
    ceiling: f64,
    monitor: &Monitor,
) -> Option<Vec<Open<Known>>> {
    let Some(active) = &open.known else {
        if widest(&open.region).1 > coarse.smallest() {
            let halves = halves(&open.region)?.into_iter().filter(|half| model.yaws.allow(half));
            let bounds = halves.map(|region| {
                let bound = coarse.lower_bound(model, &region).unwrap_or(0.0).max(open.bound);
                Open { bound, region, known: None }
            });
            return Some(bounds.collect());
        }
        return Some(vec![with_cells(model, open, ceiling, monitor)]);
    };
    let halves = halves(&open.region)?.into_iter().filter(|half| model.yaws.allow(half));
    let bounds = halves.map(|region| {
        let level = model.level(&region).unwrap_or(0);
        let mut active = (**active).clone();
        while active.level < level {
            active = active.halved();
        }
        let found = model.lower_bound(&region, &active, ceiling, monitor);
        Open { bound: found.sum.max(open.bound), region, known: Some(Arc::new(found.active)) }
    });
    Some(bounds.collect())
}

/// A box of which no cells of heading are known yet, with those of its size: level by level, so that what a coarser
/// level leaves out is not bounded on a finer one.
fn with_cells(model: &Model, open: &Open<Known>, ceiling: f64, monitor: &Monitor) -> Open<Known> {
    let (region, mut bound) = (open.region, open.bound);
    let level = model.level(&region).unwrap_or(0);
    let mut active = ActiveCells::full(model.points.len(), model.table.headings(0));
    loop {
        let found = model.lower_bound(&region, &active, ceiling, monitor);
        bound = found.sum.max(bound);
        if found.active.level >= level || bound >= ceiling {
            return Open { bound, region, known: Some(Arc::new(found.active)) };
        }
        active = found.active.halved();
    }
}
