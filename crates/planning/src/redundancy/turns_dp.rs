//! Dynamic programming over beta, the flip and the turns of the joints: where these decide.
//!
//! [`super::transition`] takes joint angles modulo a turn. Where the path that it finds winds a joint beyond its
//! limits, as rounds of a contour do, states are distinguished by their flip and their turns too. A joint steps by less
//! than half a turn, so that the turns after a step follow from those before it: a step is checked once, for all flips
//! and turns together.
//!
//! The search goes from the end of a segment to its start. What the way to a state costs without regard to flips and
//! turns is known from [`super::forward_pass`], and is the least that it can cost; where that and what follows are
//! above a bound together, the state is left out. The bound is first a little above the cost of the whole segment
//! without regard to flips and turns, and is raised until a path is found: no other is cheaper. Where these costs are
//! not kept, as of long segments, there is no bound.
//!
//! [`super::reference_dp`] does the same node by node, and is the judge of this in the tests.

use super::forward_pass::Pass;
use super::knots::{Knot, Place};
use super::layered::{Stages, cheapest};
use super::{SegmentPlanner, Workspace};
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use stead_model::robot::angles::ANGLE_ROUNDING;
use stead_model::robot::{PostureClass, Robot, turns};
use stead_problem::constraints::STEP_ROUNDING;
use stead_problem::evaluate::batch::{KernelNumber, StateGrid};

/// Nodes whose predecessors are kept at the most; longer segments are gone through in blocks.
const MAX_NODES: usize = 1 << 22;

/// The turns that the joints of an arm may stand at, numbered in the order of joint 1 to 6, for either flip.
#[derive(Debug, Clone)]
struct Numbering {
    ranges: [turns::Range; 6],
    /// The turn before the lowest of each joint, and how many there are from that to the one after the highest: a joint
    /// that advances by a turn from a state that is allowed keeps to its own numbers.
    lowest: [i32; 6],
    counts: [i32; 6],
}

impl Numbering {
    fn new(robot: &Robot) -> Self {
        let ranges: [turns::Range; 6] = std::array::from_fn(|j| turns::Range::of(&robot.joints()[j]));
        // Real angles are counted from those of the flip with theta_5 not negative, half a turn off in joints 4 and 6.
        let lowest = ranges.map(|range| ((range.min - ANGLE_ROUNDING - TAU) / TAU).ceil() as i32 - 1);
        let highest = ranges.map(|range| ((range.max + ANGLE_ROUNDING + PI) / TAU).floor() as i32 + 1);
        Self { ranges, lowest, counts: std::array::from_fn(|j| (highest[j] - lowest[j] + 1).max(1)) }
    }

    /// The most flips and turns that one state can have.
    fn most(&self) -> usize {
        let of = |range: &turns::Range| ((range.max - range.min + 2.0 * ANGLE_ROUNDING) / TAU) as usize + 1;
        2 * self.ranges.iter().map(of).product::<usize>()
    }

    /// The numbers of the flips and turns in which joint angles (rad, theta_5 not negative) are inside the limits,
    /// ascending.
    fn allowed(&self, angles: &[f64; 6], flips: [bool; 2], numbers: &mut Vec<u32>) {
        for flip in [0, 1].into_iter().filter(|flip| flips[*flip]) {
            let half_turn = PI * flip as f64;
            let [q1, q2, q3, q4, q5, q6] = *angles;
            let real = [q1, q2, q3, q4 + half_turn, if flip == 1 { -q5 } else { q5 }, q6 + half_turn];
            let first = numbers.len();
            numbers.push(flip as u32);
            let mut start = first;
            for j in 0..6 {
                let range = &self.ranges[j];
                let lowest = ((range.min - ANGLE_ROUNDING - real[j]) / TAU).ceil();
                let more = ((range.max + ANGLE_ROUNDING - real[j]) / TAU).floor() - lowest;
                let end = numbers.len();
                for known in start..end {
                    let number = numbers[known] * self.counts[j] as u32;
                    let turn = lowest as i32 - self.lowest[j];
                    (0..=more as i32).filter(|_| more >= 0.0).for_each(|k| numbers.push(number + (turn + k) as u32));
                }
                start = end;
            }
            numbers.drain(first..start);
        }
    }

    /// By how much the number rises where each joint advances by so many turns, at most one.
    fn rise(&self, more: &[i32; 6]) -> i32 {
        (0..6).fold(0, |rise, j| rise * self.counts[j] + more[j])
    }
}

