//! The objective of a placement by the lookup table: dynamic programming over interpolated scores.
//!
//! The rules are those of [`stead_planning::redundancy::transition`], but for the steps and turns of the joints.

use super::interpolate::Scratch;
use super::polar::{PlacedPath, PolarPoint};
use super::{BetaGrid, LookupTable};
use std::ops::Range as Span;
use stead_cell::Proximity;
use stead_model::robot::{Posture, PostureClass};
use stead_planning::redundancy::{BetaChange, StateSet};
use stead_problem::candidate::{Objective, best_of};
use stead_problem::problem::Placement;
use stead_problem::sense::Sense;

/// How the states of a path are checked for collisions.
pub(super) struct PathCheck<'s> {
    pub placement: &'s Placement,
    pub grid: &'s BetaGrid,
    /// See [`CollisionEffort::stride`](CollisionEffort::stride).
    pub stride: usize,
}

/// Scratch space of one thread.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(super) scratch: Scratch,
    scores: Vec<f32>,
    /// Smallest sums of scores so far, over beta.
    costs: Vec<f32>,
    windows: [Vec<f32>; 2],
    pub(super) segments: Vec<SegmentSpace>,
    /// Rows of the class gone through last, where there is a scene.
    kept: Rows,
    /// States that hit, of the placement evaluated.
    pub(super) forbidden: StateSet,
    /// What is known of distances along the way, and of those across it.
    pub(super) known: [Proximity; 2],
}

/// What is known of one segment.
#[derive(Debug, Clone, Default)]
pub(super) struct SegmentSpace {
    /// The class that won last, also with the placement before.
    favourite: usize,
    /// For each class what is known to be not more than its sum of scores. m
    least: [f64; 4],
    /// Rows of the class that won last, where there is a scene.
    pub rows: Rows,
}

/// Values over beta, point by point.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    /// Costs after each point.
    pub costs: Vec<f32>,
    /// Weighed scores, without what collisions forbid.
    scores: Vec<f32>,
    /// Whether all points have scores.
    is_whole: bool,
}

/// The path at a placement, and the grid of beta on which ways along it are found.
#[derive(Clone, Copy)]
struct BetaPath<'s> {
    placed: &'s PlacedPath,
    grid: &'s BetaGrid,
}

/// A posture class with its scores over beta, point by point, as far as they are known.
struct ClassScores<'s> {
    class: usize,
    known: &'s [f32],
}

/// How thoroughly collisions are looked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollisionEffort {
    /// The states of every so many points of a way are looked at first, the others only beside what hits.
    pub stride: usize,
    /// Collisions are checked only if the collision-free objective lies within these; otherwise it is returned
    /// unchecked. m
    pub within: [f64; 2],
}

impl CollisionEffort {
    /// At everything.
    pub const ALL: Self = Self { stride: 1, within: [f64::NEG_INFINITY, f64::INFINITY] };
}

