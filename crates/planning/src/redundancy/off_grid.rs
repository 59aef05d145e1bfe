//! Beta off the grid: dynamic programming on ever narrower grids around a plan.
//!
//! Each level lays five values of beta around the present plan at every point, finds the best way through them under
//! the same constraints as on the grid (real joint angles, exact limits on beta), and repeats until nothing moves; then
//! the spacing is halved. The plan can only get better, kinks of the absolute value do not matter, and no constraint is
//! ever left.

use super::super::transfer_path::{AtPoint, Space};
use super::joint_turns::{inside_limits, is_allowed};
use super::layered::{Steps, cheapest_before};
use super::{SegmentPlan, Sense};
use rayon::prelude::*;
use stead_model::robot::angles::nearest_turns;
use stead_problem::beta_step::BetaStep;
use stead_problem::constraints::joint_steps_hold;
use stead_problem::evaluate::batch::{BatchEvaluator, PlacedPoint, StateGrid};
use stead_problem::joint_travel::joint_distance;
use stead_problem::problem::{Placement, Problem, Redundancy};

/// Values of beta at each point of a level.
const VALUES: usize = 5;
/// Repetitions of a level at the most. Where a joint is at its speed along a dense path, a plan moves by a small step
/// in each.
const REPEATS: usize = 64;

/// A pass that gains less than this share of the cost ends its level.
pub(super) const MIN_GAIN: f64 = 1e-9;

/// Points that one thread lays at least.
const MIN_SHARE: usize = 500;

/// How far the grid of beta around a plan is narrowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// First spacing of beta. rad
    pub first: f64,
    /// Last spacing of beta. rad
    pub last: f64,
}

impl Spacing {
    /// From half the step of a grid down to a thousandth of a degree.
    pub fn full(grid: &Redundancy) -> Self {
        Self { first: grid.beta_step() / 2.0, last: 1.7e-5 }
    }

    /// Down to a sixtieth of a degree: for a subset of a path, whose mean is off by more than that makes.
    pub fn rough(grid: &Redundancy) -> Self {
        Self { last: 2.9e-4, ..Self::full(grid) }
    }
}

/// One value of beta at one point.
#[derive(Clone, Copy)]
struct Value {
    beta: f64,
    /// What the arm comes to there, none where a constraint on the state forbids it.
    state: Option<Allowed>,
    /// The same with turns inside the limits of the joints.
    node: Option<Node>,
}

/// An allowed state.
#[derive(Clone, Copy)]
struct Allowed {
    /// Joint angles modulo a turn. rad
    joints: [f64; 6],
    /// What it adds to the cost of a plan.
    cost: f64,
}

/// An allowed state with its turns.
#[derive(Clone, Copy)]
struct Node {
    /// Real joint angles. rad
    joints: [f64; 6],
    /// As that of the state.
    cost: f64,
}

/// What is looked at in the states of a path point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Watch {
    /// Whether shapes keep apart.
    pub collisions: bool,
    /// Whether the line along the tool axis, out of the cut or into it, has its whole length.
    pub line: bool,
    /// Whether beta stays as it is.
    pub held: bool,
}

/// Refines the plan of one segment for the workpiece at a placement. Returns whether it got better.
///
/// The plan given need not be one for this placement exactly: with an infinite cost, the betas of `plan` are only where
/// the grid is laid, and the first feasible path through it is taken. Where there is none the plan stays as it is and
/// false is returned. In the states at the points of the plan holds what is `watched` there.
pub fn refine(
    evaluator: &BatchEvaluator<'_>,
    placement: &Placement,
    sense: Sense,
    range: Spacing,
    watched: &[Watch],
    plan: &mut SegmentPlan,
) -> bool {
    let (problem, first) = (evaluator.problem(), plan.points.start);
    let at = plan.points.clone().map(|point| evaluator.placed(point, placement)).collect();
    let grid = Around { evaluator, placement, watched, at };
    let mut better = false;
    let (travel, limits) = (problem.travel_cost(sense), BetaStep::ANY);
    let mut steps = LevelSteps { problem, sense, travel, point: first, limits, joint_steps: [f64::INFINITY; 6] };
    let mut spacing = range.first;
    let unknown = Value { beta: f64::NAN, state: None, node: None };
    let none =
        Layer { values: [unknown; VALUES], is_fresh: false, costs: [f64::INFINITY; VALUES], before: [0; VALUES] };
    let mut layers = vec![none; plan.points.len()];
    while spacing >= range.last {
        layers.iter_mut().for_each(|layer| layer.is_fresh = false);
        for _ in 0..REPEATS {
            grid.lay(spacing, plan, &mut layers);
            if !level(&mut steps, plan, &mut layers) {
                break;
            }
            better = true;
        }
        spacing /= 2.0;
    }
    better
}

