//! What should be known about a result.

use crate::criterion::Criterion;
use crate::feed::CutFeed;
use crate::outcome::{CANCELLATION, Cycle, Plan};
use crate::problem::Problem;
use stead_model::plausibility;
use stead_numerics::digits::figures;
use stead_numerics::message::Warning;

/// Warns of a plan that balances the deflection to nothing: a result of the criterion, not of the robot.
pub(super) fn cancellation(problem: &Problem, mean: f64) -> Option<Warning> {
    (mean <= CANCELLATION && problem.criterion == Criterion::default()).then(|| {
        let message = "the best plan cancels the deflection to nothing, which no real force will; \
                       criterion.force_uncertainty makes the score the worst case over force errors";
        Warning::new("cancellation", message)
    })
}

/// What should be known about a best plan though nothing is wrong with it.
pub(super) fn of(problem: &Problem, plan: &Plan, feed: &CutFeed) -> Vec<String> {
    let large = plausibility::deflection(plan.deflection.total.max);
    small_part(problem, plan).into_iter().chain(large).chain(slowed(feed)).collect()
}

/// A note that the arm does not hold the programmed feed.
fn slowed(feed: &CutFeed) -> Option<String> {
    let (segments, limit) = (feed.slowed(), feed.highest()?);
    (segments > 0).then(|| {
        format!(
            "the best plan does not hold the programmed feed of {} mm/s but {} mm/s: {limit}, decides; {segments} of {} segments are \
             slower, and cutting times are with the highest feed of each",
            figures(feed.programmed * 1e3),
            figures(limit.feed * 1e3),
            feed.segments.len()
        )
    })
}

/// A scored part below this share of the whole deflection is small.
const SMALL_PART: f64 = 0.2;

/// A note on a plan whose scored part is small beside the whole deflection: it may have been balanced against itself.
fn small_part(problem: &Problem, plan: &Plan) -> Option<String> {
    let (scored, total) = (plan.mean * 1e3, plan.deflection.total.mean * 1e3);
    (problem.criterion.force_uncertainty == 0.0 && scored < SMALL_PART * total).then(|| {
        format!(
            "the scored part of the deflection, {} mm in the mean, is below a fifth of the whole, {} mm: a plan that balances one \
             part leaves the rest; criterion.direction = \"total\" scores the whole, and criterion.force_uncertainty covers errors of \
             the force",
            figures(scored),
            figures(total)
        )
    })
}

pub(super) fn interruption() -> Warning {
    Warning::new("interrupted", "interrupted: the results are the best found so far, not the end of the search")
}

/// That moves between segments have no free way, where they hit.
pub(super) fn blocked_moves(problem: &Problem, cycle: &Cycle) -> Option<Warning> {
    let scene = problem.scene.as_deref()?;
    let blocked: Vec<String> = cycle
        .transfers
        .iter()
        .filter_map(|transfer| {
            let pair = scene.pair(transfer.way.as_ref()?.blocked_by?)?;
            Some(format!("after segment {} ({pair})", transfer.after_segment))
        })
        .collect();
    (!blocked.is_empty()).then(|| {
        let moves = blocked.join(", ");
        Warning::new(
            "blocked-move",
            format!("no free way was found for the move {moves}: its time is that of the straight move"),
        )
    })
}
