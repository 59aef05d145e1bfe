//! `stead score`: one given placement.

use super::arguments::ScoreOptions;
use super::{Failure, print, say};
use crate::config::read_run;
use crate::placement::outcome::CANCELLED;
use crate::placement::place::score;
use crate::placement::problem::{Criterion, Placement, Problem};
use crate::report::{evaluation, json};

pub(super) fn run(options: &ScoreOptions) -> Result<(), Failure> {
    let run = read_run(&options.config)?;
    let placement = options.place.placement();
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    mention_cell(&run.problem, &placement);
    let scored = score(&run.problem, &placement);
    if options.json {
        let document = match &scored {
            Ok(score) => evaluation::score_json(score),
            Err(nothing) => evaluation::infeasible_json(nothing),
        };
        print(&json::bytes(&document));
    } else if let Ok(score) = &scored {
        mention_cancellation(&run.problem, score.best.mean);
        print(evaluation::score_text(score).as_bytes());
    }
    scored?;
    Ok(())
}

/// A plan that balances the deflection to nothing is a result of the criterion, not of the robot.
pub(super) fn mention_cancellation(problem: &Problem, mean: f64) {
    if mean <= CANCELLED && problem.criterion == Criterion::default() {
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
