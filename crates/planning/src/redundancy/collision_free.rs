//! Plans in which nothing hits.
//!
//! A plan is made, its states are looked at, those that hit are forbidden with their neighbours in beta that hit too,
//! and the plan is made again until nothing hits (`forbid`). A plan over fewer states is never better, so the first one
//! that is free is the best free one of its grid, but for moves from point to point: for these, states are forbidden
//! that would do with another before them. Lines into the cut and out of it count too, without shapes as well, as far
//! as there are states with whole ones. Both flips of the wrist count as one: a state is forbidden where that of the
//! plan hits.

use super::forbid::Forbidding;
use super::joint_turns::SegmentChoice;
use super::segment_planner::Request;
use super::until_free::{Lazy, until_free};
use super::{NoFeasiblePlan, Planner, SegmentPlan, Workspace, joint_turns, off_grid};
use crate::transfer_path::whole_lines;
use std::collections::{BTreeMap, BTreeSet};
use stead_cell::PairKind;
use stead_model::robot::Posture;
use stead_problem::candidate::Objective;
use stead_problem::collision::Fault;
use stead_problem::evaluate::batch::{BatchEvaluator, KernelNumber};
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// Plans made for one placement, at the most; one that still hits after that counts as none.
const MAX_ROUNDS: usize = 60;

/// Plans made for one placement to get rid of moves that the arm cannot follow; then they are accepted, with a warning.
const FOLLOW_ROUNDS: usize = 20;

/// Times that a plan taken off the grid is looked at for more points that hit, before all are looked at.
const WATCHES: usize = 6;

/// Which pairs of the scene hit at which path points.
pub type Collisions = BTreeMap<usize, BTreeSet<usize>>;

/// What a plan off the grid keeps of the one that it is made of.
#[derive(Debug, Clone, Copy)]
pub struct Kept {
    /// Lines into and out of the cut that are whole.
    pub lines: [bool; 2],
    /// Moves from point to point in which nothing is wrong.
    pub moves: bool,
}

/// A plan with beta taken off the grid ([`off_grid::refine`]; one of infinite cost only says where, and may stay so).
/// Where it would hit at some points, the states of these are looked at one by one, at last those of all; what is kept
/// of the plan stays as it was, with beta held at the ends of moves that would not.
pub fn settled_among_free(
    evaluator: &BatchEvaluator<'_>,
    placement: &Placement,
    sense: Sense,
    spacing: off_grid::Spacing,
    kept: Kept,
    plan: &SegmentPlan,
) -> SegmentPlan {
    let watched = vec![off_grid::Watch::default(); plan.points.len()];
    let mut settling = Settling { evaluator, placement, sense, spacing, kept, plan, watched, round: 0 };
    match until_free(&mut settling, WATCHES + 1) {
        Ok((settled, is_free)) if is_free || !kept.moves => settled,
        Ok(_) => plan.clone(),
        Err(never) => match never {},
    }
}

/// A plan that is taken off the grid with more and more of its states watched.
struct Settling<'a> {
    evaluator: &'a BatchEvaluator<'a>,
    placement: &'a Placement,
    sense: Sense,
    spacing: off_grid::Spacing,
    kept: Kept,
    plan: &'a SegmentPlan,
    /// By the places of the plan.
    watched: Vec<off_grid::Watch>,
    round: usize,
}

impl Settling<'_> {
    /// Watches a place of the plan.
    fn watch(&mut self, place: usize) {
        let lines = self.kept.lines;
        self.watched[place] = off_grid::Watch {
            collisions: true,
            line: (place == 0 && lines[0]) || (place + 1 == self.watched.len() && lines[1]),
            held: self.watched[place].held,
        };
    }
}

