//! Convex programmes, solved by clarabel: the general form, and two small ones over the pose.

use super::LENGTH_UNIT;
use super::rows::Rows;
use super::slacks::placement_rooms;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT,
    ZeroConeT,
};
use nalgebra::{Matrix4, Vector4};
use stead_model::robot::angles::wrap;
use stead_problem::problem::{Interval, Placement, Problem};

/// clarabel refused a programme or found no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the subproblem could not be solved")]
pub struct Unsolved;

/// Minimises `x^T quadratic x / 2 + linear . x` subject to `bound - matrix x` in the cones: quiet, on one thread.
/// Solutions of its linear systems are refined only where it fails without: that takes two fifths of its time.
pub(super) fn programme(
    quadratic: &CscMatrix<f64>,
    linear: &[f64],
    matrix: &CscMatrix<f64>,
    bound: &[f64],
    cones: &[SupportedConeT<f64>],
) -> Result<DefaultSolution<f64>, Unsolved> {
    let solved = |iterative_refinement_enable: bool| {
        let settings =
            DefaultSettings { verbose: false, max_threads: 1, iterative_refinement_enable, ..Default::default() };
        let mut solver = DefaultSolver::new(quadratic, linear, matrix, bound, cones, settings).ok()?;
        solver.solve();
        let is_solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
        is_solved.then_some(solver.solution)
    };
    solved(false).or_else(|| solved(true)).ok_or(Unsolved)
}

/// The step that maximises `gradient . d - d^T curvature d / 2` inside the cell and a trust region, all scaled, with
/// the part clear of what stands in the cell; `None` when clarabel found none.
pub fn pose_step(
    problem: &Problem,
    placement: &Placement,
    gradient: &Vector4<f64>,
    curvature: &Matrix4<f64>,
    trust: f64,
) -> Option<Vector4<f64>> {
    let unit = gradient.norm();
    let upper = curvature.upper_triangle() / unit;
    let entries = (0..4).flat_map(|k| (0..=k).map(move |j| (j, k)));
    let (row, column): (Vec<usize>, Vec<usize>) = entries.unzip();
    let value = row.iter().zip(&column).map(|(j, k)| upper[(*j, *k)]).collect();
    let quadratic = CscMatrix::new_from_triplets(4, 4, row, column, value);
    let linear: Vec<f64> = gradient.iter().map(|g| -g / unit).collect();
    let mut rows = Rows::default();
    let bounds = pose_bounds(problem, placement);
    for (k, bound) in bounds.iter().enumerate() {
        rows.add([(k, 1.0)], bound.max.min(trust));
        rows.add([(k, -1.0)], (-bound.min).min(trust));
    }
    for slack in placement_rooms(problem, placement) {
        rows.add((0..4).map(|k| (k, -slack.slopes[k])), slack.spare());
    }
    let count = rows.bound.len();
    let matrix = CscMatrix::new_from_triplets(count, 4, rows.row, rows.column, rows.value);
    let found = programme(&quadratic, &linear, &matrix, &rows.bound, &[NonnegativeConeT(count)]).ok()?;
    Some(Vector4::from_fn(|k, _| bounds[k].clamp(found.x[k])))
}

/// Length of the shortest vector `sum_i l_i gradient_i - sum_j m_j normal_j` with l on the unit simplex and m not
/// negative; infinite when there is no gradient or clarabel found none.
pub fn shortest(gradients: &[Vector4<f64>], normals: &[Vector4<f64>]) -> f64 {
    let unit = gradients.iter().map(|g| g.norm()).fold(0.0, f64::max);
    if gradients.is_empty() || unit == 0.0 {
        return if gradients.is_empty() { f64::INFINITY } else { 0.0 };
    }
    let columns: Vec<Vector4<f64>> =
        gradients.iter().map(|g| g / unit).chain(normals.iter().map(|normal| -normal)).collect();
    let n = columns.len();
    let (mut row, mut column, mut value) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..n {
        for j in 0..=k {
            row.push(j);
            column.push(k);
            value.push(columns[j].dot(&columns[k]));
        }
    }
    let quadratic = CscMatrix::new_from_triplets(n, n, row, column, value);
    let mut rows = Rows::default();
    rows.add((0..gradients.len()).map(|i| (i, 1.0)), 1.0);
    for k in 0..n {
        rows.add([(k, -1.0)], 0.0);
    }
    let matrix = CscMatrix::new_from_triplets(n + 1, n, rows.row, rows.column, rows.value);
    let cones = [ZeroConeT(1), NonnegativeConeT(n)];
    let Ok(found) = programme(&quadratic, &vec![0.0; n], &matrix, &rows.bound, &cones) else { return f64::INFINITY };
    let sum = columns.iter().zip(&found.x).fold(Vector4::zeros(), |sum, (c, x)| sum + c * *x);
    sum.norm() * unit
}

/// How far each pose variable may move inside the cell, in scaled variables.
pub fn pose_bounds(problem: &Problem, placement: &Placement) -> [Interval; 4] {
    let cell = &problem.cell;
    std::array::from_fn(|k| {
        if k < 3 {
            let Interval { min, max } = cell.position[k];
            Interval { min: (min - placement[k]) / LENGTH_UNIT, max: (max - placement[k]) / LENGTH_UNIT }
        } else if cell.is_yaw_free() {
            Interval { min: f64::NEG_INFINITY, max: f64::INFINITY }
        } else {
            let middle = (cell.yaw.min + cell.yaw.max) / 2.0;
            let yaw = middle + wrap(placement.yaw - middle);
            Interval { min: cell.yaw.min - yaw, max: cell.yaw.max - yaw }
        }
    })
}
