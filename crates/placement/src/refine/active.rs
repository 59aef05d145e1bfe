//! Which bounds hold an optimum, and what moving them would gain.
//!
//! For the best placement that is the multiplier of each bound in the convex subproblem at the optimum: how fast the objective
//! falls when the bound gives way. For the worst placement a wall of the cell counts by the one-sided derivative of the
//! objective across it, since the objective is a minimum over plans.

use super::linearise::{Curvature, UNITS, linearise};
use super::programme::pose_bounds;
use super::subproblem::{Answer, Question, solve};
use super::{LENGTH_UNIT, Solution, planned};
use crate::problem::Problem;
use crate::redundancy::{Planner, off_grid};
use serde::Serialize;
use stead_model::robot::Posture;

/// A limit that can hold an optimum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Limit {
    /// A wall of the cell in x.
    CellX,
    /// A wall of the cell in y.
    CellY,
    /// A wall of the cell in z.
    CellZ,
    /// A bound of the cell on the yaw.
    CellYaw,
    /// A limit of a joint, from 1.
    Joint(u8),
    /// The step of a joint (from 1) between path points, by its speed.
    JointStep(u8),
    /// The bound on 1/kappa_F.
    Conditioning,
    /// The rate of beta along the path.
    BetaRate,
    /// The turn of the spindle in space along the path.
    SpindleTurn,
    /// The largest score of a point.
    MaxDeflection,
    /// The smallest distance of the path from axis 1.
    BaseDistance,
}

impl Limit {
    /// The walls of the cell: x, y, z, yaw.
    pub const ALL_WALLS: [Self; 4] = [Self::CellX, Self::CellY, Self::CellZ, Self::CellYaw];
}

/// One side of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Side {
    /// The limit.
    pub limit: Limit,
    /// Whether it is the upper one.
    pub is_upper: bool,
}

/// A bound that holds an optimum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ActiveBound {
    /// Which.
    pub side: Side,
    /// How much the objective improves (falls for the best placement, rises for the worst) when the bound gives way by one unit,
    /// to first order: m per m for walls of x, y, z, distances and deflections, m per rad for angles and the limits on beta (rad of its change in a step),
    /// m per unit of 1/kappa_F.
    pub gain: f64,
}

/// Half width of the neighbourhood in which bounds are seen, in scaled variables.
const NEIGHBOURHOOD: f64 = 1e-3;
/// Gains below this share of the objective per scaled unit are rounding.
const FLOOR: f64 = 1e-5;
/// A wall nearer than this is touched. Scaled
const TOUCHED: f64 = 1e-5;

/// The bounds that hold a best placement, the largest gains first; nothing where the subproblem has no solution.
pub fn active_bounds(problem: &Problem, solution: &Solution) -> Vec<ActiveBound> {
    let question = Question { trust: NEIGHBOURHOOD, curved: true, pose_stays: false };
    let answer = linearise(problem, solution, Curvature::Beta)
        .and_then(|locals| solve(problem, solution, &locals, question).ok());
    let Some(Answer { multipliers: mut gains, .. }) = answer else { return Vec::new() };
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
    sorted(bounds)
}

/// How far the difference reaches that measures the gain of a wall at a worst placement, in scaled variables.
const STEP: f64 = 1e-3;

/// The walls of the cell that hold a worst placement, the largest gains first: everything is planned anew a little inside each
/// wall that it touches.
pub fn active_walls(planner: &Planner<'_>, worst: &Solution, scheme: Option<&[Posture]>) -> Vec<ActiveBound> {
    let rooms = pose_bounds(planner.problem(), &worst.placement);
    let spacing = off_grid::Spacing::full(planner.grid());
    let mut workspace = planner.workspace();
    let mut bounds = Vec::new();
    for (k, room) in rooms.into_iter().enumerate() {
        for (is_upper, near, far) in [(true, room.max, -room.min), (false, -room.min, room.max)] {
            if near > TOUCHED || far < STEP {
                continue;
            }
            let mut inside = worst.placement;
            inside[k] += if is_upper { -STEP } else { STEP } * UNITS[k];
            let Some(inside) = planned(planner, &inside, scheme, spacing, &mut workspace) else { continue };
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
