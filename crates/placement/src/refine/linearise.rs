//! Exact first derivatives of everything that the subproblem needs, and the curvature of the scores.

use super::super::evaluate::reference::{State, scored_part_by_parameters, state};
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
    /// Where several directions are scored and their norm has its kink near: the parts along them, whose norm is
    /// [`State::scored`]. Empty elsewhere. m
    pub parts: Vec<Dual<LOCAL>>,
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
            let mut centre = gradient(problem, point, at, plan.posture)?;
            for kinked in [&mut centre.changes, &mut centre.parts] {
                if !is_near_kink(kinked) {
                    kinked.clear();
                }
            }
            let curvature = curvature(problem, point, at, plan.posture, &centre, asked);
            let Differentiated { state, changes, parts } = centre;
            let margin = if changes.is_empty() { state.margin } else { Dual::constant(0.0) };
            let added = state.uncertainty + margin;
            locals.push(Local { state, added, changes, parts, joints: plan.joints[place], curvature });
        }
    }
    Some(locals)
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

/// A state, and the vectors of which the norms of its score are taken.
struct Differentiated {
    state: State<Dual<LOCAL>>,
    /// That of the margin.
    changes: Vec<Dual<LOCAL>>,
    /// That of the scored part, where several directions are scored and errors of the force do not smooth it.
    parts: Vec<Dual<LOCAL>>,
}

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
            let slopes = scored_part_by_parameters(problem, point, &placement, &found.joints);
            known.changes(&slopes).map(|change| change.scale(confidence)).collect()
        }
        _ => Vec::new(),
    };
    let directions = problem.scored_directions(point, &problem.placed(point, &placement).axes);
    let parts = match directions.single() {
        None if problem.criterion.force_uncertainty == 0.0 => {
            directions.vectors().iter().map(|direction| direction.dot(&found.deflection)).collect()
        }
        _ => Vec::new(),
    };
    Some(Differentiated { state: found, changes, parts })
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
    let sign = if centre.state.scored.value < 0.0 { -1.0 } else { 1.0 };
    // Near a kink the norm is the subproblem's: here the vector is followed along its present direction.
    let shares = |vector: &[Dual<LOCAL>], norm: f64| -> Vec<f64> {
        vector.iter().map(|entry| if norm > 0.0 { entry.value / norm } else { 0.0 }).collect()
    };
    let changes = shares(&centre.changes, centre.state.margin.value);
    let parts = shares(&centre.parts, centre.state.scored.value);
    let along = |shares: &[f64], vector: &[Dual<LOCAL>], k: usize| -> f64 {
        shares.iter().zip(vector).map(|(share, entry)| share * entry.gradient[k]).sum()
    };
    let slope = |there: &Differentiated, k: usize| {
        let s = &there.state;
        let margin = if changes.is_empty() { s.margin.gradient[k] } else { along(&changes, &there.changes, k) };
        let scored = if parts.is_empty() { sign * s.scored.gradient[k] } else { along(&parts, &there.parts, k) };
        scored + s.uncertainty.gradient[k] + margin
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
