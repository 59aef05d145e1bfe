//! From a candidate of the search to the bottom (or top) of its basin, on the table: steps along one direction at a time.
//!
//! The directions are those in which an upright tool's problem has its variables: away from axis 1, up, and the yaw against
//! the azimuth, which is kept while the others change. Each has a step of its own that grows with success and shrinks without.

use super::{BetaGrid, LookupTable, Workspace};
use crate::problem::Placement;
use crate::redundancy::Objective;
use crate::search::rank;
use crate::sense::Sense;
use nalgebra::Vector2;
use std::cmp::Ordering;
use stead_model::robot::Posture;

/// First steps: radius (m), height (m), yaw (rad).
const FIRST: [f64; 3] = [0.03, 0.03, 0.06];
/// The polishing ends when every step is below this share of the first.
const LAST: f64 = 0.01;
/// A step that brings nothing is divided by this.
const SHRINK: f64 = 3.0;
/// A step that brings something is multiplied by this.
const GROWTH: f64 = 1.7;
/// Placements looked at, at the most.
const MAX_EVALUATIONS: usize = 150;

impl LookupTable<'_> {
    /// The best placement (in the sense of the sense) that steps from `start` (x, y, z in m, yaw in rad) lead to, what it is
    /// worth by the table, and the number of placements looked at; never worse than the start.
    pub fn coordinate_search(
        &self,
        start: &[f64; 4],
        sense: Sense,
        scheme: Option<&[Posture]>,
        grid: &BetaGrid,
        workspace: &mut Workspace,
    ) -> ([f64; 4], Objective, usize) {
        let mut best = *start;
        let mut worth = self.objective(start, grid, scheme, workspace);
        let mut evaluations = 1;
        let mut steps = FIRST;
        while evaluations < MAX_EVALUATIONS && (0..3).any(|k| steps[k].abs() > LAST * FIRST[k]) {
            for k in 0..3 {
                let found = [1.0, -1.0].into_iter().any(|side| {
                    let pose = self.moved(&best, k, side * steps[k]);
                    if pose == best {
                        return false;
                    }
                    evaluations += 1;
                    let there = self.objective(&pose, grid, scheme, workspace);
                    let better = rank(sense, there, worth) == Ordering::Less;
                    if better {
                        (best, worth) = (pose, there);
                        // The next step goes the same way first.
                        steps[k] *= side;
                    }
                    better
                });
                steps[k] = if found { steps[k] * GROWTH } else { steps[k] / SHRINK };
            }
        }
        (best, worth, evaluations)
    }

    /// What an upright tool's problem knows of a pose: radius and height of the workpiece origin (m), and the yaw against its
    /// azimuth (rad).
    pub fn cylindrical(&self, pose: &[f64; 4]) -> [f64; 3] {
        let root = self.problem.robot.geometry().root_in_base;
        let (x, y) = (pose[0] - root.x, pose[1] - root.y);
        [libm::hypot(x, y), pose[2], pose[3] - libm::atan2(y, x)]
    }

    /// A pose moved along one direction, inside the cell.
    fn moved(&self, pose: &[f64; 4], direction: usize, step: f64) -> [f64; 4] {
        let root = self.problem.robot.geometry().root_in_base;
        let [mut x, mut y, mut z, mut yaw] = *pose;
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
        let turned = azimuth(inside.x, inside.y) - azimuth(pose[0], pose[1]);
        let inside = cell.clamp(&Placement { yaw: inside.yaw + turned, ..inside });
        [inside.x, inside.y, inside.z, inside.yaw]
    }
}
