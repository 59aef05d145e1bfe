//! Plans against plain counting, against random sets, and against what `fit` reports in the end.

use super::super::law::{ArmParameter, Law, Quantity};
use super::super::sheet::LoadCase;
use super::super::synthetic::sheet;
use super::super::tests::identify;
use super::super::tests::{GEOMETRY, NOISE, arm, cell, gauss, problem};
use super::super::{Estimate, FitModel, Problem};
use super::candidates::draw_candidates;
use super::expected::{normal_of, sheet_of};
use super::fedorov::{IOptimality, exchange, random_set, values};
use super::parameters::{InformationMatrix, MAX_PARAMETERS, Parameters};
use super::unobservable::UnobservableReason;
use super::*;
use nalgebra::{DMatrix, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::PI;
use stead_model::robot::testing::{kr270, odd_arms};
use stead_model::robot::{Compliance, Frames, Robot};
use stead_model::stiffness::equilibrium::{Load, displaced};
use stead_numerics::monitor::Monitor;

/// The arm to be found, not known well: every compliance is off by a quarter or more.
fn guess() -> Robot {
    let mut laws = [0.4e-6, 0.3e-6, 0.6e-6, 2e-6, 5e-6, 3e-6].map(Compliance::from);
    if let Compliance::Compensated { alone, compensator } = arm().joints()[1].compliance {
        laws[1] = Compliance::Compensated { alone: 1.2 * alone, compensator };
    }
    kr270().with_compliances(laws).unwrap()
}

/// 20 configurations with 5 angles of joint 2, three points, 2.7 kN in any direction a quarter of a metre off axis 6.
fn request(seed: u64) -> Request {
    let robot = guess();
    let limits = std::array::from_fn(|j| [robot.joints()[j].min.max(-PI), robot.joints()[j].max.min(PI)]);
    Request {
        load_point: cell(3).load_point,
        points: cell(3).points,
        noise: NOISE,
        varying: Some((1, Law::Spring(GEOMETRY))),
        model: FitModel::Axes,
        hold: [false; 6],
        hold_normal: [[false; 2]; 6],
        angle_tolerance: 1e-4,
        level_joint: 1,
        levels: [0.2, 0.75, 1.3, 1.9, 2.5].to_vec(),
        limits,
        loads: LoadDirections::Any,
        load: 2700.0,
        volume: Volume::OPEN,
        max_deflection: 0.02,
        tip: cell(3).load_point,
        tests: TestCases::Drawn(100),
        configurations: 20,
        candidates: 400,
        seed,
        starts: 4,
        random_sets: 1000,
        max_relative_deviation: 0.2,
        robot,
    }
}

fn planned(request: &Request) -> Design {
    design_experiment(request, &Monitor::silent()).unwrap()
}

/// Candidates' informations, and the criterion over all numbers.
fn prepared(request: &Request) -> (Vec<InformationMatrix>, IOptimality, InformationMatrix) {
    let parameters = Parameters::new(&request.robot, request.varying);
    let informations: Vec<_> = draw_candidates(request)
        .load_cases
        .iter()
        .map(|load_case| parameters.information(request, load_case))
        .collect();
    let tests = super::candidates::test_cases(request, 30);
    let weighting = parameters.weighting(request, &tests);
    let free = std::array::from_fn(|number| number < 6 || request.varying.is_some());
    let criterion = IOptimality::new(&weighting, &free, &informations, request.configurations);
    (informations, criterion, weighting)
}

#[test]
fn the_criterion_is_the_trace_of_the_product_with_the_inverse() {
    for varying in [None, Some((1, Law::Spring(GEOMETRY)))] {
        let request = Request { varying, candidates: 60, ..request(1) };
        let (informations, criterion, weighting) = prepared(&request);
        let size = if varying.is_some() { MAX_PARAMETERS } else { 6 };
        for draw in 0..20 {
            let set = random_set(9, draw, 20, informations.len());
            let sum = set.iter().fold(InformationMatrix::zeros(), |sum, index| sum + informations[*index]);
            let [matrix, q] = [sum, weighting].map(|m| DMatrix::from_fn(size, size, |i, j| m[(i, j)]));
            let unit = DMatrix::from_diagonal(&matrix.diagonal().map(|value| 1.0 / libm::sqrt(value)));
            let inverse = &unit * (&unit * matrix * &unit).try_inverse().unwrap() * &unit;
            let expected = (q * inverse).trace();
            assert!((criterion.value(&sum) / expected - 1.0).abs() < 1e-6, "{} {expected}", criterion.value(&sum));
        }
        assert_eq!(criterion.value(&InformationMatrix::zeros()), f64::INFINITY);
    }
}

#[test]
fn information_is_that_of_the_normal_equations_of_fit() {
    let request = Request { varying: None, levels: vec![], candidates: 30, ..request(2) };
    let (informations, ..) = prepared(&request);
    let (_, normal) = normal_of::<6>(&request, &sheet_of(&request, &draw_candidates(&request).load_cases));
    let sum = informations.iter().fold(InformationMatrix::zeros(), |sum, part| sum + part);
    for i in 0..6 {
        for j in 0..6 {
            let scale = libm::sqrt(normal.shared[(i, i)] * normal.shared[(j, j)]);
            assert!((sum[(i, j)] - normal.shared[(i, j)]).abs() < 1e-12 * scale);
        }
    }
}

#[test]
fn exchange_finds_the_best_of_all_sets() {
    for seed in 0..6 {
        let request = Request { candidates: 14, configurations: 4, varying: None, levels: vec![], ..request(seed) };
        let (informations, criterion, _) = prepared(&request);
        let mut sets: Vec<Vec<usize>> = vec![vec![]];
        for _ in 0..4 {
            let longer = |set: &Vec<usize>| {
                let set = set.clone();
                (set.last().map_or(0, |last| last + 1)..14)
                    .map(move |next| [&set[..], &[next]].concat())
                    .collect::<Vec<_>>()
            };
            sets = sets.iter().flat_map(longer).collect();
        }
        assert_eq!(sets.len(), 1001);
        let best = values(&criterion, &informations, &sets).into_iter().fold(f64::INFINITY, f64::min);
        let starts: Vec<_> = (0..6).map(|draw| random_set(seed, draw, 4, 14)).collect();
        let found = exchange(&criterion, &informations, 4, &starts, &Monitor::silent()).unwrap();
        assert!((found.value / best - 1.0).abs() < 1e-9, "{} {best}", found.value);
    }
}

/// Arms of all kinds, with and without a law of joint 2.
fn requests() -> Vec<Request> {
    let mut requests: Vec<Request> = (0..3).map(request).collect();
    for (index, robot) in odd_arms().into_iter().enumerate().step_by(9) {
        requests.push(Request {
            robot,
            varying: None,
            levels: vec![],
            limits: [[-3.0, 3.0]; 6],
            ..request(index as u64)
        });
    }
    requests.push(Request {
        varying: Some((1, Law::Constant)),
        configurations: 8,
        loads: LoadDirections::Horizontal,
        ..request(5)
    });
    requests.push(Request { points: cell(1).points, configurations: 6, ..request(6) });
    requests
}

#[test]
fn plans_are_better_than_the_best_of_a_thousand_random_sets() {
    for request in requests() {
        let plan = planned(&request);
        let ExpectedErrors { planned, best_random, median_random, random_sets, .. } = plan.errors;
        assert_eq!(random_sets, 1000);
        assert!(planned < best_random && best_random < median_random, "{:?}", plan.errors);
        // A thousand others than those among which the exchange has a start.
        let others = Request { starts: 2, ..request.clone() };
        let parameters = Parameters::new(&others.robot, others.varying);
        let informations: Vec<_> =
            draw_candidates(&others).load_cases.iter().map(|s| parameters.information(&others, s)).collect();
        let weighting = parameters.weighting(&others, &plan.tests);
        let free: [bool; MAX_PARAMETERS] =
            std::array::from_fn(|number| number < 6 || matches!(others.varying, Some((_, Law::Spring(_)))));
        let criterion = IOptimality::new(&weighting, &free, &informations, others.configurations);
        let sets: Vec<_> =
            (0..1000).map(|k| random_set(others.seed + 77, k, others.configurations, informations.len())).collect();
        let least = values(&criterion, &informations, &sets).into_iter().fold(f64::INFINITY, f64::min);
        assert!(planned < libm::sqrt(least), "{planned} {}", libm::sqrt(least));
    }
}

/// A sheet from the true arm at the shots of a plan.
fn measured(plan: &Design, seed: u64, noise: f64) -> Problem {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let readings = sheet(&arm(), &cell(3), &plan.load_cases, || noise * gauss(&mut random), || 0.0);
    let start = Some(cell(3).tracker_from_base.rotation);
    Problem { robot: guess(), noise: Some(NOISE), start, ..problem(readings, &cell(3)) }
}

#[test]
fn fit_reports_what_the_plan_expects_and_many_sheets_spread_as_much() {
    const REPETITIONS: u64 = 400;
    let request = request(1);
    let plan = planned(&request);
    let found: Vec<_> =
        (0..REPETITIONS).into_par_iter().map(|seed| identify(&measured(&plan, seed, NOISE)).unwrap()).collect();
    assert_eq!(found[0].compliances.len(), plan.compliances.iter().filter(|bar| bar.deviation.is_some()).count());
    let expected = plan.compliances.iter().filter_map(|bar| bar.deviation);
    for (index, expected) in expected.enumerate() {
        let reported = found[0].compliances[index].deviation;
        assert!((reported / expected - 1.0).abs() < 0.02, "seen {index}: {reported} {expected}");
        let mean = found.iter().map(|f| f.compliances[index].value).sum::<f64>() / REPETITIONS as f64;
        let square = found
            .iter()
            .map(|f| (f.compliances[index].value - mean) * (f.compliances[index].value - mean))
            .sum::<f64>();
        let spread = libm::sqrt(square / (REPETITIONS - 1) as f64);
        // Three standard deviations of an estimated standard deviation.
        assert!((spread / expected - 1.0).abs() < 3.0 / libm::sqrt(2.0 * REPETITIONS as f64), "{spread} {expected}");
    }
    // The error of the deflection of the tip, over tests and sheets. The law makes it hang on the true arm a little.
    let mut squares = 0.0;
    for test in &plan.tests {
        let frames = Frames::new(&request.robot, &test.theta);
        let tip = frames.base_from_flange.point(&request.tip);
        let moved = |robot: &Robot| {
            let compliances = robot.compliances_at(&test.theta);
            stead_model::stiffness::displacement(&frames, &tip, &compliances, &test.force, &test.moment).linear
        };
        let truth = moved(&arm());
        squares += found.iter().map(|found| (moved(&found.robot) - truth).norm_squared()).sum::<f64>();
    }
    let error = libm::sqrt(squares / (plan.tests.len() as u64 * REPETITIONS) as f64);
    assert!((error / plan.errors.planned - 1.0).abs() < 0.1, "{error} {}", plan.errors.planned);
}

/// Those of small loads; the arm of the full load is deflected when `fit` looks at it, which changes them by less than
/// a thousandth.
#[test]
fn the_expected_errors_of_the_compensator_are_those_of_fit() {
    for (load, tolerance) in [(270.0, 1e-4), (2700.0, 1e-3)] {
        // From the true arm and without an error, since they hang on each other and on the estimate.
        let request = Request { robot: arm(), load, ..request(3) };
        let plan = planned(&request);
        let found = identify(&Problem { robot: arm(), ..measured(&plan, 1, 0.0) }).unwrap();
        assert_eq!(plan.compensator.len(), 3);
        for bar in &plan.compensator {
            let fitted = found.arm.iter().find(|estimate| estimate.parameter == bar.parameter).unwrap();
            assert!((fitted.deviation / bar.deviation - 1.0).abs() < tolerance, "{bar:?} {fitted:?}");
            assert!((fitted.value / bar.value - 1.0).abs() < 1e-6);
        }
        let joint = |j: usize| plan.compliances.iter().find(|bar| bar.joint == j).unwrap();
        let is_plain =
            |e: &&Estimate<ArmParameter>| e.parameter.quantity == Quantity::Compliance && e.parameter.joint != 1;
        for estimate in found.arm.iter().filter(is_plain) {
            assert!((estimate.deviation / joint(estimate.parameter.joint).by_law - 1.0).abs() < tolerance);
        }
    }
}

#[test]
fn what_no_load_shows_is_named_with_the_reason_and_the_rest_is_planned() {
    let small = |change: fn(&mut Request)| {
        let mut request = Request { candidates: 100, random_sets: 50, ..request(4) };
        change(&mut request);
        planned(&request)
    };
    let reasons =
        |plan: &Design| plan.unobservable.iter().map(|b| (b.compliances[0].0.joint, b.reason)).collect::<Vec<_>>();
    let vertical = small(|request| request.loads = LoadDirections::Vertical);
    assert_eq!(reasons(&vertical), [(0, UnobservableReason::LoadsAlongAxis)]);
    assert!(
        vertical.compliances.iter().all(|bar| bar.joint != 0) && vertical.errors.planned < vertical.errors.best_random
    );
    let on_axis = small(|request| request.load_point = Vector3::new(0.0, 0.0, 0.2));
    assert_eq!(reasons(&on_axis), [(5, UnobservableReason::LoadOnAxis)]);
    let one_point = small(|request| request.points = vec![Vector3::new(0.0, 0.0, 0.3)]);
    assert_eq!(reasons(&one_point), [(5, UnobservableReason::PointsOnAxis)]);
    let straight = small(|request| request.limits[4] = [0.0, 0.0]);
    assert_eq!(
        reasons(&straight).iter().map(|(_, reason)| *reason).collect::<Vec<_>>(),
        [UnobservableReason::Dependent]
    );
    let pair: Vec<usize> = straight.unobservable[0].compliances.iter().map(|(spring, _)| spring.joint).collect();
    assert!(pair == [3, 5] || pair == [5, 3], "{pair:?}");

    let near = small(|request| request.load_point = Vector3::new(0.002, 0.0, 0.2));
    assert!(near.unobservable.is_empty());
    let weak = near.weakly_observed.iter().find(|weak| weak.joint == 5).unwrap();
    assert!(weak.share > 0.2 && weak.lever < 0.003, "{weak:?}");
    let far = small(|_| ());
    assert!(
        far.unobservable.is_empty() && far.weakly_observed.is_empty(),
        "{:?} {:?}",
        far.unobservable,
        far.weakly_observed
    );
}

#[test]
fn candidates_keep_to_limits_levels_volume_and_deflection() {
    let mut request = Request { candidates: 300, ..request(8) };
    request.volume = Volume { ranges: [[0.2, 4.0], [-4.0, 4.0], [-0.6, 2.0]], min_radius: 0.7 };
    request.max_deflection = 0.006;
    let drawn = draw_candidates(&request);
    assert_eq!(drawn.load_cases.len(), 300);
    let rejected = drawn.rejected;
    assert!(rejected.volume > 0 && rejected.radius > 0 && rejected.deflection > 0, "{rejected:?}");
    assert_eq!(drawn.draws, 300 + rejected.volume + rejected.radius + rejected.deflection);
    for LoadCase { theta, force, .. } in &drawn.load_cases {
        assert!(request.levels.contains(&theta[1]));
        assert!((0..6).all(|j| j == 1 || (request.limits[j][0]..=request.limits[j][1]).contains(&theta[j])));
        assert!((force.norm() - 2700.0).abs() < 0.1);
        let flange = request.robot.forward(theta);
        assert!(request.points.iter().all(|point| request.volume.contains(&flange.point(point))));
    }
    let none = Request { volume: Volume { min_radius: 9.0, ..Volume::OPEN }, ..request };
    assert!(matches!(
        design_experiment(&none, &Monitor::silent()),
        Err(DesignError::TooFewCandidates { found: 0, .. })
    ));
}

#[test]
fn candidates_are_so_little_deflected_that_the_model_of_fit_is_linear_enough() {
    let request = Request { max_deflection: 0.01, candidates: 200, ..request(9) };
    let mut worst = 0.0_f64;
    for LoadCase { theta, force, moment } in draw_candidates(&request).load_cases {
        let compliances = request.robot.compliances_at(&theta);
        let frames = Frames::new(&request.robot, &theta);
        let load = frames.base_from_flange.point(&request.load_point);
        let linear = stead_model::stiffness::displacement(&frames, &load, &compliances, &force, &moment).linear;
        let exact =
            displaced(&request.robot, &theta, &Load { point: request.load_point, force, moment }).unwrap().linear;
        worst = worst.max((exact - linear).norm() / linear.norm());
    }
    assert!(worst < 0.02, "{worst}");
}

#[test]
fn the_plan_is_the_same_on_any_number_of_threads() {
    let request = Request { candidates: 150, random_sets: 100, ..request(3) };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| planned(&request))
    };
    assert_eq!(on(1), on(3));
    let stopped = Monitor::silent();
    stopped.stop_handle().stop();
    assert_eq!(design_experiment(&request, &stopped), Err(DesignError::Stopped));
}

