//! `stead score`: one given placement.

use super::arguments::ScoreOptions;
use super::progress::Terminal;
use super::{Failure, files_written, left_in, on_threads, print, print_json, say_notes, say_warnings};
use stead::{Error, Run};
use stead_report::Folder;

pub(super) fn run(options: &ScoreOptions) -> Result<(), Failure> {
    let run = Run::read_with(&options.config, options.set.clone())?;
    let (run, placement) = options.place.of(run, options.orientation.as_deref())?;
    // Taken before the work is done.
    let out = options.out.as_deref().map(Folder::create).transpose().map_err(Failure::Output)?;
    let out = out.map(|folder| folder.keeping_partial(options.keep_partial));
    say_notes(run.notes());
    let outside_cell = run.outside_cell(&placement);
    say_notes(outside_cell.as_slice());
    let shown = Terminal::start(out.as_ref()).show(None);
    let score = on_threads(None, || {
        let mut score = run.score_with(&placement, &shown.monitor)?;
        if options.out.is_some() {
            score.map(&shown.monitor);
        }
        Ok(score)
    })?;
    drop(shown);
    let score = score.inspect_err(|error| {
        if let (true, Error::Infeasible(nothing)) = (options.json, error) {
            // What cannot be printed is said as the error all the same.
            let _ = print_json(&run.infeasible_json(nothing));
        }
    })?;
    // What was known before was said then.
    say_notes(score.notes().get(run.notes().len() + outside_cell.iter().len()..).unwrap_or_default());
    say_warnings(score.warnings());
    let written = out
        .as_ref()
        .map_or(Ok(()), |out| files_written(score.write_in(out).inspect(|files| drop(left_in(out, files)))));
    if options.json {
        print_json(&score)?;
    } else {
        print(score.to_string().as_bytes())?;
    }
    written?;
    if score.score().interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}
