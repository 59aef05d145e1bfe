//! How far beta may go from point to point, in steps of its grid.
//!
//! What is allowed is an interval of changes ([`Problem::beta_step`], with the limits of the grid): about zero for the rate of beta, about the opposite of the
//! feed's turn for the turn of the spindle. Where it is at least two steps of the grid wide, the whole steps in it are all.
//! Between points so close that it is narrower, beta follows the middle of the intervals on the grid, to the nearest step, for
//! as many points as it takes to save up a step, and then makes one of those that the intervals together allow; the plan found
//! is smoothed afterwards, each change spread over the points that it was saved for, so that the limits are kept everywhere.

use super::super::problem::{Problem, Redundancy};
use crate::constraints::STEP_ROUNDING;
use std::ops::Range as Span;
use stead_model::robot::angles::wrap;

/// The changes of the beta number that a step may make: from `min` to `max`, none where `min` is above `max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BetaChange {
    /// The smallest.
    pub min: i32,
    /// The largest.
    pub max: i32,
}

impl BetaChange {
    /// No change is allowed, and not to stand still either.
    pub const NONE: Self = Self { min: 1, max: 0 };

    /// This change alone.
    pub fn only(change: i32) -> Self {
        Self { min: change, max: change }
    }

    /// Whether there is no allowed change.
    pub fn is_none(self) -> bool {
        self.min > self.max
    }

    /// Number of allowed changes.
    pub fn count(self) -> usize {
        (self.max - self.min + 1).max(0) as usize
    }

    /// Shifts from a state to its predecessors (the opposite of the changes), from the middle outwards, so that for changes
    /// about zero small ones come first.
    pub fn shifts(self) -> impl Iterator<Item = isize> {
        let middle = self.middle_shift();
        (0..self.count() as isize).map(move |k| middle + if k % 2 == 1 { -(k + 1) / 2 } else { k / 2 })
    }

    /// The shift in the middle, the larger where there are two.
    pub fn middle_shift(self) -> isize {
        (-self.min - (self.max - self.min) / 2) as isize
    }

    /// The largest size of a change.
    pub fn widest(self) -> usize {
        if self.is_none() { 0 } else { self.min.unsigned_abs().max(self.max.unsigned_abs()) as usize }
    }

    /// The whole numbers within `half` of `middle`, on a cyclic grid of `count` values. Numbers of the grid
    pub(super) fn within(middle: f64, half: f64, count: usize) -> Self {
        let all = count / 2;
        if half < 0.0 {
            return Self::NONE;
        }
        // About zero the ends of an even grid are one value.
        let needed = if middle == 0.0 { all as f64 } else { count as f64 / 2.0 };
        if half + STEP_ROUNDING >= needed {
            return Self { min: -(all as i32), max: all as i32 };
        }
        let middle = middle - count as f64 * (middle / count as f64).round();
        let (min, max) = (middle - half - STEP_ROUNDING, middle + half + STEP_ROUNDING);
        Self { min: min.ceil() as i32, max: max.floor() as i32 }
    }

    /// The changes left when some of them was made before, on a cyclic grid.
    pub(super) fn after(self, taken: i32, count: usize) -> Self {
        let turns = (f64::from(self.min - taken + self.max - taken) / (2.0 * count as f64)).round() as i32;
        let taken = taken + turns * count as i32;
        Self { min: self.min - taken, max: self.max - taken }
    }
}

/// The change of beta at a point where steps are saved up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SavedChange {
    pub change: BetaChange,
    /// Number of points whose joint steps it may take, itself among them.
    pub points: usize,
    /// Whether it follows a moving middle, so that states on the grid are up to half a step of it beside those planned.
    pub is_moving: bool,
}

/// The limits on beta along the whole path, on a grid.
#[derive(Debug, Clone)]
pub(super) struct RateLimit {
    grid: Redundancy,
    /// Between neighbours.
    direct: Vec<BetaChange>,
    /// The same with steps saved up.
    saved: Vec<SavedChange>,
    /// Where a run of points that a change is spread over ends, the number of its points; else zero.
    spread: Vec<usize>,
    /// Whether steps are saved up at a point.
    is_saving: Vec<bool>,
}

/// A run of points over which steps are saved up: sums of the middles and half widths, in steps of the grid.
#[derive(Default)]
struct Run {
    middle: f64,
    half: f64,
    points: usize,
    /// How far the middle was followed.
    taken: i32,
}

