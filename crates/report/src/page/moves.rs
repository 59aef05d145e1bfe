//! The moves between segments as they are drawn: along the ways that keep free.

use super::packed::singles;
use crate::placement::setup::unit;
use stead_placement::outcome::Case;
use stead_planning::course::{MovePart, parts};
use stead_planning::transfer::Transfer;
use stead_problem::problem::Problem;
use stead_problem::settings::TransferSettings;

records! {
    /// A move between segments. Lists of numbers are in single precision, little endian, as Base64.
    pub struct MoveData of (problem: &Problem, parts: &[MovePart]) {
        let places = || {
            let first = parts.first().and_then(|part| part.places.first());
            first.into_iter().chain(parts.iter().flat_map(|part| part.places.iter().skip(1)))
        };
        let units: Vec<f64> = problem.external_axes.iter().map(|axis| unit(axis.kind).factor).collect();
    } with {
        /// Joint angles at its places.
        joints_deg: String = singles(places().flat_map(|place| place.joints.map(f64::to_degrees))),
        /// Positions of the external axes there, in their units.
        axes: String =
            singles(places().flat_map(|place| place.axes.iter().zip(&units).map(|(at, factor)| at * factor))),
        /// Steps of each part.
        steps: Vec<usize> = parts.iter().map(|part| part.places.len() - 1).collect(),
        /// Share of the time of each part.
        time_shares: Vec<f64> = parts.iter().map(|part| (part.time_share * 1e6).round() / 1e6).collect(),
    }
}

/// For each plan its moves in their order; nothing where no plan has a path round shapes.
pub(super) fn moves(
    problem: &Problem,
    settings: &TransferSettings,
    plans: &[&Case],
) -> Option<Vec<Vec<Option<MoveData>>>> {
    let has_ways = plans.iter().any(|case| case.cycle.transfers.iter().any(|transfer| transfer.way.is_some()));
    has_ways.then(|| plans.iter().map(|case| of_plan(&problem.in_setup(&case.setup), settings, case)).collect())
}

fn of_plan(problem: &Problem, settings: &TransferSettings, case: &Case) -> Vec<Option<MoveData>> {
    let segments = problem.task.segments();
    let at = |point: usize| case.plan.points.get(point).map(|at| (point, at.posture));
    let drawn = |transfer: &Transfer| {
        let [before, behind] = [transfer.after_segment - 1, transfer.after_segment].map(|k| segments.get(k));
        let ends = [at(before?.end - 1)?, at(behind?.start)?];
        Some(MoveData::of(problem, &parts(problem, settings, transfer.way.as_ref()?, ends)))
    };
    case.cycle.transfers.iter().map(drawn).collect()
}
