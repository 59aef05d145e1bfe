//! One given placement.

use super::infeasible::{Infeasible, infeasible};
use super::notes::{self, cancellation};
use super::plan::{stated, worst_plan};
use crate::lean_map::LeanMap;
use crate::outcome::{Case, Cycle, Plan};
use crate::refine::planned;
use crate::setup_sheet::SetupSheet;
use stead_numerics::message::{Note, Warning};
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::redundancy::Planner;
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::{BySense, Sense};
use stead_problem::settings::TransferSettings;
use stead_problem::setup::Setup;

/// What one given placement is worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// The placement.
    pub placement: Placement,
    /// How part and external axes are set up for it.
    pub setup: Setup,
    /// The name of the orientation of the part, where the run says several.
    pub orientation: Option<String>,
    /// The best and the worst plan.
    pub plans: BySense<Plan>,
    /// Deflection over lead and tilt at a point of the best plan, where the tool may lean and that was made
    /// ([`Score::map_leans`]).
    pub lean_map: Option<LeanMap>,
    /// What a fitter needs to set it up, where that was made ([`Score::make_sheet`]).
    pub sheet: Option<SetupSheet>,
    /// What should be known about the result though nothing is wrong, in sentences.
    pub notes: Vec<Note>,
    /// Times of both plans.
    pub cycles: BySense<Cycle>,
    /// Whether the caller asked to stop before all that was wanted was there.
    pub interrupted: bool,
    /// Why the result may not be what was wanted.
    pub warnings: Vec<Warning>,
}

impl Score {
    /// Both plans as cases of one placement.
    pub fn cases(&self) -> BySense<Case> {
        BySense::from_fn(|plan_sense| Case {
            placement_sense: Sense::Min,
            plan_sense,
            placement: self.placement,
            setup: self.setup.clone(),
            orientation: self.orientation.clone(),
            plan: self.plans[plan_sense].clone(),
            cycle: self.cycles[plan_sense].clone(),
            active_bounds: None,
            objective_by_stiffness: None,
        })
    }

    /// Makes the map over lead and tilt, where the tool may lean. A stop may leave it out, which is then the warning
    /// that is returned.
    pub fn map_leans(&mut self, problem: &Problem, monitor: &Monitor) -> Option<Warning> {
        let (lean_map, left_out) = LeanMap::new(problem, &self.cases().best, monitor);
        self.lean_map = lean_map;
        left_out
    }

    /// Makes the setup sheet. A stop may leave out its tolerances, which is then the warning that is returned.
    pub fn make_sheet(&mut self, problem: &Problem, monitor: &Monitor) -> Option<Warning> {
        let sheet = SetupSheet::new(problem, &self.cases().best, monitor);
        self.sheet.insert(sheet).left_out()
    }
}

/// Plans one given placement, best and worst. The two plans are made even when the caller asks to stop, unless nothing
/// is wanted then ([`Monitor::for_all_or_nothing`]).
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
    let planner = Planner::finer(problem).unwanted_after(monitor.unwanted());
    let best = planned(&planner, placement, None, &mut planner.workspace());
    let worst = worst_plan(&planner, placement, None);
    let Some(best) = best.filter(|_| !planner.is_unwanted()) else {
        return Err(infeasible(&planner, placement, None, false, monitor));
    };
    // A placement with a best plan has a worst one too; in a narrow space the grid may miss it, and the best is both.
    let has_worst = worst.is_ok();
    let worst = worst.unwrap_or_else(|_| best.plans.clone());
    let cancelled = cancellation(problem, best.objective);
    let [best, worst] = [best.plans, worst].map(|plans| stated(problem, placement, transfer, &plans));
    let (plans, cycles) = (BySense { best: best.0, worst: worst.0 }, BySense { best: best.1, worst: worst.1 });
    let ends = notes::short_ends(problem, placement, "best plan", &plans.best);
    let warnings = cancelled
        .into_iter()
        .chain(notes::moves(&[("best plan", &cycles.best), ("worst plan", &cycles.worst)], ends))
        .collect();
    let mut notes = notes::of(problem, placement, &plans.best, &cycles.best.feed, monitor);
    notes.extend((!has_worst).then(notes::no_worst_plan));
    Ok(Score {
        placement: *placement,
        setup: problem.setup.clone(),
        orientation: problem.orientation().map(|orientation| orientation.name.clone()),
        notes,
        lean_map: None,
        sheet: None,
        plans,
        cycles,
        interrupted: monitor.should_stop(),
        warnings,
    })
}
