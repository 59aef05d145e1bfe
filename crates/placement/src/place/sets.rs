//! What each stiffness set of the criterion makes of the refined basins.

use super::basins::{leading, of_best, refine_basins};
use super::job::Planned;
use super::long_path::LongPath;
use super::plan::detailed;
use crate::evaluator::Evaluator;
use crate::outcome::{Plan, SetBasin, SetOutcome};
use crate::sensitivity::mean_by;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::candidate::Candidate;
use stead_problem::criterion::Over;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;

/// The stiffness sets of a criterion, each with what is best for it alone.
#[derive(Default)]
pub(super) struct Sets {
    /// The problem with one set alone, and the mean score of its best placement. m
    alone: Vec<(Problem, Option<f64>)>,
    /// Every refined basin of the best placement.
    pub basins: Vec<SetBasin>,
    is_by_regret: bool,
}

impl Sets {
    /// Refines the basins of the best placement, `found`, for each set alone, and holds those refined for all sets
    /// together, `refined`, against it. Nothing where the criterion has no sets, or once the caller asks to stop.
    pub fn of(
        problem: &Problem,
        found: &[Candidate],
        long: Option<&LongPath>,
        refined: &[Planned],
        monitor: &Monitor,
    ) -> Self {
        let Some(stiffness) = problem.criterion.stiffness.as_ref().filter(|_| !monitor.should_stop()) else {
            return Self::default();
        };
        let basins = of_best(found.to_vec());
        let alone = |set| {
            let alone = problem.with_stiffness_alone(set);
            let planner = Planner::finer(&alone);
            let refined = refine_basins(&Evaluator::new(&planner, None), long, &basins, monitor).0.best;
            let best = leading(Sense::Min, &refined).map(|Planned { solution, .. }| {
                mean_by(&alone, &solution.placement, &detailed(&alone, &solution.placement, &solution.plans))
            });
            (alone, best)
        };
        let alone = stiffness.robots.iter().map(alone).collect();
        if monitor.should_stop() {
            return Self::default();
        }
        let mut sets = Self { alone, is_by_regret: stiffness.over == Over::Regret, basins: Vec::new() };
        sets.basins = refined.iter().map(|refined| sets.basin(problem, refined)).collect();
        sets
    }

    fn basin(&self, problem: &Problem, planned: &Planned) -> SetBasin {
        let solution = &planned.solution;
        let plan = detailed(problem, &solution.placement, &solution.plans);
        let regrets = self.alone.iter().filter_map(|(alone, best)| {
            SetOutcome { mean: mean_by(alone, &solution.placement, &plan), alone: *best }.regret()
        });
        SetBasin { placement: solution.placement, objective: solution.objective, regret: regrets.reduce(f64::max) }
    }

    /// The largest regret of each basin, where that decides.
    pub fn regrets(&self) -> Option<Vec<Option<f64>>> {
        self.is_by_regret.then(|| self.basins.iter().map(|basin| basin.regret).collect())
    }

    /// What each set makes of a plan at a placement of the problem.
    pub fn outcomes(&self, placement: &Placement, plan: &Plan) -> Vec<SetOutcome> {
        let outcome = |(alone, of_best): &(Problem, Option<f64>)| SetOutcome {
            mean: mean_by(alone, placement, plan),
            alone: *of_best,
        };
        self.alone.iter().map(outcome).collect()
    }
}
