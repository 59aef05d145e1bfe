//! The worst placement: an upper bound of what placements are worth, limits between neighbouring points dropped.
//!
//! Dropping limits lowers what a placement is worth, so this is no upper bound of values with the rate of beta or joint steps.

use super::branch_and_bound::{Bound, BranchAndBound, Open, halves, widest};
use super::compliance_table::{ComplianceTable, Steps};
use super::lower_bound::Model;
use super::model::{Unfit, certifiable, prepared};
use super::region::Region;
use super::upper_bound::{BoxBounds, Inherited};
use crate::problem::Problem;
use crate::sense::Sense;
use std::sync::Arc;
use stead_numerics::monitor::Monitor;

/// Steps of the coarsest tables, and their number: one level more than lower bounds have, for a first bounds.
const STEPS: Steps = Steps { length: 0.05, headings: 64 };
const LEVELS: usize = 5;
/// Boxes to begin with are cut to what tables can answer for, but no smaller than this, in terms of those of lower bounds.
const SMALL: f64 = 0.25;

/// A box, and what has been seen of it: `None` where it was not looked at yet.
type Looked = Open<Option<Arc<Inherited>>>;

/// Bounds from above what placements of a problem are worth with the limits between neighbouring points dropped, until none can
/// be worse than `value` ([`super::relaxed_value`] of the worst placement known, m) by more than `gap` (relative).
///
/// The rate of beta, joint steps, the limits of joints 1, 4 and 6 and the largest deflection of a point are relaxed, both in
/// which placements count and in what they are worth: see [`super::relaxed_value`]. The result does not depend on the number of
/// threads.
///
/// # Errors
/// Why the problem cannot be certified this way.
pub fn worst(problem: &Problem, value: f64, gap: f64, monitor: &Monitor) -> Result<Bound, Unfit> {
    certifiable(problem)?;
    let compliances = problem.robot.constant_compliances().ok_or(Unfit::VaryingCompliance)?;
    let (model, whole) = prepared(problem, &compliances, false);
    let (extent, _) = model.table.grid();
    let model = Model { table: ComplianceTable::new(extent, STEPS, LEVELS), ..model };
    let search = BranchAndBound { sense: Sense::Max, value, gap, with_rate: false, points: model.points.len() };
    let ceiling = search.ceiling();
    let unknown = |region| Open { bound: f64::INFINITY, region, known: None };
    let start = first(&model, whole).into_iter().map(unknown).collect();
    Ok(search.explore(start, 0, monitor, |open| parts(&model, open, ceiling)))
}

/// The boxes to begin with, together all of the cell.
fn first(model: &Model, whole: Region) -> Vec<Region> {
    let (mut open, mut out) = (vec![whole], Vec::new());
    while let Some(region) = open.pop() {
        match widest(&region) {
            _ if !model.yaws.allow(&region) => {}
            (_, size) if size <= SMALL || model.level(&region).is_some() => out.push(region),
            (side, _) => open.extend(region.split(side)),
        }
    }
    out
}

/// A box not looked at yet with its bound, or the halves of one with theirs; `None` where it is not to be cut further.
fn parts(model: &Model, open: &Looked, ceiling: f64) -> Option<Vec<Looked>> {
    let (parts, seen) = match &open.known {
        None => (vec![open.region], Arc::new(Inherited::nothing(model))),
        Some(seen) => (halves(&open.region)?.to_vec(), Arc::clone(seen)),
    };
    let bound = |region: Region| match BoxBounds::new(model, &region) {
        Some(over) => {
            let glance = if open.known.is_none() { over.glance(ceiling) } else { f64::INFINITY };
            if glance <= ceiling {
                return Open { bound: glance, region, known: None };
            }
            let (sum, seen) = over.upper_bound(&seen, ceiling);
            Open { bound: sum.min(open.bound), region, known: Some(Arc::new(seen)) }
        }
        None => Open { bound: open.bound, region, known: Some(Arc::clone(&seen)) },
    };
    Some(parts.into_iter().filter(|part| model.yaws.allow(part)).map(bound).collect())
}

#[cfg(test)]
mod tests;