#[test]
fn counts_that_cannot_do_are_refused() {
    let refused = |change: fn(&mut Request)| {
        let mut request = Request { candidates: 50, ..request(1) };
        change(&mut request);
        design_experiment(&request, &Monitor::silent()).unwrap_err()
    };
    assert!(matches!(refused(|r| r.configurations = 2), DesignError::Law(_)));
    assert!(matches!(
        refused(|r| (r.configurations, r.varying) = (1, None)),
        DesignError::Setup(super::super::setup::SetupError::TooFew { equations: 9, unknowns: 15 })
    ));
    let one = |r: &mut Request| {
        r.points.truncate(1);
        (r.configurations, r.varying) = (1, None);
    };
    assert!(matches!(refused(one), DesignError::TooFew { equations: 3, unknowns: 6 }));
}

#[test]
fn a_plan_for_all_springs_expects_what_a_full_fit_reports() {
    use super::super::gauge::Gauge;
    use super::super::tests::full::{WRIST_CENTRE, full_arm};
    let robot = full_arm(WRIST_CENTRE);
    let request = Request {
        model: FitModel::Full,
        varying: None,
        levels: vec![],
        configurations: 30,
        candidates: 150,
        starts: 2,
        random_sets: 100,
        robot: robot.clone(),
        ..request(1)
    };
    let plan = planned(&request);
    assert_eq!((plan.compliances.len(), plan.gauge.replaced.len()), (15, 3));
    assert!(plan.errors.planned < plan.errors.best_random && plan.unobservable.is_empty(), "{:?}", plan.errors);
    let readings = sheet(&robot, &cell(3), &plan.load_cases, || 0.0, || 0.0);
    let start = Some(cell(3).tracker_from_base.rotation);
    let varying = None;
    let fit =
        Problem { robot, noise: Some(NOISE), start, varying, model: FitModel::Full, ..problem(readings, &cell(3)) };
    let found = identify(&fit).unwrap();
    for (bar, estimate) in plan.compliances.iter().zip(&found.compliances) {
        assert_eq!(bar.spring(), found.spring(estimate.parameter));
        // The plan takes the arm as it is without the load.
        assert!((estimate.deviation / bar.deviation.unwrap() - 1.0).abs() < 0.02, "{bar:?} {estimate:?}");
        assert!((bar.by_law / bar.deviation.unwrap() - 1.0).abs() < 1e-6, "{bar:?}");
        // Turns of joints 4 and 5 commute to first order only: some hundredths of a standard deviation.
        assert!((estimate.value - bar.value).abs() < 0.1 * estimate.deviation, "{bar:?} {estimate:?}");
    }
    // With all of joint 5 held there is nothing that cannot be told apart but by joint 4 and 6 alone.
    let held =
        Request { hold_normal: [[false; 2], [false; 2], [false; 2], [false, true], [true; 2], [false; 2]], ..request };
    let plan = planned(&held);
    assert_eq!((plan.compliances.len(), &plan.gauge), (15, &Gauge::default()));
    // Loads along the axis of joint 1 do not turn it about that, but about x and y.
    let vertical = planned(&Request { loads: LoadDirections::Vertical, ..held });
    let unseen: Vec<String> = vertical.unobservable.iter().map(|entry| entry.compliances[0].0.to_string()).collect();
    assert_eq!(unseen, ["joint 1 about z"]);
    let warning = &vertical.warnings.iter().find(|warning| warning.kind == "unobservable").unwrap().message;
    for part in
        ["joint 1 about z is unobservable: every load is vertical, along axis 1", "fit.hold = [\"joints[1].z\"]"]
    {
        assert!(warning.contains(part), "{part} in {warning}");
    }
}
