//! The joint travel in the objective of the subproblem.

use super::subproblem::Build;
use stead_planning::problem::Problem;

/// The joint travel in the objective. Where a step of a joint may change its direction inside the trust region, one
/// more variable is not less than its size; elsewhere it is linear.
#[derive(Debug, Default)]
pub(super) struct Travel {
    /// What a radian of it counts. Units of the objective
    pub weight: f64,
    /// What it is at the solution, but for steps with a variable. Units of the objective
    pub here: f64,
    /// How that changes with the variables.
    pub slopes: Vec<(usize, f64)>,
    /// Variables that are sizes of steps.
    pub sizes: usize,
}

impl Travel {
    pub fn new(problem: &Problem, unit: f64) -> Self {
        Self { weight: problem.travel_weight() / unit, ..Self::default() }
    }
}

impl Build<'_> {
    /// Counts the size of a joint's step (rad), where joint travel counts.
    pub(super) fn step_size(&mut self, step: f64, row: &[(usize, f64)]) {
        if self.travel.weight == 0.0 {
            return;
        }
        let swing = self.request.trust * row.iter().map(|(_, v)| v.abs()).sum::<f64>();
        if step.abs() > swing {
            let weight = self.travel.weight * step.signum();
            self.travel.here += weight * step;
            self.travel.slopes.extend(row.iter().map(|(column, slope)| (*column, weight * slope)));
            return;
        }
        let size = self.sizes() + self.travel.sizes;
        self.travel.sizes += 1;
        self.travel.slopes.push((size, self.travel.weight));
        for sign in [1.0, -1.0] {
            let terms = row.iter().map(|(column, slope)| (*column, sign * slope)).chain([(size, -1.0)]);
            self.rows.add(terms, -sign * step);
        }
    }
}