impl Lazy for Settling<'_> {
    type Plan = SegmentPlan;
    type Refused = std::convert::Infallible;

    fn plan(&mut self) -> Result<SegmentPlan, Self::Refused> {
        let mut refined = self.plan.clone();
        off_grid::refine(self.evaluator, self.placement, self.sense, self.spacing, &self.watched, &mut refined);
        Ok(refined)
    }

    fn forbid(&mut self, refined: &SegmentPlan) -> bool {
        let (count, kept) = (self.watched.len(), self.kept);
        // Places of the plan where something is wrong, and whether beta is held there for that.
        let mut places: Vec<(usize, bool)> = Vec::new();
        if refined.cost.is_finite() {
            let problem = self.evaluator.problem();
            for fault in problem.plan_faults(self.placement, refined, kept.moves) {
                let place = fault.point - self.plan.points.start;
                places.push((place, fault.is_between));
                places.extend(fault.is_between.then(|| (place - 1, true)));
            }
            let whole = whole_lines(problem, self.placement, refined);
            places.extend((kept.lines[0] && !whole[0]).then_some((0, false)));
            places.extend((kept.lines[1] && !whole[1]).then_some((count - 1, false)));
        }
        for (place, held) in &places {
            // What hits at one point mostly hits at the next.
            (place.saturating_sub(1)..(place + 2).min(count)).for_each(|near| self.watch(near));
            self.watched[*place].held |= held;
        }
        self.round += 1;
        if self.round == WATCHES {
            (0..count).for_each(|place| self.watch(place));
        }
        !places.is_empty()
    }
}

/// What is wanted of the plans: that no move asks more of the joints than they can follow, or of the end of a segment
/// that its line is whole.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Demand {
    /// So far nothing was forbidden for it.
    #[default]
    Met,
    /// States were forbidden for it.
    Bound,
    /// It is given up, since no plan satisfies it.
    Waived,
}

/// Plans of all segments in which more and more states are forbidden ([`Planner::collision_free_plans`]).
struct FreePlans<'s, P, E> {
    planner: &'s Planner<'s>,
    request: Request<'s>,
    workspace: &'s mut Workspace<E>,
    /// What makes the plans of some segments.
    plan: P,
    /// Of every segment.
    choices: Vec<Vec<SegmentChoice>>,
    /// Segments that are planned next.
    requested: Vec<usize>,
    /// Plans in which nothing is wrong, as far as they were looked at.
    free: Vec<Option<SegmentPlan>>,
    collisions: Collisions,
    /// How often the move to a point was faulty.
    faulty: BTreeMap<usize, u32>,
    moves: Demand,
    /// The lines at the ends of segments, by their points.
    lines: BTreeMap<usize, Demand>,
    round: usize,
}

impl<P, E: KernelNumber> FreePlans<'_, P, E> {
    /// The ends of the segments that have no plan, of those at which states were forbidden for their lines.
    fn lines_in_the_way(&self, none: &NoFeasiblePlan) -> Vec<usize> {
        let path = self.planner.problem.task.path();
        let blocked = none.blocked_points.iter().map(|point| path.segment_of(*point));
        let failed: BTreeSet<usize> = blocked.chain(none.broken_segments.iter().map(|(segment, _)| *segment)).collect();
        let is_bound = |end: &(&usize, &Demand)| *end.1 == Demand::Bound && failed.contains(&path.segment_of(*end.0));
        self.lines.iter().filter(is_bound).map(|(point, _)| *point).collect()
    }

    /// Plans anew as if some demands were none.
    fn waive(&mut self, lines: &[usize], moves: bool) {
        self.lines.retain(|_, demand| *demand == Demand::Waived);
        self.lines.extend(lines.iter().map(|point| (*point, Demand::Waived)));
        if moves {
            self.moves = Demand::Waived;
        }
        self.workspace.forbidden.clear();
        self.free.fill(None);
        self.requested = (0..self.choices.len()).collect();
    }

    /// Forbids states of a plan in which something is wrong; whether anything is.
    fn forbid_in(&mut self, plan: &SegmentPlan) -> bool {
        let checks_moves = self.planner.segments.checks_moves();
        let mut forbidding = Forbidding {
            planner: self.planner,
            placement: self.request.placement,
            plan,
            forbidden: &mut self.workspace.forbidden,
        };
        let (mut is_free, mut hit) = (true, Vec::new());
        for fault in self.planner.problem.plan_faults(self.request.placement, plan, checks_moves) {
            match fault.fault {
                Fault::Hit(pair) => drop(self.collisions.entry(pair).or_default().insert(fault.point)),
                Fault::Unfollowed(_) if self.moves == Demand::Waived => continue,
                Fault::Unfollowed(_) => self.moves = Demand::Bound,
            }
            is_free = false;
            let times = if fault.is_between { self.faulty.entry(fault.point).or_default() } else { &mut 0 };
            let ends = forbidding.fault(&fault, *times);
            hit.extend(ends.filter(|_| !fault.is_between).map(|betas| (fault.point, betas)));
            *times += 1;
        }
        forbidding.around(hit);
        if !is_free || !checks_moves {
            return !is_free;
        }
        let is_waived = |point: usize| self.lines.get(&point) == Some(&Demand::Waived);
        let short = forbidding.short_lines(is_waived);
        self.lines.extend(short.iter().map(|point| (*point, Demand::Bound)));
        !short.is_empty()
    }
}