/// All nodes of one path point that are looked at, states in one flip with their turns, in the order of beta.
#[derive(Debug, Clone, Default)]
struct Layer {
    /// See [`Numbering`].
    numbers: Vec<u32>,
    /// Smallest signed costs from here to the end, infinite where that is not reached.
    costs: Vec<f64>,
    /// How each goes on.
    ways: Ways,
    /// Joint angles over beta, modulo a turn, theta_5 not negative; meaningful where there are nodes. rad
    angles: Vec<[f64; 6]>,
}

/// How the nodes of a path point go on.
#[derive(Debug, Clone, Default)]
struct Ways {
    /// The successors in the next layer.
    to: Vec<u32>,
    /// Where the nodes of each beta begin, and their end.
    starts: Vec<u32>,
}

impl Ways {
    fn of(&self, beta: usize) -> Range<usize> {
        self.starts[beta] as usize..self.starts[beta + 1] as usize
    }

    /// The beta number of a node.
    fn beta(&self, node: usize) -> usize {
        self.starts.partition_point(|start| *start as usize <= node) - 1
    }
}

impl Layer {
    /// Fills in what is allowed of a posture class in the states requested, without costs.
    fn fill<E: KernelNumber>(
        &mut self,
        states: &StateGrid<E>,
        is_requested: impl Fn(usize) -> bool,
        class: PostureClass,
        flips: [bool; 2],
        numbering: &Numbering,
    ) {
        self.numbers.clear();
        self.ways.starts.clear();
        self.angles.resize(states.count(), [0.0; 6]);
        let (scores, pad) = (states.inner_scores(class), states.pad());
        for beta in 0..states.count() {
            self.ways.starts.push(self.numbers.len() as u32);
            if !scores[beta].get().is_finite() || !is_requested(beta) {
                continue;
            }
            for j in 0..6 {
                let [sines, cosines] = states.directions(class, j);
                self.angles[beta][j] = libm::atan2(sines[pad + beta].get(), cosines[pad + beta].get());
            }
            numbering.allowed(&self.angles[beta], flips, &mut self.numbers);
        }
        let count = self.numbers.len();
        self.ways.starts.push(count as u32);
        self.ways.to.clear();
        self.ways.to.resize(count, 0);
        self.costs.clear();
        self.costs.resize(count, f64::INFINITY);
    }

    /// The smallest cost of all nodes, infinite where none goes on.
    fn least(&self) -> f64 {
        self.costs.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// The cheapest path of one posture class with regard to flips and turns.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TurnsPath {
    /// Its cost, by the sense of the pass: the smaller the better.
    pub cost: f64,
    /// For every path point the beta number, that of the knot before where it is between knots.
    pub betas: Vec<usize>,
}

/// How much more than without regard to flips and turns a path may cost, relative to that, in the first search and the
/// next ones: mostly it is little, and then few states are looked at.
const MARGINS: [f64; 4] = [2e-4, 2e-2, 0.15, f64::INFINITY];
/// Sums of costs are as exact as this, relative to them.
const SUM_ROUNDING: f64 = 1e-9;

/// What is planned: from the end of a segment to its start, by nodes from which the start may still be reached at no
/// more than `most`.
struct Search<'s> {
    planner: &'s SegmentPlanner<'s>,
    pass: Pass<'s>,
    class: PostureClass,
    /// Whether the flip with theta_5 not negative, and the other, may be taken.
    flips: [bool; 2],
    numbering: Numbering,
    most: f64,
}

/// The knots of a pass as stages, from the last to the first.
struct Backward<'s, E> {
    search: &'s Search<'s>,
    workspace: &'s mut Workspace<E>,
    /// Room for the layer that comes next.
    spare: Layer,
    /// The number of the last knot.
    last: usize,
}

impl<E: KernelNumber> Stages for Backward<'_, E> {
    type Layer = Layer;
    type Links = Ways;

    fn first(&mut self) -> Option<Layer> {
        self.search.last(self.workspace)
    }

    fn advance(&mut self, layer: &mut Layer, stage: usize) -> Option<()> {
        self.search.go_back(layer, &mut self.spare, self.last - stage, self.workspace)
    }

    fn costs(layer: &Layer) -> &[f64] {
        &layer.costs
    }

    fn links(layer: &Layer) -> &Ways {
        &layer.ways
    }

    fn before(ways: &Ways, node: usize) -> usize {
        ways.to[node] as usize
    }
}

