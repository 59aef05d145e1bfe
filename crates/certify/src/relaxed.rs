//! The objective of a placement without the limits between neighbouring points, by the reference evaluator.

use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

use stead_model::robot::{PostureClass, angles::ANGLE_ROUNDING, turns::Range};
use stead_numerics::monitor::Monitor;
use stead_problem::problem::{Placement, Problem};

/// Grid values of beta, before it is refined.
const BETAS: usize = 360;
/// Steps of the golden section: from two grid steps to a billionth of them.
const NARROWINGS: usize = 43;
/// Values of beta where few are enough.
const FEW: usize = 36;

/// The figure that is minimised, of the least score of each path point over beta, in the best posture class of each
/// segment; `None` where some segment has no class that is allowed at all its points, or once the caller asks to stop.
/// m
///
/// What must hold: reach, the limits of joints 2, 3 and 5 (of the last the farther from zero, both ways) and the least
/// inverse condition. What is relaxed: the rate of beta, joint steps, the limits of joints 1, 4 and 6 and the largest
/// deflection of a point. So no plan of the placement comes to less. Beta is sought over a grid of one degree
/// and then by golden section about each least value; ranges of allowed beta narrower than the grid may be missed.
pub fn relaxed_value(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Option<f64> {
    value_by(minimum, problem, placement, monitor)
}

/// The same from a few values of beta alone, which is never less. m
pub(super) fn rough_value(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Option<f64> {
    value_by(least_of_few, problem, placement, monitor)
}

/// The same where `minimum` tells the least of a function of beta.
fn value_by(
    minimum: fn(&dyn Fn(f64) -> f64) -> f64,
    problem: &Problem,
    placement: &Placement,
    monitor: &Monitor,
) -> Option<f64> {
    let points = problem.task.points().len();
    let all: Vec<[f64; 4]> = (0..points)
        .into_par_iter()
        .map(|point| {
            let cost = |score: f64| if score.is_finite() { problem.point_cost(point, score) } else { score };
            let minimum = |class| minimum(&|beta| cost(score(problem, placement, point, class, beta)));
            if monitor.should_stop() { [f64::INFINITY; 4] } else { PostureClass::ALL.map(minimum) }
        })
        .collect();
    let segment = |span: &std::ops::Range<usize>| {
        let join = |sum: f64, cost: f64| problem.criterion.aggregate.join(sum, cost);
        let of = |class: usize| all[span.clone()].iter().map(|costs| costs[class]).fold(0.0, join);
        (0..4).map(of).fold(f64::INFINITY, f64::min)
    };
    let value = problem.objective(problem.task.segments().iter().map(segment));
    value.is_finite().then_some(value)
}

/// The score of a state; infinite where it is not allowed. m
pub(super) fn score(problem: &Problem, placement: &Placement, point: usize, class: PostureClass, beta: f64) -> f64 {
    let Ok(found) = problem.at(placement).state(point, beta, class.postures()[0]) else { return f64::INFINITY };
    let joints = problem.robot.joints();
    let within = |j: usize| Range::of(&joints[j]).nearest(found.joints[j]).1 == 0.0;
    let real = std::array::from_fn(|j| Range::of(&joints[j]).nearest(found.joints[j]).0);
    let is_sum_within = problem.robot.beyond_sum(&real) <= ANGLE_ROUNDING;
    let widest5 = joints[4].min.abs().max(joints[4].max.abs()) + ANGLE_ROUNDING;
    let fifth = widest5 >= PI || libm::cos(found.joints[4]) >= libm::cos(widest5);
    let conditioned = found.inverse_condition >= problem.constraints.min_inverse_condition;
    if within(1) && within(2) && is_sum_within && fifth && conditioned { found.score() } else { f64::INFINITY }
}

/// The least of a function over a turn.
fn minimum(of: &dyn Fn(f64) -> f64) -> f64 {
    let step = TAU / BETAS as f64;
    let values: Vec<f64> = (0..BETAS).map(|k| of(step * k as f64)).collect();
    let mut best = f64::INFINITY;
    for (k, value) in values.iter().enumerate() {
        let (before, after) = (values[(k + BETAS - 1) % BETAS], values[(k + 1) % BETAS]);
        if *value < f64::INFINITY && *value <= before && *value <= after {
            let found = narrowed(of, step * (k as f64 - 1.0), step * (k as f64 + 1.0));
            best = best.min(*value).min(found);
        }
    }
    best
}

/// The least at a few values of beta.
fn least_of_few(of: &dyn Fn(f64) -> f64) -> f64 {
    (0..FEW).map(|k| of(TAU / FEW as f64 * k as f64)).fold(f64::INFINITY, f64::min)
}

/// The least value met by a golden section.
fn narrowed(of: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let (mut a, mut b) = (high - SHARE * (high - low), low + SHARE * (high - low));
    let (mut at_a, mut at_b) = (of(a), of(b));
    let mut best = at_a.min(at_b);
    for _ in 0..NARROWINGS {
        if at_a <= at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - SHARE * (high - low);
            at_a = of(a);
            best = best.min(at_a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + SHARE * (high - low);
            at_b = of(b);
            best = best.min(at_b);
        }
    }
    best
}
