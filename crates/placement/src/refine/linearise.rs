//! Exact first derivatives of everything that the subproblem needs, and the curvature of the scores.

use super::super::evaluate::reference::{State, normal_part_by_parameters, state};
use super::super::problem::{Placement, Problem};
use super::{LENGTH_UNIT, Solution};
use nalgebra::{Matrix5, SymmetricEigen};
use stead_model::robot::Posture;
use stead_numerics::scalar::{Dual, Scalar};

/// Number of variables of one path point: x, y, z (in [`LENGTH_UNIT`]), yaw and its beta (rad).
pub const LOCAL: usize = 5;
/// Units of the local variables.
pub const UNITS: [f64; LOCAL] = [LENGTH_UNIT, LENGTH_UNIT, LENGTH_UNIT, 1.0, 1.0];

/// One path point of a solution, linearised in scaled variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Local {
    /// The state with exact gradients.
    pub state: State<Dual<LOCAL>>,
    /// What the score adds to |c_i| and is smooth here: what force errors add, and the margin, unless its kink is near. m
    pub added: Dual<LOCAL>,
    /// Where the margin has its kink near: changes of c_i by independent errors of the compliances, as often as the
    /// criterion asks, whose Euclidean norm is [`State::margin`]. Empty elsewhere. m
    pub changes: Vec<Dual<LOCAL>>,
    /// Real joint angles. rad
    pub joints: [f64; 6],
    /// Curvature of the score where |c_i| is smooth and a margin near its kink follows its present changes, the negative part
    /// left out.
    /// m per square unit
    pub curvature: Matrix5<f64>,
}

/// Step from gradient to gradient for the curvature, in scaled variables.
const CURVATURE_STEP: f64 = 1e-4;

/// How much of the curvature is asked for: each variable costs an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curvature {
    /// None: it is left at zero.
    None,
    /// Along beta, and between beta and the placement: all that matters while the placement stays.
    Beta,
    /// All of it.
    Full,
}

/// All path points of a solution, in order; `None` when one cannot be reached, which a solution rules out.
pub fn linearise(problem: &Problem, solution: &Solution, asked: Curvature) -> Option<Vec<Local>> {
    let mut locals = Vec::with_capacity(problem.task.points().len());
    for plan in &solution.plans {
        for (place, point) in plan.points.clone().enumerate() {
            let at = [
                solution.placement[0],
                solution.placement[1],
                solution.placement[2],
                solution.placement[3],
                plan.betas[place],
            ];
            let centre = gradient(problem, point, at, plan.posture)?;
            let centre = (centre.0, if is_near_kink(&centre.1) { centre.1 } else { Vec::new() });
            let curvature = curvature(problem, point, at, plan.posture, &centre, asked);
            let (state, changes) = centre;
            let margin = if changes.is_empty() { state.margin } else { Dual::constant(0.0) };
            locals.push(Local {
                state,
                added: state.uncertainty + margin,
                changes,
                joints: plan.joints[place],
                curvature,
            });
        }
    }
    Some(locals)
}

/// A margin that steps of this size could bring to zero has its kink near; in scaled variables.
const KINK: f64 = 0.1;

/// Whether a margin, the norm of these changes, can vanish nearby. Elsewhere it is smooth, and better followed with its own
/// curvature: where the changes only turn, that of their norm and their own cancel.
fn is_near_kink(changes: &[Dual<LOCAL>]) -> bool {
    let square = |numbers: &mut dyn Iterator<Item = f64>| numbers.fold(0.0, |sum, number| sum + number * number);
    let size = square(&mut changes.iter().map(|change| change.value));
    let slope = square(&mut changes.iter().flat_map(|change| change.gradient));
    size < KINK * KINK * slope
}

/// A state and what the margin of its score is made of.
type Differentiated = (State<Dual<LOCAL>>, Vec<Dual<LOCAL>>);

/// The state at `at` (x, y, z in m, yaw, beta in rad) with its gradient in scaled variables.
fn gradient(problem: &Problem, point: usize, at: [f64; LOCAL], posture: Posture) -> Option<Differentiated> {
    let variables: [Dual<LOCAL>; LOCAL] = std::array::from_fn(|k| {
        let mut variable = Dual::variable(at[k], k);
        variable.gradient[k] = UNITS[k];
        variable
    });
    let [x, y, z, yaw, beta] = variables;
    let placement = Placement::from([x, y, z, yaw]);
    let found = state(problem, point, &placement, beta, posture).ok()?;
    let confidence = problem.criterion.confidence;
    let changes = match problem.robot.uncertainty() {
        Some(known) if confidence > 0.0 => {
            let slopes = normal_part_by_parameters(problem, point, &placement, &found.joints);
            known.changes(&slopes).map(|change| change.scale(confidence)).collect()
        }
        _ => Vec::new(),
    };
    Some((found, changes))
}

/// Differences of exact gradients, made symmetric, without negative eigenvalues: what a convex model can use.
fn curvature(
    problem: &Problem,
    point: usize,
    at: [f64; LOCAL],
    posture: Posture,
    centre: &Differentiated,
    asked: Curvature,
) -> Matrix5<f64> {
    let from = match asked {
        Curvature::None => return Matrix5::zeros(),
        Curvature::Beta => LOCAL - 1,
        Curvature::Full => 0,
    };
    let sign = if centre.0.normal_part.value < 0.0 { -1.0 } else { 1.0 };
    let margin = centre.0.margin.value;
    let is_smooth = centre.1.is_empty();
    // Near a kink the norm of the changes is the subproblem's: here they are followed along their present direction.
    let share = |change: &Dual<LOCAL>| if margin > 0.0 { change.value / margin } else { 0.0 };
    let shares: Vec<f64> = centre.1.iter().map(share).collect();
    let slope = |(s, changes): &Differentiated, k: usize| {
        let along = shares.iter().zip(changes).map(|(share, change)| share * change.gradient[k]);
        let margin = if is_smooth { s.margin.gradient[k] } else { along.sum() };
        sign * s.normal_part.gradient[k] + s.uncertainty.gradient[k] + margin
    };
    let mut hessian = Matrix5::zeros();
    for k in from..LOCAL {
        let mut moved = at;
        moved[k] += CURVATURE_STEP * UNITS[k];
        let Some(there) = gradient(problem, point, moved, posture) else { return Matrix5::zeros() };
        for j in 0..LOCAL {
            hessian[(j, k)] = (slope(&there, j) - slope(centre, j)) / CURVATURE_STEP;
        }
    }
    if asked == Curvature::Beta {
        let beta = LOCAL - 1;
        if hessian[(beta, beta)] <= 0.0 {
            return Matrix5::zeros();
        }
        hessian.set_row(beta, &hessian.column(beta).transpose());
        return hessian;
    }
    let symmetric = (hessian + hessian.transpose()) * 0.5;
    let eigen = SymmetricEigen::new(symmetric);
    let positive = eigen.eigenvalues.map(|value| value.max(0.0));
    eigen.eigenvectors * Matrix5::from_diagonal(&positive) * eigen.eigenvectors.transpose()
}
