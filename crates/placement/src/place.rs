//! The placement job: search, refine, plan, map.

use super::candidate::{Candidate, Objective};
use super::criterion::Criterion;
use super::evaluate::reference::{scored_part_by_parameters, state};
use super::evaluator::Evaluator;
use super::lookup::LookupTable;
use super::outcome::{
    CANCELLATION, Case, Cases, Cycle, DeflectionFigures, LookupSummary, Outcome, Plan, PlanPoint, Refinement,
};
use super::problem::{Placement, Problem};
use super::redundancy::{NoFeasiblePlan, Planner, SegmentPlan, off_grid};
use super::refine::{Solution, planned, refine};
use super::search::{self, SearchResult};
use super::sense::Sense;
use super::settings::{LookupUse, SearchSettings, TransferSettings};
use super::symmetry::Unsupported;
use super::transfer::cycle;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_model::robot::{Posture, angles::wrap};
use stead_numerics::mean_max::percentile;
use stead_numerics::message::Warning;
use stead_numerics::monitor::{Monitor, Progress};

mod infeasible;

pub use infeasible::Infeasible;
use infeasible::infeasible;

/// Finds the best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table III.
///
/// The result depends on the arguments alone, not on the number of threads. When `monitor` asks to stop, every stage ends with what
/// it has, only the plans of the best and the worst placement are still made, and [`Outcome::interrupted`] is set. Maps are not
/// made here: see [`Outcome::map`].
///
/// # Errors
/// [`Infeasible`] when the search met no feasible placement.
pub fn place(
    problem: &Problem,
    settings: &SearchSettings,
    transfer: &TransferSettings,
    monitor: &Monitor,
) -> Result<Outcome, Infeasible> {
    let planner = Planner::finer(problem);
    let Searched { found, table, lookup_summary, evaluations } = search_cell(&planner, settings, monitor)?;
    let refused = || {
        let nearest = &found[0].basins[0];
        infeasible(&planner, &nearest.placement, nearest.scheme.as_deref(), true, monitor)
    };
    let evaluator = Evaluator::new(&planner, table.as_ref()).with_finer_lookup(2);
    let (solutions, refinements) = refine_basins(&evaluator, &found, monitor).ok_or_else(refused)?;
    monitor.report(Progress::Steps { stage: "plans and maps", done: 0, total: 1 });
    let [best, worst] = &solutions;
    let worst_plan_of =
        |refined: &Refined| worst_plan(&planner, &refined.solution.placement, refined.scheme.as_deref());
    let (of_best, of_worst) = rayon::join(|| worst_plan_of(best), || worst_plan_of(worst));
    let case = |placement_sense, solution: &Refined, plan_sense, worst: &Result<Vec<SegmentPlan>, NoFeasiblePlan>| {
        let best = &solution.solution.plans;
        let plans = match plan_sense {
            Sense::Min => best,
            // A placement with a best plan has a worst one too; should the two disagree on a limit, the best stands for both.
            Sense::Max => worst.as_ref().unwrap_or(best),
        };
        Case {
            placement_sense,
            plan_sense,
            placement: solution.solution.placement,
            plan: detailed(problem, &solution.solution.placement, plans),
            cycle: cycle(problem, transfer, plans),
        }
    };
    let mean = best.solution.objective;
    let interrupted = found.iter().any(|f| f.interrupted) || monitor.should_stop();
    Ok(Outcome {
        cases: Cases {
            best: case(Sense::Min, best, Sense::Min, &of_best),
            best_worst_plan: case(Sense::Min, best, Sense::Max, &of_best),
            worst: case(Sense::Max, worst, Sense::Min, &of_worst),
            worst_worst_plan: case(Sense::Max, worst, Sense::Max, &of_worst),
        },
        lookup_summary,
        convergence: found.iter().flat_map(|f| f.history.clone()).collect(),
        refinements,
        maps: None,
        evaluations,
        states: evaluations * problem.task.points().len() * problem.redundancy.beta_count,
        interrupted,
        warnings: cancellation(problem, mean).into_iter().chain(interrupted.then(interruption)).collect(),
    })
}

