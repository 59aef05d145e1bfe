//! Which states a plan may not use any more, once it has turned out to hit, or to have a move that the arm cannot
//! follow.

use super::{Planner, SegmentPlan, StateSet, kinds_left};
use crate::transfer_path::{AtPoint, Space, line_ends};
use stead_cell::{PairKind, Proximity};
use stead_model::robot::PostureClass;
use stead_model::robot::angles::{nearest_turns, wrap};
use stead_problem::collision::{Fault, PlanFault};
use stead_problem::problem::Placement;

/// Of the moves to all values of beta, so many at the most are checked where one may not be.
const MOVES_CHECKED: usize = 90;

/// The values of beta of a grid, all round, of which every so many are checked.
#[derive(Debug, Clone, Copy)]
pub struct BetaRing {
    /// How many there are.
    pub count: usize,
    /// One of so many is checked, and what lies between two that hit is forbidden with them.
    pub stride: usize,
}

impl StateSet {
    /// Adds a state that hits, and its neighbours in beta as far as they hit too: the last that is added on either
    /// side.
    pub fn add_around(
        &mut self,
        point: usize,
        class: PostureClass,
        beta: usize,
        ring: BetaRing,
        mut hits: impl FnMut(usize) -> bool,
    ) -> [usize; 2] {
        let BetaRing { count, stride } = ring;
        self.add(point, class, beta);
        [1, count - 1].map(|side| {
            let mut at = beta;
            loop {
                let next = (at + stride * side) % count;
                if self.contains(point, class, next) || !hits(next) {
                    break;
                }
                for _ in 0..stride {
                    at = (at + side) % count;
                    self.add(point, class, at);
                }
            }
            at
        })
    }
}

/// A plan of a segment in which something is wrong, and the states that plans may not use any more.
pub(super) struct Forbidding<'s> {
    pub planner: &'s Planner<'s>,
    pub placement: &'s Placement,
    pub plan: &'s SegmentPlan,
    pub forbidden: &'s mut StateSet,
}

