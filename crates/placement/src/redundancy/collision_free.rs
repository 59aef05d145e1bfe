//! Plans in which nothing hits.
//!
//! A plan is made, its states are looked at, those that hit are forbidden with their neighbours in beta that hit too, and the plan
//! is made again until nothing hits. A plan over fewer states is never better, so the first one that is free is the best free one of
//! its grid. Lines into the cut and out of it between segments count too, as far as there are states with whole ones. Both flips of the wrist count as one: a state is forbidden where that of the plan hits.

use super::joint_turns::SegmentChoice;
use super::{NoFeasiblePlan, Planner, SegmentPlan, StateSet, Workspace, joint_turns, kinds_left, off_grid};
use crate::candidate::Objective;
use crate::collision::PlanHit;
use crate::problem::{Placement, Problem};
use crate::sense::Sense;
use crate::way::{AtPoint, Space, line_ends, whole_lines};
use std::collections::{BTreeMap, BTreeSet};
use stead_cell::{PairKind, Proximity};
use stead_model::robot::angles::wrap;
use stead_model::robot::{Posture, PostureClass};

/// Plans made for one placement, at the most; one that still hits after that counts as none.
const MAX_ROUNDS: usize = 60;

/// Times that a plan taken off the grid is looked at for more points that hit, before all are looked at.
const WATCHES: usize = 6;

/// Which pairs of the scene hit at which path points.
pub type Collisions = BTreeMap<usize, BTreeSet<usize>>;

/// Forbids a state that hits, on a grid of `count` values of beta, and its neighbours in beta as far as they hit too; with a `stride`
/// above one only every so many of them are looked at, and what lies between two that hit is forbidden with them.
pub(crate) fn forbid(
    (point, class): (usize, PostureClass),
    (beta, count, stride): (usize, usize, usize),
    mut hits: impl FnMut(usize) -> bool,
    forbidden: &mut StateSet,
) {
    forbidden.add(point, class, beta);
    for side in [1, count - 1] {
        let mut at = beta;
        loop {
            let next = (at + stride * side) % count;
            if forbidden.contains(point, class, next) || !hits(next) {
                break;
            }
            for _ in 0..stride {
                at = (at + side) % count;
                forbidden.add(point, class, at);
            }
        }
    }
}

/// A plan with beta taken off the grid ([`off_grid::refine`]; one of infinite cost only says where, and may stay so). Where it would hit
/// at some points, the states of these are looked at one by one, at last those of all; lines into and out of the cut that are whole stay
/// so (`lines`).
pub(crate) fn settled_among_free(
    problem: &Problem,
    placement: &Placement,
    sense: Sense,
    (spacing, lines): (off_grid::Spacing, [bool; 2]),
    plan: &SegmentPlan,
) -> SegmentPlan {
    let kept = |place: usize, is_watched: bool| off_grid::Watch {
        collisions: is_watched,
        line: is_watched && ((place == 0 && lines[0]) || (place + 1 == plan.points.len() && lines[1])),
    };
    let refined = |watched: &[bool]| {
        let watched: Vec<_> = watched.iter().enumerate().map(|(place, watch)| kept(place, *watch)).collect();
        let mut refined = plan.clone();
        off_grid::refine(problem, placement, sense, spacing, &watched, &mut refined);
        refined
    };
    let mut watched = vec![false; plan.points.len()];
    for _ in 0..WATCHES {
        let refined = refined(&watched);
        let mut places: Vec<usize> = Vec::new();
        if refined.cost.is_finite() {
            let hits = problem.plan_hits(placement, &refined, false);
            places.extend(hits.iter().map(|hit| hit.point - plan.points.start));
            let whole = whole_lines(problem, placement, &refined);
            places.extend((lines[0] && !whole[0]).then_some(0));
            places.extend((lines[1] && !whole[1]).then_some(watched.len() - 1));
        }
        if places.is_empty() {
            return refined;
        }
        // What hits at one point mostly hits at the next.
        for place in places {
            let last = (place + 2).min(watched.len());
            watched[place.saturating_sub(1)..last].fill(true);
        }
    }
    refined(&vec![true; watched.len()])
}

