//! States of a path point at any values of beta.

use super::{BatchEvaluator, PointGeometry, StateGrid};
use crate::problem::Placement;
use std::f64::consts::PI;
use stead_model::robot::{Posture, PostureClass};
use stead_numerics::simd::MAX_LANES;

/// A path point with the workpiece at a placement: what its states have in common.
#[derive(Debug, Clone)]
pub struct PlacedPoint {
    pub(super) geometry: PointGeometry,
    /// Whether it is nearer to axis 1 than allowed.
    pub(super) is_near: bool,
    /// Whether there is one set of compliances, and its score covers no errors.
    pub(super) is_plain: bool,
}

/// Values of beta that are evaluated at once, at the most.
pub const MOST_BETAS: usize = MAX_LANES;

impl BatchEvaluator<'_> {
    /// A path point with the workpiece at a placement.
    pub fn placed(&self, point: usize, placement: &Placement) -> PlacedPoint {
        let geometry = self.point_geometry(point, placement);
        let min_distance = self.problem.constraints.min_base_distance;
        let is_near = min_distance > 0.0 && libm::hypot(geometry.tip.x, geometry.tip.y) < min_distance;
        PlacedPoint { geometry, is_near, is_plain: self.is_plain(point) }
    }

    /// Space for the states of [`BatchEvaluator::evaluate_at`].
    pub fn states_at() -> StateGrid {
        StateGrid::new(MOST_BETAS, 0).with_angles(true)
    }

    /// Evaluates a point at values of beta (rad), at most `MOST_BETAS`, in a posture that is one of
    /// [`BatchEvaluator::flips`], as [`BatchEvaluator::evaluate`] does on the grid; returns for each what the state
    /// adds to the cost of a plan, with its joint angles (rad, modulo a turn), none where it is not allowed. Limits of
    /// the joints hold for one of the two postures of its class.
    pub fn evaluate_at<'s>(
        &self,
        placed: &PlacedPoint,
        posture: Posture,
        betas: &[f64],
        states: &'s mut StateGrid,
    ) -> impl Fn(usize) -> Option<(f64, [f64; 6])> + use<'s> {
        let (mut sine, mut cosine) = ([0.0; MOST_BETAS], [1.0; MOST_BETAS]);
        for (k, beta) in betas.iter().enumerate().take(MOST_BETAS) {
            (sine[k], cosine[k]) = libm::sincos(*beta);
        }
        let class = posture.class();
        let classes = PostureClass::ALL.map(|other| other == class);
        self.run(placed, classes, [&sine, &cosine], 0..betas.len(), states);
        let states = &*states;
        move |k| {
            let (cost, mut joints) = states.state(class, k)?;
            if posture.is_flipped() {
                // Joint 5 is bent to the other side, and joints 4 and 6 point the other way.
                joints = [joints[0], joints[1], joints[2], joints[3] + PI, -joints[4], joints[5] + PI];
            }
            Some((cost, joints))
        }
    }
}