impl Forbidding<'_> {
    /// Forbids the states of the grid next to the ends of the plan whose lines into or out of the cut are short, but
    /// for ends that are waived: the points of these ends.
    pub fn short_lines(&mut self, is_waived: impl Fn(usize) -> bool) -> Vec<usize> {
        let (planner, placement, plan) = (self.planner, self.placement, self.plan);
        let problem = planner.problem;
        let space = Space::new(problem, placement);
        let is_short = |at: AtPoint| space.line_end(at, problem.segment_moves.retract).is_some();
        let ends = line_ends(problem, plan).into_iter().flatten();
        let short: Vec<AtPoint> = ends.filter(|end| !is_waived(end.point) && is_short(*end)).collect();
        for end in &short {
            let hits = |k: usize| {
                let beta = planner.grid().beta(k);
                let joints =
                    problem.robot.inverse(&problem.at(placement).base_from_flange(end.point, beta), plan.posture);
                joints.is_ok_and(|found| is_short(AtPoint { beta, joints: nearest_turns(&found, &end.joints), ..*end }))
            };
            self.near(end.point, end.beta, 1, hits);
        }
        short.into_iter().map(|end| end.point).collect()
    }

    /// Forbids the states of the grid next to one of the plan that hits; next to one that ends a move which may not be,
    /// or once that is forbidden, next to the one at its start. Where a move to the same point was faulty so many
    /// `times` before, more and more states on either side go with it. Returns the numbers of beta of
    /// [`Forbidding::near`].
    pub fn fault(&mut self, fault: &PlanFault, times: u32) -> Option<[usize; 3]> {
        let (planner, placement, plan) = (self.planner, self.placement, self.plan);
        let (point, place) = (fault.point, fault.point - plan.points.start);
        let (count, mut known) = (planner.grid().beta_count, Proximity::default());
        if !fault.is_between {
            let kinds = kinds_left(planner.segments.tool_hits.as_deref());
            let hits = |k| {
                let beta = planner.grid().beta(k);
                planner.problem.at(placement).next_hit(point, beta, plan.posture, kinds, &mut known).is_some()
            };
            return self.near(point, plan.betas[place], 1, hits);
        }
        // Moves take longer to check than states.
        let stride = (count / MOVES_CHECKED).max(1);
        let is_hit = matches!(fault.fault, Fault::Hit(_));
        [place, place - 1].into_iter().find_map(|at| {
            let (point, beta) = (plan.points.start + at, plan.betas[at]);
            // Past a shape both ends go together; what the arm can follow depends on how far beta turns.
            let turned = |k: usize| {
                let turn = wrap(planner.grid().beta(k) - beta);
                [0, 1].map(|end| if is_hit || place - 1 + end == at { turn } else { 0.0 })
            };
            let moved = Moved { planner, placement, plan, place };
            let hits = |k| moved.is_faulty(turned(k), &mut known);
            let [nearest, up, down] = self.near(point, beta, stride, hits)?;
            for step in 1..((1 << (times / 2).min(8)).min(count)) {
                self.forbidden.add(point, plan.posture.class(), (up + step) % count);
                self.forbidden.add(point, plan.posture.class(), (down + count - step) % count);
            }
            Some([nearest, up, down])
        })
    }

    /// Forbids what hits around states of the plan, given by their points and numbers of beta, whichever way the wrist
    /// is flipped: that costs no plan that is free, and spares to find it state by state.
    #[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
    pub fn around(&mut self, mut open: Vec<(usize, [usize; 3])>) {
        let Self { planner, placement, plan, .. } = *self;
        let (segments, class) = (&planner.segments, plan.posture.class());
        let ring = BetaRing { count: planner.grid().beta_count, stride: 1 };
        let (postures, kinds) = (segments.equivalent_postures(plan.posture), kinds_left(segments.tool_hits.as_deref()));
        let mut known = Proximity::default();
        let mut hits = |point: usize, k: usize| {
            let beta = planner.grid().beta(k);
            postures.iter().all(|posture| {
                planner.problem.at(placement).next_hit(point, beta, *posture, kinds, &mut known).is_some()
            })
        };
        while let Some((point, betas)) = open.pop() {
            for next in [point.wrapping_sub(1), point + 1].into_iter().filter(|next| plan.points.contains(next)) {
                for beta in betas {
                    if !self.forbidden.contains(next, class, beta) && hits(next, beta) {
                        let [up, down] = self.forbidden.add_around(next, class, beta, ring, |k| hits(next, k));
                        open.push((next, [beta, up, down]));
                    }
                }
            }
        }
    }

    /// Forbids the state of the grid next to a beta (rad), or where that is forbidden the one on its other side, with
    /// its neighbours as far as they hit too: that state and the last ones on either side. None where both of the two
    /// were forbidden.
    fn near(&mut self, point: usize, beta: f64, stride: usize, hits: impl FnMut(usize) -> bool) -> Option<[usize; 3]> {
        let (grid, class) = (self.planner.grid(), self.plan.posture.class());
        let count = grid.beta_count;
        let share = (beta - grid.beta(0)) / grid.beta_step();
        let nearest = (share.round() as i64).rem_euclid(count as i64) as usize;
        let other = if share > share.round() { nearest + 1 } else { nearest + count - 1 } % count;
        let beta = [nearest, other].into_iter().find(|beta| !self.forbidden.contains(point, class, *beta))?;
        let [up, down] = self.forbidden.add_around(point, class, beta, BetaRing { count, stride }, hits);
        Some([beta, up, down])
    }
}

/// The move of a plan to one of its places.
#[derive(Clone, Copy)]
struct Moved<'s> {
    planner: &'s Planner<'s>,
    placement: &'s Placement,
    plan: &'s SegmentPlan,
    place: usize,
}

impl Moved<'_> {
    /// Whether something is wrong with the move with beta at both ends turned on by angles. rad
    fn is_faulty(&self, turns: [f64; 2], known: &mut Proximity) -> bool {
        let Self { planner, placement, plan, place } = *self;
        let (problem, end) = (planner.problem, plan.points.start + place);
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
}
