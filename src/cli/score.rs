//! `stead score`: one given placement.

use super::Failure;
use super::given::{GivenPlacement, GivenRun};
use super::manual::Manual;
use super::output::{files_written, left_in, more, print, print_json, say_all, say_notes, say_warnings, show};
use super::progress::Terminal;
use clap::Args;
use std::path::PathBuf;
use stead::Error;
use stead::report::{Folder, summary_text};

#[derive(Debug, Args)]
pub(super) struct ScoreOptions {
    #[command(flatten)]
    pub run: GivenRun,
    #[command(flatten)]
    pub place: GivenPlacement,
    /// Folder for plans, maps, pictures and score.json [default: nothing is written]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// If it is interrupted, let its results take the place of finished ones, instead of leaving them in
    /// <DIR>.interrupted
    #[arg(long, requires = "out")]
    pub keep_partial: bool,
    /// Print the table of both plans, and say every warning and note, in place of the summary
    #[arg(long)]
    pub notes: bool,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead score configs/caro-2013.toml --x-mm 2.2 --y-mm -1643.5 --z-mm -556.4 --q4 0.9258",
        "stead score configs/caro-2013.toml --x-mm 0 --y-mm -1640 --z-mm -214 --yaw-deg 79 --json",
        "stead score configs/caro-2013.toml --placement-of results/caro-2013 --case 3 --out results/worst",
        "stead score configs/tilting-table.toml --x-mm 1700 --y-mm 0 --z-mm 700 --yaw-deg 0 --orientation flat",
    ],
    written: "with --out",
    files: "\
best-plan.csv, worst-plan.csv: the two plans, point by point
deflection-map.{csv,svg}: smallest deflection, or what forbids it, over path point and spindle angle; unless [output] \
    maps = false
lean-map.csv: with a table [lean]: smallest deflection over lead and tilt at the worst point of the best plan; unless \
    [output] maps = false
placement.svg: the cell from above with the placement
report.html, cell.glb, page-data.json: page for the browser, moving 3-D scene, what `stead page` makes both of; \
    unless [output] page = false
setup.svg: setup sheet of the placement, an A4 page to print: where all stands, check points, tolerances; unless \
    [output] page = false
notes.txt: the summary, the table, every warning and every note
score.json: what --json prints, and with a setup sheet its numbers
stability-{best,worst}-plan.csv, stability.svg: with a table [stability]: critical depth along the path",
    failed: "the placement is infeasible, with the violated constraints and the path points, or a file could not be written",
    refused: "wrong usage, bad input, or a results folder that cannot be written to",
    interrupted: "ended early by Ctrl-C: both plans are there, critical depths, the map of a long path and that over lead and tilt may be left out",
    ..Manual::NEW
};

pub(super) fn run(options: &ScoreOptions) -> Result<(), Failure> {
    let terminal = Terminal::start(None);
    let run = options.run.read(&terminal, None)?;
    let (run, placement) = options.place.of(run)?;
    // Taken before the work is done.
    let out = options.out.as_deref().map(Folder::create).transpose()?;
    let out = out.map(|folder| folder.keeping_partial(options.keep_partial));
    out.iter().try_for_each(|out| out.has_no_other(MANUAL.file_names()))?;
    out.iter().for_each(|out| terminal.holds(out));
    let is_short = !options.notes && !options.json;
    let outside_cell = run.outside_cell(&placement);
    let say_read = || {
        say_all(run.notes(), run.warnings());
        say_notes(outside_cell.as_slice());
    };
    if !is_short {
        say_read();
    }
    let score = terminal.on_threads(None, |monitor| {
        let mut score = run.score(&placement, monitor)?;
        if options.out.is_some() {
            score.map(monitor);
            score.make_sheet(monitor);
        }
        Ok(score)
    })?;
    let score = score.inspect_err(|error| {
        if is_short {
            say_read();
        }
        if let (true, Error::Infeasible(nothing)) = (options.json, error) {
            // What cannot be printed is said as the error all the same.
            let _ = print_json(&run.infeasible_json(nothing));
        }
    })?;
    if !is_short {
        // What was known before was said then.
        say_notes(score.notes().get(run.notes().len() + outside_cell.iter().len()..).unwrap_or_default());
        say_warnings(score.warnings().get(run.warnings().len()..).unwrap_or_default());
    }
    let mut left = String::new();
    let written = out.as_ref().map_or(Ok(()), |out| {
        let files = score.write_in(out);
        left = files.as_ref().map(|files| left_in(out, files).display().to_string()).unwrap_or_default();
        files_written(files)
    });
    if is_short {
        let mut lines = score.summary();
        lines.extend(more(score.notes().len() + score.warnings().len(), &left));
        print(summary_text(&lines).as_bytes())?;
    } else {
        show(&score, options.json)?;
    }
    written?;
    if score.score().interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}
