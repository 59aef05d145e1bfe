//! The convex subproblem of the refinement, solved by clarabel.
//!
//! Variables, all scaled: pose step (4), beta steps (n), epigraph variables t (n, in units of the present objective), and
//! where the largest score is minimised, that. Minimised is the aggregate of t (mean, mean square or largest) plus the
//! curvature model; for every path point `t_i >= +-c_i + u_i`, linearised (u is what the score
//! adds to |c_i|); then joint limits, joint steps, conditioning and c_max, linearised, the limits on beta, the cell, the trust region.
//! Rows that cannot become active inside the trust region are left out. Where the margin of a
//! point for uncertain compliances has its kink near, one more variable s_i holds it: `t_i >= +-c_i + u_i + s_i`, and s_i is
//! not less than the norm of the linearised changes of c_i (a second-order cone), so that this kink is no obstacle either;
//! likewise for the norm of the parts where several directions are scored.

use super::super::criterion::Aggregate;
use super::super::problem::{Interval, Placement, Problem};
use super::super::redundancy::SegmentPlan;
use super::active::{Limit, Side};
use super::linearise::{Curvature, LOCAL, Local, UNITS, linearise};
use super::{LENGTH_UNIT, Solution};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolution, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT, SolverStatus,
    SupportedConeT, ZeroConeT,
};
use nalgebra::{Matrix4, Vector4};
use stead_model::robot::angles::wrap;
use stead_numerics::scalar::Dual;

/// What a subproblem is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Question {
    /// Half width of the trust region in scaled variables.
    pub trust: f64,
    /// Whether the objective has the curvature of the scores.
    pub curved: bool,
    /// Whether the pose has to stay, so that only the betas move.
    pub pose_stays: bool,
}

/// What it answers.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Step of x, y, z (m) and yaw (rad).
    pub placement: [f64; 4],
    /// Steps of all betas. rad
    pub betas: Vec<f64>,
    /// Decrease of the mean score that the model promises, not negative. m
    pub promised: f64,
    /// Gradient of the model's minimum with respect to the pose, where the pose had to stay. m per scaled unit
    pub pose_gradient: [f64; 4],
    /// How much smaller the model's minimum becomes where a bound gives way, for every bound near enough to bind and every
    /// point it holds at. m per scaled unit, or per unit of the constraint
    pub multipliers: Vec<(Side, f64)>,
}

/// clarabel refused a subproblem or found no solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the subproblem could not be solved")]
pub struct Unsolved;

/// Coefficients of inequalities `row . x <= bound`.
#[derive(Default)]
struct Rows {
    row: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
    bound: Vec<f64>,
    /// Which bound of the problem stands behind a row, ascending by row; none behind those of the model.
    bounds: Vec<(usize, Side)>,
}

impl Rows {
    fn add(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, bound: f64) {
        let row = self.bound.len();
        for (column, value) in terms {
            self.row.push(row);
            self.column.push(column);
            self.value.push(value);
        }
        self.bound.push(bound);
    }

    /// `low <= terms <= high`, each side only if a change of at most `swing` can reach it.
    fn add_between(&mut self, limit: Limit, terms: &[(usize, f64)], low: f64, high: f64, swing: f64) {
        if high < swing {
            self.bounds.push((self.bound.len(), Side { limit, is_upper: true }));
            self.add(terms.iter().copied(), high);
        }
        if -low < swing {
            self.bounds.push((self.bound.len(), Side { limit, is_upper: false }));
            self.add(terms.iter().map(|(k, v)| (*k, -v)), -low);
        }
    }
}

/// Solves the subproblem at a solution with its linearisation.
///
/// # Errors
/// [`Unsolved`] when clarabel refused it or found no solution.
pub fn solve(problem: &Problem, solution: &Solution, locals: &[Local], question: Question) -> Result<Answer, Unsolved> {
    let vectors = |i: usize| [&locals[i].changes[..], &locals[i].parts[..]].map(|vector| (i, vector));
    let kinked = (0..locals.len()).flat_map(vectors).filter(|(_, vector)| !vector.is_empty()).collect();
    let rows = Rows::default();
    let mut build = Build { problem, solution, locals, question, kinked, unit: solution.objective, rows };
    if question.pose_stays {
        (0..4).for_each(|k| build.rows.add([(k, 1.0)], 0.0));
    }
    let equalities = build.rows.bound.len();
    (0..locals.len()).for_each(|i| build.point(i));
    solution.plans.iter().for_each(|plan| build.steps(plan));
    build.largest();
    build.trust_region();
    let inequalities = build.rows.bound.len() - equalities;
    let mut cones: Vec<SupportedConeT<f64>> = vec![ZeroConeT(equalities), NonnegativeConeT(inequalities)];
    cones.extend(build.cones());
    build.answer(&cones)
}

