//! The room along the plans, for the page: without the pairs whose distance never changes, which would hide all others.

use super::packed::{chosen_singles, singles};
use crate::figure::PlaceMm;
use serde_json::Value;
use stead_cell::{Clearance, Scene};
use stead_placement::outcome::Case;
use stead_problem::collision::{ChangingClearance, PointClearance};
use stead_problem::problem::Problem;

records! {
    /// The least room along a plan without the pairs whose distance does not change along it.
    pub struct ClearanceData of (scene: &Scene, changing: &ChangingClearance) {
        let mut numbers: Vec<usize> = changing.at.iter().flatten().map(|at| at.pair).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let place = |at: &Clearance| numbers.iter().position(|number| *number == at.pair).map_or(f64::NAN, |k| k as f64);
        let name = |number: usize| scene.pair(number).map_or_else(String::new, ToString::to_string);
    } with {
        /// The pairs left out.
        still: Vec<StillPair> = changing.still.iter().map(|of| StillPair::of(name(of.pair), of.distance)).collect(),
        /// The pairs of the points.
        pairs: Vec<String> = numbers.iter().map(|number| name(*number)).collect(),
        /// For each point the number of its pair, from 0; NaN where nothing is nearer than 1 m.
        pair: String = singles(changing.at.iter().map(|at| at.as_ref().map_or(f64::NAN, place))),
        /// The distance of that pair. mm
        clearance_mm: String = singles(changing.at.iter().map(|at| at.map_or(f64::NAN, |at| at.distance * 1e3))),
    }

    /// Two shapes that stand still to each other.
    pub struct StillPair of (pair: String, distance: f64) {
        /// The two.
        pair: String = pair,
        /// Their distance.
        distance_mm: PlaceMm = distance.into(),
    }
}

/// For each plan its changing room, null where that is the room of the table; nothing where it is so of all plans.
pub(super) fn changing(problem: &Problem, plans: &[&Case]) -> Option<Vec<Option<ClearanceData>>> {
    let of = |case: &&Case| {
        let points = case.plan.points.iter();
        let plan: Vec<PointClearance> =
            points.map(|of| PointClearance { point: of.point, joints: of.joints, clearance: of.clearance }).collect();
        let problem = problem.in_setup(&case.setup);
        let found = problem.changing_clearance(&case.placement, &plan)?;
        Some(ClearanceData::of(problem.scene.as_deref()?, &found))
    };
    let all: Vec<_> = plans.iter().map(of).collect();
    all.iter().any(Option::is_some).then_some(all)
}

/// Keeps chosen path points of [`ClearanceData`] of all plans.
pub(super) fn keep(plans: &mut Value, chosen: &[usize]) {
    for plan in plans.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
        for (_, all) in plan.iter_mut().filter(|(key, _)| ["pair", "clearance_mm"].contains(&key.as_str())) {
            *all = chosen_singles(all.as_str().unwrap_or_default(), chosen, 1).into();
        }
    }
}
