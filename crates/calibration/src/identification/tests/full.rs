//! Springs about three directions of every joint: which can be told apart, and what is found of them.

use super::gauge::Gauge;
use super::springs::{AXES, FULL, column, compliances_of, spring};
use super::*;
use nalgebra::{Matrix3, Matrix6, Vector6};
use stead_model::robot::{BaseCompliance, Frames, MeasuredFrom, NormalSprings, Spindle, SpringModel};
use stead_model::stiffness::whole::WholeArm;

/// Compliances of about the size of a public set (KUKA series 2000), about z, then x and y, in urad/(N m).
const ABOUT_Z: [f64; 6] = [0.54, 0.41, 0.42, 2.8, 3.1, 2.1];
const NORMAL: [[f64; 2]; 6] = [[0.31, 0.22], [0.35, 0.41], [0.52, 0.37], [1.2, 0.9], [0.8, 1.4], [1.9, 1.1]];

/// An arm with springs about three directions of every joint, those normal to the axes at these places on them.
pub(in super::super) fn full_arm(bearings: [f64; 6]) -> Robot {
    let normal = std::array::from_fn(|joint| NormalSprings {
        compliance: NORMAL[joint].map(|urad| urad * 1e-6),
        bearing: bearings[joint],
    });
    let robot = kr270().with_compliances(ABOUT_Z.map(|urad| urad * 1e-6)).unwrap();
    robot.with_normal_springs(Some(normal)).unwrap().with_spring_model(Some(SpringModel::Full))
}

/// Bearings of joints 1 to 3 and 6 only; of joint 4 too; of all joints.
pub(in super::super) const WRIST_CENTRE: [f64; 6] = [-0.75, 0.1, -0.05, 0.0, 0.0, 0.12];
const FOREARM: [f64; 6] = [-0.75, 0.1, -0.05, -0.621, 0.0, 0.12];
const ALL: [f64; 6] = [-0.75, 0.1, -0.05, -0.621, 0.08, 0.12];

fn seen_of(robot: &Robot) -> Gauge {
    Gauge::of::<FULL>(FitModel::Full, robot, &[false; FULL])
}

#[test]
fn the_springs_that_cannot_be_told_apart_follow_from_where_they_sit() {
    let named = |bearings| -> Vec<String> {
        let gauge = seen_of(&full_arm(bearings));
        gauge.replaced.iter().map(|replaced| replaced.spring.to_string()).collect()
    };
    assert_eq!(named(WRIST_CENTRE), ["joint 4 about y", "joint 5 about x", "joint 5 about y"], "15 of 18");
    assert_eq!(named(FOREARM), ["joint 5 about y"], "17 of 18");
    assert_eq!(named(ALL), [""; 0], "18 of 18");
    let gauge = seen_of(&full_arm(WRIST_CENTRE));
    let sum = |number: usize| gauge.sum_name(spring(number), spring(number).to_string());
    assert_eq!(sum(3), "joint 4 about z with joint 5 about x");
    assert_eq!(sum(4), "joint 5 about z with joint 4 about y");
    assert_eq!(sum(5), "joint 6 about z with joint 5 about y, less joint 5 about x");
    assert_eq!(sum(12), "joint 4 about x with joint 5 about x");
    assert_eq!(sum(0), "joint 1 about z");
    // What is held is known, and tells the others apart.
    let held: [bool; FULL] = std::array::from_fn(|number| [13, 14, 15].contains(&number));
    assert_eq!(Gauge::of(FitModel::Full, &full_arm(WRIST_CENTRE), &held), Gauge::default());
    assert_eq!(Gauge::of(FitModel::Axes, &full_arm(WRIST_CENTRE), &[false; AXES]), Gauge::default());
}

/// The arm with these compliances in the order of columns.
fn with(robot: &Robot, compliances: &[f64; FULL]) -> Robot {
    let about_axes: [f64; 6] = std::array::from_fn(|joint| compliances[joint]);
    let normal = robot.stated_normal_springs().copied().unwrap();
    let normal = std::array::from_fn(|joint| NormalSprings {
        compliance: [0, 1].map(|about| compliances[AXES + 2 * joint + about]),
        ..normal[joint]
    });
    robot.with_compliances(about_axes).unwrap().with_normal_springs(Some(normal)).unwrap()
}

