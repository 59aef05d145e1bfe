//! Plans in which nothing hits.
//!
//! A plan is made, its states are looked at, those that hit are forbidden with their neighbours in beta that hit too,
//! and the plan is made again until nothing hits (`forbid`). A plan over fewer states is never better, so the first one
//! that is free is the best free one of its grid, but for moves from point to point: for these, states are forbidden
//! that would do with another before them. Lines into the cut and out of it count too, without shapes as well, as far
//! as there are states with whole ones. Both flips of the wrist count as one: a state is forbidden where that of the
//! plan hits.

use super::joint_turns::SegmentChoice;
use super::{NoFeasiblePlan, Planner, SegmentPlan, Workspace, joint_turns, off_grid};
use crate::transfer_path::whole_lines;
use std::collections::{BTreeMap, BTreeSet};
use stead_cell::PairKind;
use stead_model::robot::Posture;
use stead_problem::candidate::Objective;
use stead_problem::collision::Fault;
use stead_problem::problem::{Placement, Problem};
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
    problem: &Problem,
    placement: &Placement,
    sense: Sense,
    spacing: off_grid::Spacing,
    kept: Kept,
    plan: &SegmentPlan,
) -> SegmentPlan {
    let count = plan.points.len();
    let lines = kept.lines;
    let refined = |watched: &[off_grid::Watch]| {
        let mut refined = plan.clone();
        off_grid::refine(problem, placement, sense, spacing, watched, &mut refined);
        refined
    };
    let watch = |place: usize, held: bool| off_grid::Watch {
        collisions: true,
        line: (place == 0 && lines[0]) || (place + 1 == count && lines[1]),
        held,
    };
    let mut watched = vec![off_grid::Watch::default(); count];
    for round in 0..=WATCHES {
        let refined = refined(&watched);
        // Places of the plan where something is wrong, and whether beta is held there for that.
        let mut places: Vec<(usize, bool)> = Vec::new();
        if refined.cost.is_finite() {
            for fault in problem.plan_faults(placement, &refined, kept.moves) {
                let place = fault.point - plan.points.start;
                places.push((place, fault.is_between));
                places.extend(fault.is_between.then(|| (place - 1, true)));
            }
            let whole = whole_lines(problem, placement, &refined);
            places.extend((lines[0] && !whole[0]).then_some((0, false)));
            places.extend((lines[1] && !whole[1]).then_some((count - 1, false)));
        }
        if places.is_empty() || (round == WATCHES && !kept.moves) {
            return refined;
        }
        for (place, held) in places {
            // What hits at one point mostly hits at the next.
            for place in place.saturating_sub(1)..(place + 2).min(count) {
                watched[place] = watch(place, watched[place].held);
            }
            watched[place].held |= held;
        }
        if round + 1 == WATCHES {
            watched = (0..count).map(|place| watch(place, watched[place].held)).collect();
        }
    }
    plan.clone()
}

