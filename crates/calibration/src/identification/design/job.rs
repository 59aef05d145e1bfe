//! The job as a whole.

use super::super::law::{Law, LawError};
use super::super::model::{Layout, Parameter, Response};
use super::super::setup::{SetupError, estimate};
use super::super::sheet::{LoadCase, Sheet};
use super::candidates::{Candidates, Rejected, draw_candidates, test_cases};
use super::expected::{
    ExpectedCompliance, ExpectedParameter, bars, covariance, expected_compensator, normal_of, seen, sheet_of,
};
use super::fedorov::{IOptimality, exchange, random_set, values};
use super::order::{ordered, travel};
use super::parameters::{InformationMatrix, MAX_PARAMETERS, Parameters};
use super::request::{Request, TestCases};
use super::unobservable::{Unobservable, WeaklyObserved, unobservable, weakly_observed};
use nalgebra::{Matrix3, Vector6};
use rayon::prelude::*;
use stead_model::robot::{Frames, Pose};
use stead_numerics::monitor::Monitor;

/// A set of configurations to measure, and what it will tell.
#[derive(Debug, Clone, PartialEq)]
pub struct Design {
    /// Joint angles and loads, in the order in which to measure.
    pub load_cases: Vec<LoadCase>,
    /// The sheet of these, with what the starting arm would show; base and tracker frame are the same.
    pub sheet: Sheet,
    /// Every compliance with its expected error.
    pub bars: Vec<ExpectedCompliance>,
    /// The numbers of joint and compensator likewise, where the starting robot has a compensator.
    pub spring: Vec<ExpectedParameter>,
    /// What sets are worth: root of the mean square error of the deflection of the tip over the tests. m
    pub errors: ExpectedErrors,
    /// Root of the mean square of that deflection itself, by the starting arm. m
    pub deflection: f64,
    /// Where the deflection of the tip is to be known.
    pub tests: Vec<LoadCase>,
    /// What no candidate shows, or this set does not.
    pub unobservable: Vec<Unobservable>,
    /// What is hardly seen.
    pub weakly_observed: Vec<WeaklyObserved>,
    /// Candidates the set was chosen from.
    pub candidates: usize,
    /// Configurations drawn to have these.
    pub draws: usize,
    /// Configurations that were not allowed, and why.
    pub rejected: Rejected,
    /// The joint that turns furthest, summed over the ways from one configuration to the next. rad
    pub travel: f64,
}

/// What sets are worth. m
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExpectedErrors {
    /// The plan.
    pub planned: f64,
    /// The best of the random sets, infinite where none tells everything.
    pub best_random: f64,
    /// The median of the random sets.
    pub median_random: f64,
    /// How many random sets there are.
    pub random_sets: usize,
    /// How many of those do not tell everything that the candidates tell.
    pub unidentifiable_sets: usize,
}

/// Why there is no plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Too few configurations are allowed.
    #[error(
        "of {draws} random configurations only {found} are allowed, where {wanted} are wanted: {} would leave the volume, {} come \
         too near to the base, {} deflect too far",
        rejected.volume, rejected.radius, rejected.deflection
    )]
    TooFewCandidates {
        /// How many are allowed.
        found: usize,
        /// How many are needed.
        wanted: usize,
        /// How many were drawn.
        draws: usize,
        /// Why the others are not.
        rejected: Rejected,
    },
    /// No test pose is allowed.
    #[error("no random test pose is allowed by the volume and the largest deflection")]
    NoTest,
    /// Fewer equations than unknowns.
    #[error("{equations} deflection components do not tell {unknowns} compliances")]
    TooFew {
        /// Components read.
        equations: usize,
        /// Compliances sought.
        unknowns: usize,
    },
    /// Base transform and reference points cannot be told.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A compensator cannot be told from so few angles.
    #[error("{0}")]
    Law(#[from] LawError),
    /// There is nothing that the loads show.
    #[error("the loads show no compliance at all")]
    NothingSeen,
    /// No set of this size tells all that the candidates tell.
    #[error("no set of {0} of the candidates was found that tells every compliance")]
    NothingTold(usize),
    /// The caller wanted no more.
    #[error("stopped before there was a plan")]
    Stopped,
}

