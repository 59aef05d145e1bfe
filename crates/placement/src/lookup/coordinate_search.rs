//! Coordinate search on the lookup table: from a candidate to the bottom (or top) of its basin, one direction at a time.
//!
//! The directions are those in which an upright tool's problem has its variables: away from axis 1, up, and the yaw against
//! the azimuth, which is kept while the others change. Each has a step of its own that grows with success and shrinks without.

use super::{BetaGrid, LookupTable, Workspace};
use crate::candidate::Objective;
use crate::candidate::rank;
use crate::problem::Placement;
use crate::sense::Sense;
use nalgebra::Vector2;
use std::cmp::Ordering;
use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;

/// First steps: radius (m), height (m), yaw (rad).
const FIRST: [f64; 3] = [0.03, 0.03, 0.06];
/// The search ends when every step is below this share of the first.
const LAST: f64 = 0.01;
/// A step that brings nothing is divided by this.
const SHRINK: f64 = 3.0;
/// A step that brings something is multiplied by this.
const GROWTH: f64 = 1.7;
/// Placements evaluated, at most.
const MAX_EVALUATIONS: usize = 150;

impl LookupTable<'_> {
    /// The best placement (in the given sense) that steps from `start` (x, y, z in m, yaw in rad) lead to, its
    /// objective by the table, and the number of placements evaluated; never worse than the start. A stop ends it.
    pub fn coordinate_search(
        &self,
        start: &Placement,
        sense: Sense,
        scheme: Option<&[Posture]>,
        grid: &BetaGrid,
        workspace: &mut Workspace,
        monitor: &Monitor,
    ) -> (Placement, Objective, usize) {
        let mut best = *start;
        let mut objective = self.objective(start, grid, scheme, workspace);
        let mut evaluations = 1;
        let mut steps = FIRST;
        let may_go_on = |evaluations: usize| evaluations < MAX_EVALUATIONS && !monitor.should_stop();
        while may_go_on(evaluations) && (0..3).any(|k| steps[k].abs() > LAST * FIRST[k]) {
            for k in 0..3 {
                let found = [1.0, -1.0].into_iter().any(|side| {
                    let placement = self.moved(&best, k, side * steps[k]);
                    if placement == best {
                        return false;
                    }
                    evaluations += 1;
                    let there = self.objective(&placement, grid, scheme, workspace);
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

    /// A placement moved along one direction, inside the cell.
    fn moved(&self, placement: &Placement, direction: usize, step: f64) -> Placement {
        let root = self.problem.robot.geometry().root_in_base;
        let Placement { mut x, mut y, mut z, mut yaw } = *placement;
        match direction {
            0 => {
                let away = Vector2::new(x - root.x, y - root.y);
                let away = if away.norm() > 0.0 { away.normalize() } else { Vector2::x() };
                x += away.x * step;
                y += away.y * step;
            }
            1 => z += step,
            _ => yaw += step,
        }
        let cell = &self.problem.cell;
        let inside = cell.clamp(&Placement { x, y, z, yaw });
        // The yaw follows the azimuth.
        let azimuth = |x: f64, y: f64| libm::atan2(y - root.y, x - root.x);
        let turned = azimuth(inside.x, inside.y) - azimuth(placement.x, placement.y);
        cell.clamp(&Placement { yaw: inside.yaw + turned, ..inside })
    }
}
