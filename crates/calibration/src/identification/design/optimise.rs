//! The choice of measurements as a whole.

use super::super::gauge::Gauge;
use super::super::inverse::{MIN_PIVOT, inverse_over};
use super::super::law::{Law, LawError};
use super::super::model::{Layout, Parameter};
use super::super::setup::{SetupError, estimate};
use super::super::sheet::{LoadCase, Sheet};
use super::super::springs::{AXES, FULL, FitModel, spring};
use super::candidates::{Candidates, draw_candidates, test_cases};
use super::error::DesignError;
use super::expected::{
    Covariances, ExpectedCompliance, expected_compensator, expected_compliances, normal_of, seen, sheet_of,
};
use super::fedorov::{IOptimality, exchange, random_set, sum_over, values};
use super::order::{ordered, travel};
use super::parameters::{FULL_PARAMETERS, InformationMatrix, MAX_PARAMETERS, Parameters};
use super::request::{Request, TestCases};
use super::result::{Design, ExpectedErrors};
use super::unobservable::{Unobservable, unobservable, weakly_observed};
use super::warnings::{unused_angles, warnings};
use nalgebra::Matrix3;
use rayon::prelude::*;
use stead_model::robot::Pose;
use stead_numerics::message::Note;
use stead_numerics::monitor::Monitor;

/// Chooses the configurations and loads to measure, start by start of the exchange.
///
/// The chosen set is at least as good as the best of the random sets: that is one of the starts.
///
/// # Errors
/// [`DesignError`] when no set could be chosen.
pub fn design_experiment(request: &Request, monitor: &Monitor) -> Result<Design, DesignError> {
    if request.varying.is_some_and(|(joint, _)| request.hold[joint]) {
        // The joint keeps the law of the starting arm, as in an identification that holds it.
        return design_experiment(&Request { varying: None, ..request.clone() }, monitor);
    }
    match request.model {
        FitModel::Axes => designed::<AXES, MAX_PARAMETERS>(request, monitor),
        FitModel::Full => designed::<FULL, FULL_PARAMETERS>(request, monitor),
    }
}

/// The same with so many springs and parameters.
fn designed<const N: usize, const P: usize>(request: &Request, monitor: &Monitor) -> Result<Design, DesignError> {
    let held: [bool; N] = request.held();
    let gauge = Gauge::of(request.model, &request.robot, &held);
    let hold: [bool; N] = std::array::from_fn(|column| held[column] || gauge.is_zero(spring(column)));
    check_counts(request, hold.iter().filter(|is_free| !**is_free).count())?;
    let size = request.configurations;
    let pool: Pool<'_, P> = Pool::new(request, hold)?;
    let random = RandomSets::new(&pool);
    let starts = random.starts(request.starts.saturating_sub(1));
    let chosen = exchange(&pool.criterion, &pool.informations, size, &starts, monitor).ok_or(DesignError::Stopped)?;
    let planned = pool.covariance(&chosen.set).filter(|_| chosen.value.is_finite());
    let planned = planned.ok_or(DesignError::NoIdentifyingSet(size))?;

    let load_cases = ordered(&chosen.set.iter().map(|index| pool.drawn.load_cases[*index]).collect::<Vec<_>>());
    let sheet = sheet_of(request, &load_cases);
    check_setup(request, &sheet)?;
    let (layout, normal) = normal_of(request, &sheet);
    let (alone, unidentifiable) = seen(&layout, &normal, hold);
    let mut all_unobservable = pool.unobservable.clone();
    for spot in unobservable(request, &load_cases, &layout, &unidentifiable) {
        if !all_unobservable.iter().any(|known| known.is_same(&spot)) {
            all_unobservable.push(spot);
        }
    }
    let covariances = Covariances {
        plan: planned,
        random: random.sets.par_iter().filter_map(|set| pool.covariance(set)).collect(),
        best_random: random.best.and_then(|best| pool.covariance(&random.sets[best])),
    };
    let mut compliances = expected_compliances(request, &pool.parameters, &gauge, &pool.free, &covariances);
    compliances.iter_mut().for_each(|c| c.deviation = own_deviation(request, c, &layout, &alone));
    let weakly_observed = weakly_observed(request, &load_cases, &compliances);
    Ok(Design {
        travel: travel(&load_cases),
        notes: unused_angles(request.model, &compliances).map(Note::from).into_iter().collect(),
        warnings: warnings(request, &gauge, &all_unobservable, &weakly_observed),
        weakly_observed,
        load_cases,
        sheet,
        compliances,
        compensator: expected_compensator(request, &covariances.plan),
        errors: random.errors(chosen.value),
        deflection: pool.parameters.deflection(request, &pool.tests),
        gauge,
        tests: pool.tests,
        unobservable: all_unobservable,
        candidates: pool.drawn.load_cases.len(),
        draws: pool.drawn.draws,
        rejected: pool.drawn.rejected,
    })
}

