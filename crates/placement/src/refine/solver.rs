//! The sequential convex programme for the best placement, as an argmin solver.
//!
//! The iterate is the [`Solution`] itself: a placement with its plan. It only gets better. argmin's executor runs the
//! solver, so its observers and its termination apply.

use super::super::outcome::RefinementStatus;
use super::linearise::{Curvature, Local, linearise};
use super::slacks::NEAR_STEPS;
use super::subproblem::{StepRequest, solve};
use super::{Solution, moved};
use argmin::core::{
    Error, Executor, IterState, KV, Problem as ArgminProblem, Solver, State, TerminationReason, TerminationStatus,
};
use argmin::kv;
use stead_numerics::monitor::Monitor;
use stead_planning::problem::{Placement, Problem};

/// argmin's state of this solver.
pub type Iterate = IterState<Solution, (), (), (), (), f64>;

/// The trust region at the start, in scaled variables.
const FIRST_TRUST: f64 = 0.1;
/// The largest trust region.
const MAX_TRUST: f64 = 0.4;
/// A promised gain of less than this part of [`Ending::min_gain`] ends it.
const PROMISE: f64 = 0.1;
/// So many steps in a row that gain less than [`Ending::min_gain`] end it.
const LAZY_STEPS: usize = 3;

/// When a run is at its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ending {
    /// The trust region at which it ends, in scaled variables.
    pub last_trust: f64,
    /// Steps that gain less than this share of the objective end it.
    pub min_gain: f64,
    /// Iterations at the most.
    pub max_iterations: u64,
}

impl Ending {
    /// At a local optimum, to a micrometre.
    pub const TIGHT: Self = Self { last_trust: 1e-6, min_gain: 1e-6, max_iterations: 80 };
    /// Where a step costs much and its gain would be far below what a search is good for: a tenth of a millimetre.
    pub const LOOSE: Self = Self { last_trust: 1e-3, min_gain: 2e-5, max_iterations: 12 };
}

/// The solver: the trust region around the iterate, and how it ended.
#[derive(Debug, Clone)]
pub struct SequentialConvex<'a> {
    problem: &'a Problem,
    ending: Ending,
    trust: f64,
    lazy: usize,
    status: Option<RefinementStatus>,
    monitor: Monitor,
}

/// What a run returns.
#[derive(Debug, Clone, PartialEq)]
pub struct SolverRun {
    /// Never worse than the start.
    pub solution: Solution,
    /// How it ended.
    pub status: RefinementStatus,
    /// Subproblems solved.
    pub iterations: usize,
}

/// Runs the programme from a solution until its end or until the caller asks to stop.
pub fn run(problem: &Problem, start: &Solution, ending: Ending, monitor: &Monitor) -> SolverRun {
    let monitor = monitor.clone();
    let solver = SequentialConvex { problem, ending, trust: FIRST_TRUST, lazy: 0, status: None, monitor };
    let executor = Executor::new((), solver)
        .configure(|state| state.param(start.clone()).max_iters(ending.max_iterations))
        .timer(false);
    match executor.run() {
        Ok(mut result) => SolverRun {
            solution: result.state.take_param().unwrap_or_else(|| start.clone()),
            status: result.solver.status.unwrap_or(RefinementStatus::MaxIterations),
            iterations: result.state.get_iter() as usize,
        },
        // No step of ours fails.
        Err(_) => SolverRun { solution: start.clone(), status: RefinementStatus::SubproblemFailed, iterations: 0 },
    }
}

impl Solver<(), Iterate> for SequentialConvex<'_> {
    fn name(&self) -> &str {
        "sequential convex programme"
    }

    fn init(&mut self, _: &mut ArgminProblem<()>, state: Iterate) -> Result<(Iterate, Option<KV>), Error> {
        let mean = state.get_param().map_or(f64::INFINITY, |known| known.objective);
        Ok((state.cost(mean), None))
    }

    fn next_iter(&mut self, _: &mut ArgminProblem<()>, mut state: Iterate) -> Result<(Iterate, Option<KV>), Error> {
        let known = state.take_param().ok_or_else(|| Error::msg("the iterate is missing"))?;
        let mean = known.objective;
        if self.monitor.should_stop() {
            self.status = Some(RefinementStatus::Interrupted);
            return Ok((state.param(known).cost(mean), None));
        }
        let Some(locals) = linearise(self.problem, &known, Curvature::Full, NEAR_STEPS) else {
            self.status = Some(RefinementStatus::NotLinearised);
            return Ok((state.param(known).cost(mean), None));
        };
        let next = self.step(&known, mean, &locals).unwrap_or(known);
        self.lazy = if mean - next.objective < self.ending.min_gain * mean { self.lazy + 1 } else { 0 };
        if self.lazy >= LAZY_STEPS && self.status.is_none() {
            self.status = Some(RefinementStatus::NoMoreGain);
        }
        if self.trust < self.ending.last_trust && self.status.is_none() {
            self.status = Some(RefinementStatus::SmallestTrustRegion);
        }
        let mean = next.objective;
        Ok((state.param(next).cost(mean), Some(kv!("trust" => self.trust;))))
    }

    fn terminate(&mut self, _: &Iterate) -> TerminationStatus {
        match self.status {
            Some(status) => TerminationStatus::Terminated(TerminationReason::SolverExit(status.to_string())),
            None => TerminationStatus::NotTerminated,
        }
    }
}

impl SequentialConvex<'_> {
    /// A better solution inside the trust region, which shrinks until there is one or it is gone; the linearisation
    /// stays.
    fn step(&mut self, known: &Solution, mean: f64, locals: &[Local]) -> Option<Solution> {
        while self.trust >= self.ending.last_trust && !self.monitor.should_stop() {
            let request = StepRequest { trust: self.trust, curved: true, pose_stays: false };
            let Ok(answered) = solve(self.problem, known, locals, request) else {
                self.status = Some(RefinementStatus::SubproblemFailed);
                self.trust /= 4.0;
                continue;
            };
            if answered.promised < PROMISE * self.ending.min_gain * mean {
                self.status = Some(RefinementStatus::NoFirstOrderGain);
                return None;
            }
            self.status = None;
            let placement = Placement::from(std::array::from_fn(|k| known.placement[k] + answered.placement[k]));
            let placement = self.problem.cell.clamp(&placement);
            let betas = known.plans.iter().flat_map(|plan| &plan.betas).zip(&answered.betas);
            let betas: Vec<f64> = betas.map(|(beta, step)| beta + step).collect();
            let gained = |candidate: &Solution| mean - candidate.objective;
            match moved(self.problem, known, placement, &betas) {
                Some(candidate) if gained(&candidate) > 0.1 * answered.promised => {
                    if gained(&candidate) > 0.7 * answered.promised {
                        self.trust = (2.0 * self.trust).min(MAX_TRUST);
                    }
                    return Some(candidate);
                }
                _ => self.trust /= 3.0,
            }
        }
        None
    }
}
