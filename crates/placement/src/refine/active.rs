//! Which bounds hold an optimum, and what moving them would gain.
//!
//! For the best placement that is the multiplier of each bound in the convex subproblem at the optimum: how fast the objective
//! falls when the bound gives way. For the worst placement a wall of the cell counts by the one-sided derivative of the
//! objective across it, since the objective is a minimum over plans.

use super::ascent::touching;
use super::linearise::{Curvature, UNITS, linearise};
use super::programme::pose_bounds;
use super::rooms::{NEAR_STEPS, Room};
use super::subproblem::{Answer, Question, solve};
use super::{LENGTH_UNIT, Solution, planned};
use crate::limit::{ActiveBound, Limit, Side};
use crate::problem::{Placement, Problem};
use crate::redundancy::Planner;
use nalgebra::Vector4;
use stead_model::robot::Posture;

/// Half width of the neighbourhood in which bounds are seen, in scaled variables.
const NEIGHBOURHOOD: f64 = 1e-3;
/// Gains below this share of the objective per scaled unit are rounding.
const FLOOR: f64 = 1e-5;
/// A wall nearer than this is touched. Scaled
const TOUCHED: f64 = 1e-5;
/// Shapes that a step of this length brings together are touched: refinements end a little before them. Scaled
const TOUCHED_SHAPES: f64 = 1e-4;

/// The bounds that hold a best placement, the largest gains first; none where the subproblem has no solution, so that they are not
/// known.
pub fn active_bounds(problem: &Problem, solution: &Solution) -> Option<Vec<ActiveBound>> {
    let locals = linearise(problem, solution, (Curvature::Beta, NEAR_STEPS))?;
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
            None => bounds.push(ActiveBound { side, names: names(problem, side.limit), gain }),
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

/// The walls and shapes of the cell that hold a worst placement, the largest gains first.
pub fn active_walls(planner: &Planner<'_>, worst: &Solution, scheme: Option<&[Posture]>) -> Vec<ActiveBound> {
    let walls = touched_walls(planner, worst, scheme);
    sorted(walls.into_iter().chain(active_clearances(planner, worst, scheme)).collect())
}

/// Everything is planned anew a little inside each wall that the placement touches.
fn touched_walls(planner: &Planner<'_>, worst: &Solution, scheme: Option<&[Posture]>) -> Vec<ActiveBound> {
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
                bounds.push(ActiveBound { side: Side { limit: Limit::ALL_WALLS[k], is_upper }, names: None, gain });
            }
        }
    }
    bounds
}

/// The same of the shapes of the cell that the part or its fixture touches there: everything is planned anew a little away from them.
fn active_clearances(planner: &Planner<'_>, worst: &Solution, scheme: Option<&[Posture]>) -> Vec<ActiveBound> {
    let problem = planner.problem();
    let mut workspace = planner.workspace();
    let gained = |(room, inward): (Room, Vector4<f64>)| {
        let away = Placement::from(std::array::from_fn(|k| worst.placement[k] + STEP * inward[k] * UNITS[k]));
        let away = planned(planner, &problem.cell.clamp(&away), scheme, &mut workspace)?;
        let gain = (worst.objective - away.objective) / (STEP * room.pose_slopes().norm());
        (gain > FLOOR * worst.objective).then(|| ActiveBound {
            side: Side { limit: room.limit, is_upper: false },
            names: names(problem, room.limit),
            gain,
        })
    };
    touching(problem, worst, TOUCHED_SHAPES).filter_map(gained).collect()
}

/// The names of the two that have to keep a distance.
fn names(problem: &Problem, limit: Limit) -> Option<[String; 2]> {
    let (Limit::Clearance(pair) | Limit::KeepOut(pair)) = limit else { return None };
    problem.scene.as_deref().and_then(|scene| scene.pair(pair)).map(|pair| (*pair.names).clone())
}

fn sorted(mut bounds: Vec<ActiveBound>) -> Vec<ActiveBound> {
    bounds.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.side.cmp(&b.side)));
    bounds
}

#[cfg(test)]
mod tests;
