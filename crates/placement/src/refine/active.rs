//! Which bounds hold an optimum, and what moving them would gain.
//!
//! For the best placement that is the multiplier of each bound in the convex subproblem at the optimum: how fast the
//! objective falls when the bound gives way. For the worst placement a wall of the cell counts by the one-sided
//! derivative of the objective across it, since the objective is a minimum over plans.

use super::ascent::touching;
use super::linearise::{Curvature, linearise_leaning};
use super::programme::pose_bounds;
use super::slacks::{NEAR_STEPS, Slack};
use super::subproblem::{StepRequest, SubproblemStep, solve};
use super::{LENGTH_UNIT, Solution, UNITS, planned};
use nalgebra::{DMatrix, Vector4};
use stead_model::robot::Posture;
use stead_planning::redundancy::Planner;
use stead_problem::limit::{ActiveBound, Limit, Side};
use stead_problem::problem::{Placement, Problem};

/// Half width of the neighbourhood in which bounds are seen, in scaled variables.
const NEIGHBOURHOOD: f64 = 1e-3;
/// Gains below this share of the objective per scaled unit are rounding.
const FLOOR: f64 = 1e-5;
/// A wall nearer than this is touched. Scaled
const TOUCHED: f64 = 1e-5;
/// Shapes that a step of this length brings together are touched: refinements end a little before them. Scaled
const TOUCHED_SHAPES: f64 = 1e-4;

/// The bounds that hold a best placement, the largest gains first; none where the subproblem has no solution, so that
/// they are not known.
pub fn active_bounds(problem: &Problem, solution: &Solution) -> Option<Vec<ActiveBound>> {
    let locals = linearise_leaning(problem, solution, Curvature::Beta, NEAR_STEPS)?;
    // Without its curvature the model of a long path is better scaled in so small a neighbourhood.
    let answers = [true, false].into_iter().filter_map(|curved| {
        solve(problem, solution, &locals, StepRequest { trust: NEIGHBOURHOOD, curved, pose_stays: false }).ok()
    });
    let SubproblemStep { multipliers: mut gains, .. } = { answers }.next()?;
    gains.iter_mut().for_each(|(side, point, _)| side.limit = behind(problem, *side, *point));
    // The gains of all points that one bound holds add up.
    gains.sort_by_key(|(side, point, _)| (*side, *point));
    let mut bounds: Vec<ActiveBound> = Vec::new();
    for gains in gains.chunk_by(|a, b| a.0 == b.0) {
        let (side, _, _) = gains[0];
        if gains.iter().map(|(_, _, gain)| gain).sum::<f64>() > FLOOR * solution.objective {
            let gain = gains.iter().map(|(_, point, gain)| gain * loosened(problem, solution, side, *point)).sum();
            bounds.push(ActiveBound { side, names: names(problem, side.limit), gain });
        }
    }
    // A step that something else bounds than the limit has nothing to gain from that.
    bounds.retain(|bound| bound.gain > 0.0);
    Some(sorted(bounds))
}

/// The limit behind a bound at a point: whether the turn of the spindle is bounded by length or by time.
fn behind(problem: &Problem, side: Side, point: usize) -> Limit {
    match side.limit {
        Limit::SpindleTurn if loosened_turn(problem, side, point, Limit::SpindleTurn) == 0.0 => Limit::SpindleSpeed,
        limit => limit,
    }
}

/// By how much a bound at a point gives way, in the unit of its multiplier, when the limit does by one unit of
/// [`ActiveBound::gain`].
fn loosened(problem: &Problem, solution: &Solution, side: Side, point: usize) -> f64 {
    let space = problem.lean.as_deref();
    match side.limit {
        Limit::CellX | Limit::CellY | Limit::CellZ => 1.0 / LENGTH_UNIT,
        Limit::MaxDeflection => 1.0 / solution.objective,
        Limit::BetaRate | Limit::SpindleTurn | Limit::SpindleSpeed => loosened_turn(problem, side, point, side.limit),
        Limit::JointStep(joint) => {
            let (own, time) = (usize::from(joint) - 1, problem.step_time(point));
            let speed = problem.robot.joints()[own].max_speed.unwrap_or(f64::INFINITY);
            if problem.joint_steps(point)[own] < speed * time { 0.0 } else { time }
        }
        // The linear model is of the share of the ridge, half of the distance and the turn of the tool axis.
        Limit::Scallop => space.and_then(|space| space.scallop).map_or(0.0, |most| 1.0 / most),
        Limit::StepOver => 0.5,
        Limit::ContactTolerance => space.map_or(0.0, |space| {
            let leans = [point - 1, point].map(|point| problem.setup.leans.get(point).copied().unwrap_or_default());
            let turn = space.most_turn(problem.task.upright().path(), point, [&leans[0], &leans[1]]);
            turn / (2.0 * space.contact_tolerance)
        }),
        Limit::CellYaw
        | Limit::Lead
        | Limit::Tilt
        | Limit::MaxLean
        | Limit::Joint(_)
        | Limit::AxesSum
        | Limit::Conditioning
        | Limit::BaseDistance
        | Limit::Clearance(_)
        | Limit::KeepOut(_) => 1.0,
    }
}

