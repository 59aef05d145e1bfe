//! A placement that a bound is compared with where no plan is known: some good one of a small search.

use super::relaxed::{relaxed_value, rough_value};
use rayon::prelude::*;
use stead_model::task::KeptPoint;
use stead_numerics::monitor::Monitor;
use stead_problem::problem::{Placement, Problem};

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
