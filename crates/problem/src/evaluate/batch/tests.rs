//! The batch evaluator against the reference evaluator.

use super::*;
use crate::criterion::{Aggregate, Criterion, Over, StiffnessSets, Weights};
use crate::testing::{compensated, five_segments, with_axes_2_3, with_laws, with_uncertainty};
use stead_model::robot::angles::{wrap, yaw_from_q4};
use stead_model::robot::testing::{linked_arms, odd_arms};
use stead_model::robot::{Compensator, Compliance, Posture, Robot};
use stead_model::task::{Task, Wrench};

/// Holds every state of some points against [`state`]; returns how many were allowed.
pub(super) fn compare(problem: &Problem, placement: &Placement, points: impl Iterator<Item = usize> + Clone) -> usize {
    Flips::of(problem).iter().map(|flips| compare_flips(problem, placement, points.clone(), *flips)).sum()
}

fn compare_flips(problem: &Problem, placement: &Placement, points: impl Iterator<Item = usize>, flips: Flips) -> usize {
    let evaluator = BatchEvaluator::new(problem, &problem.redundancy, flips);
    let mut states = StateGrid::<f64>::new(problem.redundancy.beta_count, 3);
    let mut states_at = BatchEvaluator::states_at();
    let mut rough = StateGrid::<f32>::new(problem.redundancy.beta_count, 3);
    let (mut allowed, mut far) = (0, 0);
    for point in points {
        evaluator.evaluate(point, placement, &mut states);
        evaluator.evaluate(point, placement, &mut rough);
        let placed = evaluator.placed(point, placement);
        for class in PostureClass::ALL {
            for k in 0..problem.redundancy.beta_count {
                let found = states.scores(class)[3 + k];
                let expected = class.postures().map(|p| reference(problem, placement, point, k, p));
                let requested = class.postures().map(|p| flips.contains(p));
                let margins = expected.iter().zip(requested).filter(|(_, requested)| *requested).map(|(e, _)| e.margin);
                let margin = margins.fold(f64::MIN, f64::max);
                if margin.abs() < 1e-9 {
                    continue;
                }
                assert!(!found.is_nan(), "point {point} class {class:?} beta {k}");
                assert_eq!(found.is_finite(), margin > 0.0, "point {point} class {class:?} beta {k} margin {margin}");
                // In single precision the same where no limit is near, to a few of its last digits, but for some states
                // near singularities.
                let single = f64::from(rough.scores(class)[3 + k]);
                if margin.abs() > 1e-3 {
                    assert_eq!(single.is_finite(), margin > 0.0, "point {point} {class:?} beta {k} margin {margin}");
                }
                if found.is_finite() && single.is_finite() {
                    let error = (single - found).abs();
                    assert!(error < 1e-2 * found.abs() + 1e-9, "{single} {found}");
                    far += usize::from(error > 1e-4 * found.abs() + 1e-9);
                }
                for (posture, expected) in
                    class.postures().into_iter().zip(&expected).filter(|(p, _)| flips.contains(*p))
                {
                    let betas = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|by| problem.redundancy.beta(k) + 0.01 * by);
                    let at = evaluator.evaluate_at(&placed, posture, &betas, &mut states_at)(2);
                    assert_eq!(at.is_some(), found.is_finite());
                    let Some((cost, joints)) = at else { continue };
                    assert!((cost - found).abs() < 1e-12 * (1.0 + found), "{cost} {found}");
                    for j in 0..6 {
                        assert!(wrap(joints[j] - expected.joints[j]).abs() < 1e-10, "{posture} joint {}", j + 1);
                    }
                }
                if found.is_finite() {
                    allowed += 1;
                    let score = expected.iter().zip(requested).find(|(_, requested)| *requested).unwrap().0.score;
                    assert!((found - score).abs() < 1e-12 * (1.0 + found), "{found} {score}");
                    for j in 0..6 {
                        let [sine, cosine] = states.directions(class, j).map(|row| row[3 + k]);
                        assert!((sine * sine + cosine * cosine - 1.0).abs() < 1e-12, "joint {} {sine} {cosine}", j + 1);
                        let angle = libm::atan2(sine, cosine);
                        assert!(wrap(angle - expected[0].joints[j]).abs() < 1e-10, "joint {} {angle}", j + 1);
                    }
                }
            }
        }
    }
    assert!(far <= allowed / 100 + 1, "{far} of {allowed} are far off in single precision");
    allowed
}

