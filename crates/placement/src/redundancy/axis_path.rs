//! An external axis that moves along the path: dynamic programming over (beta, position of the axis).
//!
//! A state of a path point is a grid value of beta, one of the positions that the axis may have there, a posture and real joint angles. From
//! one point to the next beta may change by its rate, the axis by its speed, and each joint by its own; the posture stays all along a
//! segment. The batch evaluator tells which states are worth a look, the reference evaluator what they cost. The plan itself is made
//! afterwards, with the axis led along the positions found here ([`AxisPositions::PerPoint`]), so nothing of what is printed rests on
//! this grid.
//!
//! [`AxisPositions::PerPoint`]: crate::setup::AxisPositions::PerPoint

use super::joint_turns::is_allowed;
use super::rate_limit::BetaChange;
use super::{Planner, SEARCH_ROOM, Workspace};
use crate::constraints::joint_steps_hold;
use crate::evaluate::reference;
use crate::joint_travel::joint_distance;
use crate::problem::{Placement, Problem};
use crate::sense::Sense;
use crate::setup::{AxisPositions, Setup};
use rayon::prelude::*;
use std::ops::Range as Span;
use stead_model::robot::{Posture, turns::Range};

/// How far beyond its speed an axis may be, relative: rounding.
const SPEED_ROUNDING: f64 = 1e-9;

/// The positions that one external axis of a problem may have, as many at every path point.
#[derive(Debug, Clone)]
pub struct AxisGrid<'a> {
    /// The problem, in a setup that says where the other axes stand.
    pub problem: &'a Problem,
    /// Which axis moves, from 0.
    pub axis: usize,
    /// For every path point the positions, ascending. m or rad
    pub positions: Vec<Vec<f64>>,
}

/// A real configuration of the arm at a path point.
#[derive(Debug, Clone)]
pub(super) struct Node {
    /// Which position of the axis.
    pub position: usize,
    /// Which grid value of beta.
    pub beta: usize,
    /// Real joint angles. rad
    pub joints: [f64; 6],
    /// What the point adds to the cost.
    pub score: f64,
    /// Smallest cost up to here.
    pub cost: f64,
    /// From which node of the point before.
    pub from: usize,
}

/// The axis along one segment.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisPath {
    /// Its position at each point of the segment. m or rad
    pub positions: Vec<f64>,
    /// What the points of the segment add to the objective.
    pub cost: f64,
}

impl<'a> AxisGrid<'a> {
    /// The problem with the axis at the position of one number at every point.
    pub(super) fn problem_at(&self, number: usize) -> Problem {
        let mut rows = self.problem.setup.positions.spread(&self.problem.task);
        for (row, own) in rows.iter_mut().zip(&self.positions) {
            row[self.axis] = own[number];
        }
        let setup = Setup { positions: AxisPositions::PerPoint(rows), ..self.problem.setup };
        self.problem.in_setup(&setup).into_owned()
    }

    /// How many positions each point has.
    pub(super) fn count(&self) -> usize {
        self.positions.first().map_or(0, Vec::len)
    }

    /// How far the axis may move from the point before. m or rad
    pub(super) fn step(&self, point: usize) -> f64 {
        let speed = self.problem.external_axes[self.axis].max_speed.unwrap_or(f64::INFINITY);
        speed * self.problem.step_time(point) * (1.0 + SPEED_ROUNDING)
    }

    /// The cheapest way of the axis along every segment at a placement, in the posture in which it is cheapest, or in one for the whole
    /// path where the posture may not change; `None` where some segment has none.
    pub fn paths(&self, placement: &Placement) -> Option<Vec<AxisPath>> {
        let problems: Vec<Problem> = (0..self.count()).map(|number| self.problem_at(number)).collect();
        let planners: Vec<Planner<'_>> =
            problems.iter().map(|problem| Planner::on_grid(problem, problem.redundancy, SEARCH_ROOM)).collect();
        let search = Search { grid: self, planners: &planners, placement };
        let postures: Vec<Posture> = self.problem.postures.allowed().collect();
        let spans = self.problem.task.segments();
        let jobs: Vec<(usize, usize)> =
            (0..postures.len()).flat_map(|posture| (0..spans.len()).map(move |span| (posture, span))).collect();
        let found: Vec<Option<AxisPath>> = jobs
            .into_par_iter()
            .map_init(
                || planners.first().map(Planner::workspace),
                |space, (posture, span)| search.segment(&spans[span], postures[posture], space.as_mut()?),
            )
            .collect();
        let of = |posture: usize, span: usize| found[posture * spans.len() + span].clone();
        if self.problem.postures.may_change {
            let cheapest = |span: usize| {
                (0..postures.len()).filter_map(|posture| of(posture, span)).min_by(|a, b| a.cost.total_cmp(&b.cost))
            };
            return (0..spans.len()).map(cheapest).collect();
        }
        let whole = |posture: usize| (0..spans.len()).map(|span| of(posture, span)).collect::<Option<Vec<_>>>();
        let objective = |paths: &Vec<AxisPath>| self.problem.objective(paths.iter().map(|path| path.cost));
        (0..postures.len()).filter_map(whole).min_by(|a, b| objective(a).total_cmp(&objective(b)))
    }
}

/// What is searched.
struct Search<'s, 'a> {
    grid: &'s AxisGrid<'a>,
    /// For each number of a position.
    planners: &'s [Planner<'s>],
    placement: &'s Placement,
}

