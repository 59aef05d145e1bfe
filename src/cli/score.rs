//! `stead score`: one given placement.

use super::arguments::ScoreOptions;
use super::{Failure, on_threads, print, print_json, say_notes, say_warnings};
use stead::{Error, Run};

pub(super) fn run(options: &ScoreOptions) -> Result<(), Failure> {
    let run = Run::read(&options.config)?;
    let placement = options.place.placement();
    say_notes(run.notes());
    say_notes(run.outside_cell(&placement).as_slice());
    let score = on_threads(None, || run.score(&placement))?.inspect_err(|error| {
        if let (true, Error::Infeasible(nothing)) = (options.json, error) {
            // What cannot be printed is said as the error all the same.
            let _ = print_json(&run.infeasible_json(nothing));
        }
    })?;
    say_warnings(score.warnings());
    if options.json {
        return print_json(&score);
    }
    print(score.to_string().as_bytes())
}