/// The compliance of a tool in a configuration. m and rad per N and N m
fn compliance(robot: &Robot, theta: &[f64; 6]) -> Matrix6<f64> {
    let spindle = Spindle::new(Matrix3::identity(), Vector3::new(0.3, 0.1, 0.4)).unwrap();
    let frames = Frames::new(robot, theta);
    let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
    let arm = WholeArm::new(robot, &spindle, &frames, robot.compliances_at(theta), tip);
    Matrix6::from_columns(&[0, 1, 2, 3, 4, 5].map(|k| {
        let wrench = Vector6::ith(k, 1.0);
        let moved = arm.displacement(&wrench.fixed_rows::<3>(0).into(), &wrench.fixed_rows::<3>(3).into());
        Vector6::from_iterator(moved.linear.iter().chain(&moved.angular).copied())
    }))
}

#[test]
fn the_tool_yields_alike_in_every_gauge_and_the_split_has_the_least_squares_of_those_above_zero() {
    for bearings in [WRIST_CENTRE, FOREARM, ALL] {
        let robot = full_arm(bearings);
        let gauge = seen_of(&robot);
        let given: [f64; FULL] = compliances_of::<FULL>(&robot, &[0.0; 6]).into();
        let fixed = gauge.fixed(&given);
        let split = gauge.split(&fixed, &[0.0; FULL]).unwrap();
        let squares = |all: &[f64; FULL]| all.iter().map(|value| value * value).sum::<f64>();
        assert!(split.iter().all(|value| *value >= 0.0) && squares(&split) <= squares(&given));
        if bearings == WRIST_CENTRE {
            assert_eq!(fixed[column(spring(13))], 0.0);
            assert!(squares(&split) < squares(&given));
            // No step along what changes nothing makes it less.
            let mut random = ChaCha8Rng::seed_from_u64(4);
            for _ in 0..200 {
                let mut near = split;
                let [a, b, c] = [0, 1, 2].map(|_| 1e-9 * (random.random_range(0..3) as f64 - 1.0));
                (near[13], near[4], near[15], near[5]) = (near[13] + a, near[4] - a, near[15] + b, near[5] - b);
                for (number, sign) in [(3, 1.0), (12, 1.0), (13, 1.0), (4, -1.0), (14, -1.0), (15, -1.0)] {
                    near[number] += sign * c;
                }
                let is_it = [a, b, c] == [0.0; 3];
                assert!(is_it || near.iter().any(|value| *value < 0.0) || squares(&near) > squares(&split));
            }
        }
        for k in 0..20 {
            let theta = std::array::from_fn(|joint| libm::sin(1.7 * k as f64 + 2.3 * joint as f64) * 2.5);
            let expected = compliance(&robot, &theta);
            // The gauge may have compliances below zero, which no arm has: what it has of others is enough to compare.
            let found = compliance(&with(&robot, &split), &theta);
            assert!((found - expected).norm() < 1e-12 * expected.norm(), "{bearings:?} {k}");
        }
    }
}

#[test]
fn sums_below_zero_are_split_among_values_above_zero() {
    let gauge = seen_of(&full_arm(WRIST_CENTRE));
    let mut given: [f64; FULL] = compliances_of::<FULL>(&full_arm(WRIST_CENTRE), &[0.0; 6]).into();
    (given[5], given[15], given[14]) = (0.1e-6, 0.2e-6, 1.5e-6);
    let fixed = gauge.fixed(&given);
    assert!(fixed[5] < -1e-6, "{fixed:?}");
    let split = gauge.split(&fixed, &[0.0; FULL]).unwrap();
    assert!(split.iter().all(|value| *value >= 0.0));
    let again = gauge.fixed(&split);
    assert!(fixed.iter().zip(again).all(|(a, b)| (a - b).abs() < 1e-12 * 3e-6), "{fixed:?} {again:?}");
    // x of joints 4 and 5 together below zero: there is none.
    given[12] = -2e-6;
    assert_eq!(gauge.split(&gauge.fixed(&given), &[0.0; FULL]), None);
}

/// Configurations all over the limits under a load in random directions, off the axis of joint 6.
fn random_cases(count: usize, seed: u64, load: f64) -> Vec<LoadCase> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut cases = load_cases(&mut random, count, count);
    cases.iter_mut().for_each(|case| case.force *= load / 2700.0);
    cases
}

