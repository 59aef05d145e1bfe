//! `stead place`: search, then files, then a table, and then, where it is asked for, a certificate with its own files.

use super::arguments::PlaceOptions;
use super::certify::{certified, warn_unfit};
use super::progress::Terminal;
use super::score::{mention_cancellation, path_stability};
use super::{Failure, files_written, on_threads, out_folder, print, say};
use serde_json::Value;
use std::time::Instant;
use stead_format::read_run_to_certify;
use stead_placement::outcome::Cases;
use stead_placement::place::place;
use stead_report::certificate::{certificate_json, certificate_text, write_certificate};
use stead_report::document::{self, Timing};
use stead_report::placement::{Context, evaluation, place_json, placement_text, write_placement};

pub(super) fn run(options: &PlaceOptions) -> Result<(), Failure> {
    let run = read_run_to_certify(&options.config, options.certify)?;
    let mut search = run.search;
    search.seed = options.seed.unwrap_or(search.seed);
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    warn_unfit(&run);

    let terminal = Terminal::start();
    let shown = terminal.show(None);
    let started = Instant::now();
    let (outcome, threads) =
        on_threads(options.threads, || place(&run.problem, &search, &run.transfer, &shown.monitor))?;
    let wall = started.elapsed().as_secs_f64();
    let was_stopped = shown.monitor.should_stop();
    drop(shown);
    let outcome = outcome.inspect_err(|nothing| {
        if options.json {
            print(&document::bytes(&evaluation::infeasible_json(nothing, &Context::new(&run, search))));
        }
        out.give_up();
        if was_stopped {
            say("interrupted: this is what was found so far, not the end of the search");
        }
    })?;

    let Cases { best, worst, .. } = &outcome.cases;
    let plans = [(&best.placement, &best.plan), (&worst.placement, &worst.plan)];
    let stability = match &run.path_stability {
        Some(analysis) => Some(on_threads(options.threads, || path_stability(&run.problem, analysis, plans))?.0?),
        None => None,
    };
    let context = Context { stability, ..Context::new(&run, search) };
    let written = write_placement(&out.folder, &run.problem, &outcome, &context);
    let mut document = place_json(&outcome, &context, &Timing { wall, threads });
    // Text is shown as it comes; in JSON there is one document, shown when the certificate is in it.
    let mut shown = match options.json {
        true => files_written(written),
        false => out.tell(
            written,
            |folder| format!("; results in {folder}"),
            |where_to| {
                let table = placement_text(&run.problem, &outcome, &context);
                format!("{table}in {wall:.1} s on {threads} threads{where_to}\n")
            },
        ),
    };
    mention_cancellation(&run.problem, outcome.cases.best.plan.mean);
    if outcome.interrupted {
        say("interrupted: the results are the best found so far, not the end of the search");
    }
    if let Some(settings) = run.certificate {
        let certificate = certified(&run, settings, &outcome, options.threads, &terminal)?;
        shown = shown.and(files_written(write_certificate(&out.folder, &run.problem, &certificate)));
        if let Value::Object(entries) = &mut document {
            entries.insert("certificate".to_owned(), certificate_json(&certificate));
        }
        if !options.json {
            let wall = certificate.wall;
            print(format!("\n{}in {wall:.1} s\n", certificate_text(&certificate)).as_bytes());
        }
    }
    if options.json {
        print(&document::bytes(&document));
    }
    shown
}