impl SegmentPlanner<'_> {
    /// The cheapest path of a posture class in the flips requested, with every joint inside its limits at the knots of
    /// a pass, which has just been made and found one of this cost without regard to flips and turns.
    pub(super) fn path_with_turns<E: KernelNumber>(
        &self,
        pass: Pass<'_>,
        class: PostureClass,
        flips: [bool; 2],
        cost: f64,
        workspace: &mut Workspace<E>,
    ) -> Option<TurnsPath> {
        let numbering = Numbering::new(&self.problem.robot);
        let nodes = self.grid.beta_count * numbering.most();
        let knots = self.knot_count(pass);
        let block = (MAX_NODES / nodes).max(knots.isqrt()).max(1);
        let mut search = Search { planner: self, pass, class, flips, numbering, most: f64::INFINITY };
        let is_bounded = workspace.record.reached(0, class).is_some();
        let rounding = SUM_ROUNDING.max(64.0 * E::EPSILON);
        MARGINS.into_iter().filter(|margin| is_bounded || margin.is_infinite()).find_map(|margin| {
            let above = if margin.is_finite() { margin * cost.abs() } else { f64::INFINITY };
            search.most = cost + above;
            search.path(block, workspace).filter(|found| found.cost <= search.most - rounding * found.cost.abs())
        })
    }
}

impl Search<'_> {
    /// The path, with the links of so many knots kept at a time.
    fn path<E: KernelNumber>(&self, block: usize, workspace: &mut Workspace<E>) -> Option<TurnsPath> {
        let (planner, pass) = (self.planner, self.pass);
        let knots = planner.knot_count(pass);
        let mut betas = vec![0; pass.span.len()];
        let mut backward = Backward { search: self, workspace, spare: Layer::default(), last: knots - 1 };
        let cost = cheapest(&mut backward, knots, block, |stage, ways, node| {
            betas[planner.knot(pass, knots - 1 - stage) - pass.span.start] = ways.beta(node);
        })?;
        Some(TurnsPath { cost, betas })
    }

    /// Evaluates a path point in the posture class alone.
    fn evaluate<E: KernelNumber>(&self, point: usize, workspace: &mut Workspace<E>) {
        let requested = PostureClass::ALL.map(|class| class == self.class);
        self.planner.evaluate(self.pass, point, requested, workspace);
    }

    fn join(&self, a: f64, b: f64) -> f64 {
        self.planner.problem.criterion.aggregate.join_signed(self.pass.sense, a, b)
    }

    /// Fills the layer of a knot that has just been evaluated with the nodes from which the start may be reached, where
    /// what follows costs `rest` at the least.
    fn fill<E: KernelNumber>(&self, layer: &mut Layer, knot: usize, rest: Option<f64>, workspace: &Workspace<E>) {
        let reached = workspace.record.reached(knot, self.class);
        let is_requested = |beta: usize| {
            reached.is_none_or(|costs| {
                rest.map_or(costs[beta].get(), |rest| self.join(costs[beta].get(), rest)) <= self.most
            })
        };
        layer.fill(&workspace.now, is_requested, self.class, self.flips, &self.numbering);
    }

    /// The layer of the last point, where it has states.
    fn last<E: KernelNumber>(&self, workspace: &mut Workspace<E>) -> Option<Layer> {
        let knot = self.planner.knot_count(self.pass) - 1;
        self.evaluate(self.planner.knot(self.pass, knot), workspace);
        let mut layer = Layer::default();
        self.fill(&mut layer, knot, None, workspace);
        let scores = workspace.now.inner_scores(self.class);
        for (beta, score) in scores.iter().enumerate() {
            layer.costs[layer.ways.of(beta)].fill(score.get() * self.pass.sense.sign());
        }
        Some(layer).filter(|layer| layer.least().is_finite())
    }

    /// Goes back to a knot from the next one, where some of its states go on; `before` is room for its layer.
    fn go_back<E: KernelNumber>(
        &self,
        layer: &mut Layer,
        before: &mut Layer,
        number: usize,
        workspace: &mut Workspace<E>,
    ) -> Option<()> {
        let (planner, pass) = (self.planner, self.pass);
        let [point, next] = [number, number + 1].map(|number| planner.knot(pass, number));
        for between in point + 1..next {
            self.evaluate(between, workspace);
            if !planner.add_between(pass, between, self.class, workspace) {
                return None;
            }
        }
        self.evaluate(point, workspace);
        let Place::Knot(knot) = planner.place(pass, next) else { return None };
        self.fill(before, number, Some(layer.least()), workspace);
        self.connect(before, layer, number, knot, workspace);
        std::mem::swap(layer, before);
        layer.least().is_finite().then_some(())
    }

    /// Gives each node its cheapest successor. Of equal ones the nearest in beta is taken.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn connect<E: KernelNumber>(
        &self,
        layer: &mut Layer,
        after: &Layer,
        number: usize,
        knot: Knot,
        workspace: &Workspace<E>,
    ) {
        let (planner, sign) = (self.planner, self.pass.sense.sign());
        let count = planner.grid.beta_count;
        let next = planner.knot(self.pass, number + 1);
        let limits = planner.joint_limits(next, knot.points).map(|limit| limit + STEP_ROUNDING);
        let (scores, pad) = (workspace.now.inner_scores(self.class), workspace.now.pad());
        let reached = workspace.record.reached(number, self.class);
        let joining = planner.joining(self.pass);
        let between = (knot.points > 1).then(|| workspace.run_costs.of(self.class, knot.change.min, joining));
        let travel = planner.travel_cost(self.pass.sense);
        let cheapest = |beta| after.costs[after.ways.of(beta)].iter().copied().fold(f64::INFINITY, f64::min);
        let cheapest: Vec<f64> = (0..count).map(cheapest).collect();
        for beta in 0..count {
            let own = layer.ways.of(beta);
            if own.is_empty() {
                continue;
            }
            let (numbers, costs) = (&layer.numbers[own.clone()], &mut layer.costs[own.clone()]);
            let to = &mut layer.ways.to[own];
            // The largest of its nodes' costs so far: what costs as much or more is not looked at.
            let mut most = f64::INFINITY;
            for shift in knot.change.shifts() {
                let later = (beta as isize - shift).rem_euclid(count as isize) as usize;
                let cost_between = between.map(|between| between.row(shift)[pad + later].get());
                let join = |rest: f64| cost_between.map_or(rest, |between| self.join(between, rest));
                let is_open = cheapest[later].is_finite() && cost_between.is_none_or(f64::is_finite);
                let is_too_dear = |costs: &[E]| self.join(costs[beta].get(), join(cheapest[later])) > self.most;
                if !is_open || join(cheapest[later]) >= most || reached.is_some_and(is_too_dear) {
                    continue;
                }
                let Some((turns, distance)) =
                    crossings(&planner.problem.robot, &layer.angles[beta], &after.angles[later], &limits)
                else {
                    continue;
                };
                let joined = |rest: f64| join(rest) + travel * distance;
                let known = after.ways.of(later);
                let (known_costs, known_numbers) = (&after.costs[known.clone()], &after.numbers[known.clone()]);
                let take = |node: usize, next: usize| {
                    let cost = joined(known_costs[next]);
                    if cost < costs[node] {
                        (costs[node], to[node]) = (cost, (known.start + next) as u32);
                    }
                };
                same_numbers(numbers, known_numbers, self.numbering.rise(&turns), take);
                most = costs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            }
            let score = scores[beta].get() * sign;
            for cost in costs.iter_mut().filter(|cost| cost.is_finite()) {
                *cost = self.join(score, *cost);
            }
        }
    }
}