/// A problem of a full fit, from an arm with other compliances.
fn problem_of(truth: &Robot, count: usize, seed: u64, noise: f64, load: f64) -> Problem {
    let cell = cell(3);
    let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
    let readings = sheet(truth, &cell, &random_cases(count, 5, load), || noise * gauss(&mut random), || 0.0);
    let start = with(truth, &std::array::from_fn(|number| if number < AXES { 1e-6 } else { 0.5e-6 }));
    Problem {
        robot: start,
        model: FitModel::Full,
        measured_from: Some(MeasuredFrom::Base),
        varying: None,
        start: Some(cell.tracker_from_base.rotation),
        noise: (noise > 0.0).then_some(noise),
        ..problem(readings, &cell)
    }
}

/// What is to be found under the name of a parameter.
fn sum_of(found: &Identified, truth: &Robot, parameter: Parameter) -> f64 {
    let given: [f64; FULL] = compliances_of::<FULL>(truth, &[0.0; 6]).into();
    found.gauge.fixed(&given)[column(found.spring(parameter))]
}

#[test]
fn without_noise_all_sums_are_found_again() {
    let central = full_arm(WRIST_CENTRE);
    let gauge = seen_of(&central);
    // An arm in which what others replace is rigid, of as many sums above zero.
    let given: [f64; FULL] = compliances_of::<FULL>(&central, &[0.0; 6]).into();
    let rigid = with(&central, &gauge.fixed(&given));
    // Turns of joints 4 and 5 commute to second order only, and so far their split matters.
    let arms = [(rigid, 15, 1e-7), (central, 15, 3e-4), (full_arm(FOREARM), 17, 1e-7), (full_arm(ALL), 18, 1e-7)];
    for (truth, count, tolerance) in arms {
        let found = identify(&problem_of(&truth, 20, 1, 0.0, 2700.0)).unwrap();
        assert_eq!(found.compliances.len(), count);
        for estimate in &found.compliances {
            let off = estimate.value / sum_of(&found, &truth, estimate.parameter) - 1.0;
            assert!(off.abs() < tolerance, "{count} {} {off:e}", found.name(estimate.parameter, None));
        }
        assert_eq!(found.robot.spring_model(), Some(SpringModel::Full));
        assert_eq!(found.robot.stiffness_measured_from(), Some(MeasuredFrom::Base));
        assert_eq!(found.at_lowest, []);
        let theta = [0.3, 0.9, -2.1, 0.4, 1.1, 0.7];
        let [a, b] = [&found.robot, &truth].map(|robot| compliance(robot, &theta));
        assert!((a - b).norm() < 10.0 * tolerance * b.norm(), "{count}");
    }
}

#[test]
fn intervals_of_many_sheets_cover_what_is_told() {
    const SHEETS: usize = 400;
    let truth = full_arm(WRIST_CENTRE);
    let found: Vec<Identified> = (0..SHEETS)
        .into_par_iter()
        .map(|seed| identify(&problem_of(&truth, 60, seed as u64, NOISE, 2700.0)).unwrap())
        .collect();
    for index in 0..15 {
        let expected = sum_of(&found[0], &truth, found[0].compliances[index].parameter);
        let name = found[0].name(found[0].compliances[index].parameter, None);
        let estimates = || found.iter().map(|found| &found.compliances[index]);
        let covered = estimates().filter(|e| e.interval[0] <= expected && expected <= e.interval[1]).count();
        assert!((91 * SHEETS / 100..=99 * SHEETS / 100).contains(&covered), "{name}: {covered}");
        let square = estimates().map(|e| (e.value - expected) * (e.value - expected)).sum::<f64>() / SHEETS as f64;
        let reported = estimates().map(|e| e.deviation * e.deviation).sum::<f64>() / SHEETS as f64;
        assert!((libm::sqrt(square / reported) - 1.0).abs() < 0.12, "{name}: {}", libm::sqrt(square / reported));
    }
}

#[test]
fn springs_that_come_out_below_zero_by_chance_are_as_good_as_rigid_in_the_arm() {
    // Nearly rigid about x and y of joint 6, of which the readings tell little.
    let mut given: [f64; FULL] = compliances_of::<FULL>(&full_arm(WRIST_CENTRE), &[0.0; 6]).into();
    (given[16], given[17]) = (1e-9, 1e-9);
    let truth = with(&full_arm(WRIST_CENTRE), &given);
    let mut low = 0;
    for seed in 0..10 {
        let found = identify(&problem_of(&truth, 30, seed, NOISE, 2700.0)).unwrap();
        let normal = found.robot.normal_springs().unwrap();
        assert!(normal.iter().all(|springs| springs.compliance.iter().all(|value| *value >= 0.0)));
        assert!(found.robot.joints().iter().all(|joint| joint.compliance_at(0.0) > 0.0));
        for about in [0, 1] {
            let estimate = found.compliances.iter().find(|e| found.spring(e.parameter) == spring(16 + about)).unwrap();
            let is_lowest = found.at_lowest.contains(&estimate.parameter);
            // One below zero may be above it where the other is held at zero.
            assert_eq!(is_lowest, normal[5].compliance[about] == 0.0, "{seed} {estimate:?}");
            assert!(is_lowest || estimate.value > 0.0 || !found.at_lowest.is_empty(), "{seed} {estimate:?}");
            if is_lowest {
                low += 1;
                assert!(found.warnings.iter().any(|warning| warning.kind == "below-zero"), "{:?}", found.warnings);
            }
        }
    }
    assert!((4..=16).contains(&low), "{low} of 20");
}

