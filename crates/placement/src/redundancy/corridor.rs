//! The best path near one that asks too much of a joint between its points: dynamic programming on a narrow grid of beta around it.
//!
//! Plans from knot to knot ([`super::knots`]) hold the steps of the joints over runs of points. Where tool or feed turn, a joint at its
//! speed may not follow in between, though a path nearby can be followed. The grid of the plan has no steps small enough to find it from point
//! to point; a corridor around the plan needs no more values with steps as small as the joints ask for.

use super::super::evaluate::point_evaluator::PointEvaluator;
use super::joint_turns::{inside_limits, is_allowed};
use super::{Planner, StateSet};
use crate::constraints::STEP_ROUNDING;
use crate::problem::Placement;
use crate::sense::Sense;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range as Span;
use stead_model::robot::{
    Posture,
    angles::{nearest_turns, wrap},
};

/// Steps of the corridor that the joints allow from point to point, on average along the path.
const STEPS_PER_POINT: f64 = 4.0;
/// No step is wider than this part of one of the grid.
const WIDEST: f64 = 0.5;
/// How far a corridor reaches on either side, as long as it has not more values than [`MOST`]; and one where no path goes through that. rad
const REACH: f64 = 6.0 * PI / 180.0;
const WIDE_REACH: f64 = 45.0 * PI / 180.0;
/// Values on either side, at least and at most.
const LEAST: usize = 16;
const MOST: usize = 48;
/// The same of a wide corridor, if that makes no more states along the path than this.
const MOST_WIDE: usize = 180;
const MOST_STATES: usize = 200_000;
/// Narrow corridors laid one after the other, each around the path of the one before, and the share of the cost that another has to gain.
const REPEATS: usize = 6;
const GAIN: f64 = 1e-4;
/// Points that one thread lays at least.
const MIN_SHARE: usize = 200;

/// An allowed state of the corridor.
#[derive(Clone, Copy)]
struct Node {
    beta: f64,
    /// Modulo a turn. rad
    joints: [f64; 6],
    /// What its point adds, times the sign of the sense.
    own: f64,
    /// The signed cost of the best way to it, and its predecessor.
    cost: f64,
    from: usize,
}

