//! Plans with everything that there is to say of them.

use super::job::{Job, Planned};
use crate::outcome::{AtHeldFeed, Cycle, DeflectionFigures, Plan, PlanPoint};
use crate::refine::planned;
use crate::sag::Sag;
use std::ops::Range;
use stead_model::robot::{Posture, angles::wrap};
use stead_numerics::mean_max::percentile;
use stead_numerics::monitor::Monitor;
use stead_planning::feed::CutFeed;
use stead_planning::redundancy::{NoFeasiblePlan, Planner, SegmentPlan};
use stead_planning::transfer::cycle;
use stead_problem::collision::PlanClearance;
use stead_problem::evaluate::reference::{ScoredByOrigin, scored_by_origin, scored_part_by_parameters};
use stead_problem::joint_travel::{JointTravel, joint_travel};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::Sense;
use stead_problem::settings::TransferSettings;

/// What is stated at a refined placement: its best plan, or one within the tie whose moves are shorter, and its worst.
pub(super) struct StatedPlans {
    pub best: Vec<SegmentPlan>,
    pub worst: Vec<SegmentPlan>,
}

impl StatedPlans {
    /// Plans a placement that was found.
    pub fn of(planner: &Planner<'_>, found: &Planned, monitor: &Monitor) -> Self {
        let worst = || worst_plan(planner, &found.solution.placement, found.scheme.as_deref());
        let (best, worst) = rayon::join(|| Self::best(planner, found, monitor), worst);
        // A placement with a best plan has a worst one too; should the two disagree on a limit, the best stands for
        // both.
        Self { worst: worst.unwrap_or_else(|_| best.clone()), best }
    }

    /// The best plan; once the caller asks to stop, the one that was found.
    pub fn best(planner: &Planner<'_>, found: &Planned, monitor: &Monitor) -> Vec<SegmentPlan> {
        let Planned { solution, scheme, .. } = found;
        let tie = planner.problem().postures.tie;
        let within_tie = || {
            if tie == 0.0 || monitor.should_stop() {
                return None;
            }
            let found = planned(planner, &solution.placement, scheme.as_deref(), &mut planner.workspace());
            found.filter(|found| found.objective <= solution.objective * (1.0 + tie + ROUNDING))
        };
        within_tie().map_or_else(|| solution.plans.clone(), |found| found.plans)
    }
}

/// The objective of the plan that would be stated of a placement. m
pub(super) fn stated_objective(job: &Job<'_>, found: &Planned) -> f64 {
    let problem = found.problem(job.problem);
    let plans = StatedPlans::best(&Planner::finer(&problem), found, job.monitor);
    detailed(&problem, &found.solution.placement, &plans).objective
}

/// Objectives that differ by less (relative) are the same.
const ROUNDING: f64 = 1e-9;

/// The worst plan at a placement.
pub(super) fn worst_plan(
    planner: &Planner<'_>,
    placement: &Placement,
    scheme: Option<&[Posture]>,
) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
    planner.plan_fine(placement, Sense::Max, scheme, &mut planner.workspace())
}

/// A plan with its times, and what it comes to at the feed that the arm holds.
pub(super) fn stated(
    problem: &Problem,
    placement: &Placement,
    transfer: &TransferSettings,
    plans: &[SegmentPlan],
) -> (Plan, Cycle) {
    let cycle = cycle(problem, placement, transfer, plans);
    let mut plan = detailed(problem, placement, plans);
    plan.held = at_held_feed(problem, placement, plans, &plan, &cycle.feed);
    (plan, cycle)
}

/// A plan with the forces of the feed that the arm holds, where it is known how they change with the feed.
fn at_held_feed(
    problem: &Problem,
    placement: &Placement,
    plans: &[SegmentPlan],
    programmed: &Plan,
    feed: &CutFeed,
) -> Option<AtHeldFeed> {
    if !problem.task.has_edge_parts() {
        return None;
    }
    let of = |plan: &Plan| {
        let (mean, max, deflection) = (plan.mean, plan.max, plan.deflection);
        AtHeldFeed { slowed: feed.slowed(), mean, max, deflection }
    };
    if feed.slowed() == 0 {
        return Some(of(programmed));
    }
    problem
        .at_feed(|segment, programmed| feed.share(segment, programmed))
        .map(|slower| of(&detailed(&slower, placement, plans)))
}