/// Relative step of the central differences of how far a limit lets beta change.
const TURN_STEP: f64 = 1e-6;

/// By how much a side of the allowed changes of beta at a point gives way with a limit. rad per its unit
fn loosened_turn(problem: &Problem, side: Side, point: usize, limit: Limit) -> f64 {
    let end = |factor: f64| {
        let mut limits = problem.redundancy;
        let own = match limit {
            Limit::BetaRate => &mut limits.max_beta_rate,
            Limit::SpindleSpeed => &mut limits.max_spindle_speed,
            _ => &mut limits.max_spindle_turn,
        };
        let value = own.as_mut()?;
        *value *= factor;
        let moved = *value;
        let step = problem.beta_step_within(point, &limits);
        Some((moved, if side.is_upper { step.middle + step.half } else { step.half - step.middle }))
    };
    let (Some(wide), Some(narrow)) = (end(1.0 + TURN_STEP), end(1.0 - TURN_STEP)) else { return 0.0 };
    let slope = (wide.1 - narrow.1) / (wide.0 - narrow.0);
    // Rounding, where another limit decides.
    if slope.abs() * wide.0 < TURN_STEP * wide.1.abs() { 0.0 } else { slope }
}

/// How far the difference reaches that measures the gain of a wall at a worst placement, in scaled variables.
const STEP: f64 = 1e-3;

/// The walls and shapes of the cell that hold a worst placement, the largest gains first: for each that it touches
/// everything is planned anew a little away from it, along the others.
pub fn active_walls(planner: &Planner<'_>, worst: &Solution, scheme: Option<&[Posture]>) -> Vec<ActiveBound> {
    let problem = planner.problem();
    let touched: Vec<Touched> = walls(problem, worst).into_iter().chain(shapes(problem, worst)).collect();
    if touched.is_empty() {
        return Vec::new();
    }
    let inward = DMatrix::from_fn(touched.len(), 4, |row, k| touched[row].inward[k]);
    // Along the column of each the slack to it grows by one, and that to the others stays; equal ones share.
    let Ok(away) = inward.pseudo_inverse(PARALLEL) else { return Vec::new() };
    let mut workspace = planner.workspace();
    let mut gain = |(place, touched): (usize, &Touched)| {
        let step = away.column(place) * STEP;
        let moved = Placement::from(std::array::from_fn(|k| worst.placement[k] + step[k] * UNITS[k]));
        let moved = planned(planner, &problem.cell.clamp(&moved), scheme, &mut workspace)?;
        Some((worst.objective - moved.objective) / (STEP * touched.unit))
    };
    let gains = touched.iter().enumerate().filter_map(|held| Some((held.1.side, gain(held)?)));
    let mut bounds: Vec<ActiveBound> = Vec::new();
    for (side, gain) in gains.filter(|(_, gain)| *gain > FLOOR * worst.objective) {
        match bounds.iter_mut().find(|known| known.side == side) {
            Some(known) => known.gain += gain,
            None => bounds.push(ActiveBound { side, names: names(problem, side.limit), gain }),
        }
    }
    sorted(bounds)
}

/// What a worst placement touches.
struct Touched {
    side: Side,
    /// The direction away from it, in scaled variables.
    inward: Vector4<f64>,
    /// By how much the slack to it grows in a step of one along that. m or rad
    unit: f64,
}

/// Directions are the same where their sines are below this.
const PARALLEL: f64 = 1e-3;

/// The walls of the cell that a placement touches.
fn walls(problem: &Problem, worst: &Solution) -> Vec<Touched> {
    let slacks = pose_bounds(problem, &worst.placement);
    let sides = |k: usize| [(k, true, slacks[k].max, -slacks[k].min), (k, false, -slacks[k].min, slacks[k].max)];
    let touched = |(k, is_upper, near, far): (usize, bool, f64, f64)| {
        let sign = if is_upper { -1.0 } else { 1.0 };
        let inward = Vector4::from_fn(|j, _| if j == k { sign } else { 0.0 });
        let is_touched = near <= TOUCHED && far >= STEP;
        is_touched.then_some(Touched { side: Side { limit: Limit::ALL_WALLS[k], is_upper }, inward, unit: UNITS[k] })
    };
    (0..4).flat_map(sides).filter_map(touched).collect()
}

/// The shapes of the cell that the part or its fixture touches at a placement.
fn shapes(problem: &Problem, worst: &Solution) -> Vec<Touched> {
    let touched = |(slack, inward): (Slack, Vector4<f64>)| Touched {
        side: Side { limit: slack.limit, is_upper: false },
        inward,
        unit: slack.pose_slopes().norm(),
    };
    touching(problem, worst, TOUCHED_SHAPES).map(touched).collect()
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
