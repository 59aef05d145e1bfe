//! Which bounds hold an optimum, and what moving them would gain.
//!
//! For the best placement that is the multiplier of each bound in the convex subproblem at the optimum: how fast the objective
//! falls when the bound gives way. For the worst placement a wall of the cell counts by the one-sided derivative of the
//! objective across it, since the objective is a minimum over plans.

use super::linearise::{Curvature, UNITS, linearise};
use super::programme::pose_bounds;
use super::subproblem::{Answer, Question, solve};
use super::{LENGTH_UNIT, Solution, planned};
use crate::limit::{ActiveBound, Limit, Side};
use crate::problem::Problem;
use crate::redundancy::Planner;
use stead_model::robot::Posture;

/// Half width of the neighbourhood in which bounds are seen, in scaled variables.
const NEIGHBOURHOOD: f64 = 1e-3;
/// Gains below this share of the objective per scaled unit are rounding.
const FLOOR: f64 = 1e-5;
/// A wall nearer than this is touched. Scaled
const TOUCHED: f64 = 1e-5;

/// The bounds that hold a best placement, the largest gains first; none where the subproblem has no solution, so that they are not
/// known.
pub fn active_bounds(problem: &Problem, solution: &Solution) -> Option<Vec<ActiveBound>> {
    let locals = linearise(problem, solution, Curvature::Beta)?;
    // Without its curvature the model of a long path is better scaled in so small a neighbourhood.
    let answers = [true, false].into_iter().filter_map(|curved| {
        solve(problem, solution, &locals, Question { trust: NEIGHBOURHOOD, curved, pose_stays: false }).ok()
    });
    let Answer { multipliers: mut gains, .. } = { answers }.next()?;
    // The gains of all points that one bound holds add up.
    gains.sort_by_key(|(side, _)| *side);
    let mut bounds: Vec<ActiveBound> = Vec::new();
    for (side, gain) in gains {
        match bounds.last_mut().filter(|last| last.side == side) {
            Some(last) => last.gain += gain,
            None => bounds.push(ActiveBound { side, gain }),
        }
    }
    bounds.retain(|bound| bound.gain > FLOOR * solution.objective);
    for bound in &mut bounds {
        if matches!(bound.side.limit, Limit::CellX | Limit::CellY | Limit::CellZ) {
            bound.gain /= LENGTH_UNIT;
        } else if bound.side.limit == Limit::MaxDeflection {
            bound.gain /= solution.objective;
        }
    }
    Some(sorted(bounds))
}

/// How far the difference reaches that measures the gain of a wall at a worst placement, in scaled variables.
const STEP: f64 = 1e-3;

/// The walls of the cell that hold a worst placement, the largest gains first: everything is planned anew a little inside each
/// wall that it touches.
pub fn active_walls(planner: &Planner<'_>, worst: &Solution, scheme: Option<&[Posture]>) -> Vec<ActiveBound> {
    let rooms = pose_bounds(planner.problem(), &worst.placement);
    let mut workspace = planner.workspace();
    let mut bounds = Vec::new();
    for (k, room) in rooms.into_iter().enumerate() {
        for (is_upper, near, far) in [(true, room.max, -room.min), (false, -room.min, room.max)] {
            if near > TOUCHED || far < STEP {
                continue;
            }
            let mut inside = worst.placement;
            inside[k] += if is_upper { -STEP } else { STEP } * UNITS[k];
            let Some(inside) = planned(planner, &inside, scheme, &mut workspace) else { continue };
            let gain = (worst.objective - inside.objective) / (STEP * UNITS[k]);
            if gain > FLOOR * worst.objective {
                bounds.push(ActiveBound { side: Side { limit: Limit::ALL_WALLS[k], is_upper }, gain });
            }
        }
    }
    sorted(bounds)
}

fn sorted(mut bounds: Vec<ActiveBound>) -> Vec<ActiveBound> {
    bounds.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.side.cmp(&b.side)));
    bounds
}

#[cfg(test)]
mod tests;