/// A plan with everything that there is to say of each point, from the reference evaluator.
pub(super) fn detailed(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> Plan {
    let mut points = Vec::with_capacity(problem.task.points().len());
    let known = problem.robot.uncertainty();
    let mut slopes = vec![0.0; known.map_or(0, |known| known.parameters().len())];
    for (segment, plan) in plans.iter().enumerate() {
        for (place, point) in plan.points.clone().enumerate() {
            let Ok(s) = problem.at(placement).state(point, plan.betas[place], plan.posture) else { continue };
            let placed = problem.placed(point, placement);
            let sign = if s.own.scored < 0.0 { -1.0 } else { 1.0 };
            for (sum, slope) in slopes.iter_mut().zip(scored_part_by_parameters(problem, point, placement, &s.joints)) {
                *sum += sign * slope;
            }
            points.push(PlanPoint {
                point,
                segment: segment + 1,
                position: placed.tip,
                beta: wrap(plan.betas[place]),
                posture: plan.posture,
                posture_words: problem.robot.posture_words(plan.posture),
                joints: plan.joints[place],
                inverse_condition: s.inverse_condition,
                force: placed.force,
                deflection: s.deflection,
                feed_part: s.feed_part,
                normal_part: s.normal_part,
                axial_part: s.axial_part,
                surface_part: s.surface_part,
                score: s.score(),
                deviation: s.own.deviation,
                by_origin: problem.yields_beside().then(|| scored_by_origin(problem, point, placement, &s.joints)),
                clearance: problem.state_clearance(point, placement, &plan.joints[place]),
                lean: problem.task.path().leans().map(|leans| leans[point]),
            });
        }
    }
    let path = problem.task.path();
    let scored = points.iter().filter(|p| path.is_scored(p.point));
    let count = path.scored_count() as f64;
    let joints: Vec<[f64; 6]> = plans.iter().flat_map(|plan| plan.joints.iter().copied()).collect();
    let travel = JointTravel::of(path, &joints);
    let scores = problem.objective(points.iter().map(|p| problem.point_cost(p.point, p.score)));
    Plan {
        postures: plans.iter().map(|plan| plan.posture).collect(),
        posture_words: plans.iter().map(|plan| problem.robot.posture_words(plan.posture)).collect(),
        objective: scores + problem.travel_weight() * travel.total,
        mean: scored.clone().map(|p| p.score).sum::<f64>() / count,
        max: scored.clone().map(|p| p.score).fold(0.0, f64::max),
        percentiles: [0.5, 0.95].map(|share| percentile(scored.clone().map(|p| p.score), share)),
        deflection: DeflectionFigures::of(scored),
        held: None,
        sag: Sag::of(problem, placement, points.iter().map(|p| (p.point, p.joints))),
        by_origin: mean_by_origin(problem, &points),
        mean_deviation: known.map(|known| known.standard_deviation(&slopes) / count),
        clearance: plan_clearance(problem, &points),
        travel,
        points,
        axes: problem.axis_paths(),
    }
}

/// What each thing that yields adds in the mean of the scored points.
fn mean_by_origin(problem: &Problem, points: &[PlanPoint]) -> Option<ScoredByOrigin> {
    let path = problem.task.path();
    let mut sum = problem.yields_beside().then(ScoredByOrigin::default)?;
    points.iter().filter(|p| path.is_scored(p.point)).filter_map(|p| p.by_origin.as_ref()).for_each(|p| sum.add(p));
    Some(sum.scaled(1.0 / path.scored_count() as f64))
}

/// The point of a plan at which a pair has the least room beyond what it has to keep.
fn plan_clearance(problem: &Problem, points: &[PlanPoint]) -> Option<PlanClearance> {
    let scene = problem.scene.as_deref()?;
    let rooms = points.iter().filter_map(|point| {
        let clearance = point.clearance?;
        let pair = scene.pair(clearance.pair)?;
        Some((clearance.distance - pair.required, point.point, clearance.distance, pair.names.clone()))
    });
    let (_, point, distance, names) = rooms.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(PlanClearance { point, distance, names })
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
        all.push(before + wrap(angle - before));
    }
    all
}