/// Visits the pairs of places in two ascending rows whose numbers are the same once those of the first have risen.
#[inline(always)]
fn same_numbers(first: &[u32], second: &[u32], rise: i32, mut visit: impl FnMut(usize, usize)) {
    let mut other = 0;
    for (place, number) in first.iter().enumerate() {
        let number = number.wrapping_add_signed(rise);
        while second.get(other).is_some_and(|known| *known < number) {
            other += 1;
        }
        if second.get(other) == Some(&number) {
            visit(place, other);
        }
    }
}

/// By how many turns each joint advances in a step from some angles to others (rad, from -pi to pi), and the joint
/// travel (rad); none where one steps by more than its limit.
fn crossings(robot: &Robot, from: &[f64; 6], to: &[f64; 6], limits: &[f64; 6]) -> Option<([i32; 6], f64)> {
    let (mut turns, mut distance, mut before) = ([0; 6], 0.0, 0.0);
    for j in 0..6 {
        let apart = to[j] - from[j];
        turns[j] = i32::from(apart < -PI) - i32::from(apart > PI);
        let step = apart + TAU * f64::from(turns[j]);
        // What motor 3 turns on an arm with a linkage.
        let driven = if j == 2 && robot.has_linkage() { before + robot.geometry().fold * step } else { step };
        if driven.abs() > limits[j] {
            return None;
        }
        before = step;
        distance += step.abs();
    }
    Some((turns, distance))
}

#[cfg(test)]
mod tests;
