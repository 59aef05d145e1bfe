//! Ascent to the worst placement: a maximum over the pose of the minimum over all plans.
//!
//! The gradient of that minimum with respect to the pose is exact (envelope theorem): it is the multiplier of "the pose
//! stays" in the subproblem. A step goes along it, projected into the cell, to a pose where everything is planned anew.

use super::super::problem::{Placement, Problem};
use super::super::redundancy::{Planner, Workspace, fine};
use super::linearise::{UNITS, linearise};
use super::solver::Run;
use super::subproblem::{Question, pose_bounds, solve};
use super::{Solution, planned};
use crate::robot::Posture;

/// Step sizes in scaled variables, first and last.
const STEPS: (f64, f64) = (0.2, 1e-5);
/// Iterations at the most.
const MOST_ITERATIONS: usize = 60;
/// A step has to gain this share of what the gradient promises.
const ARMIJO: f64 = 0.05;

/// Climbs from a solution; never returns a lower one.
pub fn run(planner: &Planner<'_>, start: &Solution, scheme: Option<&[Posture]>, workspace: &mut Workspace) -> Run {
    let problem = planner.problem();
    let tube = fine::Tube::full(problem);
    let mut best = start.clone();
    let mut step = STEPS.0;
    let mut iterations = 0;
    let mut status = "converged: no gain with the smallest step".to_owned();
    while step >= STEPS.1 {
        if iterations == MOST_ITERATIONS {
            status = "stopped at the largest number of iterations".to_owned();
            break;
        }
        iterations += 1;
        let Some(gradient) = pose_gradient(problem, &best) else {
            status = "the subproblem could not be solved".to_owned();
            break;
        };
        let mut improved = false;
        let mut promised = f64::INFINITY;
        while !improved && step >= STEPS.1 {
            let direction = projected(problem, &best.pose, &gradient, step);
            promised = (0..4).map(|k| direction[k] * gradient[k]).sum();
            if promised <= 0.0 {
                break;
            }
            let pose: [f64; 4] = std::array::from_fn(|k| best.pose[k] + direction[k] * UNITS[k]);
            let [x, y, z, yaw] = pose;
            let inside = problem.cell.clamp(&Placement { x, y, z, yaw });
            let pose = [inside.x, inside.y, inside.z, inside.yaw];
            match planned(planner, &pose, scheme, tube, workspace) {
                Some(next) if next.mean() - best.mean() > ARMIJO * promised => {
                    best = next;
                    step = (step * 1.5).min(STEPS.0);
                    improved = true;
                }
                _ => step /= 2.0,
            }
        }
        if promised <= 0.0 {
            status = "converged: the gradient points out of the cell".to_owned();
            break;
        }
    }
    Run { solution: best, status, iterations }
}

/// Gradient of the mean score of the best plan with respect to the pose, postures fixed. m per scaled unit
fn pose_gradient(problem: &Problem, solution: &Solution) -> Option<[f64; 4]> {
    let locals = linearise(problem, solution)?;
    let question = Question { trust: 1e-3, curved: true, pose_stays: true };
    solve(problem, solution, &locals, question).ok().map(|answer| answer.pose_gradient)
}

/// A step of the given length along the gradient, shortened to stay in the cell component by component.
fn projected(problem: &Problem, pose: &[f64; 4], gradient: &[f64; 4], step: f64) -> [f64; 4] {
    let bounds = pose_bounds(problem, pose);
    let mut free = [true; 4];
    let mut direction = [0.0; 4];
    // A component that the cell stops gives its length to the others.
    for _ in 0..4 {
        let norm = libm::sqrt((0..4).filter(|k| free[*k]).map(|k| gradient[k] * gradient[k]).sum());
        if norm == 0.0 {
            break;
        }
        let mut stopped = false;
        for k in (0..4).filter(|k| free[*k]).collect::<Vec<_>>() {
            let wanted = step * gradient[k] / norm;
            direction[k] = bounds[k].clamp(wanted);
            if (direction[k] - wanted).abs() > 0.5 * wanted.abs() {
                free[k] = false;
                stopped = true;
            }
        }
        if !stopped {
            break;
        }
    }
    direction
}

/// What the gradient still promises inside the cell, per unit of trust region. m per scaled unit
pub fn kkt_residual(problem: &Problem, solution: &Solution) -> f64 {
    let bounds = pose_bounds(problem, &solution.pose);
    pose_gradient(problem, solution).map_or(f64::INFINITY, |gradient| {
        (0..4)
            .filter(|k| if gradient[*k] > 0.0 { bounds[*k].max > 1e-9 } else { bounds[*k].min < -1e-9 })
            .map(|k| gradient[k].abs())
            .sum()
    })
}
