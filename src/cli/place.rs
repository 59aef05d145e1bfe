//! `stead place`: search, then files, then a table.

use super::arguments::PlaceOptions;
use super::progress::Watcher;
use super::score::{mention_cancellation, path_stability};
use super::{Failure, on_threads, out_folder, print, say};
use crate::config::read_run;
use crate::placement::control::Control;
use crate::placement::place::place;
use crate::report::json::{self, Timing};
use crate::report::{Context, evaluation, text, write_placement};
use std::time::Instant;

pub(super) fn run(options: &PlaceOptions) -> Result<(), Failure> {
    let run = read_run(&options.config)?;
    let mut search = run.search;
    search.seed = options.seed.unwrap_or(search.seed);
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));

    let watcher = Watcher::start();
    let started = Instant::now();
    let (outcome, threads) = on_threads(options.threads, || place(&run.problem, &search, &run.transfer, &watcher))?;
    let wall = started.elapsed().as_secs_f64();
    watcher.finish();
    let outcome = outcome.inspect_err(|nothing| {
        if options.json {
            print(&json::bytes(&evaluation::infeasible_json(nothing)));
        }
        out.give_up();
        if watcher.should_stop() {
            say("interrupted: this is what was found so far, not the end of the search");
        }
    })?;

    let [best, _, worst, _] = &outcome.cases;
    let plans = [(&best.placement, &best.plan), (&worst.placement, &worst.plan)];
    let stability = match &run.chatter {
        Some(chatter) => Some(on_threads(options.threads, || path_stability(&run.problem, chatter, plans))?.0?),
        None => None,
    };
    let context = Context { inputs: run.inputs, search, transfer: run.transfer, reference: run.reference, stability };
    let written = write_placement(&out.folder, &run.problem, &outcome, &context);
    let document = || json::place_json(&outcome, &context, &Timing { wall, threads });
    let where_to = |folder| format!("; results in {folder}");
    let shown = out.show(written, options.json, document, where_to, |where_to| {
        let table = text::placement_text(&run.problem, &outcome, &context);
        format!("{table}in {wall:.1} s on {threads} threads{where_to}\n")
    });
    mention_cancellation(&run.problem, outcome.cases[0].plan.mean);
    if outcome.interrupted {
        say("interrupted: the results are the best found so far, not the end of the search");
    }
    shown
}