/// What the searches of both senses come to.
struct Searched<'a> {
    found: [SearchResult; 2],
    table: Option<LookupTable<'a>>,
    lookup_summary: Option<Result<LookupSummary, Unsupported>>,
    evaluations: usize,
}

/// Searches for the best and the worst placement on the coarse grid; a planner on the finer one, `finer`, has the last word on
/// what is feasible.
fn search_cell<'a>(
    finer: &Planner<'a>,
    settings: &SearchSettings,
    monitor: &Monitor,
) -> Result<Searched<'a>, Infeasible> {
    let problem = finer.problem();
    if let Some(placement) = problem.cell.pinned() {
        let found = Sense::BOTH.map(|sense| search::pinned(finer, placement, sense));
        return match found[0].basins[0].objective {
            Objective::Feasible(_) => Ok(Searched { found, table: None, lookup_summary: None, evaluations: 1 }),
            Objective::Infeasible { .. } => Err(infeasible(finer, &placement, None, false, monitor)),
        };
    }
    let planner = Planner::new(problem);
    let table = match settings.tables {
        LookupUse::Auto | LookupUse::Always => Some(LookupTable::monitored(problem, monitor)),
        LookupUse::Never => None,
    };
    let mut lookup_summary = table.as_ref().map(|table| match table {
        Ok(table) => Ok(LookupSummary { shape: *table.shape(), accuracy: table.accuracy() }),
        Err(unsuited) => Err(unsuited.clone()),
    });
    let mut table = table.and_then(Result::ok);
    let search = |table: Option<&LookupTable<'_>>| {
        let evaluator = Evaluator::new(&planner, table).with_finer_planner(finer);
        Sense::BOTH.map(|sense| search::search(&evaluator, settings, sense, monitor))
    };
    let mut found = search(table.as_ref());
    let mut evaluations = found.iter().map(|f| f.evaluations).sum::<usize>();
    if found.iter().any(|f| f.lookup_rejected && !f.interrupted) && !monitor.should_stop() {
        (table, lookup_summary) = (None, Some(Err(Unsupported::Rejected)));
        found = search(None);
        evaluations += found.iter().map(|f| f.evaluations).sum::<usize>();
    }
    let is_feasible = |f: &SearchResult| f.basins.first().is_some_and(|i| i.objective.mean().is_some());
    if !found.iter().any(is_feasible) {
        evaluations += found.iter().map(|f| f.basins.len()).sum::<usize>();
        for (sense, found) in Sense::BOTH.into_iter().zip(&mut found) {
            search::evaluate_finer(finer, sense, &mut found.basins, monitor);
            found.basins.truncate(settings.basins);
        }
    }
    // A search that met nothing feasible goes on from what the other met.
    match found.each_ref().map(is_feasible) {
        [true, true] => {}
        [true, false] => found[1].basins = found[0].basins.clone(),
        [false, true] => found[0].basins = found[1].basins.clone(),
        [false, false] => {
            let nearest = &found[0].basins[0];
            return Err(infeasible(finer, &nearest.placement, nearest.scheme.as_deref(), true, monitor));
        }
    }
    Ok(Searched { found, table, lookup_summary, evaluations })
}

/// What one given placement is worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// The placement.
    pub placement: Placement,
    /// The best plan.
    pub best: Plan,
    /// The worst plan.
    pub worst: Plan,
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
            plan: plan.clone(),
            cycle: cycle.clone(),
        };
        [case(Sense::Min, &self.best, of_best), case(Sense::Max, &self.worst, of_worst)]
    }
}

/// Warns of a plan that balances the deflection to nothing: a result of the criterion, not of the robot.
fn cancellation(problem: &Problem, mean: f64) -> Option<Warning> {
    (mean <= CANCELLATION && problem.criterion == Criterion::default()).then(|| {
        let message = "the best plan cancels the deflection to nothing, which no real force will; \
                       criterion.force_uncertainty makes the score the worst case over force errors";
        Warning::new("cancellation", message)
    })
}

