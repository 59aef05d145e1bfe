//! What a result rests on: how its objective answers to the stiffness of every joint, and to errors of the force.

pub use crate::case::SpringSlope;
use crate::case::{Plan, PlanPoint};
use rayon::prelude::*;
pub use stead_model::robot::{About, Spring};
use stead_model::robot::{Compliance, Robot};
use stead_planning::redundancy::off_grid::Spacing;
use stead_planning::redundancy::{Kept, SegmentPlan, settled_among_free};
use stead_planning::transfer_path::whole_lines;
use stead_problem::evaluate::batch::BatchEvaluator;
use stead_problem::problem::{Placement, Problem, ProblemParts};
use stead_problem::sense::Sense;

/// Relative step of the central differences of stiffness: what "one per cent more" means.
const STEP: f64 = 0.01;
/// The spacing in which beta follows a change of stiffness. rad
const FOLLOWING: Spacing = Spacing { first: 4e-3, last: 6e-5 };
/// A sensitivity is not left uncertain by more than this share of the largest.
const UNCERTAIN: f64 = 0.01;

/// The springs of an arm, axes first, those together that no deflection tells apart: springs about z of joints 5 and 6
/// turn the tool about the lines of springs about y of joints 4 and 5, where these sit in the wrist centre.
fn springs_of(robot: &Robot) -> Vec<Vec<Spring>> {
    let mut groups: Vec<Vec<Spring>> = (0..6).map(|joint| vec![Spring { joint, about: About::Z }]).collect();
    for (joint, springs) in robot.normal_springs().into_iter().flatten().enumerate() {
        for (about, compliance) in [About::X, About::Y].into_iter().zip(springs.compliance) {
            let spring = Spring { joint, about };
            if compliance == 0.0 {
                continue;
            }
            match groups.get_mut(joint + 1) {
                Some(next) if about == About::Y && (3..5).contains(&joint) && springs.bearing == 0.0 => {
                    next.push(spring)
                }
                _ => groups.push(vec![spring]),
            }
        }
    }
    groups
}

/// How the objective of a plan answers to the stiffness of each spring of the arm, of joint and drive about the axis
/// first: central differences over one per cent, in m for a stiffness e times as large, so that one per cent more
/// changes the objective by a hundredth of it.
///
/// A best plan is made anew around the present one, since it holds deflections at zero where it can: there the plan as
/// it is would become worse both ways. Where it has nothing to gain from that, as a worst plan, the plan as it is gives
/// the same to first order.
pub fn objective_by_stiffness(
    problem: &Problem,
    placement: &Placement,
    plans: &[SegmentPlan],
    plan_sense: Sense,
) -> Vec<SpringSlope> {
    let springs = springs_of(&problem.robot);
    let of = |group: &Vec<Spring>| [1.0 + STEP, 1.0 - STEP].map(|factor| stiffened(problem, group, factor));
    let changed: Vec<[Option<Problem>; 2]> = springs.iter().map(of).collect();
    let here = held_objective(problem, placement, plans);
    let held: Vec<Option<[f64; 2]>> = changed
        .par_iter()
        .map(|[stiffer, softer]| {
            let [stiffer, softer] = [stiffer, softer]
                .map(|changed| changed.as_ref().and_then(|changed| held_objective(changed, placement, plans)));
            Some([stiffer?, softer?])
        })
        .collect();
    let largest = held.iter().flatten().map(|[stiffer, softer]| (stiffer - softer).abs()).fold(0.0, f64::max);
    // By how much the plan as it is becomes worse whichever way the stiffness goes: so much a plan made anew may gain.
    let kink = |[stiffer, softer]: &[f64; 2]| here.map_or(0.0, |here| (stiffer + softer - 2.0 * here).abs());
    let differences = changed.par_iter().zip(held).map(|(changed, held)| {
        let held = held?;
        if plan_sense == Sense::Max || kink(&held) <= UNCERTAIN * largest {
            return Some(held);
        }
        let [stiffer, softer] =
            [&changed[0], &changed[1]].map(|changed| Some(followed_objective(changed.as_ref()?, placement, plans)));
        Some([stiffer??, softer??])
    });
    let differences: Vec<Option<[f64; 2]>> = differences.collect();
    let slope = |found: Option<[f64; 2]>| found.map_or(0.0, |[stiffer, softer]| (stiffer - softer) / (2.0 * STEP));
    let slopes = springs.into_iter().zip(differences);
    slopes.map(|(springs, found)| SpringSlope { springs, slope: slope(found) }).collect()
}

