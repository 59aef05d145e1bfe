//! Where points are so close that the grid of beta has no step small enough between neighbours: plans from knot to
//! knot.
//!
//! A knot is a point far enough from the knot before it that the limits on beta and on the joints together allow some
//! steps of the grid. The dynamic programming goes from knot to knot, and beta in between follows the middle of what is
//! allowed, the rest of the change spread in proportion to the room that each point has. So the plans are those with
//! beta piecewise linear, which [`super::off_grid`] then improves point by point. A point with room enough is a knot by
//! itself, and the planning the usual one; so is every point where beta stays.
//!
//! Joint steps are held against the limits of a run taken together; what they are in between is seen when the plan is
//! spread.

use super::rate_limit::BetaChange;
use std::f64::consts::PI;
use std::ops::Range as Span;
use stead_model::robot::angles::wrap;
use stead_problem::constraints::STEP_ROUNDING;
use stead_problem::problem::{BetaPlan, MAX_JOINT_STEP, Problem, Redundancy};

/// How many steps of the grid must be allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StepBudget {
    /// Between neighbours, for both to be knots.
    pub neighbours: f64,
    /// From knot to knot otherwise.
    pub knots: f64,
}

/// What a path point is to the planning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Place {
    /// The end of a run of points, often of one.
    Knot(Knot),
    /// Inside a run.
    Between {
        /// The knot that ends the run, a path point.
        knot: usize,
        /// The middle of the changes from here to the knot. Steps of the grid
        middle: f64,
        /// The share of the other change that is made from here to the knot.
        share: f64,
        /// Whether it is the first of its run.
        is_first: bool,
    },
}

/// The end of a run of points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Knot {
    /// Its number in the segment, from 0.
    pub number: usize,
    /// Allowed changes of the beta number from the knot before.
    pub change: BetaChange,
    /// Number of points since the knot before.
    pub points: usize,
    /// The middle of the changes. Steps of the grid
    pub middle: f64,
}

/// The knots of a whole path, on a grid of beta.
#[derive(Debug, Clone)]
pub(super) struct Knots {
    grid: Redundancy,
    /// For each path point.
    places: Vec<Place>,
    /// For each path point the allowed changes from the one before. Steps of the grid
    budgets: Vec<PointBudget>,
    /// Of all segments one after the other, as path points.
    knots: Vec<usize>,
}

/// What a point allows: changes within `half` of `middle`, of which the joints make `sure` in most places. Steps of the
/// grid
#[derive(Debug, Clone, Copy, Default)]
struct PointBudget {
    middle: f64,
    half: f64,
    sure: f64,
}

impl PointBudget {
    fn new(problem: &Problem, grid: &Redundancy, point: usize, joints: &[f64; 6]) -> Self {
        let step = problem.beta_step_within(point, grid);
        let slowest = joints.iter().copied().fold(MAX_JOINT_STEP, f64::min);
        let together: f64 = joints.iter().sum();
        let (mut middle, mut half) = (step.middle, step.half.min(PI));
        if step.middle == 0.0 && half > together {
            // The spindle turns in space by no more than the joints together.
            let still = problem.still_change(point);
            let (min, max) = (f64::max(-half, still - together), f64::min(half, still + together));
            if min < max {
                (middle, half) = ((min + max) / 2.0, (max - min) / 2.0);
            }
        }
        let unit = grid.beta_step();
        Self { middle: middle / unit, half: half / unit, sure: half.min(slowest) / unit }
    }

    fn plus(self, other: Self) -> Self {
        Self { middle: self.middle + other.middle, half: self.half + other.half, sure: self.sure + other.sure }
    }
}

impl Knots {
    /// For points whose joints may step by `joints` (rad); `direct` are the changes between neighbours.
    #[expect(clippy::excessive_nesting, reason = "one loop over several dimensions, without calls between")]
    pub fn new(
        problem: &Problem,
        grid: &Redundancy,
        joints: &[[f64; 6]],
        direct: &[BetaChange],
        budget: StepBudget,
    ) -> Self {
        let count = joints.len();
        let start = Knot { number: 0, change: BetaChange::only(0), points: 1, middle: 0.0 };
        let mut found = Self {
            grid: *grid,
            places: vec![Place::Knot(start); count],
            budgets: vec![PointBudget::default(); count],
            knots: Vec::new(),
        };
        for span in problem.task.segments() {
            found.knots.push(span.start);
            let mut number = 1;
            let (mut run, mut points) = (PointBudget::default(), 0);
            for point in span.clone().skip(1) {
                let own = PointBudget::new(problem, grid, point, &joints[point]);
                found.budgets[point] = own;
                let has_room = grid.beta != BetaPlan::Free || own.sure + STEP_ROUNDING >= budget.neighbours;
                if points == 0 && (own.half < 0.0 || has_room) {
                    let knot = Knot { number, change: direct[point], points: 1, middle: 0.0 };
                    found.places[point] = Place::Knot(knot);
                    found.knots.push(point);
                    number += 1;
                    continue;
                }
                (run, points) = (run.plus(own), points + 1);
                if own.half < 0.0 || run.sure + STEP_ROUNDING >= budget.knots || point + 1 == span.end {
                    // A remainder too short belongs to the run before it.
                    let previous = point - points;
                    if run.sure + STEP_ROUNDING < budget.knots && found.points(previous) > 1 {
                        points += found.points(previous);
                        number -= 1;
                        found.knots.pop();
                    }
                    found.run(point, points, number);
                    found.knots.push(point);
                    number += 1;
                    (run, points) = (PointBudget::default(), 0);
                }
            }
        }
        found
    }

