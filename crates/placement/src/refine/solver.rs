//! The sequential convex programme for the best placement, as an argmin solver.
//!
//! The iterate is the [`Solution`] itself, a placement with its plan, and, where lead and tilt are variables too, how
//! the tool leans. It only gets better. argmin's executor runs the solver, so its observers and its termination apply.

use super::super::outcome::RefinementStatus;
use super::lean_slopes::moved_leans;
use super::linearise::{Curvature, Local, linearise, linearise_leaning};
use super::slacks::NEAR_STEPS;
use super::solution::{Solution, moved};
use super::subproblem::{StepRequest, solve};
use argmin::core::{
    Error, Executor, IterState, KV, Problem as ArgminProblem, Solver, State, TerminationReason, TerminationStatus,
};
use argmin::kv;
use std::borrow::Cow;
use std::sync::Arc;
use stead_model::task::lean::Lean;
use stead_numerics::monitor::Monitor;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::Setup;

/// A solution, and how the tool leans at every point where lead and tilt are variables.
#[derive(Debug, Clone)]
pub struct Leaned {
    leans: Option<Arc<[Lean]>>,
    solution: Solution,
}

/// argmin's state of this solver.
pub type Iterate = IterState<Leaned, (), (), (), (), f64>;

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
    run_from(problem, Leaned { leans: None, solution: start.clone() }, ending, monitor).0
}

/// The same with lead and tilt as variables beside placement and betas, from how the tool of the problem leans; and how
/// it leans in the end.
pub fn run_leaning(problem: &Problem, start: &Solution, ending: Ending, monitor: &Monitor) -> (SolverRun, Arc<[Lean]>) {
    let leans = problem.setup.leans.clone();
    let (run, found) =
        run_from(problem, Leaned { leans: Some(leans.clone()), solution: start.clone() }, ending, monitor);
    (run, found.unwrap_or(leans))
}

fn run_from(problem: &Problem, start: Leaned, ending: Ending, monitor: &Monitor) -> (SolverRun, Option<Arc<[Lean]>>) {
    let monitor = monitor.clone();
    let solver = SequentialConvex { problem, ending, trust: FIRST_TRUST, lazy: 0, status: None, monitor };
    let executor = Executor::new((), solver)
        .configure(|state| state.param(start.clone()).max_iters(ending.max_iterations))
        .timer(false);
    match executor.run() {
        Ok(mut result) => {
            let iterations = result.state.get_iter() as usize;
            let Leaned { leans, solution } = result.state.take_param().unwrap_or(start);
            let status = result.solver.status.unwrap_or(RefinementStatus::MaxIterations);
            (SolverRun { solution, status, iterations }, leans)
        }
        // No step of ours fails.
        Err(_) => {
            let status = RefinementStatus::SubproblemFailed;
            (SolverRun { solution: start.solution, status, iterations: 0 }, start.leans)
        }
    }
}

impl Solver<(), Iterate> for SequentialConvex<'_> {
    fn name(&self) -> &str {
        "sequential convex programme"
    }

    fn init(&mut self, _: &mut ArgminProblem<()>, state: Iterate) -> Result<(Iterate, Option<KV>), Error> {
        let mean = state.get_param().map_or(f64::INFINITY, |known| known.solution.objective);
        Ok((state.cost(mean), None))
    }

    fn next_iter(&mut self, _: &mut ArgminProblem<()>, mut state: Iterate) -> Result<(Iterate, Option<KV>), Error> {
        let known = state.take_param().ok_or_else(|| Error::msg("the iterate is missing"))?;
        let mean = known.solution.objective;
        if self.monitor.should_stop() {
            self.status = Some(RefinementStatus::Interrupted);
            return Ok((state.param(known).cost(mean), None));
        }
        let problem = self.leaning(known.leans.as_ref());
        let of = if known.leans.is_some() { linearise_leaning } else { linearise };
        let Some(locals) = of(&problem, &known.solution, Curvature::Full, NEAR_STEPS) else {
            self.status = Some(RefinementStatus::NotLinearised);
            return Ok((state.param(known).cost(mean), None));
        };
        let next = self.step(&problem, &known, mean, &locals).unwrap_or(known);
        self.lazy = if mean - next.solution.objective < self.ending.min_gain * mean { self.lazy + 1 } else { 0 };
        if self.lazy >= LAZY_STEPS && self.status.is_none() {
            self.status = Some(RefinementStatus::NoMoreGain);
        }
        if self.trust < self.ending.last_trust && self.status.is_none() {
            self.status = Some(RefinementStatus::SmallestTrustRegion);
        }
        let mean = next.solution.objective;
        Ok((state.param(next).cost(mean), Some(kv!("trust" => self.trust;))))
    }

    fn terminate(&mut self, _: &Iterate) -> TerminationStatus {
        match self.status {
            Some(status) => TerminationStatus::Terminated(TerminationReason::SolverExit(status.to_string())),
            None => TerminationStatus::NotTerminated,
        }
    }
}

impl<'a> SequentialConvex<'a> {
    /// The problem with its tool leaning so, or as it is.
    fn leaning(&self, leans: Option<&Arc<[Lean]>>) -> Cow<'a, Problem> {
        match leans {
            Some(leans) => self.problem.in_setup(&Setup { leans: leans.clone(), ..self.problem.setup.clone() }),
            None => Cow::Borrowed(self.problem),
        }
    }

    /// A better solution inside the trust region, which shrinks until there is one or it is gone; the linearisation
    /// stays. `problem` has its tool lean as it is known.
    fn step(&mut self, problem: &Problem, known: &Leaned, mean: f64, locals: &[Local]) -> Option<Leaned> {
        let Leaned { leans, solution: known } = known;
        while self.trust >= self.ending.last_trust && !self.monitor.should_stop() {
            let request = StepRequest { trust: self.trust, curved: true, pose_stays: false };
            let Ok(answered) = solve(problem, known, locals, request) else {
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
            let candidate = match leans.as_ref().filter(|_| !answered.leans.is_empty()) {
                None => moved(problem, known, placement, &betas).map(|moved| (leans.clone(), moved)),
                Some(_) => moved_leans(problem, &answered.leans).and_then(|leans| {
                    let leans: Arc<[Lean]> = leans.into();
                    let there = self.leaning(Some(&leans));
                    moved(&there, known, placement, &betas).map(|moved| (Some(leans), moved))
                }),
            };
            let gained = |candidate: &Solution| mean - candidate.objective;
            match candidate {
                Some((leans, candidate)) if gained(&candidate) > 0.1 * answered.promised => {
                    if gained(&candidate) > 0.7 * answered.promised {
                        self.trust = (2.0 * self.trust).min(MAX_TRUST);
                    }
                    return Some(Leaned { leans, solution: candidate });
                }
                _ => self.trust /= 3.0,
            }
        }
        None
    }
}
