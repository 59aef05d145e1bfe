//! A state of the arm with exact derivatives, and what is followed where the score of it has a kink.

use super::{LOCAL, UNITS};
use stead_model::robot::Posture;
use stead_numerics::scalar::{Dual, Scalar};
use stead_problem::criterion::Criterion;
use stead_problem::evaluate::reference::{SetScore, State, scored_part_by_parameters, scored_parts, set_scores};
use stead_problem::problem::{Placement, Problem};

/// A state, and what is scored of it under every set of compliances.
pub(super) struct Differentiated {
    pub state: State<Dual<LOCAL>>,
    pub sets: Vec<DifferentiatedSet>,
}

/// A score, and the vectors of which its norms are taken.
pub(super) struct DifferentiatedSet {
    pub score: SetScore<Dual<LOCAL>>,
    /// That of the margin.
    pub changes: Vec<Dual<LOCAL>>,
    /// That of the scored part, where several directions are scored and errors of the force do not smooth it.
    pub parts: Vec<Dual<LOCAL>>,
}

/// A state of a path point by its variables.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointState {
    pub point: usize,
    /// x, y, z in m, yaw and beta in rad.
    pub at: [f64; LOCAL],
    pub posture: Posture,
}

impl PointState {
    /// The same with one of the variables moved by a step, in scaled units.
    pub fn moved(mut self, variable: usize, step: f64) -> Self {
        self.at[variable] += step * UNITS[variable];
        self
    }

    /// Placement and beta (rad).
    pub fn split(&self) -> (Placement, f64) {
        let [x, y, z, yaw, beta] = self.at;
        (Placement::from([x, y, z, yaw]), beta)
    }
}

/// A state with its gradient in scaled variables.
pub(super) fn gradient(problem: &Problem, state: PointState) -> Option<Differentiated> {
    let PointState { point, at, posture } = state;
    let variables: [Dual<LOCAL>; LOCAL] = std::array::from_fn(|k| {
        let mut variable = Dual::variable(at[k], k);
        variable.gradient[k] = UNITS[k];
        variable
    });
    let [x, y, z, yaw, beta] = variables;
    let placement = Placement::from([x, y, z, yaw]);
    let found = problem.at(&placement).state(point, beta, posture).ok()?;
    let Criterion { confidence, force_uncertainty, weights, stiffness, .. } = &problem.criterion;
    let robots = problem.scored_robots();
    let scores = match stiffness {
        Some(_) => set_scores(problem, point, &placement, &found.joints),
        None if *confidence > 0.0 => {
            vec![(found.own, scored_part_by_parameters(problem, point, &placement, &found.joints))]
        }
        None => vec![(found.own, Vec::new())],
    };
    let mut parts = match weights.is_single() || *force_uncertainty > 0.0 {
        true => vec![Vec::new(); robots.len()],
        false => scored_parts(problem, point, &placement, &found.joints),
    };
    let sets = scores.into_iter().zip(robots).zip(&mut parts).map(|(((score, slopes), robot), parts)| {
        let changes = match robot.uncertainty() {
            Some(known) if *confidence > 0.0 => {
                known.changes(&slopes).map(|change| change.scale(*confidence)).collect()
            }
            _ => Vec::new(),
        };
        DifferentiatedSet { score, changes, parts: std::mem::take(parts) }
    });
    let sets = sets.collect();
    Some(Differentiated { state: found, sets })
}

/// What second derivatives are taken of: where |c_i| is smooth, with the signs of the parts as they are, and near a
/// kink along the present direction of the vector, whose norm is the subproblem's.
pub(super) struct Followed {
    /// The sets of compliances that count.
    counted: Vec<usize>,
    /// Of every set the sign of its scored part, and the shares of its changes and parts.
    sets: Vec<(f64, Vec<f64>, Vec<f64>)>,
}

impl Followed {
    pub fn of(problem: &Problem, centre: &Differentiated) -> Self {
        let shares = |vector: &[Dual<LOCAL>], norm: f64| -> Vec<f64> {
            vector.iter().map(|entry| if norm > 0.0 { entry.value / norm } else { 0.0 }).collect()
        };
        let score = |set: &DifferentiatedSet| set.score.score().value;
        let worst = (0..centre.sets.len()).max_by(|a, b| score(&centre.sets[*a]).total_cmp(&score(&centre.sets[*b])));
        let counted = match worst.filter(|_| problem.is_over_worst()) {
            Some(worst) => vec![worst],
            None => (0..centre.sets.len()).collect(),
        };
        let of_set = |set: &DifferentiatedSet| {
            let sign = if set.score.scored.value < 0.0 { -1.0 } else { 1.0 };
            (sign, shares(&set.changes, set.score.margin.value), shares(&set.parts, set.score.scored.value))
        };
        Self { counted, sets: centre.sets.iter().map(of_set).collect() }
    }

    /// Of a number of every entry there.
    fn sum(&self, there: &Differentiated, of: impl Fn(&Dual<LOCAL>) -> f64) -> f64 {
        let along = |shares: &[f64], vector: &[Dual<LOCAL>]| -> f64 {
            shares.iter().zip(vector).map(|(share, entry)| share * of(entry)).sum()
        };
        let of_set = |set: &usize| {
            let (there, (sign, changes, parts)) = (&there.sets[*set], &self.sets[*set]);
            let s = &there.score;
            let margin = if changes.is_empty() { of(&s.margin) } else { along(changes, &there.changes) };
            let scored = if parts.is_empty() { sign * of(&s.scored) } else { along(parts, &there.parts) };
            scored + of(&s.uncertainty) + margin
        };
        let sum: f64 = self.counted.iter().map(of_set).sum();
        if self.counted.len() == 1 { sum } else { sum / self.counted.len() as f64 }
    }

    /// The slope there in a variable.
    pub fn slope(&self, there: &Differentiated, k: usize) -> f64 {
        self.sum(there, |entry| entry.gradient[k])
    }

    /// The value there.
    pub fn value(&self, there: &Differentiated) -> f64 {
        self.sum(there, |entry| entry.value)
    }
}