    /// Number of points of the run that ends at a point, none where none does.
    fn points(&self, point: usize) -> usize {
        if let Place::Knot(knot) = self.places[point] { knot.points } else { 0 }
    }

    /// Lays a run of points that ends with a knot.
    fn run(&mut self, knot: usize, points: usize, number: usize) {
        let first = knot + 1 - points;
        let count = self.grid.beta_count;
        let all = self.budgets[first..=knot].iter().fold(PointBudget::default(), |sum, budget| sum.plus(*budget));
        let is_open = self.budgets[first..=knot].iter().all(|budget| budget.half >= 0.0);
        let mut change = BetaChange::within(all.middle, if is_open { all.half } else { -1.0 }, count);
        if is_open && change.is_none() {
            change = BetaChange::only(all.middle.round() as i32).after(0, count);
        }
        let (mut middle, mut half) = (0.0, 0.0);
        self.places[knot] = Place::Knot(Knot { number, change, points, middle: all.middle });
        for point in (first..knot).rev() {
            middle += self.budgets[point + 1].middle;
            half += self.budgets[point + 1].half;
            let share = if all.half > 0.0 { half / all.half } else { 0.0 };
            self.places[point] = Place::Between { knot, middle, share, is_first: point == first };
        }
    }

    /// What a path point is.
    pub fn at(&self, point: usize) -> Place {
        self.places[point]
    }

    /// The knots of a segment, as path points.
    pub fn of(&self, span: &Span<usize>) -> &[usize] {
        let [first, last] = [span.start, span.end].map(|point| self.knots.partition_point(|knot| *knot < point));
        &self.knots[first..last]
    }

    /// The middle of the changes of beta to a point from the one before that limits and joints together allow, and how
    /// far from it they go at the most. rad
    pub fn change_at(&self, point: usize) -> (f64, f64) {
        let PointBudget { middle, half, .. } = self.budgets[point];
        (middle * self.grid.beta_step(), half * self.grid.beta_step())
    }

    /// Whether a segment has points between knots.
    pub fn is_spread(&self, span: &Span<usize>) -> bool {
        self.of(span).len() < span.len()
    }

    /// The knots that end runs of more than one point.
    fn wide(&self) -> impl Iterator<Item = Knot> {
        self.places.iter().filter_map(|place| match place {
            Place::Knot(knot) if knot.points > 1 => Some(*knot),
            _ => None,
        })
    }

    /// The largest change of the beta number over a run.
    pub fn widest(&self) -> usize {
        // In between beta may be farther from the knot than the knot before it is, most of all where the part turns to
        // and fro.
        let reach = |knot: Knot| knot.change.widest() + 2 + knot.middle.abs() as usize;
        let between = self.places.iter().map(|place| match place {
            Place::Between { middle, .. } => middle.abs() as usize,
            Place::Knot(_) => 0,
        });
        let widest = self.wide().map(reach).max().unwrap_or(0) + between.max().unwrap_or(0);
        widest.min(self.grid.beta_count)
    }

    /// The largest number of changes over a run.
    pub fn most_changes(&self) -> usize {
        self.wide().map(|knot| knot.change.count()).max().unwrap_or(0)
    }

    /// By how many steps of the grid beta at a point between knots is beside that of the knot, for each change up to
    /// it; half a turn at the most.
    pub fn offsets(&self, knot: Knot, middle: f64, share: f64) -> impl Iterator<Item = f64> + use<> {
        let count = self.grid.beta_count as f64;
        (knot.change.min..=knot.change.max).map(move |change| {
            let within_half = |change: f64| change - count * (change / count).round();
            -within_half(middle + within_half(f64::from(change) - knot.middle) * share)
        })
    }

    /// Fills in beta (rad) between the knots of a segment.
    pub fn spread(&self, span: &Span<usize>, betas: &mut [f64]) {
        let unit = self.grid.beta_step();
        for pair in self.of(span).windows(2).filter(|pair| pair[1] - pair[0] > 1) {
            let budgets = &self.budgets[pair[0] + 1..=pair[1]];
            let all = budgets.iter().fold(PointBudget::default(), |sum, budget| sum.plus(*budget));
            let (start, end) = (betas[pair[0] - span.start], betas[pair[1] - span.start]);
            let most = all.half * unit * (1.0 + STEP_ROUNDING) + STEP_ROUNDING;
            let beside = wrap(end - start - all.middle * unit).clamp(-most, most);
            let mut part = PointBudget::default();
            for (point, budget) in (pair[0] + 1..=pair[1]).zip(budgets) {
                part = part.plus(*budget);
                let share = if all.half > 0.0 { part.half / all.half } else { 0.0 };
                betas[point - span.start] = start + part.middle * unit + beside * share;
            }
        }
    }
}
