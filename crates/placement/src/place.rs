//! The placement job: search, refine, plan, map.

use super::candidate::{Candidate, Objective};
use super::criterion::Criterion;
use super::evaluate::reference::{scored_part_by_parameters, state};
use super::evaluator::Evaluator;
use super::feasibility::{Finding, deflection_map, diagnose};
use super::lookup::LookupTable;
use super::outcome::{
    CANCELLATION, Case, Cases, DeflectionFigures, LookupSummary, Outcome, Plan, PlanPoint, Refinement,
};
use super::problem::{Placement, Problem};
use super::redundancy::{Planner, SegmentPlan, off_grid};
use super::refine::{Solution, found_again, planned, refine};
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

/// Why a placement job has no result.
#[derive(Debug, Clone, PartialEq)]
pub struct Infeasible {
    /// The placement that comes nearest: of all tried the one with the fewest blocked points.
    pub placement: Placement,
    /// Whether it was the only one asked for, or the nearest of a search.
    pub searched: bool,
    /// Which constraint fails at which points there.
    pub findings: Vec<Finding>,
}

impl std::fmt::Display for Infeasible {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Placement { x, y, z, .. } = self.placement;
        if self.searched {
            write!(f, "no feasible placement was found; the nearest is")?;
        } else {
            write!(f, "nothing is feasible at")?;
        }
        write!(
            f,
            " x = {:.1} mm, y = {:.1} mm, z = {:.1} mm, Q4 = {:.4} (yaw {:.2} deg):",
            x * 1e3,
            y * 1e3,
            z * 1e3,
            self.placement.q4(),
            self.placement.yaw.to_degrees()
        )?;
        self.findings.iter().try_for_each(|finding| write!(f, "\n  {finding}"))?;
        if self.searched {
            write!(f, "\na search may miss a small feasible region: more population and generations look closer")?;
        }
        Ok(())
    }
}

impl std::error::Error for Infeasible {}

/// Finds the best and the worst placement, each with its best and its worst plan: the four cases of Caro 2013, Table III.
///
/// The result depends on the arguments alone, not on the number of threads. When `monitor` asks to stop, the search ends
/// with its present generation, refinement is left out, and [`Outcome::interrupted`] is set.
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
    let refused = || infeasible(&planner, &found[0].basins[0].placement, found[0].basins[0].scheme.as_deref(), true);
    let evaluator = Evaluator::new(&planner, table.as_ref()).with_finer_lookup(2);
    let (solutions, refinements) = refine_basins(&evaluator, &found, monitor).ok_or_else(refused)?;
    monitor.report(Progress::Steps { stage: "plans and maps", done: 0, total: 1 });
    let [best, worst] = &solutions;
    let case = |placement_sense, solution: &Refined, plan_sense| {
        let plans = match plan_sense {
            Sense::Min => Ok(solution.solution.plans.clone()),
            Sense::Max => worst_plan(&planner, &solution.solution.placement, solution.scheme.as_deref()),
        };
        // A placement with a best plan has a worst one too; should the two disagree on a limit, the best stands for both.
        let plans = plans.unwrap_or_else(|_| solution.solution.plans.clone());
        Case {
            placement_sense,
            plan_sense,
            placement: solution.solution.placement,
            plan: detailed(problem, &solution.solution.placement, &plans),
            cycle: cycle(problem, transfer, &plans),
        }
    };
    let mean = best.solution.objective;
    let interrupted = found.iter().any(|f| f.interrupted) || monitor.should_stop();
    Ok(Outcome {
        cases: Cases {
            best: case(Sense::Min, best, Sense::Min),
            best_worst_plan: case(Sense::Min, best, Sense::Max),
            worst: case(Sense::Max, worst, Sense::Min),
            worst_worst_plan: case(Sense::Max, worst, Sense::Max),
        },
        lookup_summary,
        convergence: found.iter().flat_map(|f| f.history.clone()).collect(),
        refinements,
        map_best: deflection_map(problem, &best.solution.placement),
        map_worst: deflection_map(problem, &worst.solution.placement),
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
            Objective::Infeasible { .. } => Err(infeasible(finer, &placement, None, false)),
        };
    }
    let planner = Planner::new(problem);
    let table = match settings.tables {
        LookupUse::Auto | LookupUse::Always => Some(LookupTable::new(problem)),
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
            search::evaluate_finer(finer, sense, &mut found.basins);
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
            return Err(infeasible(finer, &nearest.placement, nearest.scheme.as_deref(), true));
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
    /// Why the result may not be what was wanted.
    pub warnings: Vec<Warning>,
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

/// Plans one given placement, best and worst.
///
/// # Errors
/// [`Infeasible`] when it has no plan.
pub fn score(problem: &Problem, placement: &Placement) -> Result<Score, Infeasible> {
    let planner = Planner::finer(problem);
    let mut workspace = planner.workspace();
    let spacing = off_grid::Spacing::full(planner.grid());
    let (Some(best), Ok(worst)) =
        (planned(&planner, placement, None, spacing, &mut workspace), worst_plan(&planner, placement, None))
    else {
        return Err(infeasible(&planner, placement, None, false));
    };
    let warnings = cancellation(problem, best.objective).into_iter().collect();
    Ok(Score {
        placement: *placement,
        best: detailed(problem, placement, &best.plans),
        worst: detailed(problem, placement, &worst),
        warnings,
    })
}

/// A refined solution with the scheme it was held to.
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
    let run = |jobs: &[(Sense, usize, &Candidate)], of: usize| -> Vec<(Sense, Refined, Option<Refinement>)> {
        let refined = |(sense, _, candidate): &(Sense, usize, &Candidate)| {
            let refined = refine_one(evaluator, *sense, candidate, monitor);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            monitor.report(Progress::Steps { stage: "refining", done, total: of });
            refined.map(|(refined, report)| (*sense, refined, report))
        };
        jobs.par_iter().filter_map(refined).collect()
    };
    let (ahead, others): (Vec<_>, Vec<_>) = jobs.iter().copied().partition(|(_, rank, _)| *rank == 0);
    let mut results = run(&ahead, jobs.len());
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
    let others: Vec<_> = others.into_iter().filter(can_win).collect();
    let of = ahead.len() + others.len();
    results.extend(run(&others, of));
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
    let [Some(best), Some(worst)] = chosen else { return None };
    Some(([best, worst], refinements))
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
        let (solution, report) = refine(evaluator, placement, sense, scheme)?;
        (found_again(evaluator.planner(), solution, scheme), Some(report))
    };
    Some((Refined { solution, scheme: candidate.scheme.clone() }, report))
}

fn worst_plan(
    planner: &Planner<'_>,
    placement: &Placement,
    scheme: Option<&[Posture]>,
) -> Result<Vec<SegmentPlan>, super::redundancy::NoFeasiblePlan> {
    let spacing = off_grid::Spacing::full(planner.grid());
    planner.plan_fine(placement, Sense::Max, scheme, spacing, &mut planner.workspace())
}

fn infeasible(planner: &Planner<'_>, placement: &Placement, scheme: Option<&[Posture]>, searched: bool) -> Infeasible {
    let none = planner.plan(placement, Sense::Min, scheme, &mut planner.workspace());
    let findings = none.err().map(|none| diagnose(planner.problem(), placement, scheme, &none)).unwrap_or_default();
    Infeasible { placement: *placement, searched, findings }
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