impl Search<'_, '_> {
    /// The cheapest way along a segment in one posture.
    fn segment(&self, span: &Span<usize>, posture: Posture, workspace: &mut Workspace) -> Option<AxisPath> {
        let mut layers: Vec<Vec<Node>> = Vec::with_capacity(span.len());
        for point in span.clone() {
            let mut layer = self.nodes(point, posture, workspace);
            match layers.last() {
                None => layer.iter_mut().for_each(|node| node.cost = node.score),
                Some(before) => self.connect(before, &mut layer, point),
            }
            layer.retain(|node| node.cost.is_finite());
            if layer.is_empty() {
                return None;
            }
            layers.push(layer);
        }
        let last = layers.last()?;
        let mut index = (0..last.len()).min_by(|a, b| last[*a].cost.total_cmp(&last[*b].cost))?;
        let cost = last[index].cost;
        let mut positions = Vec::with_capacity(span.len());
        for (layer, point) in layers.iter().zip(span.clone()).rev() {
            let node = &layer[index];
            positions.push(self.grid.positions[point][node.position]);
            index = node.from;
        }
        positions.reverse();
        Some(AxisPath { positions, cost })
    }

    /// Every real configuration of every allowed state of one point, by the number of the position and then by beta.
    fn nodes(&self, point: usize, posture: Posture, space: &mut Workspace) -> Vec<Node> {
        let mut nodes = Vec::new();
        for (position, planner) in self.planners.iter().enumerate() {
            let Some(evaluator) = planner.evaluators.iter().find(|one| one.flips().contains(posture)) else { continue };
            let class = posture.class();
            evaluator.evaluate(point, self.placement, &mut space.now);
            for beta in 0..planner.grid.beta_count {
                if space.now.inner_scores(class)[beta].is_finite() {
                    let angle = planner.grid.beta(beta);
                    nodes_of(planner.problem, (point, self.placement, angle, posture), (position, beta), &mut nodes);
                }
            }
        }
        nodes
    }

    /// Gives each node its cheapest predecessor.
    fn connect(&self, before: &[Node], layer: &mut [Node], point: usize) {
        let Some(planner) = self.planners.first() else { return };
        let (count, positions) = (planner.grid.beta_count, self.planners.len());
        // Where the nodes of each position and beta begin among those before.
        let mut starts = vec![0; positions * count + 1];
        for node in before {
            starts[node.position * count + node.beta + 1] += 1;
        }
        for place in 1..starts.len() {
            starts[place] += starts[place - 1];
        }
        let (step, limits) = (self.grid.step(point), &planner.steps[point]);
        let travel = planner.travel_cost(Sense::Min);
        let [from, to] = [point - 1, point].map(|point| &self.grid.positions[point]);
        let changes = self.changes(point);
        for node in layer {
            for (number, position) in from.iter().enumerate() {
                if (to[node.position] - position).abs() > step {
                    continue;
                }
                for shift in changes[number * positions + node.position].shifts() {
                    let beta = (node.beta as isize + shift).rem_euclid(count as isize) as usize;
                    let place = number * count + beta;
                    for (index, old) in before.iter().enumerate().take(starts[place + 1]).skip(starts[place]) {
                        let cost = old.cost + travel * joint_distance(&old.joints, &node.joints);
                        if cost < node.cost && joint_steps_hold(&old.joints, &node.joints, limits) {
                            node.cost = cost;
                            node.from = index;
                        }
                    }
                }
            }
            if node.cost.is_finite() {
                let aggregate = planner.problem.criterion.aggregate;
                node.cost = aggregate.join_signed(Sense::Min, node.cost, node.score);
            }
        }
    }
}

impl Search<'_, '_> {
    /// The allowed changes of the beta number to a point from the one before, for each position of the axis there and each here.
    fn changes(&self, point: usize) -> Vec<BetaChange> {
        let (problem, axis) = (self.grid.problem, self.grid.axis);
        let grid = &problem.redundancy;
        let mut rows = problem.setup.positions.spread_at(&problem.task, [point - 1, point]);
        let mut changes = Vec::with_capacity(self.planners.len() * self.planners.len());
        for from in &self.grid.positions[point - 1] {
            for to in &self.grid.positions[point] {
                (rows[0][axis], rows[1][axis]) = (*from, *to);
                let part = problem.part_turn_between(&rows[0], &rows[1]);
                changes.push(BetaChange::of(problem.beta_step_with(point, grid, part.as_ref()), grid));
            }
        }
        changes
    }
}

/// Adds the real configurations of a state, where it is allowed.
pub(super) fn nodes_of(
    problem: &Problem,
    (point, placement, beta, posture): (usize, &Placement, f64, Posture),
    (position, number): (usize, usize),
    nodes: &mut Vec<Node>,
) {
    let Ok(state) = reference::state(problem, point, placement, beta, posture) else { return };
    if !is_allowed(problem, &state) {
        return;
    }
    let mut configurations = vec![[0.0; 6]];
    for (j, joint) in problem.robot.joints().iter().enumerate() {
        let range = Range::of(joint);
        let extended = configurations.iter().flat_map(|known| {
            range.real_angles(state.joints[j]).map(|real| {
                let mut next = *known;
                next[j] = real;
                next
            })
        });
        configurations = extended.collect();
    }
    let score = problem.point_cost(point, state.score());
    let node = |joints| Node { position, beta: number, joints, score, cost: f64::INFINITY, from: 0 };
    nodes.extend(configurations.into_iter().map(node));
}

#[cfg(test)]
mod tests;
