//! The convex subproblem of the refinement, solved by clarabel.
//!
//! Variables, all scaled: pose step (4), beta steps (n), steps of lead and tilt where the tool may lean, epigraph
//! variables t (n, in units of the present objective), and where the largest score is minimised, that. Minimised is the
//! aggregate of t (mean, mean square or largest) plus the curvature model; for every path point `t_i >= +-c_i + u_i`,
//! linearised (u is what the score adds to |c_i|); then joint limits, joint steps, conditioning, c_max and the
//! distances of shapes, linearised, the limits on beta, on leans and on the turn of the tool axis, the cell, the trust
//! region. Rows that cannot become active inside the trust region are left out. Where the margin of a point for
//! uncertain compliances has its kink near, one more variable s_i holds it: `t_i >= +-c_i + u_i + s_i`, and s_i is not
//! less than the norm of the linearised changes of c_i (a second-order cone), so that this kink is no obstacle either;
//! likewise for the norm of the parts where several directions are scored.

use super::lean_slopes::LeanSlopes;
use super::linearise::{Curvature, Local, linearise};
use super::programme::{Unsolved, pose_bounds, programme};
use super::rows::{Rows, Triplets, curvature};
use super::slacks::NEAR_STEPS;
use super::variables::{BETA, Build, Kinked, Travel, beta_columns, lean_columns};
use super::{LOCAL, Solution, UNITS};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{NonnegativeConeT, SupportedConeT, ZeroConeT};
use stead_planning::redundancy::SegmentPlan;
use stead_problem::criterion::Aggregate;
use stead_problem::limit::{Limit, Side};
use stead_problem::problem::Problem;

pub use super::variables::StepRequest;

/// What a subproblem answers.
#[derive(Debug, Clone, PartialEq)]
pub struct SubproblemStep {
    /// Step of x, y, z (m) and yaw (rad).
    pub placement: [f64; 4],
    /// Steps of all betas. rad
    pub betas: Vec<f64>,
    /// Steps of lead and tilt at every point; empty where the tool keeps its axis all along. rad
    pub leans: Vec<[f64; 2]>,
    /// Decrease of the mean score that the model promises, not negative. m
    pub promised: f64,
    /// Gradient of the model's minimum with respect to the pose, where the pose had to stay. m per scaled unit
    pub pose_gradient: [f64; 4],
    /// How much smaller the model's minimum becomes where a bound gives way, for every bound near enough to bind and
    /// every point (from 0; 0 for walls of the cell) it holds at. m per scaled unit, or per unit of the constraint
    pub multipliers: Vec<(Side, usize, f64)>,
}

/// Solves the subproblem at a solution with its linearisation.
///
/// # Errors
/// [`Unsolved`] when clarabel refused it or found no solution.
pub fn solve<'p>(
    problem: &'p Problem,
    solution: &'p Solution,
    locals: &'p [Local],
    request: StepRequest,
) -> Result<SubproblemStep, Unsolved> {
    let vectors = |(i, local): (usize, &'p Local)| {
        let sets = local.sets.iter().enumerate();
        sets.flat_map(move |(set, of)| {
            let both = [(0, &of.changes[..]), (1, &of.parts[..])];
            both.map(|(which, vector)| Kinked { place: (i, set), which, vector })
        })
    };
    let kinked = locals.iter().enumerate().flat_map(vectors).filter(|kinked| !kinked.vector.is_empty()).collect();
    let (leans, lean_count) = lean_columns(locals.iter().map(|local| local.leaning.is_some()), BETA + locals.len());
    let rows = Rows::default();
    let mut build = Build {
        problem,
        solution,
        locals,
        request,
        kinked,
        unit: solution.objective,
        rows,
        betas: beta_columns(problem),
        leans,
        lean_count,
        travel: Travel::new(problem, solution.objective),
    };
    if request.pose_stays {
        (0..4).for_each(|k| build.rows.add([(k, 1.0)], 0.0));
    }
    let equalities = build.rows.bound.len();
    (0..locals.len()).for_each(|i| build.point(i));
    solution.plans.iter().for_each(|plan| build.steps(plan));
    build.largest();
    build.trust_region();
    build.lean_bounds();
    let inequalities = build.rows.bound.len() - equalities;
    let mut cones: Vec<SupportedConeT<f64>> = vec![ZeroConeT(equalities), NonnegativeConeT(inequalities)];
    cones.extend(build.cones());
    cones.extend(build.contact_cones());
    build.answered(&cones)
}

