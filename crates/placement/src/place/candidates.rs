//! The candidates: the best and the worst placement as search and refinement find them, in which orientation the part
//! lies, where the external axes stand.
//!
//! Every orientation, and in it a grid of positions of each axis in turn, is searched with the same settings; the best
//! and the worst of all are kept. Then the axes of the best are improved ([`super::descent`]).

use super::basins::{choose, refine_basins};
use super::block::axis::GRID;
use super::descent::Descent;
use super::found::{Found, Record};
use super::improver::Improver;
use super::infeasible::{Infeasible, infeasible};
use super::job::{Job, Planned, shifted_back};
use super::lean::leaned_at;
use super::long_path::LongPath;
use super::plan::stated_objective;
use super::searched::{Searched, search_cell};
use super::sets::Sets;
use crate::evaluator::Evaluator;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::problem::{Cell, Placement, Problem};
use stead_problem::setup::{AxisPositions, Setup, TriedSetup};

/// Finds the best and the worst placement over all setups.
///
/// # Errors
/// [`Infeasible`] when no setup met has a feasible placement: why the first has none.
pub(super) fn candidates(job: &Job<'_>) -> Result<Found, Infeasible> {
    let problem = job.problem;
    if problem.orientations.len() < 2 && problem.external_axes.is_empty() {
        return job.search(&problem.setup);
    }
    let mut all = Setups::default();
    for orientation in 0..problem.orientations.len().max(1) {
        if orientation > 0 && job.monitor.should_stop() {
            break;
        }
        job.search_axes(Setup { orientation, ..Setup::at_rest(&problem.external_axes) }, &mut all);
    }
    all.found(job)
}

/// What was found in the setups so far.
#[derive(Default)]
struct Setups {
    best: Option<(f64, Found)>,
    worst: Option<(f64, Planned)>,
    tried: Vec<TriedSetup>,
    refused: Option<Infeasible>,
    evaluations: usize,
    states: usize,
}

impl Setups {
    /// Takes in what a search in a setup has come to; its best objective, where it found something. m
    fn add(&mut self, job: &Job<'_>, setup: &Setup, found: Result<Found, Infeasible>) -> Option<f64> {
        let tried = |objectives| TriedSetup { setup: setup.clone(), objectives };
        let mut found = match found {
            Ok(found) => found,
            Err(refused) => {
                self.tried.push(tried(None));
                self.refused.get_or_insert(refused);
                return None;
            }
        };
        let best = stated_objective(job, &found.best);
        let worst = found.worst.take().map(|worst| (stated_objective(job, &worst), worst));
        self.tried.push(tried(Some((best, worst.as_ref().map(|(objective, _)| *objective)))));
        self.evaluations += found.record.evaluations;
        self.states += found.record.states;
        if let Some(worst) = worst
            && self.worst.as_ref().is_none_or(|known| worst.0 > known.0)
        {
            self.worst = Some(worst);
        }
        if self.best.as_ref().is_none_or(|known| best < known.0) {
            self.best = Some((best, found));
        }
        Some(best)
    }

    /// The best and the worst of all.
    fn found(self, job: &Job<'_>) -> Result<Found, Infeasible> {
        let Self { best, worst, tried, refused, evaluations, states } = self;
        let Some((_, mut found)) = best else {
            let nothing = || Infeasible::unexplained(Placement::from([0.0; 4]), job.monitor);
            return Err(refused.unwrap_or_else(nothing));
        };
        found.worst = worst.map(|(_, worst)| worst);
        found.record = Record { tried, evaluations, states, ..found.record };
        Ok(found)
    }
}

