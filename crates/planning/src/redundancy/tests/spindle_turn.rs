//! Limits on the turn of the spindle in space: the same judges as for the rate of beta, and corners.

use super::*;
use crate::feasibility::diagnose;
use stead_problem::constraints::ConstraintKind;
use stead_problem::testing::{corners, winding, with_turn_limits};

#[test]
fn fast_planner_agrees_with_plain_dynamic_programming() {
    let (mut compared, mut feasible) = (0, 0);
    for (lean, rate, turn) in [(0.0, None, 1.3), (0.0, None, 4.0), (0.15, None, 3.5), (0.0, Some(9.0), 2.0)] {
        let mut problem = with_turn_limits(corners(lean), 72, rate, turn);
        problem.redundancy.feed /= 4.0;
        let planner = Planner::new(&problem);
        let mut workspace = planner.workspace();
        for k in 0..8 {
            let f = f64::from(k);
            let placement = Placement::from([-0.2 + 0.06 * f, -1.6 - 0.05 * f, -0.5 + 0.03 * f, -3.0 + 0.8 * f]);
            for sense in [Sense::Min, Sense::Max] {
                let span = problem.task.segments()[0].clone();
                let choice =
                    reference_dp::plan(&planner.segments, &span, &placement, sense, &Posture::ALL, &mut workspace);
                let expected = problem.objective([choice.map_or(f64::INFINITY, |choice| choice.cost)]);
                let found = planner.plan(&placement, sense, None, &mut workspace);
                compared += 1;
                assert_eq!(found.is_ok(), expected.is_finite(), "{lean} {rate:?} {turn} {placement:?} {sense:?}");
                if let Ok(plans) = found {
                    feasible += 1;
                    let cost = problem.objective([plans[0].cost]);
                    assert!((cost - expected).abs() < 1e-12 * expected, "{cost} {expected}");
                    assert_sound(&problem, &placement, &plans);
                    let fine = planner.plan_fine(&placement, sense, None, &mut workspace).unwrap();
                    assert_sound(&problem, &placement, &fine);
                    assert!(problem.objective([fine[0].cost]) * sense.sign() <= cost * sense.sign());
                }
            }
        }
    }
    assert!(compared == 64 && feasible > 16, "{compared} {feasible}");
}

/// A rectangular pocket's corner of 2 mm radius between two walls, points of the wall 10 mm apart and 10 deg on the
/// corner.
fn pocket() -> Problem {
    let corner = 10.0_f64.to_radians();
    let wall = vec![(0.0, 0.01); 8];
    winding(&[wall.clone(), vec![(corner, 0.002 * corner); 9], wall].concat(), 0.0)
}

#[test]
fn a_spindle_that_stands_still_gets_around_a_tight_corner() {
    let mut problem = pocket();
    let placement = Placement::from([0.0, -1.8, -0.4, 1.2]);
    let fine = |problem: &Problem| {
        let planner = Planner::finer(problem);
        planner.plan_fine(&placement, Sense::Min, None, &mut planner.workspace())
    };
    // 0.9 deg/mm of beta, where the corner needs 28.6, and joints that turn no faster.
    let none = fine(&problem).unwrap_err();
    assert!(none.blocked_points.is_empty());
    let [(0, point)] = none.broken_segments[..] else { panic!("{none:?}") };
    assert!((9..=17).contains(&point), "{point}");
    let findings = diagnose(&problem, &placement, None, &none);
    assert_eq!(findings[0].stopped_by, [[ConstraintKind::JointStep], [ConstraintKind::BetaRate]]);
    let text = findings[0].to_string();
    assert!(
        text.ends_with("one would without steps of the joints between path points, or without rate of beta"),
        "{text}"
    );
    // The spindle may turn as fast in space.
    problem.redundancy.max_spindle_turn = problem.redundancy.max_beta_rate.take();
    let plans = fine(&problem).unwrap();
    assert_sound(&problem, &placement, &plans);
    let corner = problem.task.points().len() / 2;
    let turned = plans[0].betas[corner + 4] - plans[0].betas[corner - 4];
    assert!((turned + 80.0_f64.to_radians()).abs() < 4.0_f64.to_radians(), "{turned}");
    // The coarse grid of the search gets around as well: steps of 3 deg, where a limit of 0.31 deg holds between
    // points.
    let planner = Planner::new(&problem);
    let coarse = planner.plan(&placement, Sense::Min, None, &mut planner.workspace()).unwrap();
    assert_sound(&problem, &placement, &coarse);
    // In time: 60 deg/s at 66.667 mm/s.
    problem.redundancy.max_spindle_turn = None;
    problem.redundancy.max_spindle_speed = Some(1.0);
    assert_sound(&problem, &placement, &fine(&problem).unwrap());
    // With both limits the rate of beta is what stops it.
    problem.redundancy.max_beta_rate = Some(0.9_f64.to_radians() * 1e3);
    let none = fine(&problem).unwrap_err();
    assert_eq!(diagnose(&problem, &placement, None, &none)[0].stopped_by, [[ConstraintKind::BetaRate]]);
}
