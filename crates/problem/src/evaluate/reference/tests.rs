use super::*;
use crate::criterion::Weights;
use crate::testing::{Beside, five_segments, five_segments_compensated, with_beside};
use nalgebra::{Matrix6, Vector6};
use proptest::prelude::*;
use stead_model::robot::angles::yaw_from_q4;
use stead_numerics::scalar::Dual;

fn published_optimum() -> Placement {
    [2.2e-3, -1.6435, -0.5564, yaw_from_q4(0.9258)].into()
}

#[test]
fn agrees_with_the_prototype_at_point_30() {
    let problem = five_segments();
    let found = problem.at(&published_optimum()).state(30, 40.0_f64.to_radians(), Posture::ALL[2]).unwrap();
    let expected = [-92.6318, 27.4912, -150.7821, -178.7079, 101.6922, 1.5275];
    for (found, expected) in found.joints.iter().zip(expected) {
        assert!((found.to_degrees() - expected).abs() < 5.1e-5, "{} {expected}", found.to_degrees());
    }
    assert!((found.score() * 1e3 - 0.8392428).abs() < 5.1e-8, "{}", found.score() * 1e3);
    assert!((found.inverse_condition - 0.479182).abs() < 5.1e-7, "{}", found.inverse_condition);
}

#[test]
fn parts_of_the_deflection_make_up_the_whole() {
    let problem = five_segments();
    let s = problem.at(&published_optimum()).state(41, 0.4, Posture::ALL[3]).unwrap();
    let parts = Vector3::new(s.feed_part, s.normal_part, s.axial_part);
    assert!((parts.norm() - s.deflection.norm()).abs() < 1e-15);
}

#[test]
fn what_each_thing_adds_is_the_scored_part() {
    for weights in [Weights::WALL, Weights::TOTAL] {
        let mut problem = with_beside(five_segments(), Beside::Everything);
        problem.criterion.weights = weights;
        let placement = published_optimum();
        for point in [0, 30, 70] {
            let state = problem.at(&placement).state(point, 0.4, Posture::ALL[3]).unwrap();
            let origins = scored_by_origin(&problem, point, &placement, &state.joints);
            assert!((origins.total() - state.score()).abs() < 1e-15);
            assert!(origins.part != 0.0 && origins.arm.into_array().iter().all(|part| *part != 0.0), "{origins:?}");
        }
        // A part that yields moves the size of a deflection as its own displacement says.
        let mut softer = problem.clone();
        let twice = (0..105).map(|point| problem.task.part_compliance(point).unwrap() * 2.0).collect();
        softer.task = problem.task.clone().with_part_compliances(twice).unwrap();
        let [a, b] = [&problem, &softer].map(|p| p.at(&placement).state(30, 0.4, Posture::ALL[3]).unwrap());
        let turned = placement.base_from_workpiece().rotation;
        let moved = turned * (problem.task.part_compliance(30).unwrap() * problem.task.loads()[30].wrench.force);
        assert!((b.deflection - a.deflection - moved).norm() < 1e-15);
    }
}

/// A part that is rigid normal to the wall under the force moves no plan and no score of it.
#[test]
fn a_part_that_does_not_answer_along_the_wall_changes_no_score_of_it() {
    let rigid = five_segments();
    let mut problem = rigid.clone();
    // Yielding along the cross product of wall and force alone: the force meets nothing.
    let matrices = problem.task.points().iter().zip(problem.task.wrenches()).map(|(point, wrench)| {
        let across = point.normal().cross(&wrench.force).normalize();
        across * across.transpose() * 1e-6
    });
    problem.task = rigid.task.clone().with_part_compliances(matrices.collect()).unwrap();
    let placement = published_optimum();
    for point in (0..105).step_by(10) {
        let [a, b] = [&rigid, &problem].map(|p| p.at(&placement).state(point, 0.4, Posture::ALL[3]).unwrap().score());
        assert!((a - b).abs() < 1e-15);
    }
}

