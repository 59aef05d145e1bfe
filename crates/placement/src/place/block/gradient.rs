//! The placement by the gradient: alone, its plan found anew, or together with betas, leads and tilts.

use crate::evaluator::Evaluator;
use crate::place::improver::{Improver, MOST_REFINED};
use crate::place::job::Planned;
use crate::refine::{refine, solver};
use stead_planning::redundancy::Planner;
use stead_planning::transfer_path::whole_lines;
use stead_problem::sense::Sense;
use stead_problem::setup::Setup;

/// The placement refined, axes and leans held.
pub(in crate::place) fn of_placement(job: &Improver<'_>, known: &Planned) -> Option<Planned> {
    if job.problem.cell.pinned().is_some() || job.problem.task.points().len() > MOST_REFINED {
        return None;
    }
    let set_up = job.problem.in_setup(&known.setup);
    let planner = Planner::finer(&set_up);
    let evaluator = Evaluator::new(&planner, None);
    let (solution, _) = refine(&evaluator, &known.solution.placement, Sense::Min, None, job.monitor)?;
    Some(Planned { solution, ..known.clone() })
}

/// Placement, betas, leads and tilts by the gradient in all of them.
pub(in crate::place) fn of_all(job: &Improver<'_>, known: &Planned) -> Option<Planned> {
    let set_up = job.problem.in_setup(&known.setup);
    if set_up.setup.leans.is_empty() || job.problem.task.points().len() > MOST_REFINED {
        return None;
    }
    let (run, leans) = solver::run_leaning(&set_up, &known.solution, solver::Ending::TIGHT, job.monitor);
    // In a narrow space what the gradient reaches may be no plan of the grid, from which it would be found again.
    let again = Planned::at(job.problem, Setup { leans, ..known.setup.clone() }, &run.solution.placement)?;
    if again.solution.objective >= known.solution.objective {
        return None;
    }
    let is_better = again.solution.objective < run.solution.objective;
    // The gradient knows nothing of the lines into the cut and out of it.
    let loses_lines = || {
        let leaning = job.problem.in_setup(&again.setup);
        again.solution.plans.iter().zip(&run.solution.plans).any(|(planned, reached)| {
            let planned = whole_lines(&leaning, &again.solution.placement, planned);
            let reached = whole_lines(&leaning, &run.solution.placement, reached);
            (planned[0] && !reached[0]) || (planned[1] && !reached[1])
        })
    };
    let is_planned = is_better || loses_lines();
    Some(if is_planned { again } else { Planned { solution: run.solution, ..again } })
}