/// Plans the measurements, start by start of the exchange.
///
/// The plan is at least as good as the best of the random sets: that is one of the starts.
///
/// # Errors
/// [`DesignError`] when there is no plan.
pub fn design_experiment(request: &Request, monitor: &Monitor) -> Result<Design, DesignError> {
    check_counts(request)?;
    let size = request.configurations;
    let pool = Pool::new(request)?;
    let random = RandomSets::new(&pool);
    let starts = random.starts(request.starts.saturating_sub(1));
    let chosen = exchange(&pool.criterion, &pool.informations, size, &starts, monitor).ok_or(DesignError::Stopped)?;
    let planned = pool.covariance(&chosen.set).filter(|_| chosen.value.is_finite());
    let planned = planned.ok_or(DesignError::NothingTold(size))?;

    let load_cases = ordered(&chosen.set.iter().map(|index| pool.drawn.load_cases[*index]).collect::<Vec<_>>());
    let sheet = sheet_of(request, &load_cases);
    check_setup(request, &sheet)?;
    let (layout, normal) = normal_of(request, &sheet);
    let (alone, unidentifiable) = seen(&layout, &normal);
    let mut all_unobservable = pool.unobservable.clone();
    for spot in unobservable(request, &load_cases, &layout, &unidentifiable) {
        if !all_unobservable.iter().any(|known| known.is_same(&spot)) {
            all_unobservable.push(spot);
        }
    }
    let spreads: Vec<InformationMatrix> = random.sets.par_iter().filter_map(|set| pool.covariance(set)).collect();
    let best_random = random.best.and_then(|best| pool.covariance(&random.sets[best]));
    let mut bars = bars(request, &pool.parameters, &pool.free, &planned, &spreads, best_random.as_ref());
    bars.iter_mut().for_each(|bar| bar.deviation = own_deviation(request, bar, &layout, &alone));
    Ok(Design {
        travel: travel(&load_cases),
        weakly_observed: weakly_observed(request, &load_cases, &bars),
        load_cases,
        sheet,
        bars,
        spring: expected_compensator(request, &planned),
        errors: random.errors(chosen.value),
        deflection: deflection(request, &pool.tests),
        tests: pool.tests,
        unobservable: all_unobservable,
        candidates: pool.drawn.load_cases.len(),
        draws: pool.drawn.draws,
        rejected: pool.drawn.rejected,
    })
}

/// What there is to choose from, and by what.
struct Pool<'a> {
    request: &'a Request,
    drawn: Candidates,
    tests: Vec<LoadCase>,
    parameters: Parameters<'a>,
    informations: Vec<InformationMatrix>,
    /// The numbers of the arm that the candidates tell all together.
    free: [bool; MAX_PARAMETERS],
    /// What they do not.
    unobservable: Vec<Unobservable>,
    criterion: IOptimality,
}

impl<'a> Pool<'a> {
    fn new(request: &'a Request) -> Result<Self, DesignError> {
        let size = request.configurations;
        let drawn = draw_candidates(request);
        if drawn.load_cases.len() < size {
            let (found, draws, rejected) = (drawn.load_cases.len(), drawn.draws, drawn.rejected);
            return Err(DesignError::TooFewCandidates { found, wanted: size, draws, rejected });
        }
        let tests = match &request.tests {
            TestCases::Given(tests) => tests.clone(),
            TestCases::Drawn(count) => test_cases(request, *count),
        };
        if tests.is_empty() {
            return Err(DesignError::NoTest);
        }
        let parameters = Parameters::new(&request.robot, request.varying);
        let (layout, normal) = normal_of(request, &sheet_of(request, &drawn.load_cases));
        let (seen, unidentifiable) = normal.identifiable();
        let free = parameters.free(&seen);
        if !free.contains(&true) {
            return Err(DesignError::NothingSeen);
        }
        let unobservable = unobservable(request, &drawn.load_cases, &layout, &unidentifiable);
        let informations: Vec<InformationMatrix> =
            drawn.load_cases.par_iter().map(|load_case| parameters.information(request, load_case)).collect();
        let criterion = IOptimality::new(&parameters.weighting(request, &tests), &free, &informations, size);
        Ok(Self { request, drawn, tests, parameters, informations, free, unobservable, criterion })
    }

