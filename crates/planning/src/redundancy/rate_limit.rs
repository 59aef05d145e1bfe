//! How far beta may go from point to point, in steps of its grid.
//!
//! What is allowed is an interval of changes ([`Problem::beta_step`], with the limits of the grid): about zero for the
//! rate of beta, about the opposite of the feed's turn for the turn of the spindle. Where it is at least two steps of
//! the grid wide, the whole steps in it are all. Between points so close that it is narrower, the planner goes from
//! knot to knot ([`super::knots`]). The lookup table, which only estimates, goes from point to point there too: beta
//! follows the middle of the intervals on the grid, to the nearest step, for as many points as it takes to save up a
//! step, and then makes one of those that the intervals together allow.

use stead_problem::beta_step::BetaStep;
use stead_problem::constraints::STEP_ROUNDING;
use stead_problem::problem::{Problem, Redundancy};

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

    /// Shifts from a state to its predecessors (the opposite of the changes), from the middle outwards, so that for
    /// changes about zero small ones come first.
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

    /// Those that a step allows on a grid.
    pub(super) fn of(step: BetaStep, grid: &Redundancy) -> Self {
        Self::within(step.middle / grid.beta_step(), step.half / grid.beta_step(), grid.beta_count)
    }

    /// The changes left when some of them was made before, on a cyclic grid.
    pub(super) fn after(self, taken: i32, count: usize) -> Self {
        let turns = (f64::from(self.min - taken + self.max - taken) / (2.0 * count as f64)).round() as i32;
        let taken = taken + turns * count as i32;
        Self { min: self.min - taken, max: self.max - taken }
    }
}

/// A run of points over which steps are saved up: sums of the middles and half widths, in steps of the grid.
#[derive(Default)]
struct Run {
    middle: f64,
    half: f64,
    /// How far the middle was followed.
    taken: i32,
}

impl Run {
    /// Continues a run of saved steps by a point, or leaves it behind; returns the changes allowed there.
    fn add(&mut self, point: usize, problem: &Problem, grid: &Redundancy) -> BetaChange {
        let (step, count) = (problem.beta_step_within(point, grid), grid.beta_count);
        let (middle, half) = (step.middle / grid.beta_step(), step.half / grid.beta_step());
        let is_wide = half + STEP_ROUNDING >= 1.0;
        // Where the middle stands still, so does beta until there is a step, and nothing is owed.
        if half < 0.0 || (is_wide && self.middle == 0.0) {
            *self = Self::default();
            return BetaChange::within(middle, half, count);
        }
        *self = Self { middle: self.middle + middle, half: self.half + half, ..*self };
        if self.half + STEP_ROUNDING >= 1.0 {
            let run = std::mem::take(self);
            BetaChange::within(run.middle, run.half, count).after(run.taken, count)
        } else {
            let followed = self.middle.round() as i32;
            let taken = std::mem::replace(&mut self.taken, followed);
            BetaChange::only(followed - taken).after(0, count)
        }
    }
}

/// Allowed changes of the beta number at every path point from the one before, on a grid.
pub(super) fn direct_changes(problem: &Problem, grid: &Redundancy) -> Vec<BetaChange> {
    let change = |point: usize| BetaChange::of(problem.beta_step_within(point, grid), grid);
    let mut changes = vec![BetaChange::only(0); problem.task.points().len()];
    for point in problem.task.segments().iter().flat_map(|span| span.clone().skip(1)) {
        changes[point] = change(point);
    }
    changes
}

/// The same with steps saved up: where points are so close that less than a step is allowed between neighbours, a step
/// after every few of them.
pub fn saved_changes(problem: &Problem, grid: &Redundancy) -> Vec<BetaChange> {
    let mut changes = vec![BetaChange::only(0); problem.task.points().len()];
    for span in problem.task.segments() {
        let mut run = Run::default();
        for point in span.clone().skip(1) {
            changes[point] = run.add(point, problem, grid);
        }
    }
    changes
}

#[cfg(test)]
mod tests;