#[test]
fn what_is_held_stays_and_the_others_are_told_apart_by_it() {
    let truth = full_arm(WRIST_CENTRE);
    let mut problem = problem_of(&truth, 30, 1, 0.0, 2700.0);
    // The springs of joint 5 about x and y and of joint 4 about y at their true values.
    let mut start: [f64; FULL] = compliances_of::<FULL>(&problem.robot, &[0.0; 6]).into();
    let given: [f64; FULL] = compliances_of::<FULL>(&truth, &[0.0; 6]).into();
    [13, 14, 15].into_iter().for_each(|number| start[number] = given[number]);
    problem.robot = with(&problem.robot, &start);
    problem.hold_normal[3][1] = true;
    problem.hold_normal[4] = [true; 2];
    let found = identify(&problem).unwrap();
    assert_eq!((found.compliances.len(), found.held.len(), &found.gauge), (15, 3, &Gauge::default()));
    for estimate in &found.compliances {
        let expected = given[column(found.spring(estimate.parameter))];
        assert!((estimate.value / expected - 1.0).abs() < 1e-7, "{estimate:?} {expected}");
    }
    assert!(found.warnings.iter().any(|warning| warning.message.contains("the compliance of joint 4 about y is held")));
}

#[test]
fn what_yields_under_the_base_is_taken_as_stated() {
    let matrix = Matrix6::from_diagonal(&Vector6::new(2e-8, 3e-8, 1e-8, 4e-8, 5e-8, 6e-8));
    let base = BaseCompliance::new(Vector3::new(0.1, 0.0, -0.4), matrix).unwrap();
    let truth = full_arm(FOREARM).with_base_compliance(Some(base.clone()));
    let problem = problem_of(&truth, 20, 1, 0.0, 2700.0);
    let known = Problem { robot: problem.robot.clone().with_base_compliance(Some(base)), ..problem.clone() };
    let unknown = Problem { robot: problem.robot.clone().with_base_compliance(None), ..problem };
    let off = |problem: &Problem| {
        let found = identify(problem).unwrap();
        let off = found.compliances.iter().map(|e| e.value / sum_of(&found, &truth, e.parameter) - 1.0);
        off.fold(0.0, |most: f64, off| most.max(off.abs()))
    };
    assert!(off(&known) < 1e-7, "{}", off(&known));
    assert!(off(&unknown) > 1e-2, "{}", off(&unknown));
}

#[test]
fn a_fit_of_the_axes_alone_absorbs_what_it_can_and_says_that_more_is_left() {
    let truth = full_arm(WRIST_CENTRE);
    let full = problem_of(&truth, 60, 3, NOISE, 2700.0);
    let axes = Problem { robot: kr270(), model: FitModel::Axes, ..full.clone() };
    // With the load near axis 6, what springs normal to it do makes the one about it negative.
    let error = identify(&axes).unwrap_err().to_string();
    for part in
        ["the compliance of joint 6 comes out as -", "turns against its load; springs normal", "fit.model = \"full\""]
    {
        assert!(error.contains(part), "{part} in {error}");
    }
    let axes = Problem { hold: [false, false, false, false, false, true], ..axes };
    let (full, axes) = (identify(&full).unwrap(), identify(&axes).unwrap());
    assert!(!full.warnings.iter().any(|warning| warning.kind == "full-model"), "{:?}", full.warnings);
    let warning = axes.warnings.iter().find(|warning| warning.kind == "full-model").unwrap();
    assert!(warning.message.contains("fit the full model (fit.model = \"full\")"), "{warning:?}");
    assert!(axes.residual_rms > 10.0 * full.residual_rms && axes.prediction.rms > 10.0 * full.prediction.rms);
}
