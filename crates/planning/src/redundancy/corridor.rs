//! The best path near one that asks too much of a joint between its points: dynamic programming on a narrow grid of
//! beta around it.
//!
//! Plans from knot to knot ([`super::knots`]) hold the steps of the joints over runs of points. Where tool or feed
//! turn, a joint at its speed may not follow in between, though a path nearby can be followed. The grid of the plan has
//! no steps small enough to find it from point to point; a corridor around the plan needs no more values with steps as
//! small as the joints ask for.

use super::joint_turns::{inside_limits, is_allowed};
use super::layered::{Steps, cheapest_path};
use super::{SegmentPlanner, StateSet};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::Range as Span;
use stead_model::robot::{
    Posture,
    angles::{nearest_turns, wrap},
};
use stead_problem::beta_step::BetaStep;
use stead_problem::constraints::STEP_ROUNDING;
use stead_problem::evaluate::point_evaluator::PointEvaluator;
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// Steps of the corridor that the joints allow from point to point, on average along the path.
const STEPS_PER_POINT: f64 = 8.0;
/// No step is wider than this part of one of the grid.
const WIDEST: f64 = 0.5;
/// How far a corridor reaches on either side, as long as it has not more values than [`MOST`]; and one where no path
/// goes through that. rad
const REACH: f64 = 6.0 * PI / 180.0;
const WIDE_REACH: f64 = 45.0 * PI / 180.0;
/// Values on either side, at least and at most.
const LEAST: usize = 16;
const MOST: usize = 96;
/// The same of a wide corridor, if that makes no more states along the path than this.
const MOST_WIDE: usize = 180;
const MOST_STATES: usize = 200_000;
/// Narrow corridors laid one after the other, each around the path of the one before, and the share of the cost that
/// another has to gain.
const REPEATS: usize = 6;
const GAIN: f64 = 1e-4;
/// Points that one thread lays at least.
const MIN_SHARE: usize = 200;

/// An allowed state of the corridor.
#[derive(Clone, Copy)]
struct State {
    beta: f64,
    /// Modulo a turn. rad
    joints: [f64; 6],
    /// What its point adds, times the sign of the sense.
    own: f64,
}

/// The values of beta that a corridor has at a point.
#[derive(Clone, Copy)]
struct Values {
    /// In the middle. rad
    middle: f64,
    spacing: f64,
    /// How many on either side.
    half: usize,
}

/// Paths of one segment with a corridor around them.
pub(super) struct Corridor<'s> {
    pub span: &'s Span<usize>,
    pub placement: &'s Placement,
    pub sense: Sense,
    pub posture: Posture,
    /// States that hit.
    pub forbidden: &'s StateSet,
}