impl LookupTable<'_> {
    /// Scratch space for one thread and one grid of beta.
    pub fn workspace(&self, grid: &BetaGrid) -> Workspace {
        let row = || vec![0.0; grid.count];
        Workspace {
            scratch: Scratch::new(&self.shape, grid),
            scores: row(),
            costs: row(),
            windows: std::array::from_fn(|_| vec![0.0; 2 * grid.count]),
            segments: vec![SegmentSpace::default(); self.problem.task.segments().len()],
            kept: Rows::default(),
            forbidden: StateSet::default(),
            known: Default::default(),
        }
    }

    /// The mean score of the workpiece at a placement under the best plan on a grid of beta, with the
    /// posture scheme found exactly or given (one posture per segment), to the accuracy of the table.
    pub fn objective(
        &self,
        placement: &Placement,
        grid: &BetaGrid,
        scheme: Option<&[Posture]>,
        effort: CollisionEffort,
        workspace: &mut Workspace,
    ) -> Objective {
        let schemes = self.problem.unchanging_schemes(scheme);
        if !schemes.is_empty() {
            let of = |scheme: Vec<Posture>| self.objective(placement, grid, Some(&scheme), effort, workspace);
            return best_of(Sense::Min, schemes.into_iter().map(of));
        }
        let placed = self.place(placement);
        let path = BetaPath { placed: &placed, grid };
        let rules = &self.problem.postures;
        let is_requested = |index: usize, class: usize| {
            let only = scheme.map(|s| s[index].class().index());
            only.is_none_or(|requested| requested == class) && rules.allows_class(PostureClass::ALL[class])
        };
        workspace.forbidden.clear();
        let spans = self.problem.task.segments();
        let mut found: Vec<Option<(f64, usize)>> = Vec::with_capacity(spans.len());
        for index in 0..spans.len() {
            workspace.segments[index].least = [f64::NEG_INFINITY; 4];
            workspace.segments[index].rows.is_whole = false;
            found.push(self.best_class(path, index, &|class| is_requested(index, class), workspace));
        }
        let objective = |found: &[Option<(f64, usize)>]| {
            let cost = |(index, found): (usize, &Option<(f64, usize)>)| {
                found.map(|(cost, _)| self.problem.segment_weight(index) * cost)
            };
            let costs: Option<Vec<f64>> = found.iter().enumerate().map(cost).collect();
            costs.map(|costs| self.problem.objective(costs))
        };
        let relaxed = objective(&found);
        let is_within = |relaxed: f64| relaxed >= effort.within[0] && relaxed <= effort.within[1];
        if self.problem.scene.is_some() && relaxed.is_some_and(is_within) {
            workspace.known.iter_mut().for_each(Proximity::clear);
            if self.problem.placement_hit(placement).is_some() {
                return Objective::Infeasible { points: self.problem.task.points().len(), segments: 0 };
            }
            let check = PathCheck { placement, grid, stride: effort.stride };
            for (index, found) in found.iter_mut().enumerate() {
                let again = |workspace: &mut Workspace| {
                    self.best_class(path, index, &|class| is_requested(index, class), workspace)
                };
                *found = self.best_free_class(&check, index, *found, again, workspace);
            }
        }
        let Some(mean) = objective(&found) else {
            return self.blocked(path, is_requested, &found, workspace);
        };
        Objective::Feasible(mean)
    }

    /// Why there is no way through the segments for which none was found: how many points, or else segments, are in the
    /// way.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    fn blocked(
        &self,
        path: BetaPath<'_>,
        is_requested: impl Fn(usize, usize) -> bool,
        found: &[Option<(f64, usize)>],
        workspace: &mut Workspace,
    ) -> Objective {
        let BetaPath { placed, grid } = path;
        let (mut points, mut segments) = (0, 0);
        let open = self.problem.task.segments().iter().enumerate().filter(|(index, _)| found[*index].is_none());
        for (index, span) in open {
            let Workspace { scratch, scores, forbidden, .. } = workspace;
            let is_blocked = |point: &usize| {
                let polar = self.polar_point(placed, *point);
                let mut classes = (0..4).filter(|class| is_requested(index, *class));
                let mut is_allowed = |polar: &PolarPoint, class: usize| {
                    let is_reached = self.interpolate(polar, class, grid, scratch, scores);
                    for hits in grid.tool_hits.as_deref().into_iter().chain([&*forbidden]) {
                        hits.apply_to_scores(*point, class, scores);
                    }
                    is_reached && scores.iter().any(|score| score.is_finite())
                };
                polar.is_none_or(|polar| !classes.any(|class| is_allowed(&polar, class)))
            };
            let blocked = span.clone().filter(is_blocked).count();
            points += blocked;
            segments += usize::from(blocked == 0);
        }
        Objective::Infeasible { points, segments: if points > 0 { 0 } else { segments } }
    }

    /// The class that gets through a segment with the smallest sum of scores, and that sum. m
    fn best_class(
        &self,
        path: BetaPath<'_>,
        index: usize,
        is_requested: &impl Fn(usize) -> bool,
        workspace: &mut Workspace,
    ) -> Option<(f64, usize)> {
        let span = &self.problem.task.segments()[index];
        let mut best: Option<(f64, usize)> = None;
        // The class that won last time goes first: the others can then mostly be given up on the way.
        let SegmentSpace { favourite: first, least, .. } = workspace.segments[index];
        let mut order = [first, first ^ 1, first ^ 2, first ^ 3];
        order.sort_by(|a, b| least[*a].total_cmp(&least[*b]));
        for class in order.into_iter().filter(|class| is_requested(*class)) {
            let bound = best.map_or(f64::INFINITY, |(cost, _)| cost);
            if least[class] >= bound {
                continue;
            }
            // The scores of the class that won last are kept.
            let is_kept = class == first && workspace.segments[index].rows.is_whole;
            let known = if is_kept { std::mem::take(&mut workspace.segments[index].rows.scores) } else { Vec::new() };
            let cost = self.through(path, span.clone(), ClassScores { class, known: &known }, bound, workspace);
            if is_kept {
                workspace.segments[index].rows.scores = known;
            }
            let space = &mut workspace.segments[index];
            space.least[class] = cost.unwrap_or(bound).max(space.least[class]);
            if let Some(cost) = cost {
                best = Some((cost, class));
                space.favourite = class;
                std::mem::swap(&mut workspace.kept, &mut space.rows);
            }
        }
        best
    }

    /// The smallest sum of scores with which a posture class gets through a segment, if it is below `bound`; its scores
    /// are interpolated where they are not known. m
    fn through(
        &self,
        path: BetaPath<'_>,
        span: Span<usize>,
        scores_of: ClassScores<'_>,
        bound: f64,
        workspace: &mut Workspace,
    ) -> Option<f64> {
        let (BetaPath { placed, grid }, ClassScores { class, known }) = (path, scores_of);
        let Workspace { scratch, scores, costs, windows, kept, forbidden, .. } = workspace;
        let has_scene = self.problem.scene.is_some();
        kept.costs.clear();
        kept.scores.clear();
        kept.is_whole = false;
        let mut known = known.chunks_exact(grid.count);
        // Costs are relative to this, so that long sums keep their digits.
        let mut base = 0.0;
        for (place, point) in span.enumerate() {
            if let Some(known) = known.next() {
                scores.copy_from_slice(known);
            } else {
                if !self.interpolate(&self.polar_point(placed, point)?, class, grid, scratch, scores) {
                    return None;
                }
                let weight = self.problem.task.path().weight(point) as f32;
                if weight != 1.0 {
                    // A point of no weight has forbidden states too.
                    scores.iter_mut().filter(|score| score.is_finite()).for_each(|score| *score *= weight);
                }
            }
            if has_scene {
                kept.scores.extend_from_slice(scores);
                for hits in grid.tool_hits.as_deref().into_iter().chain([&*forbidden]) {
                    hits.apply_to_scores(point, class, scores);
                }
            }
            if place == 0 {
                costs.copy_from_slice(scores);
                if !costs.iter().any(|cost| cost.is_finite()) {
                    return None;
                }
            } else if !advance(costs, scores, grid.changes[point], (bound - base) as f32, windows) {
                return None;
            }
            if has_scene {
                kept.costs.extend_from_slice(costs);
            }
            if place % RENEWAL == RENEWAL - 1 {
                let min = costs.iter().copied().fold(f32::INFINITY, f32::min);
                costs.iter_mut().for_each(|cost| *cost -= min);
                base += f64::from(min);
            }
        }
        kept.is_whole = has_scene;
        let cost = base + f64::from(costs.iter().copied().fold(f32::INFINITY, f32::min));
        (cost < bound).then_some(cost)
    }
}

