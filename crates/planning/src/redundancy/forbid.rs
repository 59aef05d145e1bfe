//! Which states a plan may not use any more, once it has turned out to hit, or to have a move that the arm cannot
//! follow.

use super::{Planner, SegmentPlan, StateSet, kinds_left};
use crate::transfer_path::{AtPoint, Space, line_ends};
use std::collections::BTreeSet;
use stead_cell::{PairKind, Proximity};
use stead_model::robot::PostureClass;
use stead_model::robot::angles::{nearest_turns, wrap};
use stead_problem::collision::{Fault, PlanFault};
use stead_problem::problem::Placement;

/// Of the moves to all values of beta, so many at the most are checked where one may not be.
const MOVES_CHECKED: usize = 90;

/// Forbids a state that hits, on a grid of `count` values of beta, and its neighbours in beta as far as they hit too;
/// with a `stride` above one only every so many of them are checked, and what lies between two that hit is forbidden
/// with them. Returns the last that is forbidden on either side.
pub fn forbid(
    point: usize,
    class: PostureClass,
    beta: usize,
    count: usize,
    stride: usize,
    mut hits: impl FnMut(usize) -> bool,
    forbidden: &mut StateSet,
) -> [usize; 2] {
    forbidden.add(point, class, beta);
    [1, count - 1].map(|side| {
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
        at
    })
}