/// The subproblem as it is being built. Its variables are the change of the placement (4), the change of beta at each of the
/// n points, the score of each point (the epigraph variables), the norms that have a kink there, and the largest score where
/// that is minimised.
struct Build<'a> {
    problem: &'a Problem,
    solution: &'a Solution,
    locals: &'a [Local],
    question: Question,
    /// Points whose score has the norm of a vector in it that needs a second-order cone.
    kinked: Vec<(usize, &'a [Dual<LOCAL>])>,
    /// Scores are in this unit. m
    unit: f64,
    rows: Rows,
}

/// Column of the first change of beta.
const BETA: usize = 4;

impl Build<'_> {
    /// Column of the first score.
    fn epigraph(&self) -> usize {
        BETA + self.locals.len()
    }

    /// Column of the first norm with a kink.
    fn norms(&self) -> usize {
        BETA + 2 * self.locals.len()
    }

    /// Number of variables; the largest score is the last.
    fn variables(&self) -> usize {
        self.norms() + self.kinked.len() + usize::from(self.aggregate() == Aggregate::Max)
    }

    fn aggregate(&self) -> Aggregate {
        self.problem.criterion.aggregate
    }

    /// A gradient by placement and beta as entries of the columns of point `i`.
    fn terms(i: usize, gradient: &[f64; LOCAL]) -> Vec<(usize, f64)> {
        (0..4).map(|k| (k, gradient[k])).chain([(BETA + i, gradient[4])]).collect()
    }

    /// `low <= terms <= high`, each side only if a step inside the trust region can reach it, twice over for safety.
    fn add_between(&mut self, limit: Limit, terms: &[(usize, f64)], low: f64, high: f64) {
        let swing = 2.0 * self.question.trust * terms.iter().map(|(_, v)| v.abs()).sum::<f64>();
        self.rows.add_between(limit, terms, low, high, swing);
    }

    /// What holds at point `i` by itself: its score, the largest deflection, conditioning and joint limits.
    fn point(&mut self, i: usize) {
        let (local, unit) = (&self.locals[i], self.unit);
        let (epigraph, norms) = (self.epigraph() + i, self.norms());
        let first = self.kinked.partition_point(|(point, _)| *point < i);
        let own = self.kinked[first..].iter().take_while(|(point, _)| *point == i).count();
        let own: Vec<(usize, f64)> = (first..first + own).map(|place| (norms + place, 1.0)).collect();
        let (c, u) = (&local.state.scored, &local.added);
        let signs: &[f64] = match self.problem.criterion.weights.is_single() {
            true => &[1.0, -1.0],
            false if local.parts.is_empty() => &[1.0],
            false => &[0.0],
        };
        for sign in signs {
            let slope: [f64; LOCAL] = std::array::from_fn(|k| (sign * c.gradient[k] + u.gradient[k]) / unit);
            let row = Self::terms(i, &slope).into_iter().chain([(epigraph, -1.0)]).chain(own.iter().copied());
            self.rows.add(row, -(sign * c.value + u.value) / unit);
        }
        if let Some(limit) = self.problem.constraints.max_deflection {
            self.rows.bounds.push((self.rows.bound.len(), Side { limit: Limit::MaxDeflection, is_upper: true }));
            self.rows.add([(epigraph, 1.0)], limit / unit);
        }
        let condition: &Dual<LOCAL> = &local.state.inverse_condition;
        let spare = condition.value - self.problem.constraints.min_inverse_condition;
        self.add_between(Limit::Conditioning, &Self::terms(i, &condition.gradient), -spare, f64::INFINITY);
        if self.problem.constraints.min_base_distance > 0.0 {
            let spare = local.state.base_distance.value - self.problem.constraints.min_base_distance;
            let terms = Self::terms(i, &local.state.base_distance.gradient);
            self.add_between(Limit::BaseDistance, &terms, -spare, f64::INFINITY);
        }
        for (j, joint) in self.problem.robot.joints().iter().enumerate() {
            let q = local.joints[j];
            let terms = Self::terms(i, &local.state.joints[j].gradient);
            self.add_between(Limit::Joint(j as u8 + 1), &terms, joint.min - q, joint.max - q);
        }
    }

    /// What holds between the points of a segment: the limits on the change of beta and the steps of the joints.
    fn steps(&mut self, plan: &SegmentPlan) {
        for (place, i) in plan.points.clone().enumerate().skip(1) {
            let allowed = self.problem.beta_step(i);
            let off = allowed.off_middle(plan.betas[place] - plan.betas[place - 1]);
            let row = [(BETA + i, 1.0), (BETA + i - 1, -1.0)];
            let [lower, upper] = self.problem.beta_step_ends(i, &allowed);
            self.add_between(upper, &row, f64::NEG_INFINITY, allowed.half - off);
            self.add_between(lower, &row, -allowed.half - off, f64::INFINITY);
            let limits = self.problem.joint_steps(i);
            let (at, before) = (&self.locals[i], &self.locals[i - 1]);
            for j in 0..6 {
                let (here, there) = (&at.state.joints[j].gradient, &before.state.joints[j].gradient);
                let mut row: Vec<(usize, f64)> = (0..4).map(|k| (k, here[k] - there[k])).collect();
                row.extend([(BETA + i, here[4]), (BETA + i - 1, -there[4])]);
                let step = at.joints[j] - before.joints[j];
                self.add_between(Limit::JointStep(j as u8 + 1), &row, -limits[j] - step, limits[j] - step);
            }
        }
    }

    /// The cell, and how far the placement and every beta may go in one step.
    fn trust_region(&mut self) {
        let trust = self.question.trust;
        for (k, bounds) in pose_bounds(self.problem, &self.solution.placement).into_iter().enumerate() {
            for (is_upper, sign, room) in [(true, 1.0, bounds.max), (false, -1.0, -bounds.min)] {
                if room < trust {
                    self.rows.bounds.push((self.rows.bound.len(), Side { limit: Limit::ALL_WALLS[k], is_upper }));
                }
                self.rows.add([(k, sign)], room.min(trust));
            }
        }
        for i in 0..self.locals.len() {
            self.rows.add([(BETA + i, 1.0)], trust);
            self.rows.add([(BETA + i, -1.0)], trust);
        }
    }

    /// The largest score is above that of every point.
    fn largest(&mut self) {
        let (largest, epigraph) = (self.variables() - 1, self.epigraph());
        if self.aggregate() == Aggregate::Max {
            for i in 0..self.locals.len() {
                self.rows.add([(epigraph + i, self.problem.point_weight(i)), (largest, -1.0)], 0.0);
            }
        }
    }

    /// One second-order cone for each norm with a kink.
    fn cones(&mut self) -> Vec<SupportedConeT<f64>> {
        let (norms, unit) = (self.norms(), self.unit);
        let mut cones = Vec::with_capacity(self.kinked.len());
        for (place, (i, vector)) in self.kinked.iter().enumerate() {
            self.rows.add([(norms + place, -1.0)], 0.0);
            for entry in *vector {
                let slopes = entry.gradient.map(|slope| -slope / unit);
                self.rows.add(Self::terms(*i, &slopes), entry.value / unit);
            }
            cones.push(SecondOrderConeT(1 + vector.len()));
        }
        cones
    }

    /// What a change of each point's score counts in the objective, to first order, times the sum of all weights: none where the
    /// largest score is minimised, since which points decide then is for the subproblem to find.
    fn shares(&self) -> Vec<f64> {
        let share = |i: usize| match self.aggregate() {
            Aggregate::Mean => self.problem.point_weight(i),
            Aggregate::Rms => self.problem.point_weight(i) * self.locals[i].state.score().value / self.unit,
            Aggregate::Max => 0.0,
        };
        (0..self.locals.len()).map(share).collect()
    }

    /// Minimises the objective: of the mean square half of it, so that its slopes are those of its root.
    fn answer(self, cones: &[SupportedConeT<f64>]) -> Result<Answer, Unsolved> {
        let (n, unit, question) = (self.locals.len(), self.unit, self.question);
        let variables = self.variables();
        let (mut linear, epigraph) = (vec![0.0; variables], self.epigraph());
        let (shares, total) = (self.shares(), self.problem.total_weight());
        let mut quadratic = match question.curved {
            true => curvature(self.locals, &shares, unit * total),
            false => Triplets::default(),
        };
        match self.aggregate() {
            Aggregate::Mean => (0..n).for_each(|i| linear[epigraph + i] = shares[i] / total),
            Aggregate::Rms => {
                (0..n).for_each(|i| quadratic.add(epigraph + i, epigraph + i, self.problem.point_weight(i) / total))
            }
            Aggregate::Max => linear[variables - 1] = 1.0,
        }
        let curvature = quadratic.matrix(variables);
        let Rows { row, column, value, bound, bounds } = self.rows;
        let matrix = CscMatrix::new_from_triplets(bound.len(), variables, row, column, value);
        let found = programme(&curvature, &linear, &matrix, &bound, cones)?;
        let value = match self.problem.criterion.aggregate {
            Aggregate::Rms => libm::sqrt((2.0 * found.obj_val).max(0.0)),
            Aggregate::Mean | Aggregate::Max => found.obj_val,
        };
        let mut pose = [0.0; 4];
        let mut pose_gradient = [0.0; 4];
        for k in 0..4 {
            pose[k] = if question.pose_stays { 0.0 } else { found.x[k] * UNITS[k] };
            if question.pose_stays {
                pose_gradient[k] = -found.z[k] * unit;
            }
        }
        Ok(Answer {
            placement: pose,
            betas: found.x[BETA..BETA + n].to_vec(),
            promised: ((1.0 - value) * unit).max(0.0),
            pose_gradient,
            multipliers: bounds.into_iter().map(|(row, side)| (side, found.z[row] * unit)).collect(),
        })
    }
}

