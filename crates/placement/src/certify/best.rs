//! The best placement: a lower bound of what placements are worth.

use super::bound::Bounded;
use super::frontier::{Bound, End, Open, Search, halves, widest};
use super::prepare::{Unfit, certifiable, prepared};
use super::reduced::Reduced;
use super::region::Region;
use super::tube::Tube;
use crate::problem::Problem;
use crate::sense::Sense;
use rayon::prelude::*;
use std::sync::Arc;
use stead_numerics::monitor::Monitor;

/// Bounds from below what placements of a problem are worth, until no placement can be better than `value` (mean score, m)
/// by more than `gap` (relative).
///
/// Limits between neighbouring points other than the rate of beta, and those of joints 1, 4 and 6, are relaxed; without
/// `with_rate` that of beta as well. The result does not depend on the number of threads.
///
/// # Errors
/// Why the problem cannot be certified this way.
pub fn best(problem: &Problem, value: f64, gap: f64, with_rate: bool, monitor: &Monitor) -> Result<Bound, Unfit> {
    certifiable(problem)?;
    let compliances = problem.robot.constant_compliances().ok_or(Unfit::VaryingCompliance)?;
    let (bounded, whole) = prepared(problem, &compliances, with_rate);
    let search = Search { sense: Sense::Min, value, gap, with_rate, points: bounded.points.len() };
    // Of no placement anything is known until the tables are made.
    let reduced = match Reduced::new(&bounded, || search.report(monitor, 0.0, 1, 0)) {
        Ok(reduced) => reduced,
        Err(stop) => {
            let open = vec![(whole, 0.0)];
            return Ok(Bound { value, bound: 0.0, with_rate, nodes: 0, end: End::Stopped(stop), open });
        }
    };
    let ceiling = search.ceiling();
    let mut nodes = 0;
    let tube = Arc::new(Tube::full(bounded.points.len(), bounded.table.headings(0)));
    let start = survivors(&bounded, &reduced, whole, ceiling, &mut nodes)
        .into_iter()
        .map(|(bound, region)| Open { bound, region, known: Arc::clone(&tube) })
        .collect();
    drop(reduced);
    Ok(search.explore(start, nodes, monitor, |open| parts(&bounded, open, ceiling)))
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

/// The halves of a box with their bounds; `None` where it is not to be cut further.
fn parts(bounded: &Bounded, open: &Open<Arc<Tube>>, ceiling: f64) -> Option<Vec<Open<Arc<Tube>>>> {
    let halves = halves(&open.region)?.into_iter().filter(|half| bounded.yaws.allow(half));
    let bounds = halves.map(|region| {
        let level = bounded.level(&region).unwrap_or(0);
        let mut tube = (*open.known).clone();
        while tube.level < level {
            tube = tube.halved();
        }
        let found = bounded.below(&region, &tube, ceiling);
        Open { bound: found.sum.max(open.bound), region, known: Arc::new(found.tube) }
    });
    Some(bounds.collect())
}
