//! Ascent to the worst placement: a maximum over the placement of the minimum over all plans.
//!
//! The gradient of that minimum with respect to the placement is exact (envelope theorem): it is the multiplier of "the
//! placement stays" in the subproblem. Curvature is learnt from gradients (damped BFGS); the step maximises the model
//! inside the cell and a trust region, again by clarabel, and leads to a placement where everything is planned anew.

use super::super::outcome::RefinementStatus;
use super::linearise::{Curvature, linearise};
use super::programme::{pose_bounds, pose_step, shortest};
use super::slacks::{NEAR_STAYING, Slack, placement_rooms};
use super::solver::SolverRun;
use super::subproblem::{StepRequest, solve};
use super::{Solution, UNITS, planned};
use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;
use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::{Planner, Workspace};
use stead_problem::problem::{Placement, Problem};

/// The trust region at the start, at the most and at the end, in scaled variables.
const TRUST: (f64, f64, f64) = (0.2, 1.0, 1e-4);
/// Iterations at the most.
const MAX_ITERATIONS: usize = 40;
/// A step has to gain this share of what the model promises.
const ARMIJO: f64 = 0.05;
/// A promised gain of less than this share of the mean ends it.
const MIN_PROMISE: f64 = 1e-6;

/// Climbs from a solution until it is at the top or the caller asks to stop; never returns a lower one.
pub fn run(
    planner: &Planner<'_>,
    start: &Solution,
    scheme: Option<&[Posture]>,
    workspace: &mut Workspace,
    monitor: &Monitor,
) -> SolverRun {
    let problem = planner.problem();
    let mut best = start.clone();
    let mut iterations = 0;
    let ended = |solution, iterations, status| SolverRun { solution, iterations, status };
    let Some(mut gradient) = pose_gradient(problem, &best) else {
        return ended(best, iterations, RefinementStatus::SubproblemFailed);
    };
    let mut trust = TRUST.0;
    let mut curvature = Matrix4::identity() * (gradient.norm() / trust);
    while trust >= TRUST.2 {
        if iterations == MAX_ITERATIONS {
            return ended(best, iterations, RefinementStatus::MaxIterations);
        }
        if monitor.should_stop() {
            return ended(best, iterations, RefinementStatus::Interrupted);
        }
        iterations += 1;
        let Some(step) = pose_step(problem, &best.placement, &gradient, &curvature, trust) else {
            return ended(best, iterations, RefinementStatus::SubproblemFailed);
        };
        let promised = gradient.dot(&step) - 0.5 * step.dot(&(curvature * step));
        if promised < MIN_PROMISE * best.objective {
            return ended(best, iterations, RefinementStatus::NoFirstOrderGain);
        }
        let placement = Placement::from(std::array::from_fn(|k| best.placement[k] + step[k] * UNITS[k]));
        let placement = problem.cell.clamp(&placement);
        let candidate = planned(planner, &placement, scheme, workspace);
        let Some(next) = candidate.filter(|next| next.objective - best.objective > ARMIJO * promised) else {
            trust = trust.min(step.amax()) / 3.0;
            continue;
        };
        if next.objective - best.objective > 0.7 * promised && step.amax() > 0.9 * trust {
            trust = (2.0 * trust).min(TRUST.1);
        }
        best = next;
        let Some(there) = pose_gradient(problem, &best) else {
            return ended(best, iterations, RefinementStatus::SubproblemFailed);
        };
        learn(&mut curvature, &step, &(gradient - there));
        gradient = there;
    }
    ended(best, iterations, RefinementStatus::SmallestTrustRegion)
}

/// Damped BFGS (Powell 1978): keeps the curvature positive definite whatever the change of gradient says.
fn learn(curvature: &mut Matrix4<f64>, step: &Vector4<f64>, change: &Vector4<f64>) {
    let image = *curvature * step;
    let along = step.dot(&image);
    let measured = step.dot(change);
    let share = if measured >= 0.2 * along { 1.0 } else { 0.8 * along / (along - measured) };
    let change = change * share + image * (1.0 - share);
    let denominator = step.dot(&change);
    if along > 0.0 && denominator > 0.0 {
        *curvature += change * change.transpose() / denominator - image * image.transpose() / along;
    }
}

/// Gradient of the mean score of the best plan with respect to the placement, postures fixed. m per scaled unit
pub(super) fn pose_gradient(problem: &Problem, solution: &Solution) -> Option<Vector4<f64>> {
    let locals = linearise(problem, solution, Curvature::Beta, NEAR_STAYING)?;
    let request = StepRequest { trust: 1e-3, curved: true, pose_stays: true };
    let answered = solve(problem, solution, &locals, request).ok()?;
    Some(Vector4::from(answered.pose_gradient))
}

/// The pairs of the part and what stands in the cell that a step of a scaled length can bring together: their slopes,
/// and the direction in which they part.
pub(super) fn touching(
    problem: &Problem,
    solution: &Solution,
    within: f64,
) -> impl Iterator<Item = (Slack, Vector4<f64>)> {
    placement_rooms(problem, &solution.placement).into_iter().filter_map(move |slack| {
        let slopes = slack.pose_slopes();
        let steepest = slopes.norm();
        (steepest > 0.0 && slack.slack < within * steepest).then(|| (slack, slopes / steepest))
    })
}

/// Distance of the sampled neighbours, in scaled variables.
const SAMPLING: f64 = 2e-3;

/// First-order optimality of a worst placement: m of mean score per scaled unit, zero at a maximum.
///
/// The minimum over plans has ridges, where two plans tie and each has a gradient of its own. So the gradients of the
/// best plans of the neighbours are sampled (Burke, Lewis and Overton 2005), and the residual is the shortest vector
/// that a convex combination of them makes with the outward normals of what holds the placement: walls of the cell, and
/// shapes that the part or its fixture touches. `None` once the caller asks to stop.
pub fn kkt_residual(
    planner: &Planner<'_>,
    solution: &Solution,
    scheme: Option<&[Posture]>,
    monitor: &Monitor,
) -> Option<f64> {
    let problem = planner.problem();
    let bounds = pose_bounds(problem, &solution.placement);
    let mut normals: Vec<Vector4<f64>> = touching(problem, solution, SAMPLING).map(|(_, inward)| -inward).collect();
    let mut sampled = Vec::new();
    for k in 0..4 {
        for (side, slack) in [(-1.0, -bounds[k].min), (1.0, bounds[k].max)] {
            if slack < SAMPLING {
                normals.push(Vector4::from_fn(|j, _| if j == k { side } else { 0.0 }));
                continue;
            }
            let mut placement = solution.placement;
            placement[k] += side * SAMPLING * UNITS[k];
            sampled.push(placement);
        }
    }
    let gradient = |workspace: &mut Workspace, placement: &Placement| {
        let near = || planned(planner, placement, scheme, workspace);
        (!monitor.should_stop()).then(near).flatten().and_then(|near| pose_gradient(problem, &near))
    };
    let near: Vec<Option<Vector4<f64>>> = sampled.par_iter().map_init(|| planner.workspace(), gradient).collect();
    if monitor.should_stop() {
        return None;
    }
    let gradients: Vec<Vector4<f64>> =
        pose_gradient(problem, solution).into_iter().chain(near.into_iter().flatten()).collect();
    Some(shortest(&gradients, &normals))
}