    /// Covariance of the numbers of the arm from a set; nothing where it does not tell them.
    fn covariance(&self, set: &[usize]) -> Option<InformationMatrix> {
        let sum = set.iter().fold(InformationMatrix::zeros(), |sum, index| sum + self.informations[*index]);
        covariance(&sum, &self.free)
    }
}

/// Random sets and what they are worth.
struct RandomSets {
    sets: Vec<Vec<usize>>,
    values: Vec<f64>,
    best: Option<usize>,
}

impl RandomSets {
    fn new(pool: &Pool<'_>) -> Self {
        let (request, of) = (pool.request, pool.informations.len());
        let draw = |draw| random_set(request.seed, draw, request.configurations, of);
        let sets: Vec<Vec<usize>> = (0..request.random_sets).into_par_iter().map(draw).collect();
        let values = values(&pool.criterion, &pool.informations, &sets);
        let best = (0..sets.len()).min_by(|a, b| values[*a].total_cmp(&values[*b]));
        Self { sets, values, best }
    }

    /// The best of them, and others in their order.
    fn starts(&self, count: usize) -> Vec<Vec<usize>> {
        let others = (0..self.sets.len()).filter(|set| Some(*set) != self.best);
        self.best.into_iter().chain(others).take(count).map(|set| self.sets[set].clone()).collect()
    }

    fn errors(&self, planned: f64) -> ExpectedErrors {
        let mut ascending = self.values.clone();
        ascending.sort_by(f64::total_cmp);
        let root = |value: Option<&f64>| libm::sqrt(*value.unwrap_or(&f64::INFINITY));
        ExpectedErrors {
            planned: libm::sqrt(planned),
            best_random: root(ascending.first()),
            median_random: root(ascending.get(ascending.len() / 2)),
            random_sets: ascending.len(),
            unidentifiable_sets: ascending.iter().filter(|value| value.is_infinite()).count(),
        }
    }
}

/// The standard deviation that a fit reports for a compliance on its own, where the set has its angle.
fn own_deviation(
    request: &Request,
    bar: &ExpectedCompliance,
    layout: &Layout,
    alone: &[(Parameter, f64)],
) -> Option<f64> {
    let is_it = |parameter: Parameter| {
        layout.joint(parameter) == bar.joint
            && match (bar.angle, layout.angle(parameter)) {
                (Some(a), Some(b)) => (a - b).abs() <= request.angle_tolerance.max(1e-9),
                (a, b) => a.is_none() && b.is_none(),
            }
    };
    alone.iter().find(|(parameter, _)| is_it(*parameter)).map(|(_, deviation)| *deviation)
}

/// Refuses what cannot be told by counting.
fn check_counts(request: &Request) -> Result<(), DesignError> {
    let (size, levels) = (request.configurations, request.levels.len());
    let equations = 3 * size * request.points.len();
    let unknowns = match request.varying {
        Some((joint, Law::Spring(_))) if size.min(levels) < 3 => {
            return Err(LawError::TooFewAngles { found: size.min(levels), joint: joint + 1 }.into());
        }
        Some((_, Law::Spring(_))) => 8,
        _ => 6,
    };
    if equations < unknowns {
        return Err(DesignError::TooFew { equations, unknowns });
    }
    let setup = 6 + 3 * request.points.len();
    if equations < setup {
        return Err(SetupError::TooFew { equations, unknowns: setup }.into());
    }
    Ok(())
}

/// Refuses a set from whose unloaded readings tracker and reference points could not be found.
fn check_setup(request: &Request, sheet: &Sheet) -> Result<(), DesignError> {
    let flanges: Vec<Pose<f64>> = sheet.configurations.iter().map(|c| request.robot.forward(&c.theta)).collect();
    estimate(sheet, &flanges, &vec![true; sheet.readings.len()], Some(&Matrix3::identity()))?;
    Ok(())
}

/// Root of the mean square of the deflection in the tests.
fn deflection(request: &Request, tests: &[LoadCase]) -> f64 {
    let square = |test: &LoadCase| {
        let frames = Frames::new(&request.robot, &test.theta);
        let tip = frames.base_from_flange.point(&request.tip);
        let response = Response::new(&frames, &tip, &tip, &test.force, &test.moment);
        (response.linear * Vector6::from(request.robot.compliances_at(&test.theta))).norm_squared()
    };
    libm::sqrt(tests.iter().map(square).sum::<f64>() / tests.len().max(1) as f64)
}