fn interruption() -> Warning {
    Warning::new("interrupted", "interrupted: the results are the best found so far, not the end of the search")
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
    let spacing = off_grid::Spacing::full(planner.grid());
    let best = planned(&planner, placement, None, spacing, &mut planner.workspace());
    let (Some(best), Ok(worst)) = (best, worst_plan(&planner, placement, None)) else {
        return Err(infeasible(&planner, placement, None, false, monitor));
    };
    let warnings = cancellation(problem, best.objective).into_iter().collect();
    Ok(Score {
        placement: *placement,
        best: detailed(problem, placement, &best.plans),
        worst: detailed(problem, placement, &worst),
        cycles: [&best.plans, &worst].map(|plans| cycle(problem, transfer, plans)),
        interrupted: monitor.should_stop(),
        warnings,
    })
}

/// A refined solution with the scheme it was held to.
#[derive(Clone)]
struct Refined {
    solution: Solution,
    scheme: Option<Vec<Posture>>,
}

/// Basins whose means differ by less than this (relative) are equal: the one that the search ranked higher is taken, so
/// that rounding does not choose between mirror images.
const TIE: f64 = 1e-5;

/// A basin whose mean after the search is this much (relative) behind the best one refined is left alone, where both were
/// improved on a lookup table: refinement gains less from there.
const MAX_DEFICIT: f64 = 0.03;

/// Refines the basins of both searches side by side, and takes the best and the worst of what comes out; `None`
/// when nothing feasible went in. The first basin of each search goes ahead, to tell which of the others can still win.
fn refine_basins(
    evaluator: &Evaluator<'_>,
    found: &[SearchResult; 2],
    monitor: &Monitor,
) -> Option<([Refined; 2], Vec<Refinement>)> {
    let jobs: Vec<(Sense, usize, &Candidate)> = Sense::BOTH
        .into_iter()
        .zip(found)
        .flat_map(|(sense, f)| f.basins.iter().enumerate().map(move |(rank, candidate)| (sense, rank, candidate)))
        .collect();
    let done = AtomicUsize::new(0);
    let run = |jobs: &[(Sense, usize, &Candidate)], of: usize, known: &[Sense]| -> Vec<(Sense, Refined, Option<Refinement>)> {
        let refined = |(sense, rank, candidate): &(Sense, usize, &Candidate)| {
            if *rank > 0 && monitor.should_stop() && known.contains(sense) {
                return None;
            }
            let refined = refine_one(evaluator, *sense, candidate, monitor);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            monitor.report(Progress::Steps { stage: "refining", done, total: of });
            refined.map(|(refined, report)| (*sense, refined, report))
        };
        jobs.par_iter().filter_map(refined).collect()
    };
    let (ahead, others): (Vec<_>, Vec<_>) = jobs.iter().copied().partition(|(_, rank, _)| *rank == 0);
    let mut results = run(&ahead, jobs.len(), &[]);
    let known: Vec<Sense> = results.iter().map(|(sense, ..)| *sense).collect();
    let can_win = |(sense, _, candidate): &(Sense, usize, &Candidate)| {
        let first = results.iter().find(|(known, ..)| known == sense).map(|(_, refined, _)| refined.solution.objective);
        match (evaluator.table(), first, candidate.objective.mean()) {
            (Some(_), Some(first), Some(mean)) => match sense {
                Sense::Min => mean * (1.0 - MAX_DEFICIT) < first,
                Sense::Max => mean * (1.0 + MAX_DEFICIT) > first,
            },
            _ => true,
        }
    };
    // Once the caller asks to stop, other basins are only for a search whose first one has no plan.
    let is_wanted = |job: &(Sense, usize, &Candidate)| can_win(job) && !(monitor.should_stop() && known.contains(&job.0));
    let others: Vec<_> = others.into_iter().filter(is_wanted).collect();
    let of = ahead.len() + others.len();
    results.extend(run(&others, of, &known));
    // In the order of the searches: a stable sort.
    results.sort_by_key(|(sense, ..)| usize::from(*sense == Sense::Max));
    let mut refinements = Vec::new();
    let mut chosen: [Option<Refined>; 2] = [None, None];
    for (sense, refined, report) in results {
        refinements.extend(report);
        let slot = &mut chosen[usize::from(sense == Sense::Max)];
        let better = slot.as_ref().is_none_or(|known| match sense {
            Sense::Min => refined.solution.objective < known.solution.objective * (1.0 - TIE),
            Sense::Max => refined.solution.objective > known.solution.objective * (1.0 + TIE),
        });
        if better {
            *slot = Some(refined);
        }
    }
    match chosen {
        [Some(best), Some(worst)] => Some(([best, worst], refinements)),
        // A search whose basins have no plan on the finer grid takes the other's.
        [Some(only), None] | [None, Some(only)] => Some(([only.clone(), only], refinements)),
        [None, None] => None,
    }
}