impl SegmentPlanner<'_> {
    /// The best path of beta (rad) within a corridor around another, with joint angles modulo a turn; `None` where none
    /// goes through.
    pub(super) fn within_corridor(&self, corridor: &Corridor<'_>, around: &[f64]) -> Option<Vec<f64>> {
        let span = corridor.span;
        let evaluator = |point: usize| self.problem.at(corridor.placement).evaluator(point);
        let at: Vec<PointEvaluator<'_>> = span.clone().map(evaluator).collect();
        let spacing = self.corridor_spacing(span);
        let half = ((REACH / spacing).ceil() as usize).clamp(LEAST, MOST);
        let narrow = Values { middle: 0.0, spacing, half };
        let half = (MOST_STATES / (2 * span.len())).clamp(narrow.half, MOST_WIDE);
        let wide = Values { middle: 0.0, spacing: spacing.max(WIDE_REACH / half as f64), half };
        let through = |path: &[f64], values: Values| {
            let lay = |(place, beta): (usize, &f64)| {
                self.lay(&at[place], span.start + place, Values { middle: *beta, ..values }, corridor)
            };
            let layers = path.par_iter().enumerate().with_min_len(MIN_SHARE).map(lay).collect();
            let mut steps = CorridorSteps::new(self, span, corridor.sense, layers);
            let (cost, states) = cheapest_path(&mut steps, span.len(), 2 * values.half + 1)?;
            Some((cost, states.iter().map(|state| state.beta).collect::<Vec<f64>>()))
        };
        let mut path = self.unwrapped(span, around);
        let first = through(&path, narrow);
        let is_far = first.is_none();
        let (mut cost, found) = first.or_else(|| through(&path, wide))?;
        path = found;
        // Where the path is far from the one given, a way round may be better still.
        let laid = std::iter::repeat_n(narrow, REPEATS).chain(is_far.then_some(wide));
        let mut gained = true;
        for laid in laid.chain(std::iter::repeat_n(narrow, REPEATS)) {
            if !gained && laid.half == narrow.half {
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
            self.steps[point].iter().copied().fold(step.half.clamp(0.0, PI), f64::min)
        };
        let steps = span.len().saturating_sub(1).max(1) as f64;
        let mean = span.clone().skip(1).map(room).sum::<f64>() / steps;
        (mean / STEPS_PER_POINT).clamp(REACH / MOST as f64 / 8.0, WIDEST * self.grid.beta_step())
    }

    /// The allowed states of a point at some values of beta.
    fn lay(&self, at: &PointEvaluator<'_>, point: usize, values: Values, corridor: &Corridor<'_>) -> Vec<State> {
        let Corridor { sense, posture, forbidden, .. } = *corridor;
        let (count, unit) = (self.grid.beta_count as i64, self.grid.beta_step());
        // A value beside a state of the grid that is not allowed is not allowed.
        let is_forbidden = |beta: f64| {
            let below = ((beta + PI) / unit).floor() as i64;
            [below, below + 1].iter().any(|k| forbidden.contains(point, posture.class(), k.rem_euclid(count) as usize))
        };
        let middle_joints = self.problem.robot.mid_range();
        let state = |k: i32| {
            let beta = values.middle + f64::from(k) * values.spacing;
            let state = at.state(beta, posture).ok()?;
            let is_inside = is_allowed(self.problem, &state)
                && inside_limits(self.problem, &nearest_turns(&state.joints, &middle_joints))
                && (forbidden.is_empty() || !is_forbidden(beta));
            let own = sense.sign() * self.problem.point_cost(point, state.score());
            is_inside.then_some(State { beta, joints: state.joints, own })
        };
        let half = values.half as i32;
        (-half..=half).filter_map(state).collect()
    }
}

/// The steps of a corridor along a segment.
struct CorridorSteps<'s> {
    planner: &'s SegmentPlanner<'s>,
    span: &'s Span<usize>,
    sense: Sense,
    layers: Vec<Vec<State>>,
    /// To the present point.
    limits: BetaStep,
    joint_steps: [f64; 6],
    /// The middle of the changes of beta that limits and joints together allow, and how far from it they go at the
    /// most. rad
    middle: f64,
    most: f64,
}

impl<'s> CorridorSteps<'s> {
    fn new(planner: &'s SegmentPlanner<'s>, span: &'s Span<usize>, sense: Sense, layers: Vec<Vec<State>>) -> Self {
        Self {
            planner,
            span,
            sense,
            layers,
            limits: BetaStep::ANY,
            joint_steps: [f64::INFINITY; 6],
            middle: 0.0,
            most: 0.0,
        }
    }
}

impl Steps for CorridorSteps<'_> {
    type State = State;

    fn states(&mut self, place: usize) -> Vec<State> {
        self.layers[place].clone()
    }

    fn prepare(&mut self, place: usize, _: &[State]) {
        let (planner, point) = (self.planner, self.span.start + place);
        self.limits = planner.problem.beta_step_within(point, &planner.grid);
        self.joint_steps = planner.steps[point].map(|limit| limit + STEP_ROUNDING);
        (self.middle, self.most) = planner.knots.change_at(point);
    }

    fn may_lead_to(&self, before: &[State], state: &State, mut visit: impl FnMut(usize)) {
        let (middle, most) = (state.beta - self.middle, self.most + STEP_ROUNDING);
        let [first, last] = [middle - most, middle + most].map(|end| before.partition_point(|old| old.beta < end));
        (first..last).for_each(&mut visit);
    }

    fn step(&self, from: &State, to: &State) -> Option<f64> {
        let mut turned: [f64; 6] = std::array::from_fn(|j| wrap(to.joints[j] - from.joints[j]));
        turned = self.planner.problem.robot.drives(&turned);
        let is_near = |j: usize| turned[j].abs() <= self.joint_steps[j];
        (self.limits.allows(to.beta - from.beta) && (0..6).all(is_near)).then_some(0.0)
    }

    fn own(&self, _: usize, state: &State) -> f64 {
        state.own
    }

    fn join(&self, way: f64, own: f64) -> f64 {
        self.planner.problem.criterion.aggregate.join_signed(self.sense, way, own)
    }
}
