//! The objective of a placement by the lookup table: dynamic programming over interpolated scores.
//!
//! The rules are those of [`crate::redundancy::transition`], but for the steps and turns of the joints.

use super::interpolate::Scratch;
use super::polar::{PlacedPath, PolarPoint};
use super::{BetaGrid, LookupTable};
use crate::candidate::{Objective, best_of};
use crate::problem::Placement;
use crate::redundancy::{BetaChange, StateSet};
use crate::sense::Sense;
use std::ops::Range as Span;
use stead_cell::Proximity;
use stead_model::robot::{Posture, PostureClass};

/// Scratch space of one thread.
#[derive(Debug, Clone)]
pub struct Workspace {
    pub(super) scratch: Scratch,
    scores: Vec<f32>,
    /// Smallest sums of scores so far, over beta.
    costs: Vec<f32>,
    windows: [Vec<f32>; 2],
    /// For each segment the class that won last.
    favourites: Vec<usize>,
    /// Costs after each point of the class gone through last, where there is a scene.
    kept_costs: Vec<f32>,
    /// The same of the best class.
    pub(super) best_costs: Vec<f32>,
    /// States that hit, of the placement evaluated.
    pub(super) forbidden: StateSet,
    /// What is known of distances along the way, and of those across it.
    pub(super) known: [Proximity; 2],
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
            favourites: vec![0; self.problem.task.segments().len()],
            kept_costs: Vec::new(),
            best_costs: Vec::new(),
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
        workspace: &mut Workspace,
    ) -> Objective {
        let schemes = self.problem.unchanging_schemes(scheme);
        if !schemes.is_empty() {
            let of = |scheme: Vec<Posture>| self.objective(placement, grid, Some(&scheme), workspace);
            return best_of(Sense::Min, schemes.into_iter().map(of));
        }
        let placed = self.place(placement);
        if self.problem.scene.is_some() {
            workspace.forbidden.clear();
            workspace.known.iter_mut().for_each(Proximity::clear);
            if self.problem.placement_hit(placement).is_some() {
                return Objective::Infeasible { points: self.problem.task.points().len(), segments: 0 };
            }
        }
        let rules = &self.problem.postures;
        let mut costs = Vec::with_capacity(self.problem.task.segments().len());
        let (mut points, mut segments) = (0, 0);
        for (index, span) in self.problem.task.segments().iter().enumerate() {
            let only = scheme.map(|s| s[index].class().index());
            let asked =
                |class: usize| only.is_none_or(|asked| asked == class) && rules.allows_class(PostureClass::ALL[class]);
            let best = match self.problem.scene {
                None => self.best_class(&placed, (index, span), &asked, grid, workspace),
                Some(_) => self.best_free_class(placement, &placed, (index, span), &asked, grid, workspace),
            };
            if let Some((cost, _)) = best {
                costs.push(self.problem.segment_weight(index) * cost);
                continue;
            }
            let Workspace { scratch, scores, forbidden, .. } = workspace;
            let is_blocked = |point: &usize| {
                let polar = self.polar_point(&placed, *point);
                let mut classes = (0..4).filter(|class| asked(*class));
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
        if points > 0 {
            Objective::Infeasible { points, segments: 0 }
        } else if segments > 0 {
            Objective::Infeasible { points, segments }
        } else {
            Objective::Feasible(self.problem.objective(costs))
        }
    }

    /// The class that gets through a segment, given with its number, with the smallest sum of scores, and that sum. m
    pub(super) fn best_class(
        &self,
        placed: &PlacedPath,
        (index, span): (usize, &Span<usize>),
        asked: &impl Fn(usize) -> bool,
        grid: &BetaGrid,
        workspace: &mut Workspace,
    ) -> Option<(f64, usize)> {
        let mut best: Option<(f64, usize)> = None;
        // The class that won last time goes first: the others can then mostly be given up on the way.
        let first = workspace.favourites[index];
        for class in [first, first ^ 1, first ^ 2, first ^ 3].into_iter().filter(|class| asked(*class)) {
            let bound = best.map_or(f64::INFINITY, |(cost, _)| cost);
            if let Some(cost) = self.through(placed, span.clone(), class, grid, bound, workspace) {
                best = Some((cost, class));
                workspace.favourites[index] = class;
                std::mem::swap(&mut workspace.kept_costs, &mut workspace.best_costs);
            }
        }
        best
    }

    /// The smallest sum of scores with which a posture class gets through a segment, if it is below `bound`. m
    fn through(
        &self,
        placed: &PlacedPath,
        span: Span<usize>,
        class: usize,
        grid: &BetaGrid,
        bound: f64,
        workspace: &mut Workspace,
    ) -> Option<f64> {
        let Workspace { scratch, scores, costs, windows, kept_costs, forbidden, .. } = workspace;
        let has_scene = self.problem.scene.is_some();
        kept_costs.clear();
        // Costs are relative to this, so that long sums keep their digits.
        let mut base = 0.0;
        for (place, point) in span.enumerate() {
            if !self.interpolate(&self.polar_point(placed, point)?, class, grid, scratch, scores) {
                return None;
            }
            let weight = self.problem.task.path().weight(point) as f32;
            if weight != 1.0 {
                scores.iter_mut().for_each(|score| *score *= weight);
            }
            if has_scene {
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
                kept_costs.extend_from_slice(costs);
            }
            if place % RENEWAL == RENEWAL - 1 {
                let min = costs.iter().copied().fold(f32::INFINITY, f32::min);
                costs.iter_mut().for_each(|cost| *cost -= min);
                base += f64::from(min);
            }
        }
        let cost = base + f64::from(costs.iter().copied().fold(f32::INFINITY, f32::min));
        (cost < bound).then_some(cost)
    }
}

/// After so many points costs are made relative to the smallest.
const RENEWAL: usize = 64;

/// Adds to each score the smallest cost from which an allowed change leads to it, cyclically: the new costs. False when none is
/// below `bound`.
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
