//! The worst placement: an upper bound of the objective without the limits between neighbouring points.
//!
//! Dropping limits lowers the objective of a placement, so this is no upper bound of values with the rate of beta or
//! joint steps.

use super::branch_and_bound::{Bound, BranchAndBound, Open, Parts, halves, widest};
use super::cell::{placement_in, whole};
use super::compliance_table::{ComplianceTable, Steps};
use super::model::{Keeps, Model};
use super::part::certifiable_from_above;
use super::region::Region;
use super::relaxed::relaxed_value;
use super::upper_bound::{BoxBounds, Inherited};
use std::sync::Arc;
use stead_numerics::monitor::Monitor;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;
use stead_problem::symmetry::Unsupported;

/// Steps of the coarsest tables, and their number: one level more than lower bounds have, for a first bounds.
const STEPS: Steps = Steps { length: 0.05, headings: 64 };
const LEVELS: usize = 5;
/// Boxes to begin with are cut to what tables can answer for, but no smaller than this, in terms of those of lower
/// bounds.
const SMALL: f64 = 0.25;

/// A box, and what its halves inherit: `None` where it was not bounded in detail yet.
type WorstBox = Open<Option<Arc<Inherited>>>;

/// Bounds the objective of all placements of a problem from above, without the limits between neighbouring points,
/// until none can be worse than `value` ([`super::relaxed_value`] of the worst placement known, m) by more than the gap
/// of the settings.
///
/// The worst placement known keeps limits that are dropped here, so that others may well be worse without them. Where
/// the search comes to boxes that tables cannot distinguish, placements in these are evaluated, and what is worse than
/// the worst placement known takes its place ([`Bound::met`]).
///
/// The rate of beta, joint steps, the limits of joints 1, 4 and 6 and the largest deflection of a point are relaxed,
/// both in which placements are feasible and in their objective: see [`super::relaxed_value`]. The result does not
/// depend on the number of threads.
///
/// # Errors
/// Why the problem cannot be certified this way.
pub fn worst(
    problem: &Problem,
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> Result<Bound, Unsupported> {
    let CertificateSettings { gap, memory, .. } = *settings;
    certifiable_from_above(problem, memory)?;
    let model = without_rate(problem);
    let objective = model.objective;
    let search = BranchAndBound { sense: Sense::Max, value, gap, keeps: Keeps::NOTHING, objective, memory };
    let ceiling = search.ceiling();
    let unknown = |region| Open { bound: f64::INFINITY, region, known: None };
    let start = first(&model, whole(problem), monitor).into_iter().map(unknown).collect();
    let all = Parts {
        start,
        nodes: 0,
        of: |open: &WorstBox| parts(&model, open, ceiling, monitor),
        used: || model.used(),
        bytes: |seen: &Option<Arc<Inherited>>| seen.as_ref().map_or(0, |seen| seen.bytes()),
    };
    let mut known = value;
    let (bound, _) = search.explore(all, monitor, |regions| {
        let met = worse(problem, known, regions, monitor)?;
        known = met.0;
        Some(met)
    });
    Ok(bound)
}

/// Values closer than this (relative) are the same.
const SAME: f64 = 1e-6;

/// The worst of placements in the middle of some boxes, if it is worse than `known` (m) by more than rounding.
fn worse(problem: &Problem, known: f64, regions: &[Region], monitor: &Monitor) -> Option<(f64, Placement)> {
    let of = |region: &Region| {
        let placement = placement_in(problem, region);
        let value = relaxed_value(problem, &placement, monitor);
        Some((value?, placement))
    };
    let met = regions.iter().filter_map(of).max_by(|a, b| a.0.total_cmp(&b.0));
    met.filter(|(value, _)| *value > known * (1.0 + SAME))
}

/// What is bounded from above: without the rate of beta, and with tables of one level more.
fn without_rate(problem: &Problem) -> Model {
    let model = Model::new(problem, Keeps::NOTHING);
    let (extent, _) = model.table.grid();
    Model { table: ComplianceTable::new(extent, STEPS, LEVELS), ..model }
}

/// The boxes to begin with, together all of the cell; larger ones once the caller asks to stop.
fn first(model: &Model, whole: Region, monitor: &Monitor) -> Vec<Region> {
    let (mut open, mut out) = (vec![whole], Vec::new());
    while let Some(region) = open.pop() {
        match widest(&region) {
            _ if !model.yaws.allow(&region) => {}
            (_, size) if size <= SMALL || monitor.should_stop() || model.level(&region).is_some() => out.push(region),
            (side, _) => open.extend(region.split(side)),
        }
    }
    out
}

/// A box not bounded in detail yet with its bound, or the halves of one with theirs; `None` where it is not to be cut
/// further.
fn parts(model: &Model, open: &WorstBox, ceiling: f64, monitor: &Monitor) -> Option<Vec<WorstBox>> {
    let (parts, seen) = match &open.known {
        None => (vec![open.region], Arc::new(Inherited::nothing(model))),
        Some(seen) => (halves(&open.region)?.to_vec(), Arc::clone(seen)),
    };
    let bound = |region: Region| match BoxBounds::new(model, &region, monitor) {
        Some(over) => {
            let quick = if open.known.is_none() { over.quick_bound(ceiling) } else { f64::INFINITY };
            if quick <= ceiling {
                return Open { bound: quick, region, known: None };
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