impl RateLimit {
    pub fn new(problem: &Problem, grid: &Redundancy) -> Self {
        let count = problem.task.points().len();
        let still = SavedChange { change: BetaChange::only(0), points: 1, is_moving: false };
        let mut limit = Self {
            grid: *grid,
            direct: vec![still.change; count],
            saved: vec![still; count],
            spread: vec![0; count],
            is_saving: vec![false; count],
        };
        for span in problem.task.segments() {
            let mut run = Run::default();
            for point in span.clone().skip(1) {
                limit.add(point, problem, &mut run);
            }
            // What was not saved up to a step follows the middle.
            if run.middle != 0.0 {
                limit.spread[span.end - 1] = run.points;
            }
        }
        limit
    }

    /// Continues a run of saved steps by a point, or leaves it behind.
    fn add(&mut self, point: usize, problem: &Problem, run: &mut Run) {
        let grid = &self.grid;
        let (step, count) = (problem.beta_step_within(point, grid), grid.beta_count);
        let (middle, half) = (step.middle / grid.beta_step(), step.half / grid.beta_step());
        let direct = BetaChange::within(middle, half, count);
        self.direct[point] = direct;
        let is_wide = half + STEP_ROUNDING >= 1.0;
        // Where the middle stands still, so does beta until there is a step, and nothing is owed.
        if half < 0.0 || (is_wide && run.middle == 0.0) {
            self.saved[point] = SavedChange { change: direct, points: 1, is_moving: false };
            *run = Run::default();
            return;
        }
        self.is_saving[point] = true;
        *run = Run { middle: run.middle + middle, half: run.half + half, points: run.points + 1, ..*run };
        if run.half + STEP_ROUNDING >= 1.0 {
            let change = BetaChange::within(run.middle, run.half, count).after(run.taken, count);
            self.saved[point] = SavedChange { change, points: run.points, is_moving: run.middle != 0.0 };
            self.spread[point] = run.points;
            *run = Run::default();
        } else {
            let followed = run.middle.round() as i32;
            let change = followed - run.taken;
            self.saved[point] = SavedChange {
                change: BetaChange::only(change).after(0, count),
                points: if change == 0 { 1 } else { run.points },
                is_moving: run.middle != 0.0,
            };
            run.taken = followed;
        }
    }

    /// The changes of the beta number between neighbours.
    pub fn direct(&self, point: usize) -> BetaChange {
        self.direct[point]
    }

    /// The changes of the beta number at this point where steps are saved up.
    pub fn saved(&self, point: usize) -> SavedChange {
        self.saved[point]
    }

    /// The largest change of the beta number at any point.
    pub fn widest(&self) -> usize {
        let saved = self.saved.iter().map(|saved| saved.change);
        saved.chain(self.direct.iter().copied()).map(BetaChange::widest).max().unwrap_or(0)
    }

    /// Whether steps are spread over several points anywhere in a segment.
    pub fn is_spread(&self, span: &Span<usize>) -> bool {
        self.is_saving[span.clone()].iter().any(|is_saving| *is_saving)
    }

    /// Spreads the changes of a plan over the points that they were saved for: betas at the points of a segment, rad.
    pub fn smooth(&self, problem: &Problem, span: &Span<usize>, betas: &mut [f64]) {
        for point in span.clone().skip(1).filter(|point| self.spread[*point] > 0) {
            let place = point - span.start;
            let first = place + 1 - self.spread[point];
            let steps: Vec<_> = (first..=place).map(|p| problem.beta_step_within(span.start + p, &self.grid)).collect();
            let middle: f64 = steps.iter().map(|step| step.middle).sum();
            let half: f64 = steps.iter().map(|step| step.half).sum();
            let old = betas[first - 1];
            let share = |part: f64| if half > 0.0 { part / half } else { 0.0 };
            let room = half * (1.0 + STEP_ROUNDING) + STEP_ROUNDING;
            let change = wrap(betas[place] - old - middle).clamp(-room, room);
            let (mut part, mut followed) = (0.0, 0.0);
            for (p, step) in (first..=place).zip(&steps) {
                part += step.half;
                followed += step.middle;
                betas[p] = old + followed + change * share(part);
            }
        }
    }
}

#[cfg(test)]
mod tests;