impl Build<'_> {
    /// What holds at point `i` by itself: its score, the largest deflection, conditioning and joint limits.
    fn point(&mut self, i: usize) {
        let (local, unit) = (&self.locals[i], self.unit);
        for set in 0..local.sets.len() {
            self.score(i, set);
        }
        if let Some(limit) = self.problem.constraints.max_deflection {
            let (scores, share) = (self.scores_of(i), 1.0 / self.copies() as f64);
            let side = Side { limit: Limit::MaxDeflection, is_upper: true };
            self.rows.bounds.push((self.rows.bound.len(), (side, i)));
            self.rows.add(scores.map(|column| (column, share)), limit / unit);
        }
        let condition = &local.state.inverse_condition;
        let spare = condition.value - self.problem.constraints.min_inverse_condition;
        let terms = self.terms(i, &condition.gradient, |lean| lean.inverse_condition);
        self.add_between(Limit::Conditioning, i, &terms, -spare, f64::INFINITY);
        if self.problem.constraints.min_base_distance > 0.0 {
            let spare = local.state.base_distance.value - self.problem.constraints.min_base_distance;
            let terms = self.terms(i, &local.state.base_distance.gradient, |lean| lean.base_distance);
            self.add_between(Limit::BaseDistance, i, &terms, -spare, f64::INFINITY);
        }
        // Where the placement stays, the part and what stands in the cell stay as far apart.
        let pose_stays = self.request.pose_stays;
        for slack in local.slacks.iter().filter(|slack| slack.is_of_joints || !pose_stays) {
            let terms = self.terms(i, &slack.slopes, |_| slack.lean_slopes);
            self.add_between(slack.limit, i, &terms, -slack.spare(), f64::INFINITY);
        }
        for (j, joint) in self.problem.robot.joints().iter().enumerate() {
            let q = local.joints[j];
            let terms = self.terms(i, &local.state.joints[j].gradient, |lean| lean.joints[j]);
            self.add_between(Limit::Joint(j as u8 + 1), i, &terms, joint.min - q, joint.max - q);
        }
        let robot = &self.problem.robot;
        if let Some(range) = robot.sum_range() {
            let (q, fold) = (robot.sum_of(&local.joints), robot.geometry().fold);
            let gradients = [1, 2].map(|j| &local.state.joints[j].gradient);
            let gradient = std::array::from_fn(|k| gradients[0][k] + fold * gradients[1][k]);
            let terms = self.terms(i, &gradient, |lean| [0, 1].map(|k| lean.joints[1][k] + fold * lean.joints[2][k]));
            self.add_between(Limit::AxesSum, i, &terms, range.min - q, range.max - q);
        }
    }

    /// The score of point `i` under one set of compliances.
    fn score(&mut self, i: usize, set: usize) {
        let (local, unit) = (&self.locals[i].sets[set], self.unit);
        let scores = self.scores_of(i);
        let epigraph = scores.start + set % self.copies();
        let norms = self.norms();
        let first = self.kinked.partition_point(|kinked| kinked.place < (i, set));
        let own = self.kinked[first..].iter().take_while(|kinked| kinked.place == (i, set)).count();
        let own: Vec<(usize, f64)> = (first..first + own).map(|place| (norms + place, 1.0)).collect();
        let (c, u) = (&local.scored, &local.added);
        let signs: &[f64] = match self.problem.criterion.weights.is_single() {
            true => &[1.0, -1.0],
            false if local.parts.is_empty() => &[1.0],
            false => &[0.0],
        };
        for sign in signs {
            let slope: [f64; LOCAL] = std::array::from_fn(|k| (sign * c.gradient[k] + u.gradient[k]) / unit);
            let lean = |lean: &LeanSlopes| {
                let of = &lean.sets[set];
                [0, 1].map(|k| (sign * of.scored[k] + of.added[k]) / unit)
            };
            let row = self.terms(i, &slope, lean).into_iter().chain([(epigraph, -1.0)]).chain(own.iter().copied());
            self.rows.add(row, -(sign * c.value + u.value) / unit);
        }
    }

    /// What holds between the points of a segment: the limits on the change of beta and the steps of the joints.
    fn steps(&mut self, plan: &SegmentPlan) {
        for (place, i) in plan.points.clone().enumerate().skip(1) {
            let [column, last] = [self.betas[i], self.betas[i - 1]];
            if column != last {
                let allowed = self.problem.beta_step(i);
                let off = allowed.off_middle(plan.betas[place] - plan.betas[place - 1]);
                let row = [(column, 1.0), (last, -1.0)];
                let [lower, upper] = self.problem.beta_step_ends(i, &allowed);
                self.add_between(upper, i, &row, f64::NEG_INFINITY, allowed.half - off);
                self.add_between(lower, i, &row, -allowed.half - off, f64::INFINITY);
            }
            let limits = self.problem.joint_steps(i);
            let (at, before) = (&self.locals[i], &self.locals[i - 1]);
            let mut second = (0.0, Vec::new());
            for j in 0..6 {
                let (here, there) = (&at.state.joints[j].gradient, &before.state.joints[j].gradient);
                let mut row: Vec<(usize, f64)> = (0..4).map(|k| (k, here[k] - there[k])).collect();
                match column == last {
                    true => row.push((column, here[4] - there[4])),
                    false => row.extend([(column, here[4]), (last, -there[4])]),
                }
                row.extend(self.lean_terms(i, 1.0, |lean| lean.joints[j]));
                row.extend(self.lean_terms(i - 1, -1.0, |lean| lean.joints[j]));
                let step = at.joints[j] - before.joints[j];
                self.step_size(step, &row);
                let (mut driven, mut by) = (step, row);
                // What motor 3 turns on an arm with a linkage.
                if self.problem.robot.has_linkage() && j == 1 {
                    second = (driven, by.clone());
                } else if self.problem.robot.has_linkage() && j == 2 {
                    let fold = self.problem.robot.geometry().fold;
                    driven = second.0 + fold * step;
                    by = by.iter().map(|(column, slope)| (*column, fold * slope)).chain(second.1.drain(..)).collect();
                }
                self.add_between(Limit::JointStep(j as u8 + 1), i, &by, -limits[j] - driven, limits[j] - driven);
            }
        }
    }

    /// The cell, and how far the placement and every beta may go in one step.
    fn trust_region(&mut self) {
        let trust = self.request.trust;
        for (k, bounds) in pose_bounds(self.problem, &self.solution.placement).into_iter().enumerate() {
            for (is_upper, sign, slack) in [(true, 1.0, bounds.max), (false, -1.0, -bounds.min)] {
                if slack < trust {
                    self.rows.bounds.push((self.rows.bound.len(), (Side { limit: Limit::ALL_WALLS[k], is_upper }, 0)));
                }
                self.rows.add([(k, sign)], slack.min(trust));
            }
        }
        for i in 0..self.locals.len() {
            self.rows.add([(BETA + i, 1.0)], trust);
            self.rows.add([(BETA + i, -1.0)], trust);
        }
        for column in self.leans.iter().flatten().flat_map(|column| [*column, *column + 1]) {
            self.rows.add([(column, 1.0)], trust);
            self.rows.add([(column, -1.0)], trust);
        }
    }

    /// The largest score is above that of every point.
    fn largest(&mut self) {
        let (largest, copies) = (self.variables() - 1, self.copies() as f64);
        if self.aggregate() == Aggregate::Max {
            for i in 0..self.locals.len() {
                let weight = self.problem.point_weight(i) / copies;
                let scores = self.scores_of(i).map(|column| (column, weight));
                self.rows.add(scores.chain([(largest, -1.0)]), 0.0);
            }
        }
    }

    /// What a change of each point's score counts in the objective, to first order, times the sum of all weights: none
    /// where the largest score is minimised, since which points decide then is for the subproblem to find.
    fn shares(&self) -> Vec<f64> {
        let share = |i: usize| match self.aggregate() {
            Aggregate::Mean => self.problem.point_weight(i),
            Aggregate::Rms => self.problem.point_weight(i) * self.locals[i].state.score().value / self.unit,
            Aggregate::Max => 0.0,
        };
        (0..self.locals.len()).map(share).collect()
    }

    /// Minimises the objective: of the mean square half of it, so that its slopes are those of its root.
    fn answered(self, cones: &[SupportedConeT<f64>]) -> Result<SubproblemStep, Unsolved> {
        let (n, unit, request) = (self.locals.len(), self.unit, self.request);
        let variables = self.variables();
        let mut linear = vec![0.0; variables];
        let copies = self.copies() as f64;
        let (shares, total) = (self.shares(), self.problem.total_weight());
        let mut quadratic = match request.curved {
            true => curvature(self.locals, &self.betas, &self.leans, &shares, unit * total),
            false => Triplets::default(),
        };
        match self.aggregate() {
            Aggregate::Mean => {
                (0..n).for_each(|i| linear[self.scores_of(i)].fill(shares[i] / total / copies));
            }
            Aggregate::Rms => (0..n).for_each(|i| {
                let weight = self.problem.point_weight(i) / total / (copies * copies);
                for column in self.scores_of(i) {
                    (self.scores_of(i).start..=column).for_each(|row| quadratic.add(row, column, weight));
                }
            }),
            Aggregate::Max => linear[variables - 1] = 1.0,
        }
        self.travel.slopes.iter().for_each(|(column, slope)| linear[*column] += slope);
        let curvature = quadratic.matrix(variables);
        let Rows { row, column, value, bound, bounds } = self.rows;
        let matrix = CscMatrix::new_from_triplets(bound.len(), variables, row, column, value);
        let found = programme(&curvature, &linear, &matrix, &bound, cones)?;
        let value = match self.problem.criterion.aggregate {
            Aggregate::Rms => libm::sqrt((2.0 * found.obj_val).max(0.0)),
            Aggregate::Mean | Aggregate::Max => found.obj_val + self.travel.here,
        };
        let mut pose = [0.0; 4];
        let mut pose_gradient = [0.0; 4];
        for k in 0..4 {
            pose[k] = if request.pose_stays { 0.0 } else { found.x[k] * UNITS[k] };
            if request.pose_stays {
                pose_gradient[k] = -found.z[k] * unit;
            }
        }
        let lean = |column: &Option<usize>| column.map_or([0.0; 2], |column| [found.x[column], found.x[column + 1]]);
        Ok(SubproblemStep {
            placement: pose,
            betas: self.betas.iter().map(|column| found.x[*column]).collect(),
            leans: if self.lean_count == 0 { Vec::new() } else { self.leans.iter().map(lean).collect() },
            promised: ((1.0 - value) * unit).max(0.0),
            pose_gradient,
            multipliers: bounds.into_iter().map(|(row, (side, point))| (side, point, found.z[row] * unit)).collect(),
        })
    }
}

/// Trust region in which the linear model is asked what it still promises.
const KKT_TRUST: f64 = 1e-2;

/// The first-order optimality of a solution with postures and turns fixed: see [`super`]. m per scaled unit; infinite
/// when the subproblem could not be solved.
pub fn kkt_residual(problem: &Problem, solution: &Solution) -> f64 {
    let request = StepRequest { trust: KKT_TRUST, curved: false, pose_stays: false };
    linearise(problem, solution, Curvature::None, NEAR_STEPS)
        .and_then(|locals| solve(problem, solution, &locals, request).ok())
        .map_or(f64::INFINITY, |answered| answered.promised / KKT_TRUST)
}