/// After so many points costs are made relative to the smallest.
const RENEWAL: usize = 64;

/// Adds to each score the smallest cost from which an allowed change leads to it, cyclically: the new costs. False when
/// none is below `bound`.
fn advance(costs: &mut [f32], scores: &[f32], change: BetaChange, bound: f32, windows: &mut [Vec<f32>; 2]) -> bool {
    let count = costs.len();
    let min = |a: f32, b: f32| if b < a { b } else { a };
    let mut any = false;
    let band = change.count();
    if band == 0 {
        return false;
    }
    if band >= count {
        let best = costs.iter().copied().fold(f32::INFINITY, f32::min);
        for (cost, score) in costs.iter_mut().zip(scores) {
            *cost = best + score;
            any |= *cost < bound;
        }
        return any;
    }
    // Minima over windows of 1, 2, 4, ... values, then two of the widest that make up the band.
    let length = count + band - 1;
    let [now, next] = windows;
    // Costs from the predecessor by the largest change of the first state on, continued cyclically.
    let first = (-change.max).rem_euclid(count as i32) as usize;
    now[..count - first].copy_from_slice(&costs[first..]);
    let again = (length - (count - first)).min(count);
    now[count - first..count - first + again].copy_from_slice(&costs[..again]);
    now[count - first + again..length].copy_from_slice(&costs[..length - (count - first) - again]);
    let mut width = 1;
    while 2 * width <= band {
        let kept = length + 1 - 2 * width;
        let (a, b) = (&now[..kept], &now[width..width + kept]);
        for (out, (a, b)) in next[..kept].iter_mut().zip(a.iter().zip(b)) {
            *out = min(*a, *b);
        }
        std::mem::swap(now, next);
        width *= 2;
    }
    let (a, b) = (&now[..count], &now[band - width..band - width + count]);
    for ((cost, score), (a, b)) in costs.iter_mut().zip(scores).zip(a.iter().zip(b)) {
        *cost = min(*a, *b) + score;
        any |= *cost < bound;
    }
    any
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn advance_agrees_with_plain_loops(
            pairs in prop::collection::vec((0.0..1.0_f32, 0.0..1.0_f32, 0..10_u8), 3..60), middle in -70..70_i32, band in 0..40_i32, bound in 0.5..3.0_f32
        ) {
            let count = pairs.len();
            let band = band.min(count as i32);
            let change = BetaChange { min: middle, max: middle + band - 1 };
            let before: Vec<f32> = pairs.iter().map(|p| if p.2 < 3 { f32::INFINITY } else { p.0 }).collect();
            let scores: Vec<f32> = pairs.iter().map(|p| if p.2 > 7 { f32::INFINITY } else { p.1 }).collect();
            let mut costs = before.clone();
            let mut windows = [vec![0.0; 2 * count], vec![0.0; 2 * count]];
            let any = advance(&mut costs, &scores, change, bound, &mut windows);
            if band == 0 {
                prop_assert!(!any);
                return Ok(());
            }
            for k in 0..count {
                let at = |change: i32| before[(k as i32 - change).rem_euclid(count as i32) as usize];
                let near = (change.min..=change.max).map(at);
                prop_assert_eq!(costs[k], near.fold(f32::INFINITY, f32::min) + scores[k]);
            }
            prop_assert_eq!(any, costs.iter().any(|cost| *cost < bound));
        }
    }
}
