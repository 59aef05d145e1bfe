//! The choice among setups: in which orientation the part lies, where the external axes stand.
//!
//! Every orientation, and in it a grid of positions of each axis in turn, is searched with the same settings; the best
//! and the worst of all are kept. Then the axes of the best are improved ([`super::motion`]).

use super::axes::{GRID, Improved};
use super::infeasible::Infeasible;
use super::lean::leaned_at;
use super::motion::with_better_axes;
use super::refined::Refined;
use super::{place_as_set_up, stated_cases};
use crate::outcome::{Case, Outcome, Plan};
use crate::refine::{Solution, planned};
use crate::settings::SearchSettings;
use std::ops::Range;
use stead_model::robot::Posture;
use stead_numerics::monitor::Monitor;
use stead_planning::joint_travel::joint_travel;
use stead_planning::problem::{Cell, Placement, Problem};
use stead_planning::redundancy::{Planner, SegmentPlan};
use stead_planning::sense::{BySense, Sense};
use stead_planning::setup::{AxisPositions, Setup, TriedSetup};
use stead_planning::transfer::TransferSettings;

/// What is searched in every setup.
struct Job<'a> {
    problem: &'a Problem,
    settings: &'a SearchSettings,
    transfer: &'a TransferSettings,
    monitor: &'a Monitor,
}

/// What was found so far.
#[derive(Default)]
struct Found {
    best: Option<Outcome>,
    worst: Option<BySense<Case>>,
    tried: Vec<TriedSetup>,
    refused: Option<Infeasible>,
    evaluations: usize,
    states: usize,
}

/// Finds the best and the worst placement over all setups.
///
/// # Errors
/// [`Infeasible`] when no setup met has a feasible placement: why the first has none.
pub(super) fn place_in_all(
    problem: &Problem,
    settings: &SearchSettings,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Outcome, Infeasible> {
    let job = Job { problem, settings, transfer, monitor };
    let mut found = Found::default();
    for orientation in 0..problem.orientations.len().max(1) {
        if orientation > 0 && monitor.should_stop() {
            break;
        }
        job.search_axes(Setup { orientation, ..Setup::at_rest(&problem.external_axes) }, &mut found);
    }
    let Found { best, worst, tried, refused, evaluations, states } = found;
    let Some(mut outcome) = best else {
        let nothing = || Infeasible {
            placement: Placement::from([0.0; 4]),
            searched: true,
            findings: Vec::new(),
            collisions: Vec::new(),
            interrupted: monitor.should_stop(),
        };
        return Err(refused.unwrap_or_else(nothing));
    };
    outcome.cases.worst = worst;
    (outcome.evaluations, outcome.states) = (evaluations, states);
    outcome.tried_setups = tried;
    job.improve(&mut outcome);
    outcome.interrupted |= monitor.should_stop();
    Ok(outcome)
}

impl Job<'_> {
    /// Searches in a setup, then with each axis at other places of its range in turn.
    fn search_axes(&self, mut setup: Setup, found: &mut Found) {
        let mut least = self.search(&setup, found);
        for (number, axis) in self.problem.external_axes.iter().enumerate() {
            let AxisPositions::Same(start) = setup.positions.clone() else { return };
            let mut chosen = start.clone();
            for position in axis.grid(GRID) {
                if position == start[number] || self.monitor.should_stop() {
                    continue;
                }
                let mut positions = start.clone();
                positions[number] = position;
                let objective =
                    self.search(&Setup { positions: AxisPositions::Same(positions.clone()), ..setup.clone() }, found);
                if let Some(objective) = objective
                    && least.is_none_or(|least| objective < least)
                {
                    (least, chosen) = (Some(objective), positions);
                }
            }
            setup.positions = AxisPositions::Same(chosen);
        }
    }

    /// The search in one setup; its best objective, where it found something. m
    fn search(&self, setup: &Setup, found: &mut Found) -> Option<f64> {
        let problem = self.problem.in_setup(setup);
        let outcome = match problem.without_shifting_axes() {
            None => place_as_set_up(&problem, self.settings, self.transfer, self.monitor),
            Some((shifted, by)) => place_as_set_up(&shifted, self.settings, self.transfer, self.monitor)
                .map(|outcome| unshifted(outcome, &problem, by))
                .map_err(|refused| Infeasible { placement: back(&refused.placement, by), ..refused }),
        };
        let tried = |objectives| TriedSetup { setup: setup.clone(), objectives };
        let outcome = match outcome {
            Ok(outcome) => outcome,
            Err(refused) => {
                found.tried.push(tried(None));
                found.refused.get_or_insert(refused);
                return None;
            }
        };
        let best = outcome.cases.best.plan.objective;
        let worst = outcome.cases.worst.as_ref().map(|worst| worst.best.plan.objective);
        found.tried.push(tried(Some((best, worst))));
        found.evaluations += outcome.evaluations;
        found.states += outcome.states;
        if found.worst.as_ref().is_none_or(|known| worst > Some(known.best.plan.objective)) {
            found.worst = outcome.cases.worst.clone();
        }
        if found.best.as_ref().is_none_or(|known| best < known.cases.best.plan.objective) {
            found.best = Some(outcome);
        }
        Some(best)
    }

    /// Improves the axes of the best placement.
    fn improve(&self, outcome: &mut Outcome) {
        if self.monitor.should_stop() || !self.problem.external_axes.iter().any(|axis| axis.max > axis.min) {
            return;
        }
        let problem = self.problem.in_setup(&outcome.cases.best.setup);
        let without_tie_rule = problem.without_tie_rule();
        let planner = Planner::finer(&without_tie_rule);
        let start = match planned(&planner, &outcome.cases.best.placement, None, &mut planner.workspace()) {
            Some(start) if start.objective < outcome.cases.best.plan.objective => start,
            _ => Solution::new(
                &without_tie_rule,
                outcome.cases.best.placement,
                plans_of(&outcome.cases.best.plan, &without_tie_rule),
            ),
        };
        let start = Improved { setup: without_tie_rule.setup.clone(), solution: start };
        let Some(found) = with_better_axes(&without_tie_rule, &start, None, self.monitor) else { return };
        let problem = self.problem.in_setup(&found.setup);
        let refined = Refined { solution: found.solution, scheme: None };
        let without_tie_rule = problem.without_tie_rule();
        let planner = Planner::finer(&without_tie_rule);
        let BySense { best, worst: worst_plan } =
            stated_cases(&problem, &planner, self.transfer, Sense::Min, &refined, self.monitor);
        if best.plan.objective < outcome.cases.best.plan.objective {
            (outcome.cases.best, outcome.cases.best_worst_plan) = (best, worst_plan);
        }
    }
}

