//! `stead score`: one given placement.

use super::arguments::ScoreOptions;
use super::{Failure, print, say};
use crate::config::read_run;
use crate::placement::place::score;
use crate::placement::problem::{Placement, Problem};
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
        print(evaluation::score_text(score).as_bytes());
    }
    scored?;
    Ok(())
}

/// A placement outside the cell is evaluated all the same, but not silently.
pub(super) fn mention_cell(problem: &Problem, placement: &Placement) {
    if !problem.cell.contains(placement) {
        say("note: this placement is outside the cell of the run file");
    }
}