struct Expected {
    /// Smallest distance to a constraint, negative when broken.
    margin: f64,
    score: f64,
    joints: [f64; 6],
}

fn reference(problem: &Problem, placement: &Placement, point: usize, k: usize, posture: Posture) -> Expected {
    let Ok(s) = problem.at(placement).state(point, problem.redundancy.beta(k), posture) else {
        return Expected { margin: -1.0, score: 0.0, joints: [0.0; 6] };
    };
    let mut margin = s.inverse_condition - problem.constraints.min_inverse_condition;
    for (joint, angle) in problem.robot.joints().iter().zip(s.joints) {
        let range = Range::of(joint);
        let (real, excess) = range.nearest(angle);
        if excess > 0.0 {
            margin = margin.min(-excess);
        } else if !range.has_turns() {
            margin = margin.min((real - range.min).min(range.max - real));
        }
    }
    if let Some(range) = problem.robot.sum_range() {
        let [second, third] = [1, 2].map(|j| Range::of(&problem.robot.joints()[j]).nearest(s.joints[j]).0);
        let sum = second + third * problem.robot.geometry().fold;
        margin = margin.min((sum - range.min).min(range.max - sum));
    }
    if problem.constraints.min_base_distance > 0.0 {
        margin = margin.min(s.base_distance - problem.constraints.min_base_distance);
    }
    if let Some(limit) = problem.constraints.max_deflection {
        margin = margin.min((limit - s.score()) * 1e3);
    }
    Expected { margin, score: problem.point_cost(point, s.score()), joints: s.joints }
}

/// A path with the normal of a surface at every point, and forces and moments in every direction.
fn with_surface() -> Problem {
    let mut problem = crate::testing::slanted();
    let normals = (0..105).map(|k| {
        let (sine, cosine) = libm::sincos(0.1 * f64::from(k));
        Vector3::new(0.6 * sine, 0.8, 0.6 * cosine)
    });
    let path = problem.task.path().clone().with_surface_normals(normals.collect()).unwrap();
    let wrenches = problem.task.wrenches().map(|w| Wrench { moment: Vector3::new(3.0, -5.0, 11.0), ..*w });
    problem.task = Task::new(path, wrenches.collect()).unwrap();
    problem
}

#[test]
fn agrees_whatever_is_scored() {
    let plain = with_surface();
    let mixed = Weights { wall: 1.0, axis: 0.5, feed: 0.0, surface: 2.0 };
    for weights in [Weights::SURFACE, Weights::AXIS, Weights::TOTAL, mixed] {
        for (force_uncertainty, confidence) in [(0.0, 0.0), (0.1, 0.0), (0.0, 2.0), (0.1, 2.0)] {
            for aggregate in [Aggregate::Mean, Aggregate::Rms] {
                let mut problem = with_uncertainty(plain.clone(), 0.1);
                let segment_weights = vec![1.0, 2.0, 0.5, 3.0, 1.0];
                problem.criterion = Criterion {
                    weights,
                    aggregate,
                    segment_weights,
                    force_uncertainty,
                    confidence,
                    ..Criterion::default()
                };
                problem.constraints.max_deflection = Some(2.5e-3);
                problem.constraints.min_base_distance = 1.9;
                let mut allowed = 0;
                for placement in [[2.2e-3, -1.6435, -0.5564, 2.1], [0.2, -1.9, -0.3, -1.0]].map(Placement::from) {
                    allowed += compare(&problem, &placement, (0..105).step_by(9));
                }
                assert!(allowed > 300, "{allowed} {weights:?} {force_uncertainty} {confidence}");
            }
        }
    }
}