impl Planner<'_> {
    /// The plans that are chosen of those that `plan` makes for the segments requested, made again without the states
    /// that hit until nothing does.
    pub(super) fn collision_free_plans(
        &self,
        placement: &Placement,
        sense: Sense,
        workspace: &mut Workspace,
        mut plan: impl FnMut(&mut Workspace, &[usize]) -> Result<Vec<Vec<SegmentChoice>>, NoFeasiblePlan>,
    ) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
        let all: Vec<usize> = (0..self.problem.task.segments().len()).collect();
        workspace.forbidden.clear();
        if let Some(pair) = self.problem.placement_hit(placement) {
            return Err(self.blocked_by(pair));
        }
        let is_checked = self.problem.scene.is_some() || self.segments.checks_moves();
        let mut choices = vec![Vec::new(); all.len()];
        let mut collisions = Collisions::new();
        let mut requested = all.clone();
        // Ends of segments, by their points, at which no state of a plan has a whole line, and those at which some were
        // forbidden for that.
        let (mut waived, mut bound) = (BTreeSet::new(), BTreeSet::new());
        // Plans in which nothing hits, as far as they were looked at.
        let mut free: Vec<Option<SegmentPlan>> = vec![None; choices.len()];
        // How often the move to a point was faulty.
        let mut faulty: BTreeMap<usize, u32> = BTreeMap::new();
        // Whether states were forbidden for moves that the arm cannot follow, and whether such moves are let pass.
        let (mut are_moves_bound, mut are_moves_waived) = (false, false);
        for round in 0..MAX_ROUNDS {
            if self.is_unwanted() {
                return Err(NoFeasiblePlan::empty());
            }
            let found = plan(workspace, &requested);
            let lines = found.as_ref().err().map_or_else(Vec::new, |none| self.lines_of(none, &bound));
            let waives_moves = are_moves_bound && !are_moves_waived && (found.is_err() || round >= FOLLOW_ROUNDS);
            let found = match found {
                Err(none) if lines.is_empty() && !waives_moves => return Err(NoFeasiblePlan { collisions, ..none }),
                Ok(found) if !waives_moves => found,
                _ => {
                    // Without a state that has its whole line, or that the arm can go on from, it is planned as if none
                    // were needed.
                    bound.clear();
                    waived.extend(lines);
                    are_moves_waived |= waives_moves;
                    workspace.forbidden.clear();
                    free.fill(None);
                    requested.clone_from(&all);
                    continue;
                }
            };
            if !is_checked {
                return Ok(joint_turns::select_joint_paths(self.problem, sense, found));
            }
            for (segment, found) in requested.drain(..).zip(found) {
                choices[segment] = found;
            }
            let plans = joint_turns::select_joint_paths(self.problem, sense, choices.clone());
            for (segment, plan) in plans.iter().enumerate() {
                if free[segment].as_ref() == Some(plan) {
                    continue;
                }
                let (mut is_free, mut hit) = (true, Vec::new());
                for fault in self.problem.plan_faults(placement, plan, self.segments.checks_moves()) {
                    match fault.fault {
                        Fault::Hit(pair) => drop(collisions.entry(pair).or_default().insert(fault.point)),
                        Fault::Unfollowed(_) if are_moves_waived => continue,
                        Fault::Unfollowed(_) => are_moves_bound = true,
                    }
                    is_free = false;
                    let times = if fault.is_between { faulty.entry(fault.point).or_default() } else { &mut 0 };
                    let ends = self.forbid_fault(placement, plan, &fault, *times, &mut workspace.forbidden);
                    hit.extend(ends.filter(|_| !fault.is_between).map(|betas| (fault.point, betas)));
                    *times += 1;
                }
                self.forbid_around(placement, plan, hit, &mut workspace.forbidden);
                let lines = match is_free && self.segments.checks_moves() {
                    true => self.forbid_short_lines(placement, plan, &waived, &mut workspace.forbidden),
                    false => Vec::new(),
                };
                bound.extend(&lines);
                if is_free && lines.is_empty() {
                    free[segment] = Some(plan.clone());
                } else {
                    requested.push(segment);
                }
            }
            if requested.is_empty() {
                return Ok(plans);
            }
        }
        let points: BTreeSet<usize> = collisions.values().flatten().copied().collect();
        Err(NoFeasiblePlan { blocked_points: points.into_iter().collect(), collisions, ..NoFeasiblePlan::empty() })
    }

    /// The mean score under the best or worst plan on the grid in which nothing hits ([`Planner::objective`]).
    pub(super) fn free_objective(
        &self,
        placement: &Placement,
        sense: Sense,
        scheme: Option<&[Posture]>,
        workspace: &mut Workspace,
    ) -> Objective {
        let plans = self.collision_free_plans(placement, sense, workspace, |workspace, requested| {
            let choices = self.choices(placement, sense, scheme, workspace, requested, 0.0)?;
            Ok(self.without_hitting_ways(placement, choices))
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
        *plan = settled_among_free(problem, placement, sense, spacing, kept, plan);
    }

    /// Plans of segments without the ways of driving them (flips of the wrist) in which something hits, where others
    /// are left. Turns of the joints change nothing about collisions.
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

    /// The ends of the segments that have no plan, of those at which states were forbidden for their lines.
    fn lines_of(&self, none: &NoFeasiblePlan, bound: &BTreeSet<usize>) -> Vec<usize> {
        let path = self.problem.task.path();
        let blocked = none.blocked_points.iter().map(|point| path.segment_of(*point));
        let failed: BTreeSet<usize> = blocked.chain(none.broken_segments.iter().map(|(segment, _)| *segment)).collect();
        bound.iter().copied().filter(|point| failed.contains(&path.segment_of(*point))).collect()
    }
}
