//! Following a path of beta that asks too much of a joint between some of its points.

use super::SegmentPlanner;
use super::joint_turns::is_allowed;
use std::ops::Range as Span;
use stead_model::robot::{Posture, angles::wrap};
use stead_problem::constraints::STEP_ROUNDING;
use stead_problem::evaluate::reference::State;
use stead_problem::problem::Placement;

/// Halvings of the way between a beta that can be reached and one that cannot.
const HALVINGS: usize = 10;

impl SegmentPlanner<'_> {
    /// The path that comes at each point as near to the one given as the steps of joints and beta allow from the point
    /// before, with joint angles modulo a turn; `None` where it cannot go on. rad
    pub(super) fn followed(
        &self,
        span: &Span<usize>,
        placement: &Placement,
        posture: Posture,
        wanted: &[f64],
    ) -> Option<Vec<f64>> {
        let state = |point: usize, beta: f64| {
            let state = self.problem.at(placement).state(point, beta, posture).ok()?;
            is_allowed(self.problem, &state).then_some(state)
        };
        let mut beta = wanted[0];
        let mut last: State<f64> = state(span.start, beta)?;
        let mut betas = vec![beta];
        for (point, wanted) in span.clone().zip(wanted).skip(1) {
            let limits = &self.steps[point];
            let step = self.problem.beta_step_within(point, &self.grid);
            let goal =
                beta + step.middle + step.off_middle(wanted - beta).clamp(-step.half.max(0.0), step.half.max(0.0));
            let reached = |beta: f64| {
                let state = state(point, beta)?;
                let is_near = |j: usize| wrap(state.joints[j] - last.joints[j]).abs() <= limits[j] + STEP_ROUNDING;
                (0..6).all(is_near).then_some((beta, state))
            };
            let near = reached(goal).or_else(|| {
                let still = self.problem.still_change(point);
                let still = step.middle + step.off_middle(still).clamp(-step.half.max(0.0), step.half.max(0.0));
                let mut best = [still, step.middle, (still + step.middle) / 2.0]
                    .iter()
                    .find_map(|change| reached(beta + change))?;
                let mut far = goal;
                for _ in 0..HALVINGS {
                    let half = (best.0 + far) / 2.0;
                    match reached(half) {
                        Some(nearer) => best = nearer,
                        None => far = half,
                    }
                }
                Some(best)
            });
            (beta, last) = near?;
            betas.push(beta);
        }
        Some(betas)
    }
}
