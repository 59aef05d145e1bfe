//! One given placement.

use super::infeasible::{Infeasible, infeasible};
use super::notes::{self, cancellation};
use super::plan::{detailed, worst_plan};
use crate::outcome::{Case, Cycle, Plan};
use crate::problem::{Placement, Problem};
use crate::redundancy::Planner;
use crate::refine::planned;
use crate::sense::Sense;
use crate::settings::TransferSettings;
use crate::setup::Setup;
use crate::transfer::cycle;
use stead_numerics::message::Warning;
use stead_numerics::monitor::{Monitor, Progress};

/// What one given placement is worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// The placement.
    pub placement: Placement,
    /// How part and external axes are set up for it.
    pub setup: Setup,
    /// The name of the orientation of the part, where the run says several.
    pub orientation: Option<String>,
    /// The best plan.
    pub best: Plan,
    /// The worst plan.
    pub worst: Plan,
    /// What should be known about the result though nothing is wrong, in sentences.
    pub notes: Vec<String>,
    /// Times of both plans.
    pub cycles: [Cycle; 2],
    /// Whether the caller asked to stop before all that was wanted was there.
    pub interrupted: bool,
    /// Why the result may not be what was wanted.
    pub warnings: Vec<Warning>,
}

impl Score {
    /// Both plans as cases of one placement.
    pub fn cases(&self) -> [Case; 2] {
        let [of_best, of_worst] = &self.cycles;
        let case = |plan_sense, plan: &Plan, cycle: &Cycle| Case {
            placement_sense: Sense::Min,
            plan_sense,
            placement: self.placement,
            setup: self.setup.clone(),
            orientation: self.orientation.clone(),
            plan: plan.clone(),
            cycle: cycle.clone(),
            active_bounds: None,
            objective_by_stiffness: None,
        };
        [case(Sense::Min, &self.best, of_best), case(Sense::Max, &self.worst, of_worst)]
    }
}

/// Plans one given placement, best and worst. The two plans are made even when the caller asks to stop.
///
/// # Errors
/// [`Infeasible`] when it has no plan.
pub fn score(
    problem: &Problem,
    placement: &Placement,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Score, Infeasible> {
    monitor.report(Progress::Steps { stage: "planning", done: 0, total: 1 });
    let planner = Planner::finer(problem);
    let best = planned(&planner, placement, None, &mut planner.workspace());
    let (Some(best), Ok(worst)) = (best, worst_plan(&planner, placement, None)) else {
        return Err(infeasible(&planner, placement, None, false, monitor));
    };
    let cancelled = cancellation(problem, best.objective);
    let plan = detailed(problem, placement, &best.plans);
    let cycles = [&best.plans, &worst].map(|plans| cycle(problem, placement, transfer, plans));
    let warnings =
        cancelled.into_iter().chain(notes::moves(&[("best plan", &cycles[0]), ("worst plan", &cycles[1])])).collect();
    Ok(Score {
        placement: *placement,
        setup: problem.setup.clone(),
        orientation: problem.orientation().map(|orientation| orientation.name.clone()),
        notes: notes::of(problem, placement, (&plan, &cycles[0].feed), monitor),
        best: plan,
        worst: detailed(problem, placement, &worst),
        cycles,
        interrupted: monitor.should_stop(),
        warnings,
    })
}