impl Planner<'_> {
    /// Forbids the states of the grid next to the ends of a plan whose lines into or out of the cut are short, but for
    /// ends that are waived: the points of these ends.
    pub(super) fn forbid_short_lines(
        &self,
        placement: &Placement,
        plan: &SegmentPlan,
        waived: &BTreeSet<usize>,
        forbidden: &mut StateSet,
    ) -> Vec<usize> {
        let problem = self.problem;
        let space = Space::new(problem, placement);
        let is_short = |at: AtPoint| space.line_end(at, problem.segment_moves.retract).is_some();
        let ends = line_ends(problem, plan).into_iter().flatten();
        let short: Vec<AtPoint> = ends.filter(|end| !waived.contains(&end.point) && is_short(*end)).collect();
        for end in &short {
            let hits = |k: usize| {
                let beta = self.grid().beta(k);
                let joints =
                    problem.robot.inverse(&problem.at(placement).base_from_flange(end.point, beta), plan.posture);
                joints.is_ok_and(|found| is_short(AtPoint { beta, joints: nearest_turns(&found, &end.joints), ..*end }))
            };
            self.forbid_near(end.point, plan.posture.class(), end.beta, 1, hits, forbidden);
        }
        short.into_iter().map(|end| end.point).collect()
    }

    /// Forbids the states of the grid next to one of a plan that hits; next to one that ends a move which may not be,
    /// or once that is forbidden, next to the one at its start. Where a move to the same point was faulty so many
    /// `times` before, more and more states on either side go with it. Returns the numbers of beta of
    /// [`Planner::forbid_near`].
    pub(super) fn forbid_fault(
        &self,
        placement: &Placement,
        plan: &SegmentPlan,
        fault: &PlanFault,
        times: u32,
        forbidden: &mut StateSet,
    ) -> Option<[usize; 3]> {
        let (point, place, class) = (fault.point, fault.point - plan.points.start, plan.posture.class());
        let (count, mut known) = (self.grid().beta_count, Proximity::default());
        if !fault.is_between {
            let kinds = kinds_left(self.segments.tool_hits.as_deref());
            let hits = |k| {
                let beta = self.grid().beta(k);
                self.problem.at(placement).next_hit(point, beta, plan.posture, kinds, &mut known).is_some()
            };
            return self.forbid_near(point, class, plan.betas[place], 1, hits, forbidden);
        }
        // Moves take longer to check than states.
        let stride = (count / MOVES_CHECKED).max(1);
        let is_hit = matches!(fault.fault, Fault::Hit(_));
        [place, place - 1].into_iter().find_map(|at| {
            let (point, beta) = (plan.points.start + at, plan.betas[at]);
            // Past a shape both ends go together; what the arm can follow depends on how far beta turns.
            let turned = |k: usize| {
                let turn = wrap(self.grid().beta(k) - beta);
                [0, 1].map(|end| if is_hit || place - 1 + end == at { turn } else { 0.0 })
            };
            let hits = |k| self.is_faulty_move(placement, plan, place, turned(k), &mut known);
            let [nearest, up, down] = self.forbid_near(point, class, beta, stride, hits, forbidden)?;
            for step in 1..((1 << (times / 2).min(8)).min(count)) {
                forbidden.add(point, class, (up + step) % count);
                forbidden.add(point, class, (down + count - step) % count);
            }
            Some([nearest, up, down])
        })
    }

    /// Forbids what hits around states of a plan, given by their points and numbers of beta, whichever way the wrist is
    /// flipped: that costs no plan that is free, and spares to find it state by state.
    pub(super) fn forbid_around(
        &self,
        placement: &Placement,
        plan: &SegmentPlan,
        mut open: Vec<(usize, [usize; 3])>,
        forbidden: &mut StateSet,
    ) {
        let (count, class) = (self.grid().beta_count, plan.posture.class());
        let (postures, kinds) =
            (self.segments.equivalent_postures(plan.posture), kinds_left(self.segments.tool_hits.as_deref()));
        let mut known = Proximity::default();
        let mut hits = |point: usize, k: usize| {
            let beta = self.grid().beta(k);
            postures
                .iter()
                .all(|posture| self.problem.at(placement).next_hit(point, beta, *posture, kinds, &mut known).is_some())
        };
        while let Some((point, betas)) = open.pop() {
            for next in [point.wrapping_sub(1), point + 1].into_iter().filter(|next| plan.points.contains(next)) {
                for beta in betas {
                    if !forbidden.contains(next, class, beta) && hits(next, beta) {
                        let [up, down] = forbid(next, class, beta, count, 1, |k| hits(next, k), forbidden);
                        open.push((next, [beta, up, down]));
                    }
                }
            }
        }
    }

    /// Whether something is wrong with the move of a plan to one of its places with beta at both ends turned on by
    /// angles. rad
    fn is_faulty_move(
        &self,
        placement: &Placement,
        plan: &SegmentPlan,
        place: usize,
        turns: [f64; 2],
        known: &mut Proximity,
    ) -> bool {
        let (problem, end) = (self.problem, plan.points.start + place);
        let turned = |k: usize| {
            let (near, beta) = (plan.joints[place - 1 + k], plan.betas[place - 1 + k] + turns[k]);
            let flange = problem.at(placement).base_from_flange(end - 1 + k, beta);
            let found = problem.robot.inverse(&flange, plan.posture).ok()?;
            Some(nearest_turns(&found, &near))
        };
        let (Some(from), Some(to)) = (turned(0), turned(1)) else { return false };
        let scene = problem.scene.as_deref();
        let [start, stop] = [(end - 1, &from), (end, &to)]
            .map(|(point, joints)| scene.map(|scene| problem.poses(scene, point, placement, joints)));
        let ends = scene.zip(start.as_ref().zip(stop.as_ref())).map(|(scene, (start, stop))| (scene, [start, stop]));
        let hits_first =
            ends.is_some_and(|(scene, [start, _])| scene.next_hit(known, start, &PairKind::OF_STATES).is_some());
        hits_first || problem.at(placement).move_fault(end, plan.posture, [from, to], ends, known).is_some()
    }

    /// Forbids the state of the grid next to a beta (rad), or where that is forbidden the one on its other side, with
    /// its neighbours as far as they hit too: that state and the last ones on either side. None where both of the two
    /// were forbidden.
    fn forbid_near(
        &self,
        point: usize,
        class: PostureClass,
        beta: f64,
        stride: usize,
        hits: impl FnMut(usize) -> bool,
        forbidden: &mut StateSet,
    ) -> Option<[usize; 3]> {
        let count = self.grid().beta_count;
        let share = (beta - self.grid().beta(0)) / self.grid().beta_step();
        let nearest = (share.round() as i64).rem_euclid(count as i64) as usize;
        let other = if share > share.round() { nearest + 1 } else { nearest + count - 1 } % count;
        let beta = [nearest, other].into_iter().find(|beta| !forbidden.contains(point, class, *beta))?;
        let [up, down] = forbid(point, class, beta, count, stride, hits, forbidden);
        Some([beta, up, down])
    }
}