/// The same plans as another problem scores them, with its costs; `None` where that finds a state that is not allowed.
fn recosted(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> Option<Vec<SegmentPlan>> {
    let recosted = |plan: &SegmentPlan| {
        let scores: Option<Vec<f64>> = plan
            .points
            .clone()
            .zip(&plan.betas)
            .map(|(point, beta)| {
                let state = problem.at(placement).state(point, *beta, plan.posture).ok()?;
                Some(problem.point_cost(point, state.score()))
            })
            .collect();
        let cost = scores?.into_iter().fold(0.0, |a, b| problem.criterion.aggregate.join(a, b));
        Some(SegmentPlan { cost, ..plan.clone() })
    };
    plans.iter().map(recosted).collect()
}

/// The objective of the same plans.
fn held_objective(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> Option<f64> {
    let plans = recosted(problem, placement, plans)?;
    Some(problem.objective(plans.iter().map(|plan| plan.cost)))
}

/// The objective of the best plans around them.
fn followed_objective(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> Option<f64> {
    let plans = recosted(problem, placement, plans)?;
    let evaluators = BatchEvaluator::all(problem, &problem.redundancy);
    let followed = |plan: &SegmentPlan| {
        let evaluator = BatchEvaluator::of_posture(&evaluators, plan.posture)?;
        let kept = Kept { lines: whole_lines(problem, placement, plan), moves: false };
        Some(settled_among_free(evaluator, placement, Sense::Min, FOLLOWING, kept, plan).cost)
    };
    Some(problem.objective(plans.iter().map(followed).collect::<Option<Vec<_>>>()?))
}

/// The problem with the stiffness of some springs multiplied, in all sets of compliances.
fn stiffened(problem: &Problem, springs: &[Spring], factor: f64) -> Option<Problem> {
    let robot = stiffened_robot(&problem.robot, springs, factor)?;
    let of_set = |set: &Robot| stiffened_robot(set, springs, factor);
    let sets =
        problem.criterion.stiffness.iter().flat_map(|sets| &sets.robots).map(of_set).collect::<Option<Vec<_>>>()?;
    let change = |parts: &mut ProblemParts| {
        parts.robot = robot;
        if let Some(of_parts) = &mut parts.criterion.stiffness {
            of_parts.robots = sets;
        }
    };
    problem.changed(change).ok()
}

/// The arm with the stiffness of some springs multiplied; compensators stay as they are.
fn stiffened_robot(robot: &Robot, springs: &[Spring], factor: f64) -> Option<Robot> {
    let mut laws = robot.joints().clone().map(|joint| joint.compliance);
    let mut normal = robot.stated_normal_springs().copied();
    for Spring { joint, about } in springs {
        let place = match about {
            About::Z => {
                laws[*joint] = stiffened_law(laws[*joint], factor);
                continue;
            }
            About::X => 0,
            About::Y => 1,
        };
        if let Some(normal) = &mut normal {
            normal[*joint].compliance[place] /= factor;
        }
    }
    let changed = robot.with_compliances(laws).ok()?.with_normal_springs(normal).ok()?;
    match robot.uncertainty() {
        Some(known) => changed.with_uncertainty(known.clone()).ok(),
        None => Some(changed),
    }
}

/// The law of a joint and its drive with its stiffness multiplied.
fn stiffened_law(law: Compliance, factor: f64) -> Compliance {
    match law {
        Compliance::Constant(value) => Compliance::Constant(value / factor),
        Compliance::Range { at_min, at_max } => Compliance::Range { at_min: at_min / factor, at_max: at_max / factor },
        Compliance::Compensated { alone, compensator } => {
            Compliance::Compensated { alone: alone / factor, compensator }
        }
    }
}

/// The mean score of a plan at a placement as another problem on the same path scores it. m
pub fn mean_by(problem: &Problem, placement: &Placement, plan: &Plan) -> f64 {
    let score =
        |p: &PlanPoint| problem.at(placement).state(p.point, p.beta, p.posture).map_or(p.score, |state| state.score());
    plan.points.iter().map(score).sum::<f64>() / problem.task.path().scored_count() as f64
}

/// The objective of a plan at a placement with the scores of a problem that differs in the force errors that they
/// cover. m
pub fn objective_with_force_errors(problem: &Problem, robust: &Problem, placement: &Placement, plan: &Plan) -> f64 {
    let scores = problem.objective(plan.points.iter().map(|p| {
        let score = robust.at(placement).state(p.point, p.beta, p.posture).map_or(p.score, |state| state.score());
        problem.point_cost(p.point, score)
    }));
    scores + problem.travel_weight() * plan.travel.total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::place::score;
    use crate::refine::planned;
    use stead_numerics::monitor::Monitor;
    use stead_planning::redundancy::Planner;
    use stead_problem::criterion::{Aggregate, Weights};
    use stead_problem::settings::TransferSettings;
    use stead_problem::testing::{Beside, compensated, five_segments, with_beside, with_laws};

    /// The objective of the best plan at a placement.
    fn planned_objective(problem: &Problem, placement: &Placement) -> (f64, Vec<SegmentPlan>) {
        let planner = Planner::finer(problem);
        let solution = planned(&planner, placement, None, &mut planner.workspace()).unwrap();
        (solution.objective, solution.plans)
    }

    #[test]
    fn more_stiffness_changes_the_objective_as_planning_anew_does_whatever_is_minimised() {
        let placement = Placement::from([0.1, -1.7, -0.4, 1.0]);
        let of_wall = |problem: &mut Problem| problem.redundancy.max_beta_rate = Some(2.0);
        let of_force_errors = |problem: &mut Problem| {
            problem.criterion.weights = Weights::TOTAL;
            problem.criterion.force_uncertainty = 0.1;
        };
        let of_rms = |problem: &mut Problem| problem.criterion.aggregate = Aggregate::Rms;
        let of_max = |problem: &mut Problem| problem.criterion.aggregate = Aggregate::Max;
        let with = |set: &dyn Fn(&mut Problem)| {
            let mut problem = with_laws(five_segments(), &[(1, compensated(0.2, 3e-7))]);
            problem.redundancy.beta_count = 60;
            set(&mut problem);
            problem
        };
        let criteria = [
            ("wall", with(&of_wall)),
            ("force errors", with(&of_force_errors)),
            ("rms", with(&of_rms)),
            ("max", with(&of_max)),
        ];
        for (name, problem) in criteria {
            let (objective, plans) = planned_objective(&problem, &placement);
            let slopes = objective_by_stiffness(&problem, &placement, &plans, Sense::Min);
            for SpringSlope { springs, slope } in slopes {
                let [stiffer, softer] = [1.01, 0.99]
                    .map(|factor| planned_objective(&stiffened(&problem, &springs, factor).unwrap(), &placement).0);
                let measured = (stiffer - softer) / 0.02;
                assert!(
                    (slope - measured).abs() < 0.02 * objective,
                    "{name}, {springs:?}: {slope} {measured} of {objective}"
                );
            }
        }
    }

    #[test]
    fn all_joints_stiffer_by_a_share_make_the_objective_smaller_by_that_share() {
        let placement = Placement::from([0.1, -1.7, -0.4, 1.0]);
        for (problem, count) in [(five_segments(), 6), (with_beside(five_segments(), Beside::Alike), 16)] {
            let (objective, plans) = planned_objective(&problem, &placement);
            let slopes = objective_by_stiffness(&problem, &placement, &plans, Sense::Min);
            assert_eq!(slopes.len(), count);
            let all: f64 = slopes.iter().map(|slope| slope.slope).sum();
            assert!((all / objective + 1.0).abs() < 0.02, "{all} {objective}");
        }
    }

    #[test]
    fn springs_that_turn_about_one_line_are_named_together() {
        let names = |robot: &Robot| -> Vec<String> {
            springs_of(robot)
                .iter()
                .map(|group| group.iter().map(Spring::to_string).collect::<Vec<_>>().join(" with "))
                .collect()
        };
        let alike = names(&with_beside(five_segments(), Beside::Alike).robot);
        assert_eq!(alike[4], "joint 5 about z with joint 4 about y");
        assert_eq!(alike[5], "joint 6 about z with joint 5 about y");
        assert_eq!((alike.len(), alike[6].as_str()), (16, "joint 1 about x"));
        assert_eq!(names(&with_beside(five_segments(), Beside::Pairs).robot).len(), 18);
    }

    #[test]
    fn force_errors_only_add() {
        let problem = five_segments();
        let placement = Placement::from([0.1, -1.7, -0.4, 1.0]);
        let plan = score(&problem, &placement, &TransferSettings::default(), &Monitor::silent()).unwrap().plans.best;
        let with = |size: f64| {
            let robust = problem.clone().with(|parts| parts.criterion.force_uncertainty = size);
            objective_with_force_errors(&problem, &robust, &placement, &plan)
        };
        assert!((with(0.0) / plan.objective - 1.0).abs() < 1e-9 && with(0.1) > with(0.05) && with(0.05) > with(0.0));
    }
}