/// Minimises `x^T quadratic x / 2 + linear . x` subject to `bound - matrix x` in the cones: quiet, on one thread.
fn programme(
    quadratic: &CscMatrix<f64>,
    linear: &[f64],
    matrix: &CscMatrix<f64>,
    bound: &[f64],
    cones: &[SupportedConeT<f64>],
) -> Result<DefaultSolution<f64>, Unsolved> {
    let settings = DefaultSettings { verbose: false, max_threads: 1, ..DefaultSettings::default() };
    let mut solver = DefaultSolver::new(quadratic, linear, matrix, bound, cones, settings).map_err(|_| Unsolved)?;
    solver.solve();
    match solver.solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(solver.solution),
        _ => Err(Unsolved),
    }
}

/// The step that maximises `gradient . d - d^T curvature d / 2` inside the cell and a trust region, all scaled; `None` when
/// clarabel found none.
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
    let matrix = CscMatrix::new_from_triplets(8, 4, rows.row, rows.column, rows.value);
    let found = programme(&quadratic, &linear, &matrix, &rows.bound, &[NonnegativeConeT(8)]).ok()?;
    Some(Vector4::from_fn(|k, _| bounds[k].clamp(found.x[k])))
}

/// Length of the shortest vector `sum_i l_i gradient_i - sum_j m_j normal_j` with l on the unit simplex and m not negative;
/// infinite when there is no gradient or clarabel found none.
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