#[test]
fn agrees_with_a_linkage_and_a_range_of_the_sum_whatever_is_scored() {
    let plain = with_surface();
    let mixed = Weights { wall: 1.0, axis: 0.5, feed: 0.0, surface: 2.0 };
    for weights in [Weights::WALL, Weights::TOTAL, mixed] {
        for (force_uncertainty, confidence) in [(0.0, 0.0), (0.1, 0.0), (0.0, 2.0), (0.1, 2.0)] {
            let free = with_axes_2_3(with_uncertainty(plain.clone(), 0.1), true, [-245.0, 175.0]);
            let criterion = Criterion { weights, force_uncertainty, confidence, ..Criterion::default() };
            let mut counts = Vec::new();
            for (linkage, range) in [(true, [-245.0, 175.0]), (true, [-150.0, -20.0]), (false, [-150.0, -20.0])] {
                let mut problem = with_axes_2_3(free.clone(), linkage, range);
                problem.criterion = criterion.clone();
                let placements = [[2.2e-3, -1.6435, -0.5564, 2.1], [0.2, -1.9, -0.3, -1.0]].map(Placement::from);
                let points = (0..105).step_by(9);
                counts.push(placements.iter().map(|at| compare(&problem, at, points.clone())).sum::<usize>());
            }
            // The range of the sum takes away some states, and not all.
            assert!(counts[0] > counts[1] && counts[1] == counts[2] && counts[1] > 100, "{counts:?}");
        }
    }
}

#[test]
fn agrees_for_linkages_of_every_build() {
    for (number, arm) in linked_arms().into_iter().enumerate() {
        let mut problem = five_segments();
        problem.robot = arm;
        problem.redundancy.beta_count = 30;
        problem.constraints.min_inverse_condition = 0.05;
        if number % 2 == 0 {
            problem.criterion.weights = Weights::TOTAL;
        }
        let mut allowed = 0;
        for placement in [[0.9, 0.5, 0.4, 0.3], [0.3, -1.3, 0.1, 2.0], [-0.5, 0.9, -0.3, -1.0]].map(Placement::from) {
            allowed += compare(&problem, &placement, (0..105).step_by(15));
        }
        assert!(allowed > 50, "{allowed}");
    }
}

#[test]
fn agrees_with_the_ordinary_evaluator_over_the_cell() {
    let problem = five_segments();
    let mut allowed = 0;
    for k in 0..12 {
        let f = f64::from(k);
        let placement = Placement::from([-0.3 + 0.05 * f, -1.64 - 0.05 * f, -0.6 + 0.03 * f, -3.0 + 0.5 * f]);
        allowed += compare(&problem, &placement, (0..105).step_by(4));
    }
    let optimum = Placement::from([2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)]);
    allowed += compare(&problem, &optimum, 0..105);
    assert!(allowed > 10_000, "{allowed}");
}

#[test]
fn agrees_with_uncertainty_moments_a_limit_and_a_narrow_wrist() {
    let mut problem = five_segments();
    problem.criterion.force_uncertainty = 0.15;
    problem.constraints.max_deflection = Some(1.2e-3);
    let wrenches = problem.task.wrenches().map(|w| {
        let mut w = *w;
        w.moment = nalgebra::Vector3::new(3.0, -5.0, 11.0);
        w.force.z = 40.0;
        w
    });
    problem.task = stead_model::task::Task::new(problem.task.path().clone(), wrenches.collect()).unwrap();
    let mut joints = problem.robot.joints().clone();
    // A wrist whose two flips differ, and a joint 6 with less than a turn.
    (joints[4].min, joints[4].max) = (-0.4, 2.0);
    (joints[5].min, joints[5].max) = (-2.5, 1.5);
    problem.robot = stead_model::robot::Robot::new("narrow", joints).unwrap();
    let placement = Placement::from([2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)]);
    let allowed = compare(&problem, &placement, (0..105).step_by(2));
    assert!(allowed > 1000, "{allowed}");
}

