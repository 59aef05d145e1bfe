//! Lead and tilt as variables of the gradient.

use super::*;
use crate::refine::active::active_bounds;
use crate::refine::lean_slopes::Curvature7;
use crate::refine::solver::{Ending, run, run_leaning};
use nalgebra::SymmetricEigen;
use std::sync::Arc;
use stead_model::task::lean::{ContactRule, CutterEnd, Lean, LeanForce, LeanRule};
use stead_problem::lean::{LeanRange, LeanSpace};
use stead_problem::limit::Limit;
use stead_problem::setup::Setup;

fn range(min_deg: f64, max_deg: f64) -> Interval {
    Interval { min: min_deg.to_radians(), max: max_deg.to_radians() }
}

/// A ball cutter on the five segments that may lean, and does by so much everywhere (deg).
fn leaning([lead, tilt]: [f64; 2], tilts: Interval, change: impl FnOnce(&mut LeanSpace)) -> Problem {
    let mut space = LeanSpace {
        rule: LeanRule {
            end: CutterEnd { radius: 0.008, corner: 0.008 },
            contact: ContactRule::Centre,
            force: LeanForce::Tool,
        },
        ranges: vec![LeanRange { lead: range(-12.0, 12.0), tilt: tilts }; 105],
        max_lean: None,
        steps: [2.5_f64.to_radians(); 2],
        step_over: None,
        scallop: None,
        contact_tolerance: 5e-6,
    };
    change(&mut space);
    let problem = five_segments().with(|parts| parts.lean = Some(Arc::new(space)));
    let lean = Lean { lead: lead.to_radians(), tilt: tilt.to_radians() };
    problem.in_setup(&Setup { leans: vec![lean; 105].into(), ..Setup::default() }).into_owned()
}

fn planned_at(problem: &Problem) -> Solution {
    let planner = Planner::finer(problem);
    planned(&planner, &published_optimum(), None, &mut planner.workspace()).unwrap()
}

#[test]
fn slopes_by_lead_and_tilt_are_those_of_a_tool_that_leans_a_little_more() {
    let problem = leaning([4.0, -3.0], range(-12.0, 12.0), |_| {});
    let here = planned_at(&problem);
    let locals = linearise::linearise_leaning(&problem, &here, linearise::Curvature::Full, NEAR_STEPS).unwrap();
    for plan in &here.plans {
        for (place, point) in plan.points.clone().enumerate().step_by(5) {
            let slopes = locals[point].leaning.as_ref().unwrap();
            for k in 0..2 {
                let h = 1e-5;
                let at = |side: f64| {
                    let mut leans = problem.setup.leans.to_vec();
                    let lean = &mut leans[point];
                    *(if k == 0 { &mut lean.lead } else { &mut lean.tilt }) += side * h;
                    let there = problem.in_setup(&Setup { leans: leans.into(), ..problem.setup.clone() });
                    there.at(&here.placement).state(point, plan.betas[place], plan.posture).unwrap()
                };
                let (ahead, behind) = (at(1.0), at(-1.0));
                let slope = |of: &dyn Fn(&stead_problem::evaluate::reference::State<f64>) -> f64| {
                    (of(&ahead) - of(&behind)) / (2.0 * h)
                };
                let scored = slope(&|state| state.own.scored);
                assert!((slopes.sets[0].scored[k] - scored).abs() < 1e-3 * scored.abs() + 1e-8, "{point} {k}");
                for j in 0..6 {
                    let turn = slope(&|state| state.joints[j]);
                    assert!((slopes.joints[j][k] - turn).abs() < 1e-3 * turn.abs() + 1e-5, "{point} {k} {j}");
                }
                let condition = slope(&|state| state.inverse_condition);
                assert!((slopes.inverse_condition[k] - condition).abs() < 1e-3, "{point} {k}");
            }
            let eigen = SymmetricEigen::new(slopes.curvature).eigenvalues;
            assert!(slopes.curvature != Curvature7::zeros() && eigen.min() > -1e-9 * eigen.max(), "{eigen}");
        }
    }
    // Without leans nothing of it is there.
    let upright = problem.in_setup(&Setup::default());
    let solution = planned_at(&upright);
    let locals = linearise::linearise_leaning(&upright, &solution, linearise::Curvature::None, NEAR_STEPS).unwrap();
    assert!(locals.iter().all(|local| local.leaning.is_none()));
}

