//! The objective of a placement without the limits between neighbouring points, by the reference evaluator; and that of
//! some good placement of a small search.

use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use stead_model::robot::{PostureClass, angles::ANGLE_ROUNDING, turns::Range};
use stead_model::task::KeptPoint;
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
fn rough_value(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Option<f64> {
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

/// Placements tried all over the cell, how many of the best of them are improved, and how often steps are halved there.
const TRIED: usize = 192;
const IMPROVED: usize = 2;
const HALVINGS: usize = 6;
/// Path points that placements are compared on.
const COMPARED: usize = 8;

/// What some good placement comes to with limits relaxed ([`relaxed_value`]): what a bound of a segment is compared
/// with, of which no plan is known. m
pub(super) fn low_value(problem: &Problem, monitor: &Monitor) -> Option<f64> {
    let path = problem.task.path();
    let scored: Vec<usize> = (0..problem.task.points().len()).filter(|p| problem.point_weight(*p) > 0.0).collect();
    let step = scored.len().div_ceil(COMPARED).max(1);
    let kept: Vec<_> =
        scored.iter().step_by(step).map(|point| KeptPoint { point: *point, weight: path.weight(*point) }).collect();
    let few = problem.on_points(&kept);
    let [x, y, z] = problem.cell.position;
    let ranges = [x, y, z, problem.cell.yaw];
    let at = |shares: &[f64; 4]| {
        let [x, y, z, yaw] = std::array::from_fn(|k| ranges[k].min + ranges[k].width() * shares[k]);
        Placement { x, y, z, yaw }
    };
    let of = |shares: &[f64; 4]| rough_value(&few, &at(shares), monitor).unwrap_or(f64::INFINITY);
    // An additive recurrence, which covers four dimensions evenly.
    let ratio = 1.167_303_978_261_418_7_f64;
    let tried = |k: usize| std::array::from_fn(|d| (0.5 + (k + 1) as f64 / ratio.powi(d as i32 + 1)).fract());
    let mut all: Vec<(f64, [f64; 4])> = (0..TRIED).into_par_iter().map(|k| (of(&tried(k)), tried(k))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let improved = all.into_iter().take(IMPROVED).filter(|(value, _)| value.is_finite()).map(|mut best| {
        let (mut step, mut halved) = (0.125, 0);
        while halved < HALVINGS {
            let beside = (0..8).map(|k| {
                let mut shares = best.1;
                shares[k / 2] = (shares[k / 2] + if k % 2 == 0 { step } else { -step }).clamp(0.0, 1.0);
                (of(&shares), shares)
            });
            let next = beside.fold(best, |best, other| if other.0 < best.0 { other } else { best });
            if next.0 < best.0 {
                best = next;
            } else {
                (step, halved) = (0.5 * step, halved + 1);
            }
        }
        best
    });
    let best = improved.min_by(|a, b| a.0.total_cmp(&b.0))?;
    relaxed_value(problem, &at(&best.1), monitor)
}
