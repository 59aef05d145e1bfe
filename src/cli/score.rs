//! `stead score`: one given placement.

use super::arguments::ScoreOptions;
use super::{Failure, on_threads, print, say};
use stead_format::read_run;
use stead_placement::outcome::{CANCELLATION, Plan, PlanPoint};
use stead_placement::place::score;
use stead_placement::problem::{Criterion, Placement, Problem};
use stead_report::document;
use stead_report::placement::{Context, evaluation};
use stead_report::stability::PathStability;
use stead_simulation::path_stability::{PathConfiguration, PathStabilityAnalysis};

pub(super) fn run(options: &ScoreOptions) -> Result<(), Failure> {
    let run = read_run(&options.config)?;
    let placement = options.place.placement();
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    mention_cell(&run.problem, &placement);
    let scored = score(&run.problem, &placement);
    let stability = match (&run.path_stability, &scored) {
        (Some(analysis), Ok(score)) => {
            let plans = [(&score.placement, &score.best), (&score.placement, &score.worst)];
            let (found, _) = on_threads(None, || path_stability(&run.problem, analysis, plans))?;
            Some(found?)
        }
        _ => None,
    };
    let context = Context { stability, ..Context::new(&run, run.search) };
    if options.json {
        let document = match &scored {
            Ok(score) => evaluation::score_json(score, &context),
            Err(nothing) => evaluation::infeasible_json(nothing, &context),
        };
        print(&document::bytes(&document));
    } else if let Ok(score) = &scored {
        mention_cancellation(&run.problem, score.best.mean);
        print(evaluation::score_text(score, &context).as_bytes());
    }
    scored?;
    Ok(())
}

/// Critical depths along two plans.
pub(super) fn path_stability(
    problem: &Problem,
    analysis: &PathStabilityAnalysis,
    plans: [(&Placement, &Plan); 2],
) -> Result<PathStability, Failure> {
    let along = |(placement, plan): (&Placement, &Plan)| {
        let feeds = problem.feeds(placement);
        let configuration = |point: &PlanPoint| PathConfiguration { joints: point.joints, feed: feeds[point.point] };
        let configurations: Vec<PathConfiguration> = plan.points.iter().map(configuration).collect();
        let found = analysis.along(&problem.robot, &problem.spindle, &configurations);
        found.map_err(|error| Failure::Job(error.to_string()))
    };
    let [best, worst] = plans;
    Ok(PathStability { analysis: analysis.clone(), plans: [along(best)?, along(worst)?] })
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