/// Refines one basin, or only plans it where the job is to stop.
fn refine_one(
    evaluator: &Evaluator<'_>,
    sense: Sense,
    candidate: &Candidate,
    monitor: &Monitor,
) -> Option<(Refined, Option<Refinement>)> {
    let (placement, scheme) = (&candidate.placement, candidate.scheme.as_deref());
    let (solution, report) = if monitor.should_stop() {
        let planner = evaluator.planner();
        let spacing = off_grid::Spacing::full(planner.grid());
        (planned(planner, placement, scheme, spacing, &mut planner.workspace())?, None)
    } else {
        let (solution, report) = refine(evaluator, placement, sense, scheme, monitor)?;
        (solution, Some(report))
    };
    Some((Refined { solution, scheme: candidate.scheme.clone() }, report))
}

fn worst_plan(
    planner: &Planner<'_>,
    placement: &Placement,
    scheme: Option<&[Posture]>,
) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
    let spacing = off_grid::Spacing::full(planner.grid());
    planner.plan_fine(placement, Sense::Max, scheme, spacing, &mut planner.workspace())
}

/// A plan with everything that there is to say of each point, from the reference evaluator.
fn detailed(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> Plan {
    let mut points = Vec::with_capacity(problem.task.points().len());
    let known = problem.robot.uncertainty();
    let mut slopes = vec![0.0; known.map_or(0, |known| known.parameters().len())];
    for (segment, plan) in plans.iter().enumerate() {
        for (place, point) in plan.points.clone().enumerate() {
            let Ok(s) = state(problem, point, placement, plan.betas[place], plan.posture) else { continue };
            let placed = problem.placed(point, placement);
            let sign = if s.scored < 0.0 { -1.0 } else { 1.0 };
            for (sum, slope) in slopes.iter_mut().zip(scored_part_by_parameters(problem, point, placement, &s.joints)) {
                *sum += sign * slope;
            }
            points.push(PlanPoint {
                point,
                segment: segment + 1,
                position: placed.tip,
                beta: wrap(plan.betas[place]),
                posture: plan.posture,
                joints: plan.joints[place],
                inverse_condition: s.inverse_condition,
                force: placed.force,
                deflection: s.deflection,
                feed_part: s.feed_part,
                normal_part: s.normal_part,
                axial_part: s.axial_part,
                surface_part: s.surface_part,
                score: s.score(),
                deviation: s.deviation,
            });
        }
    }
    Plan {
        postures: plans.iter().map(|plan| plan.posture).collect(),
        objective: problem.objective(points.iter().map(|p| problem.point_cost(p.point, p.score))),
        mean: points.iter().map(|p| p.score).sum::<f64>() / points.len() as f64,
        max: points.iter().map(|p| p.score).fold(0.0, f64::max),
        percentiles: [0.5, 0.95].map(|share| percentile(points.iter().map(|p| p.score), share)),
        deflection: DeflectionFigures::of(&points),
        mean_deviation: known.map(|known| known.standard_deviation(&slopes) / points.len() as f64),
        points,
    }
}

#[cfg(test)]
mod tests;
