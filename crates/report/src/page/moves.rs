//! The moves between segments as they are drawn: along the ways that keep free.

use super::packed::singles;
use crate::placement::setup::unit;
use serde_json::{Value, json};
use stead_placement::course::{MovePart, parts};
use stead_placement::outcome::Case;
use stead_placement::problem::Problem;
use stead_placement::settings::TransferSettings;
use stead_placement::transfer::Transfer;

/// For each plan its moves in their order, null where a move is straight in joint space; nothing where no plan has a way.
pub(super) fn moves(problem: &Problem, settings: &TransferSettings, plans: &[&Case]) -> Option<Value> {
    let has_ways = plans.iter().any(|case| case.cycle.transfers.iter().any(|transfer| transfer.way.is_some()));
    has_ways.then(|| plans.iter().map(|case| of_plan(&problem.in_setup(&case.setup), settings, case)).collect())
}

fn of_plan(problem: &Problem, settings: &TransferSettings, case: &Case) -> Value {
    let segments = problem.task.segments();
    let at = |point: usize| case.plan.points.get(point).map(|at| (point, at.posture));
    let drawn = |transfer: &Transfer| {
        let [before, behind] = [transfer.after_segment - 1, transfer.after_segment].map(|k| segments.get(k));
        let ends = [at(before?.end - 1)?, at(behind?.start)?];
        Some(packed(problem, &parts(problem, settings, transfer.way.as_ref()?, ends)))
    };
    case.cycle.transfers.iter().map(drawn).collect()
}

/// The places of all parts one after the other, an end of one and the start of the next once.
fn packed(problem: &Problem, parts: &[MovePart]) -> Value {
    let places = || {
        let first = parts.first().and_then(|part| part.places.first());
        first.into_iter().chain(parts.iter().flat_map(|part| part.places.iter().skip(1)))
    };
    let units: Vec<f64> = problem.external_axes.iter().map(|axis| unit(axis.kind).factor).collect();
    let axes = places().flat_map(|place| place.axes.iter().zip(&units).map(|(at, factor)| at * factor));
    json!({
        "joints_deg": singles(places().flat_map(|place| place.joints.map(f64::to_degrees))),
        "axes": singles(axes),
        "steps": parts.iter().map(|part| part.places.len() - 1).collect::<Vec<_>>(),
        "time_shares": parts.iter().map(|part| (part.time_share * 1e6).round() / 1e6).collect::<Vec<_>>(),
    })
}
