//! `stead score`: one given placement.

use super::arguments::ScoreOptions;
use super::{Failure, on_threads, print, say};
use stead_format::read_run;
use stead_placement::outcome::{CANCELLATION, Plan, PlanPoint};
use stead_placement::place::score;
use stead_placement::problem::{Criterion, Placement, Problem};
use stead_report::stability::PathStability;
use stead_report::{evaluation, json};
use stead_simulation::chatter::{Chatter, Station};

pub(super) fn run(options: &ScoreOptions) -> Result<(), Failure> {
    let run = read_run(&options.config)?;
    let placement = options.place.placement();
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    mention_cell(&run.problem, &placement);
    let scored = score(&run.problem, &placement);
    let stability = match (&run.chatter, &scored) {
        (Some(chatter), Ok(score)) => {
            let plans = [(&score.placement, &score.best), (&score.placement, &score.worst)];
            let (found, _) = on_threads(None, || path_stability(&run.problem, chatter, plans))?;
            Some(found?)
        }
        _ => None,
    };
    if options.json {
        let document = match &scored {
            Ok(score) => evaluation::score_json(score, stability.as_ref()),
            Err(nothing) => evaluation::infeasible_json(nothing),
        };
        print(&json::bytes(&document));
    } else if let Ok(score) = &scored {
        mention_cancellation(&run.problem, score.best.mean);
        print(evaluation::score_text(score, stability.as_ref()).as_bytes());
    }
    scored?;
    Ok(())
}

/// Critical depths along two plans.
pub(super) fn path_stability(
    problem: &Problem,
    chatter: &Chatter,
    plans: [(&Placement, &Plan); 2],
) -> Result<PathStability, Failure> {
    let along = |(placement, plan): (&Placement, &Plan)| {
        let feeds = problem.feeds(placement);
        let station = |point: &PlanPoint| Station { joints: point.joints, feed: feeds[point.point] };
        let stations: Vec<Station> = plan.points.iter().map(station).collect();
        let found = chatter.along(&problem.robot, &problem.spindle, &stations);
        found.map_err(|error| Failure::Job(error.to_string()))
    };
    let [best, worst] = plans;
    Ok(PathStability { chatter: chatter.clone(), plans: [along(best)?, along(worst)?] })
}

/// A plan that balances the deflection to nothing is a result of the criterion, not of the robot.
pub(super) fn mention_cancellation(problem: &Problem, mean: f64) {
    if mean <= CANCELLATION && problem.criterion == Criterion::default() {
        say(
            "note: the best plan cancels the deflection to nothing, which no real force will; criterion.force_uncertainty \
             makes the score the worst case over force errors",
        );
    }
}

/// A placement outside the cell is evaluated all the same, but not silently.
pub(super) fn mention_cell(problem: &Problem, placement: &Placement) {
    if !problem.cell.contains(placement) {
        say("note: this placement is outside the cell of the run file");
    }
}
