//! Gradient refinement of a placement: placement and all betas together.
//!
//! **Best placement.** With postures and turns fixed, the mean score is minimised over x, y, z, yaw and every beta_i by
//! a sequential convex programme ([`solver`], an argmin solver): scores enter a convex subproblem through epigraph
//! variables, so that the kinks of |c_i| are no obstacle; joint limits, joint steps, conditioning, c_max, the rate of
//! beta and the cell and the distances of shapes are linearised; a trust region keeps the step where the model is right
//! ([`subproblem`], solved by clarabel). Derivatives are exact but those of distances ([`linearise`], [`slacks`]). Then
//! postures, turns and betas are planned anew, and so on until neither changes.
//!
//! **Worst placement.** That is a maximum over the placement of a minimum over beta. Its gradient is the multiplier of
//! the constraint "the placement stays" in the same subproblem ([`ascent`]); steps along it are taken with beta planned
//! anew.
//!
//! A step is only ever taken to a state that the reference evaluator finds allowed and better, so the result is never
//! worse or less feasible than the start.
//!
//! **The KKT residual** is in m of mean score per scaled unit, one unit being [`LENGTH_UNIT`] in position and one
//! radian in yaw and beta; it is zero at a first-order optimum. For the best placement it is the decrease that the
//! linear model still promises per unit of trust region: the smallest 1-norm that the gradient of the Lagrangian can
//! have over all multipliers. For the worst placement, which likes to sit on a ridge between two plans, see
//! [`ascent::kkt_residual`].

pub mod active;
mod agreement;
pub mod ascent;
mod differentiated;
mod kinks;
mod lean_rows;
pub mod lean_slopes;
pub mod linearise;
pub mod programme;
mod rows;
pub mod slacks;
mod solution;
pub mod solver;
pub mod subproblem;
mod travel;
mod variables;

pub use agreement::found_again;
pub(crate) use solution::neighbours;
pub use solution::{LENGTH_UNIT, LOCAL, Solution, UNITS, planned};
use solution::{NEAR, is_near};

use super::evaluator::{self, Evaluator};
use super::lookup::CollisionEffort;
use super::outcome::{Refinement, RefinementStatus};
use rayon::prelude::*;
use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::{Planner, SegmentPlan, Workspace};
use stead_problem::criterion::CANCELLATION;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// Rounds of refining and planning anew, at the most.
const ROUNDS: usize = 12;
/// The same on a subset of a path, whose mean is off by more than later ones gain.
const ROUNDS_ON_SUBSET: usize = 6;
/// A round that gains less than this share of the mean ends the refinement.
const GAIN: f64 = 1e-5;

/// Refines from one placement, with the posture scheme found anew in every round or kept as given; the KKT residual is
/// left open ([`state_residual`]). `None` when the placement has no plan to start from. Once the caller asks to stop,
/// it ends with what it has.
pub fn refine(
    evaluator: &Evaluator<'_>,
    start: &Placement,
    sense: Sense,
    scheme: Option<&[Posture]>,
    monitor: &Monitor,
) -> Option<(Solution, Refinement)> {
    let planner = evaluator.planner();
    let problem = planner.problem();
    let mut workspace = planner.workspace();
    let mut best = planned(planner, start, scheme, &mut workspace)?;
    let mut report = begun(sense, &best);
    if is_cancelled(&best) {
        report.statuses.push(RefinementStatus::Cancelled);
    }
    let (rounds, ending) = match problem.task.path().is_thinned() {
        true => (ROUNDS_ON_SUBSET, solver::Ending::LOOSE),
        false => (ROUNDS, solver::Ending::TIGHT),
    };
    while report.rounds < rounds && !is_cancelled(&best) && !monitor.should_stop() {
        report.rounds += 1;
        let (before, signature) = (best.objective, signature(&best));
        let (status, iterations);
        (best, status, iterations) = match sense {
            Sense::Min => {
                let run = solver::run(problem, &best, ending, monitor);
                (run.solution, run.status, run.iterations)
            }
            Sense::Max => {
                let run = ascent::run(planner, &best, scheme, &mut workspace, monitor);
                (run.solution, run.status, run.iterations)
            }
        };
        report.iterations += iterations;
        report.statuses.push(status);
        // Plan anew at the new placement. For the best placement a better plan is welcome; for the worst one every plan
        // is already the best at its placement.
        if sense == Sense::Min
            && !monitor.should_stop()
            && let Some(anew) = planned(planner, &best.placement, scheme, &mut workspace)
            && anew.objective < best.objective
        {
            best = anew;
        }
        let gained = (before - best.objective).abs();
        if self::signature(&best) == signature && gained < GAIN * before {
            // The model knows one plan; a neighbour may have another, better one.
            match poll(evaluator, &best, sense, scheme, monitor) {
                Some(better) => best = better,
                None => break,
            }
        }
    }
    report.end = best.placement;
    report.end_mean = best.objective;
    if monitor.should_stop() {
        state_interrupted(&mut report);
    }
    Some((best, report))
}