impl Planner<'_> {
    /// The plans that are chosen of those that `plan` makes for the segments asked for, made again without the states that hit until
    /// nothing does.
    pub(super) fn until_free(
        &self,
        placement: &Placement,
        sense: Sense,
        workspace: &mut Workspace,
        mut plan: impl FnMut(&mut Workspace, &[usize]) -> Result<Vec<Vec<SegmentChoice>>, NoFeasiblePlan>,
    ) -> Result<Vec<SegmentPlan>, NoFeasiblePlan> {
        let all: Vec<usize> = (0..self.problem.task.segments().len()).collect();
        let mut choices = Vec::new();
        let has_scene = self.problem.scene.is_some();
        if has_scene {
            workspace.forbidden.clear();
            if let Some(pair) = self.problem.placement_hit(placement) {
                return Err(self.blocked_by(pair));
            }
            choices = vec![Vec::new(); all.len()];
        }
        let mut collisions = Collisions::new();
        let mut asked = all.clone();
        // Ends of segments, by their points, at which no state of a plan has a whole line, and those at which some were forbidden for that.
        let (mut waived, mut bound) = (BTreeSet::new(), BTreeSet::new());
        // Plans in which nothing hits, as far as they were looked at.
        let mut free: Vec<Option<SegmentPlan>> = vec![None; choices.len()];
        for _ in 0..MAX_ROUNDS {
            let found = match plan(workspace, &asked) {
                Ok(found) => found,
                Err(none) => {
                    let lines = self.lines_of(&none, &bound);
                    if lines.is_empty() {
                        return Err(NoFeasiblePlan { collisions, ..none });
                    }
                    // Without a state that has its whole line, the segment is planned as if it needed none.
                    bound.clear();
                    waived.extend(lines);
                    workspace.forbidden.clear();
                    free.fill(None);
                    asked.clone_from(&all);
                    continue;
                }
            };
            if !has_scene {
                return Ok(joint_turns::select_joint_paths(self.problem, sense, found));
            }
            for (segment, found) in asked.drain(..).zip(found) {
                choices[segment] = found;
            }
            let plans = joint_turns::select_joint_paths(self.problem, sense, choices.clone());
            for (segment, plan) in plans.iter().enumerate() {
                if free[segment].as_ref() == Some(plan) {
                    continue;
                }
                let hits = self.hits(placement, plan);
                for hit in &hits {
                    collisions.entry(hit.pair).or_default().insert(hit.point);
                    self.forbid_hit(placement, plan, hit, &mut workspace.forbidden);
                }
                let lines = match hits.is_empty() && self.checks_motions {
                    true => self.forbid_short_lines(placement, plan, &waived, &mut workspace.forbidden),
                    false => Vec::new(),
                };
                bound.extend(&lines);
                if hits.is_empty() && lines.is_empty() {
                    free[segment] = Some(plan.clone());
                } else {
                    asked.push(segment);
                }
            }
            if asked.is_empty() {
                return Ok(plans);
            }
        }
        let points: BTreeSet<usize> = collisions.values().flatten().copied().collect();
        Err(NoFeasiblePlan { blocked_points: points.into_iter().collect(), broken_segments: Vec::new(), collisions })
    }

    /// The mean score under the best or worst plan on the grid in which nothing hits ([`Planner::objective`]).
    pub(super) fn free_objective(
        &self,
        placement: &Placement,
        sense: Sense,
        scheme: Option<&[Posture]>,
        workspace: &mut Workspace,
    ) -> Objective {
        let plans = self.until_free(placement, sense, workspace, |workspace, asked| {
            let choices = self.choices(placement, sense, scheme, workspace, (asked, 0.0))?;
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
    pub fn objective_without(&self, placement: &Placement, sense: Sense, forbidden: &StateSet) -> Objective {
        let mut workspace = Workspace { forbidden: forbidden.clone(), ..self.workspace() };
        self.objective(placement, sense, None, &mut workspace)
    }

    /// Takes beta of a plan off the grid. Where nothing hits on the grid, but something does off it, the states of the points where it
    /// does are looked at one by one.
    pub(super) fn refine_off_grid(&self, placement: &Placement, sense: Sense, plan: &mut SegmentPlan) {
        let (problem, spacing) = (self.problem, self.spacing);
        if problem.plan_hits(placement, plan, false).is_empty() {
            let lines = match self.checks_motions {
                true => whole_lines(problem, placement, plan),
                false => [false; 2],
            };
            *plan = settled_among_free(problem, placement, sense, (spacing, lines), plan);
        }
    }

    /// Plans of segments without the ways of driving them (flips of the wrist) in which something hits, where others are left. Turns of
    /// the joints change nothing about collisions.
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
                        self.problem.path_hits(placement, &choice.points, &path.joints, kinds, None).next().is_some()
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
            broken_segments: Vec::new(),
            collisions: Collisions::from([(pair, points.collect())]),
        }
    }

    /// What hits along a plan: the states, and the motions from point to point unless the path is a subset of points.
    fn hits(&self, placement: &Placement, plan: &SegmentPlan) -> Vec<PlanHit> {
        let with_motions = self.checks_motions && !self.problem.task.path().is_thinned();
        self.problem.plan_hits(placement, plan, with_motions)
    }

    /// The ends of the segments that have no plan, of those at which states were forbidden for their lines.
    fn lines_of(&self, none: &NoFeasiblePlan, bound: &BTreeSet<usize>) -> Vec<usize> {
        let path = self.problem.task.path();
        let blocked = none.blocked_points.iter().map(|point| path.segment_of(*point));
        let failed: BTreeSet<usize> = blocked.chain(none.broken_segments.iter().map(|(segment, _)| *segment)).collect();
        bound.iter().copied().filter(|point| failed.contains(&path.segment_of(*point))).collect()
    }

    /// Forbids the states of the grid next to the ends of a plan whose lines into or out of the cut are short, but for ends that are
    /// waived: the points of these ends.
    fn forbid_short_lines(
        &self,
        placement: &Placement,
        plan: &SegmentPlan,
        waived: &BTreeSet<usize>,
        forbidden: &mut StateSet,
    ) -> Vec<usize> {
        let problem = self.problem;
        let Some(space) = Space::new(problem, placement) else { return Vec::new() };
        let is_short = |at: AtPoint| space.line_end(at, problem.segment_moves.retract).is_some();
        let ends = line_ends(problem, plan).into_iter().flatten();
        let short: Vec<AtPoint> = ends.filter(|end| !waived.contains(&end.point) && is_short(*end)).collect();
        for end in &short {
            let hits = |k: usize| {
                let beta = self.grid.beta(k);
                let joints = problem.robot.inverse(&problem.base_from_flange(end.point, placement, beta), plan.posture);
                let turned = |found: [f64; 6]| std::array::from_fn(|j| end.joints[j] + wrap(found[j] - end.joints[j]));
                joints.is_ok_and(|found| is_short(AtPoint { beta, joints: turned(found), ..*end }))
            };
            self.forbid_near((end.point, plan.posture.class()), end.beta, hits, forbidden);
        }
        short.into_iter().map(|end| end.point).collect()
    }

    /// Forbids the states of the grid next to one of a plan that hits.
    fn forbid_hit(&self, placement: &Placement, plan: &SegmentPlan, hit: &PlanHit, forbidden: &mut StateSet) {
        let place = hit.point - plan.points.start;
        // Of a motion that hits, the state at its end; once that is forbidden, the one at its start.
        for place in if hit.is_between { vec![place, place - 1] } else { vec![place] } {
            let point = plan.points.start + place;
            let (kinds, mut known) = (kinds_left(self.tool_hits.as_deref()), Proximity::default());
            let hits = |k| {
                let state = (point, self.grid.beta(k));
                self.problem.next_hit(state, placement, plan.posture, kinds, &mut known).is_some()
            };
            if self.forbid_near((point, plan.posture.class()), plan.betas[place], hits, forbidden) {
                return;
            }
        }
    }

    /// Forbids the state of the grid next to a beta (rad), or where that is forbidden the one on its other side, with its neighbours as far
    /// as they hit too; whether one of the two was not forbidden.
    fn forbid_near(
        &self,
        (point, class): (usize, PostureClass),
        beta: f64,
        mut hits: impl FnMut(usize) -> bool,
        forbidden: &mut StateSet,
    ) -> bool {
        let count = self.grid.beta_count;
        let share = (beta - self.grid.beta(0)) / self.grid.beta_step();
        let nearest = (share.round() as i64).rem_euclid(count as i64) as usize;
        let other = if share > share.round() { nearest + 1 } else { nearest + count - 1 } % count;
        let fresh = [nearest, other].into_iter().find(|beta| !forbidden.contains(point, class, *beta));
        if let Some(beta) = fresh {
            forbid((point, class), (beta, count, 1), &mut hits, forbidden);
        }
        fresh.is_some()
    }
}
