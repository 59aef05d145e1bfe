//! First derivatives of everything that the subproblem needs, exact but those of distances, and the curvature of the
//! scores.

use super::differentiated::{Differentiated, DifferentiatedSet, Followed, PointState, gradient};
use super::lean_slopes::{LeanNeighbours, LeanSlopes};
use super::slacks::{Slack, slacks};
use super::{LOCAL, Solution};
use nalgebra::{Matrix5, SymmetricEigen};
use rayon::prelude::*;
use stead_numerics::scalar::{Dual, Scalar};
use stead_planning::redundancy::SegmentPlan;
use stead_problem::evaluate::reference::State;
use stead_problem::problem::{Placement, Problem};

/// One path point of a solution, linearised in scaled variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// The state with exact gradients.
    pub state: State<Dual<LOCAL>>,
    /// What is scored, under every set of compliances.
    pub sets: Vec<LocalScore>,
    /// Real joint angles. rad
    pub joints: [f64; 6],
    /// The shapes that are near each other.
    pub slacks: Vec<Slack>,
    /// Curvature of the score where |c_i| is smooth and a margin near its kink follows its present changes, the
    /// negative part left out; over several sets their mean, or that of the worst. m per square unit
    pub curvature: Matrix5<f64>,
    /// How it changes with lead and tilt, where the tool may lean otherwise.
    pub leaning: Option<LeanSlopes>,
}

/// What is scored of a path point under one set of compliances, linearised.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalScore {
    /// See [`scored`](stead_problem::evaluate::reference::SetScore::scored). m
    pub scored: Dual<LOCAL>,
    /// What the score adds to |c_i| and is smooth here: what force errors add, and the margin, unless its kink is near.
    /// m
    pub added: Dual<LOCAL>,
    /// Where the margin has its kink near: changes of c_i by independent errors of the compliances, as often as the
    /// criterion asks, whose Euclidean norm is [`margin`](stead_problem::evaluate::reference::SetScore::margin). Empty
    /// elsewhere. m
    pub changes: Vec<Dual<LOCAL>>,
    /// Where several directions are scored and their norm has its kink near: the parts along them, whose norm is
    /// [`scored`](stead_problem::evaluate::reference::SetScore::scored). Empty elsewhere. m
    pub parts: Vec<Dual<LOCAL>>,
}

/// Step from gradient to gradient for the curvature, in scaled variables.
const CURVATURE_STEP: f64 = 1e-4;

/// How much of the curvature is requested: each variable costs an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curvature {
    /// None: it is left at zero.
    None,
    /// Along beta, and between beta and the placement: all that matters while the placement stays.
    Beta,
    /// All of it.
    Full,
}

/// Points that one thread linearises at least.
const MIN_SHARE: usize = 200;

/// All path points of a solution, in order, with as much curvature as requested and the shapes that have less slack
/// than a limit (m); `None` when one cannot be reached, which a solution rules out.
pub fn linearise(problem: &Problem, solution: &Solution, order: Curvature, within: f64) -> Option<Vec<Local>> {
    Linearisation { problem, order, within, leaning: None }.of_all(solution)
}

/// The same with how they change with lead and tilt, where the tool of the problem leans.
pub fn linearise_leaning(problem: &Problem, solution: &Solution, order: Curvature, within: f64) -> Option<Vec<Local>> {
    let leaning = LeanNeighbours::of(problem);
    Linearisation { problem, order, within, leaning: leaning.as_ref() }.of_all(solution)
}

/// What is linearised of every path point.
struct Linearisation<'a> {
    problem: &'a Problem,
    order: Curvature,
    /// The slack of shapes that count. m
    within: f64,
    /// The tool leaning otherwise, where that matters.
    leaning: Option<&'a LeanNeighbours>,
}

