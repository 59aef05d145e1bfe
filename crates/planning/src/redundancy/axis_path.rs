//! An external axis that moves along the path: dynamic programming over (beta, position of the axis), the slow twin of
//! [`super::motion`], with real joint angles where that takes them modulo a turn.
//!
//! A state of a path point is a grid value of beta, one of the positions that the axis may have there, a posture and
//! real joint angles. From one point to the next beta may change by its rate, the axis by its speed, and each joint by
//! its own; the posture stays all along a segment. The batch evaluator tells which states are worth a look, the
//! reference evaluator what they cost.

use super::joint_turns::is_allowed;
use super::layered::{Steps, cheapest_path};
use super::rate_limit::BetaChange;
use super::{Resolution, SegmentPlanner, Workspace};
use rayon::prelude::*;
use std::ops::Range as Span;
use stead_model::robot::Posture;
use stead_model::robot::turns::real_configurations;
use stead_problem::constraints::joint_steps_hold;
use stead_problem::evaluate::batch::BatchEvaluator;
use stead_problem::evaluate::reference::State;
use stead_problem::joint_travel::joint_distance;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::setup::{AxisPositions, Setup};

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
pub(super) struct Configuration {
    /// Which position of the axis.
    pub position: usize,
    /// Which grid value of beta.
    pub beta: usize,
    /// Real joint angles. rad
    pub joints: [f64; 6],
    /// What the point adds to the cost.
    pub score: f64,
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
        let setup = Setup { positions: AxisPositions::PerPoint(rows), ..self.problem.setup.clone() };
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

    /// The cheapest way of the axis along every segment at a placement, in the posture in which it is cheapest, or in
    /// one for the whole path where the posture may not change; `None` where some segment has none.
    pub fn paths(&self, placement: &Placement) -> Option<Vec<AxisPath>> {
        let problems: Vec<Problem> = (0..self.count()).map(|number| self.problem_at(number)).collect();
        let planner = |problem| SegmentPlanner::new(problem, problem.redundancy, Resolution::Search);
        let planners: Vec<SegmentPlanner<'_>> = problems.iter().map(planner).collect();
        let search = Search { grid: self, planners: &planners, placement };
        let postures: Vec<Posture> = self.problem.postures.allowed().collect();
        let spans = self.problem.task.segments();
        let jobs: Vec<(usize, usize)> =
            (0..postures.len()).flat_map(|posture| (0..spans.len()).map(move |span| (posture, span))).collect();
        let found: Vec<Option<AxisPath>> = jobs
            .into_par_iter()
            .map_init(
                || planners.first().map(SegmentPlanner::workspace),
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
    planners: &'s [SegmentPlanner<'s>],
    placement: &'s Placement,
}

impl Search<'_, '_> {
    /// The cheapest way along a segment in one posture.
    fn segment(&self, span: &Span<usize>, posture: Posture, workspace: &mut Workspace) -> Option<AxisPath> {
        let planner = self.planners.first()?;
        let (limits, changes, starts) = ([f64::INFINITY; 6], Vec::new(), Vec::new());
        let mut steps =
            AxisSteps { search: self, planner, span, posture, workspace, point: span.start, limits, changes, starts };
        let (cost, path) = cheapest_path(&mut steps, span.len(), self.planners.len() * planner.grid.beta_count)?;
        let position = |(point, state): (usize, &Configuration)| self.grid.positions[point][state.position];
        Some(AxisPath { positions: span.clone().zip(&path).map(position).collect(), cost })
    }
}

/// The steps along a segment in one posture.
struct AxisSteps<'s, 'a> {
    search: &'s Search<'s, 'a>,
    planner: &'s SegmentPlanner<'s>,
    span: &'s Span<usize>,
    posture: Posture,
    workspace: &'s mut Workspace,
    /// The point that steps lead to.
    point: usize,
    /// How far each joint may step to it. rad
    limits: [f64; 6],
    /// The allowed changes of the beta number to it, for each position of the axis before and each of its own; none
    /// where the axis is too slow.
    changes: Vec<BetaChange>,
    /// Where the states of each position and beta begin among those before.
    starts: Vec<usize>,
}

impl AxisSteps<'_, '_> {
    /// The allowed changes of the beta number to the point, for each position of the axis before it and each of its
    /// own.
    fn allowed_changes(&self) -> Vec<BetaChange> {
        let (problem, axis, point) = (self.search.grid.problem, self.search.grid.axis, self.point);
        let (grid, step) = (&problem.redundancy, self.search.grid.step(point));
        let all = problem.setup.positions.spread(&problem.task);
        let mut rows = [all[point - 1].clone(), all[point].clone()];
        let mut changes = Vec::with_capacity(self.search.planners.len().pow(2));
        for from in &self.search.grid.positions[point - 1] {
            for to in &self.search.grid.positions[point] {
                (rows[0][axis], rows[1][axis]) = (*from, *to);
                let part = problem.part_turn_between(&rows[0], &rows[1]);
                let change = BetaChange::of(problem.beta_step_with(point, grid, part.as_ref()), grid);
                changes.push(if (to - from).abs() > step { BetaChange::NONE } else { change });
            }
        }
        changes
    }
}

impl Steps for AxisSteps<'_, '_> {
    type State = Configuration;

