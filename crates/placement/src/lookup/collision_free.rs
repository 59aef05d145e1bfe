//! The lookup table among shapes: a way through a segment is found, its states are looked at, those that hit are
//! forbidden, and the way is found again ([`stead_planning::redundancy`] does the same with the planner).
//!
//! The table does not tell the two flips of the wrist apart, so a state is forbidden where something hits in both.

use super::LookupTable;
use super::objective::{PathCheck, Workspace};
use stead_cell::Proximity;
use stead_model::robot::PostureClass;
use stead_planning::redundancy::{BetaRing, Lazy, StateSet, kinds_left, until_free};

/// Ways through a segment that are looked at, at the most; one that still hits after that counts as none.
const MAX_ROUNDS: usize = 30;

/// Where not all points are looked at, not all values of beta are either, but at least so many of a turn: every 15 deg.
const LEAST_LOOKS: usize = 24;

/// Ways through a segment with more and more states forbidden.
struct FreeWays<'s, F> {
    table: &'s LookupTable<'s>,
    check: &'s PathCheck<'s>,
    /// The segment.
    index: usize,
    /// The class that gets through with the smallest sum of scores, and that sum, where it is known. m
    found: Option<(f64, usize)>,
    /// What finds that again.
    again: F,
    workspace: &'s mut Workspace,
    /// States of earlier ways in which nothing hits.
    free: StateSet,
}

impl<F> FreeWays<'_, F> {
    /// Whether something hits in a state of a way; then it is forbidden with its neighbours.
    fn is_hit(&mut self, point: usize, class: usize, beta: usize) -> bool {
        let PathCheck { grid, stride, .. } = *self.check;
        let of_class = PostureClass::ALL[class];
        if self.free.contains(point, of_class, beta) {
            return false;
        }
        let Workspace { known: [along, across], forbidden, .. } = &mut *self.workspace;
        let is_hit = self.table.hits(self.check, point, class, beta, along);
        if is_hit {
            across.begin_with(along);
            let ring = BetaRing { count: grid.count, stride: stride.min(grid.count / LEAST_LOOKS).max(1) };
            let hits = |k| self.table.hits(self.check, point, class, k, across);
            forbidden.add_around(point, of_class, beta, ring, hits);
        } else {
            self.free.add(point, of_class, beta);
        }
        is_hit
    }
}

impl<F: FnMut(&mut Workspace) -> Option<(f64, usize)>> Lazy for FreeWays<'_, F> {
    type Plan = (f64, usize);
    type Refused = ();

    fn plan(&mut self) -> Result<(f64, usize), ()> {
        self.found.take().or_else(|| (self.again)(self.workspace)).ok_or(())
    }

    fn forbid(&mut self, found: &(f64, usize)) -> bool {
        let (span, class) = (&self.table.problem.task.segments()[self.index], found.1);
        let PathCheck { grid, stride, .. } = *self.check;
        let costs = &self.workspace.segments[self.index].rows.costs;
        let betas = traced(costs, &grid.changes[span.clone()], grid.count);
        let mut is_any = false;
        let last = betas.len() - 1;
        for place in (0..last).step_by(stride).chain([last]) {
            if self.is_hit(span.start + place, class, betas[place]) {
                is_any = true;
                let near = place.saturating_sub(stride - 1)..(place + stride).min(betas.len());
                for near in near.filter(|near| *near != place) {
                    self.is_hit(span.start + near, class, betas[near]);
                }
            }
        }
        is_any
    }
}

impl LookupTable<'_> {
    /// The class that gets through a segment in ways in which nothing hits with the smallest sum of scores, and that
    /// sum (m): first the one that was `found`, then what is found `again` without the states that hit.
    pub(super) fn best_free_class(
        &self,
        check: &PathCheck<'_>,
        index: usize,
        found: Option<(f64, usize)>,
        again: impl FnMut(&mut Workspace) -> Option<(f64, usize)>,
        workspace: &mut Workspace,
    ) -> Option<(f64, usize)> {
        found?;
        let mut job = FreeWays { table: self, check, index, found, again, workspace, free: StateSet::default() };
        until_free(&mut job, MAX_ROUNDS).ok().filter(|(_, is_free)| *is_free).map(|(found, _)| found)
    }

    /// Whether something hits at a path point and beta in both flips of a posture class.
    fn hits(&self, check: &PathCheck<'_>, point: usize, class: usize, beta: usize, known: &mut Proximity) -> bool {
        let PathCheck { placement, grid, .. } = *check;
        let [plain, flipped] = PostureClass::ALL[class].postures();
        let kinds = kinds_left(grid.tool_hits.as_deref());
        let mut hit = |posture| self.problem.at(placement).next_hit(point, grid.beta(beta), posture, kinds, known);
        let Some(pair) = hit(plain) else { return false };
        let knows_flips =
            self.problem.scene.as_deref().and_then(|scene| scene.pair(pair)).is_some_and(|p| p.knows_flips);
        !knows_flips || hit(flipped).is_some()
    }
}

/// The numbers of beta on the way with the least cost at its end, from the costs after each point.
fn traced(kept: &[f32], changes: &[stead_planning::redundancy::BetaChange], count: usize) -> Vec<usize> {
    let rows: Vec<&[f32]> = kept.chunks_exact(count).collect();
    let least = |betas: &mut dyn Iterator<Item = usize>, row: &[f32]| {
        betas.min_by(|a, b| row[*a].total_cmp(&row[*b])).unwrap_or(0)
    };
    let mut betas = vec![0; rows.len()];
    for place in (0..rows.len()).rev() {
        betas[place] = match betas.get(place + 1) {
            None => least(&mut (0..count), rows[place]),
            Some(next) => {
                let change = changes[place + 1];
                let before = |by: i32| (*next as i32 - by).rem_euclid(count as i32) as usize;
                let widest = change.min..=change.max.min(change.min + count as i32 - 1);
                least(&mut widest.map(before), rows[place])
            }
        };
    }
    betas
}