#[test]
fn agrees_with_compliances_that_change_with_the_joint_angle() {
    let range = Compliance::Range { at_min: 5e-7, at_max: 1.2e-6 };
    // A joint 6 with less than a turn, for ranges.
    let mut constant = five_segments();
    let mut joints = constant.robot.joints().clone();
    (joints[5].min, joints[5].max) = (-2.5, 3.0);
    constant.robot = Robot::new("narrow", joints).unwrap();
    for laws in [
        vec![(1, range)],
        vec![(1, compensated(0.2, 3e-7))],
        vec![(0, compensated(1.0, 4e-6)), (2, compensated(-1.0, 4e-7)), (1, range)],
        // A wrist that yields differently in its two flips.
        vec![(4, range)],
        vec![(3, compensated(0.5, 2e-6)), (4, compensated(0.3, 2e-6)), (5, compensated(-2.0, 3e-6))],
        vec![(5, range), (2, range)],
    ] {
        let mut problem = with_laws(constant.clone(), &laws);
        problem.criterion.force_uncertainty = 0.1;
        problem.constraints.max_deflection = Some(1.5e-3);
        let mut allowed = 0;
        for placement in [[2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)], [0.2, -1.9, -0.3, -1.0]].map(Placement::from)
        {
            allowed += compare(&problem, &placement, (0..105).step_by(3));
            // The laws are seen, at a thousand times the tolerance.
            let scores =
                [&problem, &constant].map(|p| p.at(&placement).state(30, 0.7, Posture::ALL[2]).unwrap().normal_part);
            assert!((scores[0] - scores[1]).abs() > 1e-9, "{scores:?} {laws:?}");
        }
        assert!(allowed > 1000, "{allowed} {laws:?}");
    }
}

#[test]
fn agrees_with_uncertain_compliances() {
    let range = Compliance::Range { at_min: 5e-7, at_max: 1.2e-6 };
    let mut constant = five_segments();
    let mut joints = constant.robot.joints().clone();
    (joints[5].min, joints[5].max) = (-2.5, 3.0);
    constant.robot = Robot::new("narrow", joints).unwrap();
    for laws in [
        vec![],
        vec![(1, compensated(0.2, 3e-7))],
        vec![(0, compensated(1.0, 4e-6)), (2, range), (5, range)],
        // A wrist that yields differently in its two flips.
        vec![(3, compensated(0.5, 2e-6)), (4, compensated(0.3, 2e-6)), (1, range)],
    ] {
        for force_uncertainty in [0.0, 0.1] {
            let mut problem = with_uncertainty(with_laws(constant.clone(), &laws), 0.1);
            let sure = problem.clone();
            problem.criterion = Criterion { force_uncertainty, confidence: 2.0, ..Criterion::default() };
            problem.constraints.max_deflection = Some(1.5e-3);
            let mut allowed = 0;
            for placement in
                [[2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)], [0.2, -1.9, -0.3, -1.0]].map(Placement::from)
            {
                allowed += compare(&problem, &placement, (0..105).step_by(3));
                // The uncertainty is seen, at a million times the tolerance.
                let scores =
                    [&problem, &sure].map(|p| p.at(&placement).state(30, 0.7, Posture::ALL[2]).unwrap().score());
                assert!(scores[0] - scores[1] > 1e-6, "{scores:?} {laws:?}");
            }
            assert!(allowed > 1000, "{allowed} {laws:?}");
        }
    }
}

/// States of a point that counts nothing are forbidden like others: a cost of no number would hide the states beside
/// it.
#[test]
fn agrees_where_a_segment_has_no_weight() {
    for aggregate in [Aggregate::Mean, Aggregate::Rms, Aggregate::Max] {
        let mut problem = with_surface();
        let segment_weights = vec![0.0, 1.0, 0.0, 1.0, 0.0];
        problem.criterion = Criterion { aggregate, segment_weights, ..Criterion::default() };
        let placement = Placement::from([2.2e-3, -1.6435, -0.5564, 2.1]);
        assert!(compare(&problem, &placement, (0..105).step_by(9)) > 300);
    }
}