/// The values of beta that a level lays at one point.
#[derive(Clone)]
struct Layer {
    values: [Value; VALUES],
    /// Whether they lie around the present plan, with the present spacing.
    is_fresh: bool,
    /// Signed costs of the cheapest ways to the values, and the values before on them.
    costs: [f64; VALUES],
    before: [usize; VALUES],
}

/// The steps between the values of a level.
struct LevelSteps<'s> {
    problem: &'s Problem,
    sense: Sense,
    /// What a radian of joint travel costs.
    travel: f64,
    point: usize,
    limits: BetaStep,
    joint_steps: [f64; 6],
}

impl Steps for LevelSteps<'_> {
    type State = Value;

    /// They are laid before.
    fn states(&mut self, _: usize) -> Vec<Value> {
        Vec::new()
    }

    fn prepare(&mut self, point: usize, _: &[Value]) {
        (self.point, self.limits, self.joint_steps) =
            (point, self.problem.beta_step(point), self.problem.joint_steps(point));
    }

    fn may_lead_to(&self, before: &[Value], _: &Value, mut visit: impl FnMut(usize)) {
        (0..before.len()).for_each(&mut visit);
    }

    fn step(&self, from: &Value, to: &Value) -> Option<f64> {
        let (old, new) = (from.node.as_ref()?, to.node.as_ref()?);
        let is_allowed = self.limits.allows(to.beta - from.beta)
            && joint_steps_hold(&self.problem.robot, &old.joints, &new.joints, &self.joint_steps);
        let travel = || if self.travel > 0.0 { self.travel * joint_distance(&old.joints, &new.joints) } else { 0.0 };
        is_allowed.then(travel)
    }

    fn own(&self, _: usize, value: &Value) -> f64 {
        value.node.map_or(f64::INFINITY, |node| self.sense.sign() * node.cost)
    }

    fn join(&self, way: f64, own: f64) -> f64 {
        self.problem.criterion.aggregate.join_signed(self.sense, way, own)
    }
}

/// The cost and the real joint angles of fixed betas at `placement`, or `None` when they break a constraint there.
pub fn replay(problem: &Problem, placement: &Placement, sense: Sense, plan: &SegmentPlan) -> Option<SegmentPlan> {
    let mut replayed = plan.clone();
    let travel = problem.travel_cost(sense);
    let aggregate = problem.criterion.aggregate;
    replayed.cost = 0.0;
    for (place, point) in plan.points.clone().enumerate() {
        let (joints, score) = allowed(problem, placement, point, plan.betas[place], plan, &plan.joints[place])?;
        replayed.joints[place] = joints;
        replayed.cost = aggregate.join(replayed.cost, problem.point_cost(point, score));
        if place > 0 {
            let steps =
                joint_steps_hold(&problem.robot, &replayed.joints[place - 1], &joints, &problem.joint_steps(point));
            if !problem.beta_step(point).allows(plan.betas[place] - plan.betas[place - 1]) || !steps {
                return None;
            }
            replayed.cost += travel * joint_distance(&replayed.joints[place - 1], &joints);
        }
    }
    Some(replayed)
}

/// The score of a path point at a beta (rad) in the posture of a plan, near given joint angles (rad); `None` where a
/// constraint on the state forbids it. m
pub fn score(
    problem: &Problem,
    placement: &Placement,
    point: usize,
    beta: f64,
    plan: &SegmentPlan,
    near: &[f64; 6],
) -> Option<f64> {
    allowed(problem, placement, point, beta, plan, near).map(|(_, score)| score)
}

/// The joint angles nearest to given ones (rad) and the score (m) of a path point in the posture of a plan, where all
/// constraints on the state hold.
fn allowed(
    problem: &Problem,
    placement: &Placement,
    point: usize,
    beta: f64,
    plan: &SegmentPlan,
    near: &[f64; 6],
) -> Option<([f64; 6], f64)> {
    let state = problem.at(placement).state(point, beta, plan.posture).ok()?;
    let joints = nearest_turns(&state.joints, near);
    (is_allowed(problem, &state) && inside_limits(problem, &joints)).then(|| (joints, state.score()))
}

/// A state with the turns nearest to given joint angles (rad), if they are inside the limits.
fn turned(problem: &Problem, state: &Allowed, near: &[f64; 6]) -> Option<Node> {
    let joints = nearest_turns(&state.joints, near);
    inside_limits(problem, &joints).then_some(Node { joints, cost: state.cost })
}

/// Where values of beta are laid around a plan.
struct Around<'a> {
    evaluator: &'a BatchEvaluator<'a>,
    placement: &'a Placement,
    /// By the places of the plan, as what follows.
    watched: &'a [Watch],
    at: Vec<PlacedPoint>,
}