/// The setup in which a given placement is best, the part as it lies in the problem's: each axis first on a grid over
/// its range, then improved; then the tool leans where it may. The problem's own where no position that is tried has a
/// plan.
pub fn setup_at(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Setup {
    let pinned = problem.without_tie_rule().in_cell(Cell::at(placement));
    let at = |setup: &Setup| {
        let set_up = pinned.in_setup(setup);
        let planner = Planner::finer(&set_up);
        planned(&planner, placement, None, &mut planner.workspace())
    };
    let mut best = (problem.setup.clone(), at(&problem.setup));
    for (number, axis) in problem.external_axes.iter().enumerate() {
        let AxisPositions::Same(start) = best.0.positions.clone() else { break };
        for position in axis.grid(GRID) {
            if monitor.should_stop() {
                break;
            }
            let mut positions = start.clone();
            positions[number] = position;
            let setup = Setup { positions: AxisPositions::Same(positions), ..best.0.clone() };
            let known = best.1.as_ref().map_or(f64::INFINITY, |known| known.objective);
            if let Some(found) = at(&setup)
                && found.objective < known
            {
                best = (setup, Some(found));
            }
        }
    }
    let (setup, start) = best;
    let set_up = pinned.in_setup(&setup);
    let start = start.map(|solution| Improved { setup: setup.clone(), solution });
    let setup =
        start.and_then(|start| with_better_axes(&set_up, &start, None, monitor)).map_or(setup, |found| found.setup);
    leaned_at(&pinned.in_setup(&setup), placement, monitor).map_or(setup, |found| found.setup)
}

/// A plan segment by segment.
pub(super) fn plans_of(plan: &Plan, problem: &Problem) -> Vec<SegmentPlan> {
    let segments = problem.task.segments().iter().zip(&plan.postures);
    let travel = problem.travel_cost(Sense::Min);
    let of_segment = |(span, posture): (&Range<usize>, &Posture)| {
        let points = &plan.points[span.clone()];
        let costs = points.iter().map(|point| problem.point_cost(point.point, point.score));
        let joints: Vec<[f64; 6]> = points.iter().map(|point| point.joints).collect();
        SegmentPlan {
            points: span.clone(),
            posture: *posture,
            betas: unwrapped(points.iter().map(|point| point.beta)),
            cost: costs.fold(travel * joint_travel(&joints), |sum, cost| problem.criterion.aggregate.join(sum, cost)),
            joints,
        }
    };
    segments.map(of_segment).collect()
}

/// Angles that change by less than half a turn from one to the next. rad
fn unwrapped(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = Vec::new();
    for angle in angles {
        let before = all.last().copied().unwrap_or(angle);
        all.push(before + stead_model::robot::angles::wrap(angle - before));
    }
    all
}

/// A placement without the shift of the axes.
fn back(placement: &Placement, by: [f64; 3]) -> Placement {
    let Placement { x, y, z, yaw } = *placement;
    Placement { x: x - by[0], y: y - by[1], z: z - by[2], yaw }
}

/// What was found in a shifted cell, in the cell itself with the axes that shift it.
fn unshifted(mut outcome: Outcome, problem: &Problem, by: [f64; 3]) -> Outcome {
    for case in outcome.cases.all_mut() {
        case.placement = back(&case.placement, by);
        case.setup = problem.setup.clone();
        case.plan.axes = problem.axis_paths();
    }
    for refinement in &mut outcome.refinements {
        refinement.start = back(&refinement.start, by);
        refinement.end = back(&refinement.end, by);
    }
    outcome.set_basins.iter_mut().for_each(|basin| basin.placement = back(&basin.placement, by));
    if let Some(found) = &mut outcome.sensitivity {
        found.placement = back(&found.placement, by);
    }
    outcome
}
