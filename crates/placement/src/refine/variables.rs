//! The variables of the convex subproblem, and the columns in which they are.

use super::lean_slopes::LeanSlopes;
use super::linearise::Local;
use super::rows::Rows;
use super::{LOCAL, Solution};
use std::ops::Range;
use stead_numerics::scalar::Dual;
use stead_problem::criterion::Aggregate;
use stead_problem::limit::Limit;
use stead_problem::problem::{BetaPlan, Problem};

/// What a subproblem is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepRequest {
    /// Half width of the trust region in scaled variables.
    pub trust: f64,
    /// Whether the objective has the curvature of the scores.
    pub curved: bool,
    /// Whether the pose has to stay, so that only the betas move.
    pub pose_stays: bool,
}

/// A vector in the score of a point whose norm has its kink near.
pub(super) struct Kinked<'a> {
    /// The point, and the set of compliances.
    pub place: (usize, usize),
    /// Which of its two vectors: the changes of the margin, or the parts.
    pub which: usize,
    pub vector: &'a [Dual<LOCAL>],
}

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

/// The subproblem as it is being built. Its variables are the change of the placement (4), the change of beta at each
/// of the n points, those of lead and tilt where the tool may lean otherwise, the score of each point (the epigraph
/// variables), the norms that have a kink there, and the largest score where that is minimised.
pub(super) struct Build<'a> {
    pub problem: &'a Problem,
    pub solution: &'a Solution,
    pub locals: &'a [Local],
    pub request: StepRequest,
    /// Vectors in scores whose norm needs a second-order cone.
    pub kinked: Vec<Kinked<'a>>,
    /// Scores are in this unit. m
    pub unit: f64,
    pub rows: Rows,
    /// Column of the change of beta at each point.
    pub betas: Vec<usize>,
    /// Column of the change of lead at each point where the tool may lean otherwise, that of tilt behind it.
    pub leans: Vec<Option<usize>>,
    /// Number of both in all.
    pub lean_count: usize,
    pub travel: Travel,
}

/// Column of the first change of beta.
pub(super) const BETA: usize = 4;

/// Column of the change of beta at each point: its own, or where beta stays that of the first point with the same.
pub(super) fn beta_columns(problem: &Problem) -> Vec<usize> {
    let of_segment = |span: &Range<usize>| match problem.redundancy.beta {
        BetaPlan::Free => span.clone().map(|i| BETA + i).collect(),
        BetaPlan::ConstantPerSegment => vec![BETA + span.start; span.len()],
        BetaPlan::Constant => vec![BETA; span.len()],
    };
    problem.task.segments().iter().flat_map(of_segment).collect()
}

/// Columns of the changes of lead at each point, those of tilt behind them, from a first one; none where the tool keeps
/// its axis. With how many there are.
pub(super) fn lean_columns(leans: impl Iterator<Item = bool>, first: usize) -> (Vec<Option<usize>>, usize) {
    let mut next = first;
    let mut column = |may_lean: bool| {
        let own = may_lean.then_some(next);
        next += if may_lean { 2 } else { 0 };
        own
    };
    let columns = leans.map(&mut column).collect();
    (columns, next - first)
}

/// The entries of the columns of lead and tilt of a point, where it has them.
pub(super) type LeanTerms = std::iter::Flatten<std::option::IntoIter<[(usize, f64); 2]>>;

impl Build<'_> {
    /// Column of the first score.
    pub fn epigraph(&self) -> usize {
        BETA + self.locals.len() + self.lean_count
    }

    /// Number of scores of each point: one for every set of compliances where their mean counts, else one above all.
    pub fn copies(&self) -> usize {
        if self.problem.is_over_worst() { 1 } else { self.problem.scored_robots().len() }
    }

    /// Columns of the scores of a point.
    pub fn scores_of(&self, i: usize) -> Range<usize> {
        let first = self.epigraph() + i * self.copies();
        first..first + self.copies()
    }

    /// Column of the first norm with a kink.
    pub fn norms(&self) -> usize {
        self.epigraph() + self.copies() * self.locals.len()
    }

    /// Column of the first size of a joint's step.
    pub fn sizes(&self) -> usize {
        self.norms() + self.kinked.len()
    }

    /// Number of variables; the largest score is the last.
    pub fn variables(&self) -> usize {
        self.sizes() + self.travel.sizes + usize::from(self.aggregate() == Aggregate::Max)
    }

    pub fn aggregate(&self) -> Aggregate {
        self.problem.criterion.aggregate
    }

    /// A gradient by placement and beta, and slopes by lead and tilt, as entries of the columns of point `i`.
    pub fn terms(
        &self,
        i: usize,
        gradient: &[f64; LOCAL],
        lean: impl Fn(&LeanSlopes) -> [f64; 2],
    ) -> Vec<(usize, f64)> {
        let own = (0..4).map(|k| (k, gradient[k])).chain([(self.betas[i], gradient[4])]);
        own.chain(self.lean_terms(i, 1.0, lean)).collect()
    }

    /// Slopes by lead and tilt, times a factor, as entries of the columns of point `i`; none where the tool keeps its
    /// axis.
    pub fn lean_terms(&self, i: usize, factor: f64, slopes: impl Fn(&LeanSlopes) -> [f64; 2]) -> LeanTerms {
        let known = self.leans[i].zip(self.locals[i].leaning.as_ref().map(slopes));
        let terms = |(column, [lead, tilt]): (usize, [f64; 2])| [(column, factor * lead), (column + 1, factor * tilt)];
        known.map(terms).into_iter().flatten()
    }

    /// `low <= terms <= high` at a point, each side only if a step inside the trust region can reach it, twice over for
    /// safety.
    pub fn add_between(&mut self, limit: Limit, point: usize, terms: &[(usize, f64)], low: f64, high: f64) {
        let swing = 2.0 * self.request.trust * terms.iter().map(|(_, v)| v.abs()).sum::<f64>();
        self.rows.add_between(limit, point, terms, low..=high, swing);
    }
}