#[test]
fn agrees_over_sets_of_compliances() {
    let range = Compliance::Range { at_min: 5e-7, at_max: 1.2e-6 };
    for weights in [Weights::WALL, Weights::TOTAL] {
        for over in [Over::Mean, Over::Worst] {
            for (force_uncertainty, confidence) in [(0.0, 0.0), (0.1, 2.0)] {
                let mut problem = with_surface();
                // The last of them yields differently in the two flips of the wrist.
                let laws =
                    [vec![], vec![(0, Compliance::Constant(4e-6))], vec![(4, range), (1, compensated(0.2, 3e-7))]];
                let robots =
                    laws.iter().map(|laws| with_uncertainty(with_laws(problem.clone(), laws), 0.1).robot.clone());
                let stiffness = Some(StiffnessSets { robots: robots.collect(), over });
                problem.criterion =
                    Criterion { weights, force_uncertainty, confidence, stiffness, ..Criterion::default() };
                problem.constraints.max_deflection = Some(4e-3);
                let mut allowed = 0;
                for placement in [[2.2e-3, -1.6435, -0.5564, 2.1], [0.2, -1.9, -0.3, -1.0]].map(Placement::from) {
                    allowed += compare(&problem, &placement, (0..105).step_by(9));
                }
                assert!(allowed > 300, "{allowed} {over:?}");
            }
        }
    }
}

#[test]
fn agrees_for_every_sign_of_twist_and_with_offsets() {
    // Springs at every joint, so that each angle's sine and cosine is held against the reference evaluator too.
    let compensator = Compensator { spring_stiffness: 4e4, a: 0.5, l: 0.3, alpha: 0.7, free_length: 0.5 };
    let sprung = Compliance::Compensated { alone: 1e-6, compensator };
    for (arm, is_sprung) in odd_arms().into_iter().flat_map(|arm| [(arm.clone(), false), (arm, true)]) {
        let mut problem = five_segments();
        problem.robot = arm.clone();
        if is_sprung {
            problem.robot = arm.with_compliances([sprung; 6]).unwrap();
            problem = with_uncertainty(problem, 0.1);
            problem.criterion.confidence = 1.0;
        }
        problem.redundancy.beta_count = 30;
        problem.constraints.min_inverse_condition = 0.05;
        let mut allowed = 0;
        for placement in [[0.9, 0.5, 0.4, 0.3], [0.3, -1.3, 0.1, 2.0], [-0.5, 0.9, -0.3, -1.0]].map(Placement::from) {
            allowed += compare(&problem, &placement, (0..105).step_by(15));
        }
        assert!(allowed > 100, "{allowed}");
    }
}

#[test]
fn one_beta_alone_is_evaluated_as_among_all() {
    let problem = five_segments();
    let placement = Placement::from([2.2e-3, -1.6435, -0.5564, 2.1]);
    let count = problem.redundancy.beta_count;
    let evaluator = BatchEvaluator::new(&problem, &problem.redundancy, Flips::of(&problem)[0]);
    let [mut all, mut alone] = [(); 2].map(|()| StateGrid::<f64>::new(count, 2).with_angles(true));
    let mut allowed = 0;
    for point in (0..problem.task.points().len()).step_by(7) {
        evaluator.evaluate(point, &placement, &mut all);
        for (only, class) in (0..count).step_by(5).flat_map(|only| PostureClass::ALL.map(|class| (only, class))) {
            evaluator.evaluate_some(point, &placement, [true; 4], Some(only), &mut alone);
            let expected = all.inner_scores(class)[only];
            assert_eq!(alone.inner_scores(class)[only].to_bits(), expected.to_bits());
            assert!((0..count).all(|beta| beta == only || alone.inner_scores(class)[beta].is_infinite()));
            assert_eq!(alone.is_alive(class), expected.is_finite());
            if expected.is_finite() {
                let joints = |states: &StateGrid| -> Vec<u64> {
                    let rows = states.all_joints(class).concat();
                    rows.chunks_exact(states.scores(class).len())
                        .map(|row| row[states.pad() + only].to_bits())
                        .collect()
                };
                assert_eq!(joints(&alone), joints(&all));
                allowed += 1;
            }
        }
    }
    assert!(allowed > 100, "{allowed}");
}

