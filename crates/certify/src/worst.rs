//! The worst placement: an upper bound of the objective without the limits between neighbouring points.
//!
//! Dropping limits lowers the objective of a placement, so this is no upper bound of values with the rate of beta or
//! joint steps.

use super::branch_and_bound::{Bound, BranchAndBound, Open, Parts, halves, widest};
use super::cell::{corners, side, whole};
use super::compliance_table::{ComplianceTable, Steps};
use super::keeps_open::KeepsOpen;
use super::model::{Keeps, Model};
use super::part::{Part, once_each, together};
use super::region::Region;
use super::relaxed::relaxed_value;
use super::upper_bound::{Inherited, WorstBox, bounded};
use std::f64::consts::TAU;
use std::sync::Arc;
use stead_model::robot::angles::wrap;
use stead_numerics::monitor::Monitor;
use stead_problem::criterion::Aggregate;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::CertificateSettings;
use stead_problem::symmetry::{
    Unsupported, Upright, require_certain_compliances, require_free_beta, require_no_travel,
};

/// Steps of the coarsest tables, and their number: one level more than lower bounds have, for a first bounds.
const STEPS: Steps = Steps { length: 0.05, headings: 64 };
const LEVELS: usize = 5;
/// Boxes to begin with are cut to what tables can answer for, but no smaller than this, in terms of those of lower
/// bounds.
const SMALL: f64 = 0.25;

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
        count: |_: &mut KeepsOpen, _: &Region, _: &Option<Arc<Inherited>>| {},
    };
    let mut known = value;
    Ok(search.explore(all, monitor, |regions| {
        let met = worse(problem, known, regions, monitor)?;
        known = met.0;
        Some(met)
    }))
}

/// Whether the worst placement can be certified too: bounds from above are those of the mean of scores that are the
/// absolute value of one part of the deflection.
///
/// # Errors
/// All reasons why not, those of the best one among them.
pub(super) fn certifiable_from_above(problem: &Problem, memory: u64) -> Result<(), Unsupported> {
    let reasons = Part::of(problem, memory).err().unwrap_or_default();
    let reasons = once_each(reasons.into_iter().chain(not_from_above(problem)));
    if reasons.is_empty() { Ok(()) } else { Err(together(reasons)) }
}

/// Why the worst placement of a problem cannot be certified, beside what bounds of the best one ask too.
fn not_from_above(problem: &Problem) -> Vec<Unsupported> {
    let criterion = &problem.criterion;
    let beyond = [
        ("criterion.aggregate", criterion.aggregate != Aggregate::Mean),
        ("criterion.robots", criterion.stiffness.is_some()),
        ("criterion.force_uncertainty", criterion.force_uncertainty != 0.0),
        ("criterion.direction", !criterion.weights.is_single()),
    ];
    let beyond = beyond.into_iter().filter(|(_, is_beyond)| *is_beyond);
    let asked = [
        if problem.orientations.len() > 1 { Err(Unsupported::Orientations) } else { Ok(()) },
        Upright::of(problem).map(drop),
        require_no_travel(problem),
        require_free_beta(problem),
        require_certain_compliances(problem),
    ];
    let asked = asked.into_iter().filter_map(Result::err);
    asked.chain(beyond.map(|(key, _)| Unsupported::NotFromAbove { key })).collect()
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

/// Azimuths tried about axis 1.
const AZIMUTHS: usize = 1440;

/// The placement of the cell that is nearest to the middle of a box, whatever its azimuth.
fn placement_in(problem: &Problem, region: &Region) -> Placement {
    let (side, root, cell) = (side(problem), problem.robot.geometry().root_in_base, &problem.cell);
    let [radius, height, turn] = region.middle;
    let z = root.z + side * height;
    let at = |azimuth: f64| {
        let (sine, cosine) = libm::sincos(azimuth);
        let wanted =
            Placement { x: root.x + radius * cosine, y: root.y + radius * sine, z, yaw: azimuth + side * turn };
        let inside = cell.clamp(&wanted);
        let off = libm::hypot(inside.x - wanted.x, inside.y - wanted.y) + radius * wrap(inside.yaw - wanted.yaw).abs();
        (off, inside)
    };
    let [x, y] = corners(cell, problem);
    let corners = [(x[0], y[0]), (x[0], y[1]), (x[1], y[0]), (x[1], y[1])].map(|(x, y)| libm::atan2(y, x));
    let even = (1..AZIMUTHS).map(|k| TAU * k as f64 / AZIMUTHS as f64);
    let all = even.chain(corners).map(at);
    all.fold(at(0.0), |best, other| if other.0 < best.0 { other } else { best }).1
}

/// What is bounded from above: without the rate of beta, and with tables of one level more.
fn without_rate(problem: &Problem) -> Model {
    let model = Model::new(problem);
    let (extent, _) = model.table.grid();
    Model { table: ComplianceTable::new(extent, STEPS, LEVELS).into(), ..model }
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
    let parts = match &open.known {
        None => vec![open.region],
        Some(_) => halves(&open.region)?.to_vec(),
    };
    let parts = parts.into_iter().filter(|part| model.yaws.allow(part));
    Some(parts.map(|part| bounded(model, open, part, ceiling, monitor)).collect())
}

#[cfg(test)]
mod tests;