/// The entries of a symmetric matrix on and above its diagonal.
#[derive(Default)]
struct Triplets {
    row: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
}

impl Triplets {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        self.row.push(row);
        self.column.push(column);
        self.value.push(value);
    }

    fn matrix(self, size: usize) -> CscMatrix<f64> {
        CscMatrix::new_from_triplets(size, size, self.row, self.column, self.value)
    }
}

/// The curvature of the objective, each point's by its share of `whole`: an arrow of the pose block, its coupling with every
/// beta, and the diagonal.
fn curvature(locals: &[Local], shares: &[f64], whole: f64) -> Triplets {
    let mut entries = Triplets::default();
    let mut pose = [[0.0; 4]; 4];
    for (i, local) in locals.iter().enumerate() {
        let share = shares[i] / whole;
        for k in 0..4 {
            for j in 0..=k {
                pose[j][k] += local.curvature[(j, k)] * share;
            }
            entries.add(k, 4 + i, local.curvature[(k, 4)] * share);
        }
        entries.add(4 + i, 4 + i, local.curvature[(4, 4)] * share);
    }
    for (j, row) in pose.iter().enumerate() {
        (j..4).for_each(|k| entries.add(j, k, row[k]));
    }
    entries
}

/// Trust region in which the linear model is asked what it still promises.
const KKT_TRUST: f64 = 1e-2;

/// The first-order optimality of a solution with postures and turns fixed: see [`super`]. m per scaled unit; infinite when
/// the subproblem could not be solved.
pub fn kkt_residual(problem: &Problem, solution: &Solution) -> f64 {
    let question = Question { trust: KKT_TRUST, curved: false, pose_stays: false };
    linearise(problem, solution, Curvature::None)
        .and_then(|locals| solve(problem, solution, &locals, question).ok())
        .map_or(f64::INFINITY, |answer| answer.promised / KKT_TRUST)
}