#[test]
fn uncertainty_is_the_worst_case_over_force_errors() {
    let mut problem = five_segments();
    problem.criterion.force_uncertainty = 0.1;
    let (placement, beta, posture) = (published_optimum(), 0.3, Posture::ALL[2]);
    let robust = problem.at(&placement).state(60, beta, posture).unwrap();
    let size = 0.1 * problem.task.loads()[60].wrench.force.norm();
    let mut worst = 0.0_f64;
    for k in 0..2000 {
        // Directions spread over the sphere.
        let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / 2000.0;
        let (s, c) = libm::sincos(f64::from(k) * 2.399_963_229_728_653);
        let r = libm::sqrt(1.0 - z * z);
        let error = Vector3::new(r * c, r * s, z) * size;
        let mut wrenches: Vec<_> = problem.task.wrenches().copied().collect();
        wrenches[60].force += error;
        let mut changed = problem.clone();
        changed.task = stead_model::task::Task::new(problem.task.path().clone(), wrenches).unwrap();
        let c_i = changed.at(&placement).state(60, beta, posture).unwrap().normal_part.abs();
        assert!(c_i <= robust.score() * (1.0 + 1e-12));
        worst = worst.max(c_i);
    }
    assert!(worst > robust.score() * 0.998, "{worst} {}", robust.score());
}

proptest! {
    #[test]
    fn deflection_agrees_with_the_matrix_inverse(beta in -3.0..3.0_f64, point in 0..105_usize) {
        let problem = five_segments();
        let placement = published_optimum();
        for posture in Posture::ALL {
            let Ok(found) = problem.at(&placement).state(point, beta, posture) else { continue };
            let frames = Frames::new(&problem.robot, &found.joints);
            let workpiece = placement.base_from_workpiece();
            let tip = workpiece.point(&problem.task.points()[point].position);
            prop_assert!((frames.base_from_flange.point(&problem.spindle.flange_from_tool.translation) - tip).norm() < 1e-9);
            let jacobian = frames.jacobian(&tip);
            let joint = Matrix6::from_diagonal(&Vector6::from(problem.robot.compliances_at(&found.joints).map(|c| 1.0 / c)));
            let Some(inverse) = jacobian.try_inverse() else { continue };
            let stiffness = inverse.transpose() * joint * inverse;
            let force = workpiece.rotation * problem.task.loads()[point].wrench.force;
            let wrench = Vector6::new(force.x, force.y, force.z, 0.0, 0.0, 0.0);
            let Some(moved) = stiffness.lu().solve(&wrench) else { continue };
            prop_assume!(found.inverse_condition > 0.02);
            prop_assert!((moved.fixed_rows::<3>(0) - found.deflection).norm() < 1e-9 * (1.0 + moved.norm()));
        }
    }

    #[test]
    fn derivatives_agree_with_central_differences(
        beta in -3.0..3.0_f64, point in 0..105_usize, is_compensated in any::<bool>(), is_whole in any::<bool>()
    ) {
        let mut problem = if is_compensated { five_segments_compensated() } else { five_segments() };
        problem.criterion.force_uncertainty = 0.2;
        if is_whole {
            problem = with_beside(problem, Beside::Everything);
        }
        let placement = published_optimum();
        let at = |shift: [f64; 5]| {
            let moved = Placement::from(std::array::from_fn(|k| placement[k] + shift[k]));
            problem.at(&moved).state(point, beta + shift[4], Posture::ALL[2])
        };
        let variables = Placement::from(std::array::from_fn(|k| Dual::<5>::variable(placement[k], k)));
        let Ok(exact) = problem.at(&variables).state(point, Dual::variable(beta, 4), Posture::ALL[2]) else { return Ok(()) };
        prop_assume!(exact.inverse_condition.value > 0.05);
        for k in 0..5 {
            let h = 1e-6;
            let mut shift = [0.0; 5];
            shift[k] = h;
            let Ok(up) = at(shift) else { continue };
            shift[k] = -h;
            let Ok(down) = at(shift) else { continue };
            let difference = |f: &dyn Fn(&State<f64>) -> f64| (f(&up) - f(&down)) / (2.0 * h);
            prop_assert!((exact.normal_part.gradient[k] - difference(&|s| s.normal_part)).abs() < 1e-8);
            prop_assert!((exact.own.uncertainty.gradient[k] - difference(&|s| s.own.uncertainty)).abs() < 1e-8);
            prop_assert!((exact.inverse_condition.gradient[k] - difference(&|s| s.inverse_condition)).abs() < 1e-6);
            for j in 0..6 {
                let turned = stead_model::robot::angles::wrap(up.joints[j] - down.joints[j]) / (2.0 * h);
                let tolerance = 1e-6 * (1.0 + turned.abs() * turned.abs());
                prop_assert!((exact.joints[j].gradient[k] - turned).abs() < tolerance, "{} {}", exact.joints[j].gradient[k], turned);
            }
        }
    }
}