impl Job<'_> {
    /// Searches in a setup, then with each axis at other places of its range in turn.
    fn search_axes(&self, mut setup: Setup, all: &mut Setups) {
        let mut least = all.add(self, &setup, self.search(&setup));
        for (number, axis) in self.problem.external_axes.iter().enumerate() {
            let AxisPositions::Same(start) = setup.positions.clone() else { return };
            let mut chosen = start.clone();
            for position in axis.grid(GRID) {
                if position == start[number] || self.monitor.should_stop() {
                    continue;
                }
                let mut positions = start.clone();
                positions[number] = position;
                let setup = Setup { positions: AxisPositions::Same(positions.clone()), ..setup.clone() };
                let objective = all.add(self, &setup, self.search(&setup));
                if let Some(objective) = objective
                    && least.is_none_or(|least| objective < least)
                {
                    (least, chosen) = (Some(objective), positions);
                }
            }
            setup.positions = AxisPositions::Same(chosen);
        }
    }

    /// The search in one setup; where the axes only shift the cell, without them in the shifted cell.
    fn search(&self, setup: &Setup) -> Result<Found, Infeasible> {
        let set_up = self.without_tie_rule.in_setup(setup);
        let Some((shifted, shift)) = set_up.without_shifting_axes() else { return self.search_problem(&set_up) };
        let back = |placement: &mut Placement| *placement = shifted_back(placement, Some(shift));
        let mut found = self.search_problem(&shifted).map_err(|mut refused| {
            back(&mut refused.placement);
            refused
        })?;
        for at in std::iter::once(&mut found.best).chain(&mut found.worst) {
            (at.setup, at.shift) = (setup.clone(), Some(shift));
        }
        found.record.refinements.iter_mut().flat_map(|one| [&mut one.start, &mut one.end]).for_each(back);
        found.record.sets.basins.iter_mut().for_each(|basin| back(&mut basin.placement));
        Ok(found)
    }

    /// The search in the setup of a problem without a tie rule.
    fn search_problem(&self, problem: &Problem) -> Result<Found, Infeasible> {
        let (settings, monitor) = (self.settings, self.monitor);
        let planner = Planner::finer(problem);
        let mut long = LongPath::new(&planner, settings, monitor);
        let Searched { found, table, lookup_summary, evaluations } = match &mut long {
            Some(path) => path.search(&planner, settings, monitor)?,
            None => search_cell(&planner, settings, monitor)?,
        };
        let evaluator = Evaluator::new(&planner, table.as_ref()).with_finer_lookup(2);
        let (basins, refinements) = refine_basins(&evaluator, long.as_ref(), &found, monitor);
        let sets = Sets::of(problem, &found.best.basins, long.as_ref(), &basins.best, monitor);
        let Some((best, worst)) = choose(&basins, sets.regrets().as_deref(), settings) else {
            let nearest = &found.best.basins[0];
            return Err(infeasible(&planner, &nearest.placement, nearest.scheme.as_deref(), true, monitor));
        };
        let points = long.as_ref().map_or(problem.task.points().len(), |path| path.levels.search.points);
        let record = Record {
            sets,
            tried: Vec::new(),
            lookup_summary,
            convergence: found.values().into_iter().flat_map(|found| found.history.clone()).collect(),
            refinements,
            evaluations,
            states: evaluations * points * problem.redundancy.beta_count,
            interrupted: found.values().iter().any(|found| found.interrupted) || monitor.should_stop(),
            basins: found.best.basins,
            long,
        };
        Ok(Found { best, worst, record, upright: None, is_improved: false })
    }
}

/// Improves the external axes of the best placement.
pub(super) fn with_axes(job: &Job<'_>, mut found: Found) -> Found {
    if job.monitor.should_stop() || !job.problem.external_axes.iter().any(|axis| axis.max > axis.min) {
        return found;
    }
    let problem = job.without_tie_rule.in_setup(&found.best.setup);
    let known = found.best.clone().with_its_axes();
    let planned = Planned::at(&problem, problem.setup.clone(), &known.solution.placement);
    let start = planned.map_or_else(|| known.clone(), |planned| known.clone().better(planned));
    let before = start.solution.objective;
    let improver = Improver { problem: &problem, space: None, monitor: job.monitor };
    let best = Descent::of_axes(&problem).run(&improver, start);
    if best.solution.objective < before {
        (found.best, found.is_improved) = (best, true);
    }
    found
}

/// The setup in which a given placement is best, the part as it lies in the problem's: each axis first on a grid over
/// its range, then improved; then the tool leans where it may. The problem's own where no position that is tried has a
/// plan.
pub fn setup_at(problem: &Problem, placement: &Placement, monitor: &Monitor) -> Setup {
    let pinned = problem.without_tie_rule().in_cell(Cell::at(placement));
    let at = |setup: Setup| Planned::at(&pinned, setup, placement);
    let (mut setup, mut best) = (problem.setup.clone(), at(problem.setup.clone()));
    for (number, axis) in problem.external_axes.iter().enumerate() {
        let AxisPositions::Same(start) = setup.positions.clone() else { break };
        for position in axis.grid(GRID) {
            if monitor.should_stop() {
                break;
            }
            let mut positions = start.clone();
            positions[number] = position;
            if let Some(found) = at(Setup { positions: AxisPositions::Same(positions), ..setup.clone() })
                && best.as_ref().is_none_or(|known| found.solution.objective < known.solution.objective)
            {
                setup = found.setup.clone();
                best = Some(found);
            }
        }
    }
    let set_up = pinned.in_setup(&setup);
    let improver = Improver { problem: &set_up, space: None, monitor };
    let setup = best.map_or(setup, |start| Descent::of_axes(&set_up).run(&improver, start).setup);
    leaned_at(&pinned.in_setup(&setup), placement, monitor).map_or(setup, |found| found.setup)
}
