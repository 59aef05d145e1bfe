//! What bounds lead and tilt in the subproblem: their ranges, what bounds a lean beside them, and how far the tool axis
//! may turn from point to point for the contact to stay near its line.

use super::variables::Build;
use clarabel::solver::{SecondOrderConeT, SupportedConeT};
use nalgebra::Vector3;
use stead_model::task::PathPoint;
use stead_model::task::lean::Lean;
use stead_problem::lean::LeanSpace;
use stead_problem::limit::{Limit, Side};

/// How far the leans are apart whose difference is the slope. rad
const STEP: f64 = 1e-6;
/// The linear model of a turn may use this share of what is allowed: a step leaves it by its square.
const KEPT: f64 = 0.98;

/// The tool axis at a point with its slopes by lead and tilt.
fn axis(at: &PathPoint, lean: &Lean) -> (Vector3<f64>, [Vector3<f64>; 2]) {
    let slope = |ends: [Lean; 2]| (ends[0].axis(at) - ends[1].axis(at)) / (2.0 * STEP);
    (lean.axis(at), beside(lean).map(slope))
}

/// A step ahead and behind in lead, and in tilt.
fn beside(lean: &Lean) -> [[Lean; 2]; 2] {
    let [lead, tilt] = [[STEP, -STEP]; 2];
    [
        lead.map(|step| Lean { lead: lean.lead + step, ..*lean }),
        tilt.map(|step| Lean { tilt: lean.tilt + step, ..*lean }),
    ]
}

impl Build<'_> {
    /// Ranges of lead and tilt, and the margins beside them.
    pub(super) fn lean_bounds(&mut self) {
        let problem = self.problem;
        let Some(space) = problem.lean.as_deref() else { return };
        let path = problem.task.upright().path();
        for point in 0..self.leans.len() {
            let Some(column) = self.leans[point] else { continue };
            let (range, lean) = (&space.ranges[point], problem.setup.leans[point]);
            for (limit, column, ends, at) in
                [(Limit::Lead, column, range.lead, lean.lead), (Limit::Tilt, column + 1, range.tilt, lean.tilt)]
            {
                self.add_between(limit, point, &[(column, 1.0)], ends.min - at, ends.max - at);
            }
            let here = space.margins(path, point, &lean);
            let ends = beside(&lean).map(|ends| ends.map(|lean| space.margins(path, point, &lean)));
            for (k, limit) in LeanSpace::LIMITS.into_iter().enumerate() {
                let Some(margin) = here[k] else { continue };
                let slope = |ends: &[[Option<f64>; 3]; 2]| match (ends[0][k], ends[1][k]) {
                    (Some(ahead), Some(behind)) => (behind - ahead) / (2.0 * STEP),
                    _ => 0.0,
                };
                let terms = [(column, slope(&ends[0])), (column + 1, slope(&ends[1]))];
                if terms.iter().any(|(_, slope)| *slope != 0.0) {
                    self.add_between(limit, point, &terms, f64::NEG_INFINITY, margin);
                }
            }
        }
    }

    /// One second-order cone for each step in which the tool axis could turn by more than the contact allows.
    pub(super) fn contact_cones(&mut self) -> Vec<SupportedConeT<f64>> {
        let mut cones = Vec::new();
        let (problem, solution) = (self.problem, self.solution);
        let Some(space) = problem.lean.as_deref() else { return cones };
        let path = problem.task.upright().path();
        for point in solution.plans.iter().flat_map(|plan| plan.points.clone().skip(1)) {
            let columns = [self.leans[point - 1], self.leans[point]];
            if columns == [None, None] {
                continue;
            }
            let leans = [point - 1, point].map(|point| problem.setup.leans[point]);
            let [(from, before), (to, now)] = [0, 1].map(|k| axis(&path.points()[point - 1 + k], &leans[k]));
            // A chord is a little shorter than its arc.
            let most = KEPT * 2.0 * libm::sin(space.most_turn(path, point, [&leans[0], &leans[1]]) / 2.0);
            let turn = to - from;
            if turn.norm() + 4.0 * self.request.trust < most {
                continue;
            }
            let side = Side { limit: Limit::ContactTolerance, is_upper: true };
            self.rows.bounds.push((self.rows.bound.len(), (side, point)));
            // A turn that is beyond it already goes back a little.
            self.rows.add([], most.max(turn.norm() - self.request.trust / 2.0));
            for k in 0..3 {
                let of = |column: Option<usize>, slopes: &[Vector3<f64>; 2], sign: f64| {
                    let terms = column.map(|column| [(column, sign * slopes[0][k]), (column + 1, sign * slopes[1][k])]);
                    terms.into_iter().flatten().collect::<Vec<_>>()
                };
                let terms = [of(columns[0], &before, 1.0), of(columns[1], &now, -1.0)].concat();
                self.rows.add(terms, turn[k]);
            }
            cones.push(SecondOrderConeT(4));
        }
        cones
    }
}
