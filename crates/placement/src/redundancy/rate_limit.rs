//! How far beta may go from point to point, in steps of its grid.
//!
//! Where the rate of beta allows a step of the grid or more between neighbours, that is all. Between points so close that it
//! does not, beta stands still on the grid for as many points as a step takes, and then makes it; the plan found is
//! smoothed afterwards, each step spread over the points that it was saved for, so that the rate is kept everywhere.

use super::super::problem::{Problem, Redundancy};
use crate::constraints::STEP_ROUNDING;
use std::ops::Range as Span;
use stead_model::robot::angles::wrap;

/// The rate_limit of beta along the whole path.
#[derive(Debug, Clone)]
pub(super) struct RateLimit {
    /// Largest change of the beta number from the point before, by the rate alone.
    reaches: Vec<u32>,
    /// Number of points over which a change at this point is spread, itself among them; zero where none may be.
    strides: Vec<u32>,
}

impl RateLimit {
    pub fn new(problem: &Problem, grid: &Redundancy) -> Self {
        let count = problem.task.points().len();
        let mut rate_limit = Self { reaches: vec![0; count], strides: vec![1; count] };
        let max_reach = (grid.beta_count / 2) as f64;
        for span in problem.task.segments() {
            let (mut saved, mut stride) = (0.0, 0);
            for point in span.clone().skip(1) {
                let steps = problem.beta_step_limit(point) / grid.beta_step();
                let reach = (steps + STEP_ROUNDING).min(max_reach) as u32;
                rate_limit.reaches[point] = reach;
                if reach > 0 {
                    (saved, stride) = (0.0, 0);
                    continue;
                }
                (saved, stride) = (saved + steps, stride + 1);
                if saved + STEP_ROUNDING >= 1.0 {
                    rate_limit.strides[point] = stride;
                    (saved, stride) = (0.0, 0);
                } else {
                    rate_limit.strides[point] = 0;
                }
            }
        }
        rate_limit
    }

    /// Largest change of the beta number between neighbours, by the rate alone.
    pub fn reach(&self, point: usize) -> usize {
        self.reaches[point] as usize
    }

    /// Largest change of the beta number at this point, and over how many points it is spread.
    pub fn step(&self, point: usize) -> (usize, usize) {
        match self.strides[point] {
            0 => (0, 1),
            1 => (self.reach(point), 1),
            stride => (1, stride as usize),
        }
    }

    /// The largest change of the beta number at any point.
    pub fn widest(&self) -> usize {
        (0..self.reaches.len()).map(|point| self.step(point).0).max().unwrap_or(0)
    }

    /// Whether steps are spread over several points anywhere in a segment.
    pub fn is_spread(&self, span: &Span<usize>) -> bool {
        self.strides[span.clone()].iter().any(|stride| *stride != 1)
    }

    /// Spreads the steps of a plan over the points that they were saved for: betas at the points of a segment, rad.
    pub fn smooth(&self, problem: &Problem, span: &Span<usize>, betas: &mut [f64]) {
        for point in span.clone().skip(1) {
            let (reach, stride) = self.step(point);
            let place = point - span.start;
            let (old, step) = (betas[place - 1], wrap(betas[place] - betas[place - 1]));
            if reach == 0 || stride == 1 || step == 0.0 {
                continue;
            }
            let first = place + 1 - stride;
            let limits = first..=place;
            let sum: f64 = limits.clone().map(|p| problem.beta_step_limit(span.start + p)).sum();
            let mut part = 0.0;
            for p in limits {
                part += problem.beta_step_limit(span.start + p);
                betas[p] = old + step * (part / sum);
            }
        }
    }
}
