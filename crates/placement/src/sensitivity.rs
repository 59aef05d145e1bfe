//! What a result rests on: how its mean answers to the stiffness of every joint, and to errors of the force.

use super::criterion::Criterion;
use super::evaluate::reference::state;
use super::outcome::{Plan, PlanPoint};
use super::problem::{Placement, Problem};
use super::redundancy::SegmentPlan;
use rayon::prelude::*;
use stead_model::robot::{Compliance, Robot};

/// Relative step of the central differences of stiffness.
const STEP: f64 = 1e-5;

/// How the mean score of a plan answers to the stiffness of each joint and its drive: derivative by its logarithm, so that one
/// per cent more stiffness changes the mean by a hundredth of it. m
///
/// The plan is held: at an optimum it does not matter to first order that a plan would follow the stiffness.
pub fn mean_by_stiffness(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> [f64; 6] {
    let states: Vec<_> = plans
        .iter()
        .flat_map(|plan| plan.points.clone().zip(&plan.betas).map(|(point, beta)| (point, *beta, plan.posture)))
        .collect();
    let mean = |robot: Robot| {
        let changed = with_set_alone(problem, &robot);
        let score = |(point, beta, posture): &(usize, f64, _)| {
            state(&changed, *point, placement, *beta, *posture).map_or(0.0, |state| state.score())
        };
        let scores: Vec<f64> = states.par_iter().with_min_len(64).map(score).collect();
        scores.iter().sum::<f64>() / problem.task.path().scored_count() as f64
    };
    std::array::from_fn(|joint| {
        let [stiffer, softer] =
            [1.0 + STEP, 1.0 - STEP].map(|factor| stiffened(&problem.robot, joint, factor).map(mean));
        stiffer.zip(softer).map_or(0.0, |(stiffer, softer)| (stiffer - softer) / (2.0 * STEP))
    })
}

/// The arm with the stiffness of one joint (from 0) and its drive multiplied; its compensator stays as it is.
fn stiffened(robot: &Robot, joint: usize, factor: f64) -> Option<Robot> {
    let mut laws = robot.joints().clone().map(|joint| joint.compliance);
    laws[joint] = match laws[joint] {
        Compliance::Constant(value) => Compliance::Constant(value / factor),
        Compliance::Range { at_min, at_max } => Compliance::Range { at_min: at_min / factor, at_max: at_max / factor },
        Compliance::Compensated { alone, compensator } => {
            Compliance::Compensated { alone: alone / factor, compensator }
        }
    };
    let changed = robot.with_compliances(laws).ok()?;
    match robot.uncertainty() {
        Some(known) => changed.with_uncertainty(known.clone()).ok(),
        None => Some(changed),
    }
}

/// The same problem with one set of compliances alone.
pub fn with_set_alone(problem: &Problem, set: &Robot) -> Problem {
    let criterion = Criterion { stiffness: None, ..problem.criterion.clone() };
    Problem { robot: set.clone(), criterion, ..problem.clone() }
}

/// The mean score of a plan at a placement as another problem on the same path scores it. m
pub fn mean_by(problem: &Problem, placement: &Placement, plan: &Plan) -> f64 {
    let score =
        |p: &PlanPoint| state(problem, p.point, placement, p.beta, p.posture).map_or(p.score, |state| state.score());
    plan.points.iter().map(score).sum::<f64>() / problem.task.path().scored_count() as f64
}

/// The objective of a plan at a placement, with scores that cover force errors of a relative size. m
pub fn objective_with_force_errors(problem: &Problem, placement: &Placement, plan: &Plan, size: f64) -> f64 {
    let mut changed = problem.clone();
    changed.criterion.force_uncertainty = size;
    let scores = problem.objective(plan.points.iter().map(|p| {
        let score = state(&changed, p.point, placement, p.beta, p.posture).map_or(p.score, |state| state.score());
        problem.point_cost(p.point, score)
    }));
    scores + problem.travel_weight() * plan.travel.total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::score;
    use crate::redundancy::Planner;
    use crate::refine::planned;
    use crate::settings::TransferSettings;
    use crate::testing::{compensated, five_segments, with_laws};
    use stead_numerics::monitor::Monitor;

    #[test]
    fn stiffer_joints_change_the_mean_as_the_formula_says() {
        let problem = with_laws(five_segments(), &[(1, compensated(0.2, 3e-7))]);
        let placement = Placement::from([0.1, -1.7, -0.4, 1.0]);
        let planner = Planner::new(&problem);
        let solution = planned(&planner, &placement, None, &mut planner.workspace()).unwrap();
        let slopes = mean_by_stiffness(&problem, &placement, &solution.plans);
        // A deflection is a sum over the joints of what falls with their stiffness, so that all together it falls as it is large.
        let constant = five_segments();
        let solution = planned(&Planner::new(&constant), &placement, None, &mut planner.workspace()).unwrap();
        let all: f64 = mean_by_stiffness(&constant, &placement, &solution.plans).iter().sum();
        assert!((all / solution.objective + 1.0).abs() < 1e-6, "{all} {}", solution.objective);
        assert!(slopes.iter().any(|slope| *slope < 0.0) && slopes.iter().all(|slope| slope.is_finite()));
    }

    #[test]
    fn force_errors_only_add() {
        let problem = five_segments();
        let placement = Placement::from([0.1, -1.7, -0.4, 1.0]);
        let plan = score(&problem, &placement, &TransferSettings::default(), &Monitor::silent()).unwrap().best;
        let with = |size: f64| objective_with_force_errors(&problem, &placement, &plan, size);
        assert!((with(0.0) / plan.objective - 1.0).abs() < 1e-9 && with(0.1) > with(0.05) && with(0.05) > with(0.0));
    }
}