/// What the gradient reaches in placement, betas, leads and tilts: allowed everywhere, better than with the leans held.
fn reached(problem: &Problem) -> (Problem, Solution) {
    let start = planned_at(problem);
    let (found, leans) = run_leaning(problem, &start, Ending::TIGHT, &Monitor::silent());
    let held = run(problem, &start, Ending::TIGHT, &Monitor::silent()).solution;
    assert!(found.solution.objective < held.objective * (1.0 - 1e-3), "{:?} {}", found, held.objective);
    let (space, path) = (problem.lean.as_deref().unwrap(), problem.task.upright().path());
    for (point, lean) in leans.iter().enumerate() {
        assert!(space.allows(path, point, lean), "{point} {lean:?}");
    }
    for point in path.segments().iter().flat_map(|span| span.clone().skip(1)) {
        assert!(space.allows_step(path, point, [&leans[point - 1], &leans[point]]), "{point}");
    }
    let there = problem.in_setup(&Setup { leans, ..problem.setup.clone() }).into_owned();
    assert_allowed(&there, &found.solution);
    (there, found.solution)
}

#[test]
fn no_lean_near_the_end_of_the_gradient_is_better() {
    let (there, found) = reached(&leaning([4.0, -3.0], range(-12.0, 12.0), |space| {
        space.max_lean = Some(13.0_f64.to_radians());
    }));
    let (space, path) = (there.lean.as_deref().unwrap(), there.task.upright().path());
    let mut tried = 0;
    for span in there.task.segments() {
        for [lead, tilt] in [[0.2, 0.0], [-0.2, 0.0], [0.0, 0.2], [0.0, -0.2], [0.2, 0.2], [-0.2, 0.2]] {
            let mut leans = there.setup.leans.to_vec();
            for point in span.clone() {
                let lean = &mut leans[point];
                let moved = Lean { lead: lean.lead + f64::to_radians(lead), tilt: lean.tilt + f64::to_radians(tilt) };
                *lean = space.ranges[point].nearest(&moved);
            }
            if !span.clone().all(|point| space.allows(path, point, &leans[point])) {
                continue;
            }
            let other = there.in_setup(&Setup { leans: leans.into(), ..there.setup.clone() });
            let betas: Vec<f64> = found.plans.iter().flat_map(|plan| plan.betas.clone()).collect();
            let Some(near) = moved(&other, &found, found.placement, &betas) else { continue };
            tried += 1;
            assert!(near.objective > found.objective * (1.0 - 1e-4), "{span:?} {lead} {tilt}: {}", near.objective);
        }
    }
    assert!(tried > 10, "{tried}");
}

/// The gain that is stated for the range of the tilt is what a wider range gains.
#[test]
fn bounds_on_leans_hold_the_optimum_by_as_much_as_is_stated() {
    let (there, found) = reached(&leaning([0.0, 0.0], range(-1.0, 1.0), |_| {}));
    let bounds = active_bounds(&there, &found).unwrap();
    let of_tilt = || bounds.iter().filter(|bound| bound.side.limit == Limit::Tilt);
    assert!(of_tilt().next().is_some(), "{bounds:?}");
    let gain: f64 = of_tilt().map(|bound| bound.gain).sum();
    let wider = 0.1_f64;
    let problem = leaning([0.0, 0.0], range(-1.0 - wider, 1.0 + wider), |_| {});
    let problem = problem.in_setup(&Setup { leans: there.setup.leans.clone(), ..problem.setup.clone() });
    let (more, _) = run_leaning(&problem, &found, Ending::TIGHT, &Monitor::silent());
    let gained = (found.objective - more.solution.objective) / wider.to_radians();
    assert!((gained / gain - 1.0).abs() < 0.3, "{gained} {gain} {bounds:?}");
}
