//! One run: a search or a given placement, and the stability of the cut along its plans.

use super::PathStability;
use stead_numerics::message::{Note, Warning};
use stead_numerics::monitor::Monitor;
use stead_placement::outcome::{Outcome, Plan};
use stead_placement::place::{self, Infeasible, Score};
use stead_problem::problem::Placement;
use stead_problem::setup::Setup;
use stead_runs::Run;
use stead_simulation::stability_analysis::StabilityError;

/// Why a run ends without a result.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// No placement, or not the given one, satisfies the constraints.
    #[error(transparent)]
    Infeasible(#[from] Infeasible),
    /// The stability of the cut cannot be computed.
    #[error(transparent)]
    Stability(#[from] StabilityError),
}

/// The best and the worst placement of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// The four cases, and how they were found.
    pub outcome: Outcome,
    /// Critical depths along case 1, and case 3 where there is one, where the run file asks for them.
    pub stability: Option<PathStability>,
}

/// A given placement of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Scored {
    /// Its best and its worst plan.
    pub score: Score,
    /// Critical depths along both plans, where the run file asks for them.
    pub stability: Option<PathStability>,
    /// What the user should know about the placement though it is not wrong, in sentences.
    pub notes: Vec<Note>,
}

/// Searches for the best and the worst placement, and makes their maps unless the run file does without. A stop that
/// the monitor asks for leaves the best found so far, without critical depths, and without maps of a long path.
///
/// # Errors
/// [`RunError`]: no placement met satisfies the constraints, or the arm says too little for the stability requested.
pub fn place(run: &Run, monitor: &Monitor) -> Result<Placed, RunError> {
    let mut outcome = place::place(&run.problem, &run.search, &run.transfer, monitor)?;
    if run.maps {
        outcome.map(&run.problem, monitor);
    }
    let optima = outcome.cases.optima();
    let plans: Vec<_> = optima.iter().map(|case| (&case.setup, &case.placement, &case.plan)).collect();
    let stability = stability(run, &plans, &mut outcome.warnings, monitor)?;
    outcome.interrupted |= monitor.should_stop();
    Ok(Placed { outcome, stability })
}

/// Plans a given placement, best and worst. A stop that the monitor asks for leaves out the critical depths.
///
/// # Errors
/// [`RunError`]: the placement has no plan, or the arm says too little for the stability requested.
pub fn score(run: &Run, placement: &Placement, monitor: &Monitor) -> Result<Scored, RunError> {
    let mut score = place::score(&run.problem, placement, &run.transfer, monitor)?;
    let setup = score.setup.clone();
    let plans = [(&setup, placement, &score.plans.best), (&setup, placement, &score.plans.worst)];
    let stability = stability(run, &plans, &mut score.warnings, monitor)?;
    score.interrupted = monitor.should_stop();
    let notes = outside_cell(run, placement).map(Note::may_be_wrong).into_iter().collect();
    Ok(Scored { score, stability, notes })
}

/// A placement outside the cell is evaluated all the same, but not silently.
pub fn outside_cell(run: &Run, placement: &Placement) -> Option<String> {
    let excess = run.problem.cell.excess(placement)?;
    Some(format!("this placement is outside the cell of the run file: {excess}"))
}

/// The critical depths along plans, where the run file asks for them; a stop leaves them out, which is then warned of.
fn stability(
    run: &Run,
    plans: &[(&Setup, &Placement, &Plan)],
    warnings: &mut Vec<Warning>,
    monitor: &Monitor,
) -> Result<Option<PathStability>, StabilityError> {
    let Some(analysis) = &run.path_stability else { return Ok(None) };
    let found = PathStability::along(&run.problem, analysis, plans, monitor)?;
    if found.is_none() {
        warnings.push(Warning::left_out("the critical depths along the path are"));
    }
    Ok(found)
}