impl<P, E: KernelNumber> Lazy for FreePlans<'_, P, E>
where
    P: FnMut(&mut Workspace<E>, &[usize]) -> Result<Vec<Vec<SegmentChoice>>, NoFeasiblePlan>,
{
    /// None where demands were given up, so that all is planned anew.
    type Plan = Option<Vec<SegmentPlan>>;
    type Refused = NoFeasiblePlan;

    fn plan(&mut self) -> Result<Self::Plan, NoFeasiblePlan> {
        if self.planner.is_unwanted() {
            return Err(NoFeasiblePlan::empty());
        }
        let found = (self.plan)(self.workspace, &self.requested);
        let lines = found.as_ref().err().map_or_else(Vec::new, |none| self.lines_in_the_way(none));
        let is_late = self.round >= FOLLOW_ROUNDS;
        let waives_moves = self.moves == Demand::Bound && (found.is_err() || is_late);
        self.round += 1;
        match found {
            Err(none) if lines.is_empty() && !waives_moves => {
                Err(NoFeasiblePlan { collisions: std::mem::take(&mut self.collisions), ..none })
            }
            Ok(found) if !waives_moves => {
                for (segment, found) in self.requested.drain(..).zip(found) {
                    self.choices[segment] = found;
                }
                let choices = self.choices.clone();
                Ok(Some(joint_turns::select_joint_paths(self.planner.problem, self.request.sense, choices)))
            }
            _ => {
                self.waive(&lines, waives_moves);
                Ok(None)
            }
        }
    }

    fn forbid(&mut self, plans: &Self::Plan) -> bool {
        let Some(plans) = plans else { return true };
        if self.planner.problem.scene.is_none() && !self.planner.segments.checks_moves() {
            return false;
        }
        for (segment, plan) in plans.iter().enumerate() {
            if self.free[segment].as_ref() == Some(plan) {
                continue;
            }
            if self.forbid_in(plan) {
                self.requested.push(segment);
            } else {
                self.free[segment] = Some(plan.clone());
            }
        }
        !self.requested.is_empty()
    }
}

