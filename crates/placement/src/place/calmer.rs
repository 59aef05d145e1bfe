//! Whether a plan that turns the joints much less costs little.

use crate::outcome::Plan;
use stead_numerics::digits::figures;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::Planner;
use stead_problem::criterion::CANCELLATION;
use stead_problem::joint_travel::joint_travel;
use stead_problem::problem::{BetaPlan, Placement, Problem};
use stead_problem::sense::Sense;

/// A calmer plan costs less than this share of the objective.
const COST: f64 = 0.02;
/// It has at most this share of the joint travel.
const TRAVEL: f64 = 0.8;

/// A note where the plan with one beta for each segment, or that with joint travel weighed, turns the joints much less
/// and costs little at a placement. They are planned on the grid of the search, and no longer once the caller asks to
/// stop.
pub(super) fn calmer(problem: &Problem, placement: &Placement, best: &Plan, monitor: &Monitor) -> Option<String> {
    let is_weighed = problem.criterion.joint_travel_weight > 0.0 || problem.redundancy.beta != BetaPlan::Free;
    if is_weighed || best.objective <= CANCELLATION || best.travel.total == 0.0 {
        return None;
    }
    let without_tie_rule = problem.without_tie_rule();
    let constant = without_tie_rule.changed(|parts| parts.redundancy.beta = BetaPlan::ConstantPerSegment);
    // So that joint travel as it is counts as much as may be lost: what the plan with it loses is no more.
    let weight = COST * best.objective * problem.stretches() / best.travel.total;
    // Not every figure can have it added to.
    let weighed =
        without_tie_rule.changed(|parts| parts.criterion.joint_travel_weight = rounded_down(weight * 1e3) / 1e3);
    let key = "criterion.joint_travel_weight_mm_per_rad";
    let variants = [
        (constant, format!("redundancy.beta = \"{}\"", BetaPlan::ConstantPerSegment.name())),
        (weighed, format!("{key} = {}", figures(rounded_down(weight * 1e3)))),
    ];
    variants.into_iter().find_map(|(calm, key)| {
        let calm = calm.ok().filter(|_| !monitor.should_stop())?;
        let planner = Planner::new(&calm);
        let plans = planner.plan(placement, Sense::Min, None, &mut planner.workspace()).ok()?;
        let travel: f64 = plans.iter().map(|plan| joint_travel(&plan.joints)).sum();
        let objective = calm.objective(plans.iter().map(|plan| plan.cost)) - calm.travel_weight() * travel;
        let cost = objective / best.objective - 1.0;
        (cost < COST && travel <= TRAVEL * best.travel.total).then(|| {
            format!(
                "a calmer plan costs little: with {key} the joints turn by {} deg in the cut in place of {}, and the \
                 objective at this \
                 placement is {} mm in place of {} ({} %)",
                whole_degrees(travel),
                whole_degrees(best.travel.total),
                figures(objective * 1e3),
                figures(best.objective * 1e3),
                signed_percent(cost),
            )
        })
    })
}

/// A number of two digits that is no larger.
fn rounded_down(value: f64) -> f64 {
    let unit = libm::pow(10.0, libm::floor(libm::log10(value)) - 1.0);
    // Digits of a power of ten are not exact; those written are.
    format!("{:.1e}", libm::floor(value / unit) * unit).parse().unwrap_or(value)
}

fn whole_degrees(angle: f64) -> String {
    format!("{:.0}", angle.to_degrees())
}

fn signed_percent(share: f64) -> String {
    format!("{:+.1}", share * 100.0)
}

/// The largest turn of a joint along a short stretch that needs no note. rad
const LARGE_TURN: f64 = std::f64::consts::FRAC_PI_4;

/// A note where a joint turns far along a short stretch of the path.
pub(super) fn swing(plan: &Plan) -> Option<String> {
    let swing = plan.travel.swing.filter(|swing| swing.angle > LARGE_TURN)?;
    let [from, to] = swing.points;
    Some(format!(
        "axis {} turns by {} deg within {} mm of the cut, from point {from} to {to}; in all the joints turn by {} deg \
         in {} mm \
         (redundancy.beta and criterion.joint_travel_weight_mm_per_rad make calmer programs)",
        swing.joint,
        whole_degrees(swing.angle),
        figures(swing.length * 1e3),
        whole_degrees(plan.travel.total),
        figures(plan.travel.length * 1e3),
    ))
}

#[cfg(test)]
mod tests;
