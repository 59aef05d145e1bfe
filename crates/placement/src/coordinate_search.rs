//! Coordinate search: from a placement to the bottom (or top) of its basin, one direction at a time.
//!
//! The directions are those in which the arm has its symmetry: away from axis 1, up, the yaw against the azimuth, which
//! is kept while the others change, and, where requested, about axis 1. Each has a step of its own that grows with
//! success and shrinks without.

use nalgebra::Vector2;
use std::cmp::Ordering;
use stead_numerics::monitor::Monitor;
use stead_problem::candidate::{Objective, rank};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::symmetry::{apart_about_axis_1, is_free_about_axis_1};

/// First steps: radius (m), height (m), yaw (rad), azimuth (rad).
const FIRST: [f64; 4] = [0.03, 0.03, 0.06, 0.06];
/// The search ends when every step is below this share of the first,
const LAST: f64 = 0.01;
/// on a subset of a path, whose mean is off by more than that makes, below this.
const LAST_ON_SUBSET: f64 = 0.03;
/// Placements as near as this (m, rad) but for a turn about axis 1 are the same.
const SAME: f64 = 1e-9;
/// A step that brings nothing is divided by this.
const SHRINK: f64 = 3.0;
/// A step that brings something is multiplied by this.
const GROWTH: f64 = 1.7;
/// Placements evaluated for each direction, at most.
const MAX_EVALUATIONS: usize = 50;

/// In which directions to search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Directions {
    /// Radius, height and yaw: where the azimuth changes nothing, or hardly anything.
    WithoutAzimuth = 3,
    /// All.
    All = 4,
}

/// The best placement (in the given sense) that steps from `start` (x, y, z in m, yaw in rad) lead to inside the cell
/// of a problem, its objective, and the number of placements evaluated; never worse than the start. A stop ends it.
pub fn coordinate_search(
    problem: &Problem,
    start: &Placement,
    sense: Sense,
    directions: Directions,
    mut evaluate: impl FnMut(&Placement) -> Objective,
    monitor: &Monitor,
) -> (Placement, Objective, usize) {
    let count = directions as usize;
    let mut best = *start;
    let mut objective = evaluate(start);
    let mut evaluations = 1;
    let mut steps = FIRST;
    let last = if problem.task.path().is_thinned() { LAST_ON_SUBSET } else { LAST };
    let is_symmetric = is_free_about_axis_1(problem);
    let may_go_on = |evaluations: usize| evaluations < MAX_EVALUATIONS * count && !monitor.should_stop();
    while may_go_on(evaluations) && (0..count).any(|k| steps[k].abs() > last * FIRST[k]) {
        for k in 0..count {
            let found = [1.0, -1.0].into_iter().any(|side| {
                let placement = moved(problem, &best, k, side * steps[k]);
                let is_like = || apart_about_axis_1(problem, &best, &placement).iter().all(|apart| *apart < SAME);
                if placement == best || (is_symmetric && objective.mean().is_some() && is_like()) {
                    return false;
                }
                evaluations += 1;
                let there = evaluate(&placement);
                let better = rank(sense, there, objective) == Ordering::Less;
                if better {
                    (best, objective) = (placement, there);
                    // The next step goes the same way first.
                    steps[k] *= side;
                }
                better
            });
            steps[k] = if found { steps[k] * GROWTH } else { steps[k] / SHRINK };
        }
    }
    (best, objective, evaluations)
}

/// The placements a step in either sense of radius, height and yaw away from one, inside the cell; `share` of the first
/// steps of a search.
pub fn neighbours(problem: &Problem, placement: &Placement, share: f64) -> Vec<Placement> {
    let all =
        (0..Directions::WithoutAzimuth as usize).flat_map(|k| [1.0, -1.0].map(|side| (k, side * share * FIRST[k])));
    let moved = all.map(|(direction, step)| moved(problem, placement, direction, step));
    moved.filter(|there| there != placement).collect()
}

/// A placement moved along one direction, inside the cell.
fn moved(problem: &Problem, placement: &Placement, direction: usize, step: f64) -> Placement {
    let root = problem.robot.geometry().root_in_base;
    let Placement { mut x, mut y, mut z, mut yaw } = *placement;
    let away = Vector2::new(x - root.x, y - root.y);
    match direction {
        0 => {
            let away = if away.norm() > 0.0 { away.normalize() } else { Vector2::x() };
            x += away.x * step;
            y += away.y * step;
        }
        1 => z += step,
        2 => yaw += step,
        _ => {
            let (sine, cosine) = libm::sincos(step);
            (x, y) = (root.x + cosine * away.x - sine * away.y, root.y + sine * away.x + cosine * away.y);
        }
    }
    let cell = &problem.cell;
    let inside = cell.clamp(&Placement { x, y, z, yaw });
    // The yaw follows the azimuth.
    let azimuth = |x: f64, y: f64| libm::atan2(y - root.y, x - root.x);
    let turned = azimuth(inside.x, inside.y) - azimuth(placement.x, placement.y);
    cell.clamp(&Placement { yaw: inside.yaw + turned, ..inside })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix6, Vector3};
    use stead_model::robot::BaseCompliance;
    use stead_problem::testing::five_segments;

    /// How many placements a search for a height, which begins at a place inside the cell, evaluates that a turn about
    /// axis 1 brings to one before.
    fn turned_about_axis_1(problem: &Problem) -> usize {
        let middle = |k: usize| problem.cell.position[k].min + 0.5 * problem.cell.position[k].width();
        let start = Placement { x: middle(0), y: middle(1), z: middle(2), yaw: 2.0 };
        let mut seen: Vec<Placement> = Vec::new();
        let mut turned = 0;
        let evaluate = |placement: &Placement| {
            let is_like = |known: &Placement| {
                known != placement && apart_about_axis_1(problem, known, placement).iter().all(|apart| *apart < SAME)
            };
            turned += usize::from(seen.iter().any(is_like));
            seen.push(*placement);
            Objective::Feasible(1.0 + (placement.z - middle(2) - 0.02).abs())
        };
        let found = coordinate_search(problem, &start, Sense::Min, Directions::All, evaluate, &Monitor::silent());
        assert!((found.0.z - middle(2) - 0.02).abs() < 1e-3, "{found:?}");
        turned
    }

    #[test]
    fn turns_about_axis_1_are_evaluated_where_they_change_something() {
        let problem = five_segments();
        assert_eq!(turned_about_axis_1(&problem), 0);
        let base = BaseCompliance::new(Vector3::new(0.0, 0.0, -0.5), Matrix6::from_diagonal_element(1e-8));
        let mut soft = problem.clone();
        soft.robot = soft.robot.clone().with_base_compliance(base.ok());
        assert!(turned_about_axis_1(&soft) > 2);
    }
}