impl Planner<'_> {
    /// The best path of beta (rad) within a corridor around another, with joint angles modulo a turn; `None` where none goes through.
    pub(super) fn within_corridor(
        &self,
        span: &Span<usize>,
        (placement, sense, posture): (&Placement, Sense, Posture),
        around: &[f64],
        forbidden: &StateSet,
    ) -> Option<Vec<f64>> {
        let at: Vec<PointEvaluator<'_>> =
            span.clone().map(|point| PointEvaluator::new(self.problem, point, placement)).collect();
        let spacing = self.corridor_spacing(span);
        let narrow = ((REACH / spacing).ceil() as usize).clamp(LEAST, MOST);
        let most = (MOST_STATES / (2 * span.len())).clamp(narrow, MOST_WIDE);
        let wide = (spacing.max(WIDE_REACH / most as f64), most);
        let through = |path: &[f64], (spacing, half): (f64, usize)| {
            let lay = |(place, beta): (usize, &f64)| {
                let laid = (*beta, spacing, half as i32);
                self.lay(&at[place], span.start + place, laid, (posture, sense, forbidden))
            };
            let mut layers: Vec<Vec<Node>> = path.par_iter().enumerate().with_min_len(MIN_SHARE).map(lay).collect();
            self.best_through(span, sense, &mut layers)
        };
        let mut path = self.unwrapped(span, around);
        let first = through(&path, (spacing, narrow));
        let is_far = first.is_none();
        let (mut cost, found) = first.or_else(|| through(&path, wide))?;
        path = found;
        // Where the path is far from the one given, a way round may be better still.
        let laid = std::iter::repeat_n((spacing, narrow), REPEATS).chain(is_far.then_some(wide));
        let mut gained = true;
        for laid in laid.chain(std::iter::repeat_n((spacing, narrow), REPEATS)) {
            if !gained && laid.1 == narrow {
                continue;
            }
            let next = through(&path, laid).filter(|next| next.0 < cost);
            gained = next.as_ref().is_some_and(|next| cost - next.0 > GAIN * cost.abs());
            if let Some(next) = next {
                (cost, path) = next;
            }
        }
        Some(path)
    }

    /// A path of beta without leaps of whole turns. rad
    fn unwrapped(&self, span: &Span<usize>, path: &[f64]) -> Vec<f64> {
        let mut path = path.to_vec();
        for place in 1..path.len() {
            let (middle, _) = self.knots.change_at(span.start + place);
            path[place] = path[place - 1] + middle + wrap(path[place] - path[place - 1] - middle);
        }
        path
    }

    /// The step of a corridor along a segment, from how far beta can go where the joints follow it one to one. rad
    fn corridor_spacing(&self, span: &Span<usize>) -> f64 {
        let room = |point: usize| {
            let step = self.problem.beta_step_within(point, &self.grid);
            self.steps[point].iter().copied().fold(step.half.max(0.0).min(PI), f64::min)
        };
        let steps = span.len().saturating_sub(1).max(1) as f64;
        let mean = span.clone().skip(1).map(room).sum::<f64>() / steps;
        (mean / STEPS_PER_POINT).clamp(REACH / MOST as f64 / 8.0, WIDEST * self.grid.beta_step())
    }

    /// The allowed states of a point around a value of beta.
    fn lay(
        &self,
        at: &PointEvaluator<'_>,
        point: usize,
        (middle, spacing, half): (f64, f64, i32),
        (posture, sense, forbidden): (Posture, Sense, &StateSet),
    ) -> Vec<Node> {
        let (count, unit) = (self.grid.beta_count as i64, self.grid.beta_step());
        // A value beside a state of the grid that is not allowed is not allowed.
        let is_forbidden = |beta: f64| {
            let below = ((beta + PI) / unit).floor() as i64;
            [below, below + 1].iter().any(|k| forbidden.contains(point, posture.class(), k.rem_euclid(count) as usize))
        };
        let middle_joints = self.problem.robot.mid_range();
        let node = |k: i32| {
            let beta = middle + f64::from(k) * spacing;
            let state = at.state(beta, posture).ok()?;
            let is_inside = is_allowed(self.problem, &state)
                && inside_limits(self.problem, &nearest_turns(&state.joints, &middle_joints))
                && (forbidden.is_empty() || !is_forbidden(beta));
            let own = sense.sign() * self.problem.point_cost(point, state.score());
            is_inside.then_some(Node { beta, joints: state.joints, own, cost: f64::INFINITY, from: 0 })
        };
        (-half..=half).filter_map(node).collect()
    }

    /// The best way through the states laid: its signed cost and its betas.
    fn best_through(&self, span: &Span<usize>, sense: Sense, layers: &mut [Vec<Node>]) -> Option<(f64, Vec<f64>)> {
        let aggregate = self.problem.criterion.aggregate;
        layers.first_mut()?.iter_mut().for_each(|node| node.cost = node.own);
        for place in 1..layers.len() {
            let (done, open) = layers.split_at_mut(place);
            let (before, now) = (&done[place - 1], &mut open[0]);
            let point = span.start + place;
            let (step, limits) = (self.problem.beta_step_within(point, &self.grid), &self.steps[point]);
            let (middle, most) = self.knots.change_at(point);
            for node in now {
                let ends = [node.beta - middle - most - STEP_ROUNDING, node.beta - middle + most + STEP_ROUNDING];
                let [first, last] = ends.map(|end| before.partition_point(|old| old.beta < end));
                for (index, old) in before.iter().enumerate().take(last).skip(first) {
                    // Joined costs only grow with what they are joined of.
                    let cost = aggregate.join_signed(sense, old.cost, node.own);
                    if old.cost.is_finite()
                        && cost < node.cost
                        && step.allows(node.beta - old.beta)
                        && (0..6).all(|j| wrap(node.joints[j] - old.joints[j]).abs() <= limits[j] + STEP_ROUNDING)
                    {
                        (node.cost, node.from) = (cost, index);
                    }
                }
            }
        }
        let ends = layers.last()?.iter().enumerate().filter(|(_, node)| node.cost.is_finite());
        let (mut index, end) = ends.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost))?;
        let cost = end.cost;
        let mut betas = vec![0.0; layers.len()];
        for (layer, beta) in layers.iter().zip(&mut betas).rev() {
            let node = &layer[index];
            (*beta, index) = (node.beta, node.from);
        }
        Some((cost, betas))
    }
}