/// What there is to choose from, and by what.
struct Pool<'a, const P: usize> {
    request: &'a Request,
    drawn: Candidates,
    tests: Vec<LoadCase>,
    parameters: Parameters<'a>,
    informations: Vec<InformationMatrix<P>>,
    /// The parameters of the arm that are identifiable from all candidates together.
    free: [bool; P],
    /// The others.
    unobservable: Vec<Unobservable>,
    criterion: IOptimality<P>,
}

impl<'a, const P: usize> Pool<'a, P> {
    fn new<const N: usize>(request: &'a Request, hold: [bool; N]) -> Result<Self, DesignError> {
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
        let (layout, normal) = normal_of::<N>(request, &sheet_of(request, &drawn.load_cases));
        let (identifiable, unidentifiable) = normal.identifiable(hold);
        let free: [bool; P] = parameters.free(&identifiable);
        if !free.contains(&true) {
            return Err(DesignError::NothingIdentifiable);
        }
        let unobservable = unobservable(request, &drawn.load_cases, &layout, &unidentifiable);
        let informations: Vec<InformationMatrix<P>> =
            drawn.load_cases.par_iter().map(|load_case| parameters.information(request, load_case)).collect();
        let criterion = IOptimality::new(&parameters.weighting(request, &tests), &free, &informations, size);
        Ok(Self { request, drawn, tests, parameters, informations, free, unobservable, criterion })
    }

    /// Covariance of the parameters of the arm from a set; nothing where they are not identifiable.
    fn covariance(&self, set: &[usize]) -> Option<InformationMatrix<P>> {
        inverse_over(&sum_over(&self.informations, set), |k| self.free[k], MIN_PIVOT)
    }
}

/// Random sets and their values of the criterion.
struct RandomSets {
    sets: Vec<Vec<usize>>,
    values: Vec<f64>,
    best: Option<usize>,
}

impl RandomSets {
    fn new<const P: usize>(pool: &Pool<'_, P>) -> Self {
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

/// The standard deviation that an identification reports for a compliance by itself, where the set has its angle.
fn own_deviation(
    request: &Request,
    expected: &ExpectedCompliance,
    layout: &Layout,
    alone: &[(Parameter, f64)],
) -> Option<f64> {
    let is_it = |parameter: Parameter| {
        layout.spring(parameter) == expected.spring()
            && match (expected.angle, layout.angle(parameter)) {
                (Some(a), Some(b)) => (a - b).abs() <= request.angle_tolerance.max(1e-9),
                (a, b) => a.is_none() && b.is_none(),
            }
    };
    alone.iter().find(|(parameter, _)| is_it(*parameter)).map(|(_, deviation)| *deviation)
}

/// Refuses what has fewer equations than unknowns.
fn check_counts(request: &Request, springs: usize) -> Result<(), DesignError> {
    let (size, levels) = (request.configurations, request.levels.len());
    let equations = 3 * size * request.points.len();
    let unknowns = match request.varying {
        Some((joint, Law::Spring(_))) if size.min(levels) < 3 => {
            return Err(LawError::TooFewAngles { found: size.min(levels), joint: joint + 1 }.into());
        }
        Some((_, Law::Spring(_))) => springs + 2,
        _ => springs,
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

/// Refuses a set from whose unloaded readings base transform and reference points are not identifiable.
fn check_setup(request: &Request, sheet: &Sheet) -> Result<(), DesignError> {
    let flanges: Vec<Pose<f64>> = sheet.configurations.iter().map(|c| request.robot.forward(&c.theta)).collect();
    estimate(sheet, &flanges, &vec![true; sheet.readings.len()], Some(&Matrix3::identity()))?;
    Ok(())
}