impl Planner<'_> {
    /// The plans that are chosen of those that `plan` makes for the segments requested, made again without the states
    /// that hit until nothing does.
    pub(super) fn collision_free_plans<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
        plan: impl FnMut(&mut Workspace<E>, &[usize]) -> Result<Vec<Vec<SegmentChoice>>, NoFeasiblePlan>,
    ) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
        let count = self.problem.task.segments().len();
        workspace.forbidden.clear();
        if let Some(pair) = self.problem.placement_hit(request.placement) {
            return Err(self.blocked_by(pair));
        }
        let mut job = FreePlans {
            planner: self,
            request,
            workspace,
            plan,
            choices: vec![Vec::new(); count],
            requested: (0..count).collect(),
            free: vec![None; count],
            collisions: Collisions::new(),
            faulty: BTreeMap::new(),
            moves: Demand::Met,
            lines: BTreeMap::new(),
            round: 0,
        };
        if let (Some(plans), true) = until_free(&mut job, MAX_ROUNDS)? {
            return Ok(plans);
        }
        let collisions = job.collisions;
        let points: BTreeSet<usize> = collisions.values().flatten().copied().collect();
        Err(NoFeasiblePlan { blocked_points: points.into_iter().collect(), collisions, ..NoFeasiblePlan::empty() })
    }

    /// The mean score under the best or worst plan on the grid in which nothing hits ([`Planner::objective`]).
    pub(super) fn free_objective<E: KernelNumber>(
        &self,
        request: Request<'_>,
        workspace: &mut Workspace<E>,
    ) -> Objective {
        let plans = self.collision_free_plans(request, workspace, |workspace, requested| {
            let choices = self.choices(request, workspace, requested, 0.0)?;
            Ok(self.without_hitting_ways(request.placement, choices))
        });
        match plans {
            Ok(plans) => Objective::Feasible(self.problem.objective(plans.iter().map(|plan| plan.cost))),
            Err(none) if none.blocked_points.is_empty() => {
                Objective::Infeasible { points: 0, segments: none.broken_segments.len() }
            }
            Err(none) => Objective::Infeasible { points: none.blocked_points.len(), segments: 0 },
        }
    }

    /// [`Planner::objective`] without some states.
    #[cfg(test)]
    pub fn objective_without(&self, placement: &Placement, sense: Sense, forbidden: &super::StateSet) -> Objective {
        let mut workspace = Workspace { forbidden: forbidden.clone(), ..self.workspace() };
        self.objective(placement, sense, None, &mut workspace)
    }

    /// Takes beta of a plan off the grid, where nothing hits on it: lines into and out of the cut that are whole stay
    /// so, and moves in which nothing is wrong.
    pub(super) fn refine_off_grid(&self, placement: &Placement, sense: Sense, plan: &mut SegmentPlan) {
        let (problem, spacing) = (self.problem, self.spacing);
        let faults = problem.plan_faults(placement, plan, self.segments.checks_moves());
        if faults.iter().any(|fault| matches!(fault.fault, Fault::Hit(_))) {
            return;
        }
        let lines = if self.segments.checks_moves() { whole_lines(problem, placement, plan) } else { [false; 2] };
        let kept = Kept { lines, moves: self.segments.checks_moves() && faults.is_empty() };
        let Some(evaluator) = BatchEvaluator::of_posture(&self.segments.evaluators, plan.posture) else { return };
        *plan = settled_among_free(evaluator, placement, sense, spacing, kept, plan);
    }

    /// Plans of segments without the ways of driving them (flips of the wrist) in which something hits, where others
    /// are left. Turns of the joints change nothing about collisions.
    #[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
    pub(super) fn without_hitting_ways(
        &self,
        placement: &Placement,
        choices: Vec<Vec<SegmentChoice>>,
    ) -> Vec<Vec<SegmentChoice>> {
        if self.problem.scene.is_none() {
            return choices;
        }
        let free = |mut choice: SegmentChoice| {
            let postures: BTreeSet<Posture> = choice.joint_paths.iter().map(|path| path.posture).collect();
            if postures.len() > 1 {
                let hits = |posture: &Posture| {
                    let path = choice.joint_paths.iter().find(|path| path.posture == *posture);
                    path.is_none_or(|path| {
                        let kinds = &PairKind::OF_JOINTS;
                        self.problem.path_faults(placement, &choice.points, &path.joints, kinds, None).next().is_some()
                    })
                };
                let free: BTreeSet<Posture> = postures.iter().copied().filter(|posture| !hits(posture)).collect();
                if !free.is_empty() {
                    choice.joint_paths.retain(|path| free.contains(&path.posture));
                }
            }
            choice
        };
        choices.into_iter().map(|plans| plans.into_iter().map(free).collect()).collect()
    }

    /// No plan, since two shapes are too near to each other whatever the arm does.
    pub(super) fn blocked_by(&self, pair: usize) -> NoFeasiblePlan {
        let points = 0..self.problem.task.points().len();
        NoFeasiblePlan {
            blocked_points: points.clone().collect(),
            collisions: Collisions::from([(pair, points.collect())]),
            ..NoFeasiblePlan::empty()
        }
    }
}
