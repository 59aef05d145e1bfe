//! How fine the grid of beta is that final plans are made on.

use stead_problem::problem::{Problem, Redundancy};

/// The grid of [`Planner::finer`], for limits on beta that may not be those of the problem.
pub(super) fn finer(problem: &Problem, grid: Redundancy) -> Redundancy {
    let inner = problem.task.segments().iter().flat_map(|span| span.clone().skip(1));
    let steps = inner.map(|point| problem.beta_step_within(point, &grid).half);
    let wanted = |half: f64| (half / STEPS_PER_CHANGE).max(DENSE_STEP).min(half);
    grid.divided(steps.filter(|step| *step >= NARROWEST_STEP).map(wanted).fold(WIDEST_STEP, f64::min))
}

/// Widest step of the grid that final plans are made on. rad
const WIDEST_STEP: f64 = std::f64::consts::PI / 180.0;
/// Steps of the grid that the largest change of beta between two points has at least, so that a plan that the limits on
/// beta hold is not far from what the grid offers;
const STEPS_PER_CHANGE: f64 = 4.0;
/// but for this no narrower step is taken. rad
const DENSE_STEP: f64 = WIDEST_STEP / 2.0;
/// Narrowest step that the limits on beta may ask for. rad
const NARROWEST_STEP: f64 = WIDEST_STEP / 8.0;