/// Every bit of the scores, and of the joint angles of allowed states, for some points.
pub(super) fn bits(problem: &Problem, instructions: Instructions, poses: &[Placement]) -> Vec<u64> {
    let mut bits = Vec::new();
    for flips in Flips::of(problem) {
        let evaluator = BatchEvaluator::new(problem, &problem.redundancy, *flips).with_instructions(instructions);
        let mut states = StateGrid::<f64>::new(problem.redundancy.beta_count, 2);
        for placement in poses {
            for point in (0..problem.task.points().len()).step_by(7) {
                evaluator.evaluate(point, placement, &mut states);
                for class in PostureClass::ALL {
                    bits.push(u64::from(states.is_alive(class)));
                    states.wrap_around(class);
                    for k in 0..problem.redundancy.beta_count + 4 {
                        let score = states.scores(class)[k];
                        bits.push(score.to_bits());
                        if score.is_finite() {
                            let rows = (0..6).flat_map(|j| states.directions(class, j));
                            bits.extend(rows.map(|row| row[k].to_bits()));
                        }
                    }
                }
            }
        }
    }
    bits
}

#[test]
fn every_processor_gives_the_same_bits() {
    let range = Compliance::Range { at_min: 5e-7, at_max: 1.2e-6 };
    let plain = five_segments();
    let mut narrow = with_laws(plain.clone(), &[(1, compensated(0.2, 3e-7)), (2, range), (4, range)]);
    narrow.criterion.force_uncertainty = 0.1;
    narrow.constraints.max_deflection = Some(1.2e-3);
    let mut sprung = with_uncertainty(with_laws(plain.clone(), &[(1, compensated(0.2, 3e-7))]), 0.1);
    sprung.criterion.confidence = 2.0;
    // All over the cell, and out of reach, above axis 1, stretched: whatever comes out NaN or infinite on the way.
    let mut poses: Vec<Placement> = (0..8)
        .map(|k| [-0.3 + 0.08 * f64::from(k), -1.64 - 0.07 * f64::from(k), -0.6 + 0.05 * f64::from(k), f64::from(k)])
        .map(Placement::from)
        .collect();
    poses.extend(
        [[0.0, 0.0, 0.5, 0.0], [0.0, -4.0, -0.4, 0.0], [0.0, -2.55, 0.2, 1.0], [1e-9, 1e-9, 2.0, -3.0]]
            .map(Placement::from),
    );
    let mut whole = narrow.clone();
    whole.criterion.weights = Weights::TOTAL;
    for problem in [plain, narrow, sprung, whole] {
        // Counts that fill the last lanes and that do not; fewer values than lanes.
        for count in [120, 121, 37, 5, 3] {
            let mut problem = problem.clone();
            problem.redundancy.beta_count = count;
            let expected = bits(&problem, Instructions::plain(), &poses);
            assert!(count < 30 || expected.len() > 10_000, "{}", expected.len());
            for instructions in Instructions::all() {
                assert!(bits(&problem, instructions, &poses) == expected, "{instructions:?} with {count} values");
            }
        }
    }
}

#[test]
fn continues_rows_cyclically() {
    let problem = five_segments();
    let evaluator = BatchEvaluator::new(&problem, &problem.redundancy, Flips::Both);
    let mut states = StateGrid::<f64>::new(120, 5);
    evaluator.evaluate(0, &Placement::from([0.0, -1.7, -0.4, 0.3]), &mut states);
    for class in PostureClass::ALL {
        states.wrap_around(class);
        let row = states.scores(class);
        assert_eq!(row[..5], row[120..125]);
        assert_eq!(row[5..10], row[125..130]);
    }
}