impl Around<'_> {
    /// Lays values of beta around the plan, where that moved since.
    fn lay(&self, spacing: f64, plan: &SegmentPlan, layers: &mut [Layer]) {
        let fresh = |states: &mut StateGrid, (place, layer): (usize, &mut Layer)| {
            if !layer.is_fresh {
                layer.is_fresh = true;
                layer.values = self.values(place, spacing, plan, &layer.values, states);
            }
        };
        layers.par_iter_mut().enumerate().with_min_len(MIN_SHARE).for_each_init(BatchEvaluator::states_at, fresh);
    }

    /// The values at a place, of which some are known.
    fn values(
        &self,
        place: usize,
        spacing: f64,
        plan: &SegmentPlan,
        known: &[Value; VALUES],
        states: &mut StateGrid,
    ) -> [Value; VALUES] {
        let (middle, joints) = (VALUES / 2, &plan.joints[place]);
        let betas: [f64; VALUES] = std::array::from_fn(|k| plan.betas[place] + (k as f64 - middle as f64) * spacing);
        // Every second value was met before, at the latest spacing.
        let met = betas.map(|beta: f64| known.iter().find(|value| value.beta == beta));
        let (mut open, mut count) = ([0.0; VALUES], 0);
        for (beta, _) in betas.iter().zip(&met).filter(|(_, met)| met.is_none()) {
            open[count] = *beta;
            count += 1;
        }
        let found = self.evaluator.evaluate_at(&self.at[place], plan.posture, &open[..count], states);
        let mut next = 0..count;
        std::array::from_fn(|k| {
            let beta = betas[k];
            let state = match met[k] {
                Some(value) => value.state,
                None => next.next().and_then(&found).map(|(cost, joints)| Allowed { joints, cost }),
            };
            let state = state.filter(|state| met[k].is_some() || self.is_free(place, beta, state, plan));
            let own = met[k].and_then(|value| value.node).filter(|node| k == middle && node.joints == *joints);
            let turned = |state: &Allowed| turned(self.evaluator.problem(), state, joints);
            Value { beta, state, node: own.or_else(|| state.as_ref().and_then(turned)) }
        })
    }

    /// Whether what is watched at a place holds in a state.
    fn is_free(&self, place: usize, beta: f64, state: &Allowed, plan: &SegmentPlan) -> bool {
        let (problem, placement) = (self.evaluator.problem(), self.placement);
        let Watch { collisions, line, held } = self.watched[place];
        let (point, posture) = (plan.points.start + place, plan.posture);
        let is_whole = || {
            // In the turns of the plan.
            let joints = nearest_turns(&state.joints, &plan.joints[place]);
            let at = AtPoint { point, beta, posture, joints };
            Space::new(problem, placement).line_end(at, problem.segment_moves.retract).is_none()
        };
        (!held || beta == plan.betas[place])
            && (!collisions || problem.state_hit(point, placement, &state.joints).is_none())
            && (!line || is_whole())
    }
}

/// One pass over what was laid; whether the plan got better by more than rounding.
fn level(steps: &mut LevelSteps<'_>, plan: &mut SegmentPlan, layers: &mut [Layer]) -> bool {
    let sign = steps.sense.sign();
    for (place, point) in plan.points.clone().enumerate() {
        let (done, open) = layers.split_at_mut(place);
        let (before, layer) = (done.last(), &mut open[0]);
        if let Some(before) = before {
            steps.prepare(point, &before.values);
        }
        for (k, value) in layer.values.iter().enumerate().filter(|(_, value)| value.node.is_some()) {
            let own = steps.own(point, value);
            let way = before.map(|before| cheapest_before(steps, &before.values, &before.costs, value));
            (layer.costs[k], layer.before[k]) = match way {
                None => (own, 0),
                Some(None) => (f64::INFINITY, 0),
                Some(Some((way, from))) => (steps.join(way, own), from),
            };
        }
    }
    let end = layers.last().and_then(|layer| {
        let ends = (0..VALUES).filter(|k| layer.values[*k].node.is_some() && layer.costs[*k].is_finite());
        ends.map(|k| (layer.costs[k], k)).min_by(|a, b| a.0.total_cmp(&b.0))
    });
    let Some((cost, mut index)) = end else { return false };
    if plan.cost.is_finite() && cost >= plan.cost * sign - MIN_GAIN * plan.cost.abs() {
        return false;
    }
    for (place, layer) in layers.iter_mut().enumerate().rev() {
        let Value { beta, node: Some(node), .. } = layer.values[index] else { return false };
        layer.is_fresh = plan.betas[place] == beta && plan.joints[place] == node.joints;
        plan.betas[place] = beta;
        plan.joints[place] = node.joints;
        index = layer.before[index];
    }
    plan.cost = cost * sign;
    true
}