/// States that a refinement was stopped before its end.
fn state_interrupted(report: &mut Refinement) {
    if report.statuses.last() != Some(&RefinementStatus::Interrupted) {
        report.statuses.push(RefinementStatus::Interrupted);
    }
}

/// States the KKT residual of what a refinement came to.
pub fn state_residual(
    planner: &Planner<'_>,
    solution: &Solution,
    scheme: Option<&[Posture]>,
    report: &mut Refinement,
    monitor: &Monitor,
) {
    report.kkt_residual = kkt_residual(planner, solution, report.sense, scheme, monitor);
    if report.kkt_residual.is_none() {
        state_interrupted(report);
    }
}

/// The report of a refinement at its start.
fn begun(sense: Sense, start: &Solution) -> Refinement {
    Refinement {
        sense,
        start: start.placement,
        start_mean: start.objective,
        end: start.placement,
        end_mean: start.objective,
        rounds: 0,
        iterations: 0,
        kkt_residual: None,
        statuses: Vec::new(),
    }
}

/// Whether the deflections cancel all along the path.
fn is_cancelled(solution: &Solution) -> bool {
    solution.objective <= CANCELLATION
}

/// The KKT residual of a solution, zero by definition where the deflection is; none once the caller asks to stop.
fn kkt_residual(
    planner: &Planner<'_>,
    solution: &Solution,
    sense: Sense,
    scheme: Option<&[Posture]>,
    monitor: &Monitor,
) -> Option<f64> {
    match sense {
        _ if monitor.should_stop() => None,
        _ if is_cancelled(solution) => Some(0.0),
        Sense::Min => Some(subproblem::kkt_residual(planner.problem(), solution)),
        Sense::Max => ascent::kkt_residual(planner, solution, scheme, monitor),
    }
}

/// Distances of the neighbours that are planned anew before a refinement ends, in scaled variables.
const POLLS: [f64; 2] = [0.03, 0.006];
/// The best neighbour along the placement axes, if it is better by more than [`GAIN`]; of those planned before a stop.
fn poll(
    evaluator: &Evaluator<'_>,
    centre: &Solution,
    sense: Sense,
    scheme: Option<&[Posture]>,
    monitor: &Monitor,
) -> Option<Solution> {
    let planner = evaluator.planner();
    let problem = planner.problem();
    let sign = sense.sign();
    let look = |placement: &Placement, within: [f64; 2], space: &mut evaluator::Workspace| {
        evaluator.approximate(placement, scheme, within, space)
    };
    let here = look(&centre.placement, CollisionEffort::ALL.within, &mut evaluator.workspace());
    // Collisions only make a mean larger.
    let most = here.filter(|_| sense == Sense::Min).unwrap_or(f64::INFINITY);
    // A neighbour that an approximation, which errs far less from one neighbour to the next, sees to be no better is
    // not planned.
    let is_no_better = |(here, there): (f64, f64)| (there - here) * sign >= 0.0;
    let planned_if_better = |(workspace, space): &mut (Workspace, evaluator::Workspace),
                             placement: &Placement|
     -> Option<Solution> {
        let is_worse = |space| here.zip(look(placement, [f64::NEG_INFINITY, most], space)).is_some_and(is_no_better);
        if monitor.should_stop() || is_worse(space) {
            return None;
        }
        planned(planner, placement, scheme, workspace)
    };
    let limit = centre.objective * (1.0 - sign * GAIN) * sign;
    let mut best: Option<Solution> = None;
    for distance in POLLS {
        let planned: Vec<Option<Solution>> = neighbours(problem, &centre.placement, distance)
            .par_iter()
            .map_init(|| (planner.workspace(), evaluator.workspace()), planned_if_better)
            .collect();
        let better = planned.into_iter().flatten().filter(|near| near.objective * sign < limit);
        best = better.reduce(|known, next| if next.objective * sign < known.objective * sign { next } else { known });
        if best.is_some() {
            break;
        }
    }
    let mut workspace = planner.workspace();
    // Along an edge of what is allowed, the same way leads on.
    while let Some(known) = best.as_ref().filter(|_| !monitor.should_stop()) {
        let ahead = Placement::from(std::array::from_fn(|k| {
            centre.placement[k] + 2.0 * (known.placement[k] - centre.placement[k])
        }));
        let ahead = problem.cell.clamp(&ahead);
        if is_near(&ahead, &known.placement, NEAR * POLLS[1]) {
            break;
        }
        let next = planned(planner, &ahead, scheme, &mut workspace);
        match next.filter(|next| next.objective * sign < known.objective * sign) {
            Some(next) => best = Some(next),
            None => break,
        }
    }
    best
}

/// What must not change any more: posture and turns of every segment.
fn signature(solution: &Solution) -> Vec<(Posture, [i32; 6])> {
    let turns = |plan: &SegmentPlan| plan.joints.first().map_or([0; 6], |q| q.map(stead_model::robot::turns::turns));
    solution.plans.iter().map(|plan| (plan.posture, turns(plan))).collect()
}

#[cfg(test)]
mod tests;