    /// Every real configuration of every allowed state, by the number of the position and then by beta.
    fn states(&mut self, place: usize) -> Vec<Configuration> {
        let (point, class) = (self.span.start + place, self.posture.class());
        let mut states = Vec::new();
        for (position, planner) in self.search.planners.iter().enumerate() {
            let Some(evaluator) = BatchEvaluator::of_posture(&planner.evaluators, self.posture) else {
                continue;
            };
            evaluator.evaluate(point, self.search.placement, &mut self.workspace.now);
            for beta in 0..planner.grid.beta_count {
                if self.workspace.now.inner_scores(class)[beta].is_finite() {
                    let angle = planner.grid.beta(beta);
                    let state = planner.problem.at(self.search.placement).state(point, angle, self.posture);
                    let found =
                        state.map_or_else(|_| Vec::new(), |state| configurations(planner.problem, point, &state));
                    states.extend(found.into_iter().map(|found| Configuration { position, beta, ..found }));
                }
            }
        }
        states
    }

    fn prepare(&mut self, place: usize, before: &[Configuration]) {
        self.point = self.span.start + place;
        self.limits = self.planner.steps[self.point];
        self.changes = self.allowed_changes();
        let count = self.planner.grid.beta_count;
        self.starts.clear();
        self.starts.resize(self.search.planners.len() * count + 1, 0);
        for state in before {
            self.starts[state.position * count + state.beta + 1] += 1;
        }
        for place in 1..self.starts.len() {
            self.starts[place] += self.starts[place - 1];
        }
    }

    fn may_lead_to(&self, _: &[Configuration], state: &Configuration, mut visit: impl FnMut(usize)) {
        let (count, positions) = (self.planner.grid.beta_count, self.search.planners.len());
        for number in 0..positions {
            for shift in self.changes[number * positions + state.position].shifts() {
                let beta = (state.beta as isize + shift).rem_euclid(count as isize) as usize;
                let place = number * count + beta;
                (self.starts[place]..self.starts[place + 1]).for_each(&mut visit);
            }
        }
    }

    fn step(&self, from: &Configuration, to: &Configuration) -> Option<f64> {
        let travel = self.planner.travel_cost(Sense::Min);
        joint_steps_hold(&self.planner.problem.robot, &from.joints, &to.joints, &self.limits)
            .then(|| travel * joint_distance(&from.joints, &to.joints))
    }

    fn own(&self, _: usize, state: &Configuration) -> f64 {
        state.score
    }

    fn join(&self, way: f64, own: f64) -> f64 {
        self.planner.problem.criterion.aggregate.join_signed(Sense::Min, way, own)
    }
}

/// The real configurations of a state of a path point, where it is allowed; position and beta are the first of the
/// grid.
pub(super) fn configurations(problem: &Problem, point: usize, state: &State<f64>) -> Vec<Configuration> {
    if !is_allowed(problem, state) {
        return Vec::new();
    }
    let score = problem.point_cost(point, state.score());
    let configuration = |joints| Configuration { position: 0, beta: 0, joints, score };
    real_configurations(&problem.robot, &state.joints).into_iter().map(configuration).collect()
}

#[cfg(test)]
mod tests;
