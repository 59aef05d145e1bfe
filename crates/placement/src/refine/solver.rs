//! The sequential convex programme for the best placement, as an argmin solver.
//!
//! The parameter vector is x, y, z (m), yaw and every beta (rad). argmin's executor runs it, so its observers and its
//! termination apply.

use super::linearise::{Curvature, linearise};
use super::subproblem::{Question, solve};
use super::{Solution, inside, moved};
use crate::problem::Problem;
use argmin::core::{
    Error, Executor, IterState, KV, Problem as ArgminProblem, Solver, State, TerminationReason, TerminationStatus,
};
use argmin::kv;
use std::sync::{Arc, Mutex};

/// argmin's state of this solver.
pub type Iterate = IterState<Vec<f64>, (), (), (), (), f64>;

/// The trust region at the start, in scaled variables.
const FIRST_TRUST: f64 = 0.1;
/// The largest trust region.
const MAX_TRUST: f64 = 0.4;
/// The trust region at which it ends.
const LAST_TRUST: f64 = 1e-6;
/// A promised gain of less than this share of the mean ends it.
const MIN_PROMISE: f64 = 1e-7;
/// So many steps in a row that gain less than [`MIN_GAIN`] of the mean end it.
const LAZY_STEPS: usize = 3;
/// See [`LAZY_STEPS`].
const MIN_GAIN: f64 = 1e-6;
/// Iterations at the most.
const MAX_ITERATIONS: u64 = 80;

/// The solver: a solution that only gets better, and the trust region around it.
#[derive(Debug, Clone)]
pub struct SequentialConvex<'a> {
    problem: &'a Problem,
    solution: Arc<Mutex<Solution>>,
    trust: f64,
    lazy: usize,
    ending: Option<String>,
}

/// What a run returns.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Never worse than the start.
    pub solution: Solution,
    /// How it ended.
    pub status: String,
    /// Subproblems solved.
    pub iterations: usize,
}

/// Runs the programme from a solution, without observers.
pub fn run(problem: &Problem, start: &Solution) -> Run {
    run_observed(problem, start, |executor| executor)
}

/// Runs the programme with an executor that the caller may give observers.
pub fn run_observed<'a>(
    problem: &'a Problem,
    start: &Solution,
    observe: impl FnOnce(Executor<(), SequentialConvex<'a>, Iterate>) -> Executor<(), SequentialConvex<'a>, Iterate>,
) -> Run {
    let best = Arc::new(Mutex::new(start.clone()));
    let solver = SequentialConvex { problem, solution: Arc::clone(&best), trust: FIRST_TRUST, lazy: 0, ending: None };
    let executor = Executor::new((), solver)
        .configure(|state| state.param(parameters(start)).max_iters(MAX_ITERATIONS))
        .timer(false);
    let outcome = observe(executor).run();
    let (status, iterations) = match &outcome {
        Ok(result) => {
            let status = match result.state().get_termination_reason() {
                Some(TerminationReason::SolverExit(reason)) => reason.clone(),
                Some(reason) => reason.text().to_owned(),
                None => "stopped".to_owned(),
            };
            (status, result.state().get_iter() as usize)
        }
        Err(error) => (format!("failed: {error}"), 0),
    };
    let solution = best.lock().map_or_else(|_| start.clone(), |known| known.clone());
    Run { solution, status, iterations }
}

/// Pose and betas in one vector.
fn parameters(solution: &Solution) -> Vec<f64> {
    solution.pose.iter().chain(solution.plans.iter().flat_map(|plan| &plan.betas)).copied().collect()
}

impl Solver<(), Iterate> for SequentialConvex<'_> {
    fn name(&self) -> &str {
        "sequential convex programme"
    }

    fn init(&mut self, _: &mut ArgminProblem<()>, state: Iterate) -> Result<(Iterate, Option<KV>), Error> {
        let mean = self.known()?.mean();
        Ok((state.cost(mean), None))
    }

    fn next_iter(&mut self, _: &mut ArgminProblem<()>, state: Iterate) -> Result<(Iterate, Option<KV>), Error> {
        let known = self.known()?;
        let mean = known.mean();
        let Some(locals) = linearise(self.problem, &known, Curvature::Full) else {
            self.ending = Some("a point cannot be linearised".to_owned());
            return Ok((state.param(parameters(&known)).cost(mean), None));
        };
        let mut accepted = None;
        // Until a step is good or the trust region is gone; the linearisation stays.
        while accepted.is_none() && self.trust >= LAST_TRUST {
            let question = Question { trust: self.trust, curved: true, pose_stays: false };
            match solve(self.problem, &known, &locals, question) {
                Err(reason) => {
                    self.ending = Some(reason);
                    self.trust /= 4.0;
                }
                Ok(answer) if answer.promised < MIN_PROMISE * mean => {
                    self.ending = Some("converged: no first-order gain".to_owned());
                    break;
                }
                Ok(answer) => {
                    self.ending = None;
                    let pose = std::array::from_fn(|k| known.pose[k] + answer.pose[k]);
                    let pose = inside(self.problem, pose);
                    let betas: Vec<f64> = known
                        .plans
                        .iter()
                        .flat_map(|plan| &plan.betas)
                        .zip(&answer.betas)
                        .map(|(b, d)| b + d)
                        .collect();
                    match moved(self.problem, &known, pose, &betas) {
                        Some(candidate) if mean - candidate.mean() > 0.1 * answer.promised => {
                            if mean - candidate.mean() > 0.7 * answer.promised {
                                self.trust = (2.0 * self.trust).min(MAX_TRUST);
                            }
                            accepted = Some(candidate);
                        }
                        _ => self.trust /= 3.0,
                    }
                }
            }
        }
        let next = accepted.unwrap_or(known);
        self.lazy = if mean - next.mean() < MIN_GAIN * mean { self.lazy + 1 } else { 0 };
        if self.lazy >= LAZY_STEPS && self.ending.is_none() {
            self.ending = Some("converged: no more gain".to_owned());
        }
        if self.trust < LAST_TRUST && self.ending.is_none() {
            self.ending = Some("converged: no gain in the smallest trust region".to_owned());
        }
        let (parameters, mean) = (parameters(&next), next.mean());
        *self.solution.lock().map_err(|_| Error::msg("poisoned"))? = next;
        Ok((state.param(parameters).cost(mean), Some(kv!("trust" => self.trust;))))
    }

    fn terminate(&mut self, _: &Iterate) -> TerminationStatus {
        match self.ending.take() {
            Some(reason) => TerminationStatus::Terminated(TerminationReason::SolverExit(reason)),
            None => TerminationStatus::NotTerminated,
        }
    }
}

impl SequentialConvex<'_> {
    fn known(&self) -> Result<Solution, Error> {
        Ok(self.solution.lock().map_err(|_| Error::msg("poisoned"))?.clone())
    }
}
