//! The lookup table among shapes: a way through a segment is found, its states are looked at, those that hit are
//! forbidden, and the way is found again ([`stead_planning::redundancy`] does the same with the planner).
//!
//! The table does not tell the two flips of the wrist apart, so a state is forbidden where something hits in both.

use super::objective::{PathCheck, Workspace};
use super::{BetaGrid, LookupTable};
use stead_cell::Proximity;
use stead_model::robot::PostureClass;
use stead_planning::redundancy::{StateSet, forbid, kinds_left};
use stead_problem::problem::Placement;

/// Ways through a segment that are looked at, at the most; one that still hits after that counts as none.
const MAX_ROUNDS: usize = 30;

/// Where not all points are looked at, not all values of beta are either, but at least so many of a turn: every 15 deg.
const LEAST_LOOKS: usize = 24;

impl LookupTable<'_> {
    /// The class that gets through a segment in ways in which nothing hits with the smallest sum of scores, and that
    /// sum (m): first the one that was `found`, then what is found `again` without the states that hit.
    pub(super) fn best_free_class(
        &self,
        PathCheck { placement, grid, stride }: &PathCheck<'_>,
        index: usize,
        mut found: Option<(f64, usize)>,
        again: impl Fn(&mut Workspace) -> Option<(f64, usize)>,
        workspace: &mut Workspace,
    ) -> Option<(f64, usize)> {
        let (span, stride) = (&self.problem.task.segments()[index], *stride);
        // States met on earlier ways in which nothing hits.
        let mut free = StateSet::default();
        for _ in 0..MAX_ROUNDS {
            let (_, class) = found?;
            let betas = traced(&workspace.segments[index].rows.costs, &grid.changes[span.clone()], grid.count);
            let Workspace { known: [along, across], forbidden, .. } = workspace;
            let mut is_hit = |place: usize| {
                let (point, beta) = (span.start + place, betas[place]);
                if free.contains(point, PostureClass::ALL[class], beta) {
                    return false;
                }
                let is_hit = self.hits(placement, point, class, grid, beta, along);
                if is_hit {
                    across.begin_with(along);
                    let hits = |k| self.hits(placement, point, class, grid, k, across);
                    let across = stride.min(grid.count / LEAST_LOOKS).max(1);
                    forbid(point, PostureClass::ALL[class], beta, grid.count, across, hits, forbidden);
                } else {
                    free.add(point, PostureClass::ALL[class], beta);
                }
                is_hit
            };
            let mut is_free = true;
            let last = betas.len() - 1;
            for place in (0..last).step_by(stride).chain([last]) {
                if is_hit(place) {
                    is_free = false;
                    let near = place.saturating_sub(stride - 1)..(place + stride).min(betas.len());
                    near.filter(|near| *near != place).for_each(|near| {
                        is_hit(near);
                    });
                }
            }
            if is_free {
                return found;
            }
            found = again(workspace);
        }
        None
    }

    /// Whether something hits at a path point and beta in both flips of a posture class.
    fn hits(
        &self,
        placement: &Placement,
        point: usize,
        class: usize,
        grid: &BetaGrid,
        beta: usize,
        known: &mut Proximity,
    ) -> bool {
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