impl Linearisation<'_> {
    fn of_all(&self, solution: &Solution) -> Option<Vec<Local>> {
        let of_plan = |plan: &'_ SegmentPlan| {
            let places = (0..plan.points.len()).into_par_iter().with_min_len(MIN_SHARE);
            places.map(|place| self.local(&solution.placement, plan, place)).collect::<Option<Vec<_>>>()
        };
        let plans: Option<Vec<_>> = solution.plans.par_iter().map(of_plan).collect();
        plans.map(|plans| plans.into_iter().flatten().collect())
    }

    /// A place of a plan.
    fn local(&self, placement: &Placement, plan: &SegmentPlan, place: usize) -> Option<Local> {
        let Self { problem, order, within, leaning } = *self;
        let at = [placement.x, placement.y, placement.z, placement.yaw, plan.betas[place]];
        let state = PointState { point: plan.points.start + place, at, posture: plan.posture };
        let mut centre = gradient(problem, state)?;
        for set in &mut centre.sets {
            for kinked in [&mut set.changes, &mut set.parts] {
                if !is_near_kink(kinked) {
                    kinked.clear();
                }
            }
        }
        let followed = Followed::of(problem, &centre);
        let raw = second_derivatives(problem, state, &followed, &centre, order);
        let may_lean = problem.lean.as_deref().is_some_and(|space| !space.ranges[state.point].is_none());
        let neighbours = leaning.filter(|_| may_lean);
        let leaning = neighbours.and_then(|neighbours| {
            let raw = raw.as_ref().filter(|_| order == Curvature::Full);
            neighbours.slopes(state, &followed, &centre, raw)
        });
        let curvature = raw.map_or_else(Matrix5::zeros, |raw| convex(&raw, order));
        let sets = centre.sets.into_iter().map(|DifferentiatedSet { score, changes, parts }| {
            let margin = if changes.is_empty() { score.margin } else { Dual::constant(0.0) };
            LocalScore { scored: score.scored, added: score.uncertainty + margin, changes, parts }
        });
        let ahead = neighbours.map(LeanNeighbours::ahead);
        let slacks = slacks(problem, ahead, state, within);
        let (sets, joints) = (sets.collect(), plan.joints[place]);
        Some(Local { state: centre.state, sets, joints, slacks, curvature, leaning })
    }
}

/// A norm that steps of this size could bring to zero has its kink near; in scaled variables.
const KINK: f64 = 0.1;

/// Whether the norm of these numbers can vanish nearby. Elsewhere it is smooth, and better followed with its own
/// curvature: where the vector only turns, that of its norm and its own cancel.
fn is_near_kink(changes: &[Dual<LOCAL>]) -> bool {
    let square = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0, |sum, number| sum + number * number);
    let size = square(&mut changes.iter().map(|change| change.value));
    let slope = square(&mut changes.iter().flat_map(|change| change.gradient));
    size < KINK * KINK * slope
}

/// Differences of exact gradients, as many as requested.
fn second_derivatives(
    problem: &Problem,
    state: PointState,
    followed: &Followed,
    centre: &Differentiated,
    order: Curvature,
) -> Option<Matrix5<f64>> {
    let from = match order {
        Curvature::None => return None,
        Curvature::Beta => LOCAL - 1,
        Curvature::Full => 0,
    };
    let mut hessian = Matrix5::zeros();
    for k in from..LOCAL {
        let there = gradient(problem, state.moved(k, CURVATURE_STEP))?;
        for j in 0..LOCAL {
            hessian[(j, k)] = (followed.slope(&there, j) - followed.slope(centre, j)) / CURVATURE_STEP;
        }
    }
    if order == Curvature::Beta {
        return Some(hessian);
    }
    Some((hessian + hessian.transpose()) * 0.5)
}

/// Second derivatives without negative eigenvalues: what a convex model can use.
fn convex(hessian: &Matrix5<f64>, order: Curvature) -> Matrix5<f64> {
    if order == Curvature::Beta {
        let beta = LOCAL - 1;
        let mut hessian = *hessian;
        if hessian[(beta, beta)] <= 0.0 {
            return Matrix5::zeros();
        }
        hessian.set_row(beta, &hessian.column(beta).transpose());
        return hessian;
    }
    let eigen = SymmetricEigen::new(*hessian);
    let positive = eigen.eigenvalues.map(|value| value.max(0.0));
    eigen.eigenvectors * Matrix5::from_diagonal(&positive) * eigen.eigenvectors.transpose()
}
