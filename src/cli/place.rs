//! `stead place`: search, then files, then a table, and then, where it is requested, a certificate with its own files.

use super::Failure;
use super::given::GivenRun;
use super::manual::Manual;
use super::output::{
    files_written, left_in, more, out_folder, print, print_json, say, say_all, say_notes, say_warnings,
};
use super::progress::Terminal;
use super::values::{gap, positive, seed, threads};
use clap::Args;
use std::path::PathBuf;
use stead::program::ProgramFormat;
use stead::report::{Folder, summary_line, summary_text};
use stead::{Error, Monitor, Placements, Run};

#[derive(Debug, Args)]
pub(super) struct PlaceOptions {
    #[command(flatten)]
    pub run: GivenRun,
    /// Folder for the results [default: results/<name of the run file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Seed of the random numbers, instead of the run file's
    #[arg(long, value_name = "S", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Continue until it is proved that no placement is better, or worse, by more than G per cent
    #[arg(long, value_name = "G", value_parser = gap, allow_hyphen_values = true)]
    pub certify: Option<f64>,
    /// End the proof after S seconds, with the bound that it has by then
    #[arg(long, value_name = "S", value_parser = positive, allow_hyphen_values = true)]
    pub time_limit: Option<f64>,
    /// Refine the basins of the best placement once more for force errors of 10 %, and say how far it moves
    #[arg(long)]
    pub sensitivity: bool,
    /// Look for the best placement alone, in half of the time, whatever the run file says
    #[arg(long)]
    pub no_worst: bool,
    /// Leave no page for the browser, whatever the run file says
    #[arg(long)]
    pub no_page: bool,
    /// If it is interrupted, let its results take the place of finished ones, instead of leaving them in
    /// <DIR>.interrupted
    #[arg(long)]
    pub keep_partial: bool,
    /// Print the tables of all cases, and say every warning and note, in place of the summary
    #[arg(long)]
    pub notes: bool,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Print one JSON document instead of tables
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead place configs/caro-2013.toml",
        "stead place configs/caro-2013.toml --seed 7 --out results/seed-7",
        "stead place configs/caro-2013.toml --certify 0.5 --time-limit 60 --no-worst",
        "stead place configs/caro-2013.toml --set 'cell.z_mm=[-602, -402]' --set robot.joints[1].stiffness_mnm_per_rad=0.8",
    ],
    files: "\
placements.csv: the four cases: pose, postures, mean and largest deflection, times, highest feed
best.csv, worst.csv: plan of the best and of the worst placement, point by point
best-worst-plan.csv, worst-worst-plan.csv: the same placements with the worst plan of the spindle angle
deflection-map-{best,worst}.{csv,svg}: smallest deflection, or what forbids it, over path point and spindle angle; \
    unless [output] maps = false
lean-map.csv: with a table [lean]: smallest deflection over lead and tilt at the worst point of the best plan; unless \
    [output] maps = false
convergence.{csv,svg}: the genetic searches, generation by generation
refinements.csv: the gradient refinement of each basin: start, end, optimality residual, status
transfers.csv: joint moves between segments: duration and largest travel
cell.svg: the cell from above: reach, limits, placements
setup.svg: setup sheet of the best placement, an A4 page to print: where all stands, check points, tolerances; unless \
    [output] page = false or --no-page
notes.txt: the summary, the tables of all cases, every warning and every note
summary.json: all of it for programs, with the keys of the run file and their values
report.html, cell.glb, page-data.json: page for the browser, moving 3-D scene, what `stead page` makes both of; \
    unless [output] page = false or --no-page
stability-{best,worst}.csv, stability.svg: with a table [stability]: critical depth along the path
certificate.json: with --certify or a table [certificate]: bounds and gaps, and why where there are none
open-region.{csv,svg}, open-region-worst.svg: with --certify or a table [certificate]: where a placement may be \
    better, or worse, by more than the gap",
    remarks: "With --no-worst no file of the worst placement is written.",
    done: "done; also when a certificate did not reach its gap or was ended by Ctrl-C",
    failed: "no feasible placement was found, or a file could not be written after the search",
    refused: "wrong usage, bad input, or a results folder that cannot be written to",
    interrupted: "Ctrl-C ended the search: results are the best found so far, maps of a long path are left out",
    ..Manual::NEW
};

/// The run as the options have it.
fn read(options: &PlaceOptions, terminal: &Terminal) -> Result<Run, Failure> {
    let mut run = options.run.read_with(options.certify, terminal, options.threads)?;
    if let Some(seconds) = options.time_limit {
        run = run.with_time_limit(seconds)?;
    }
    if let Some(seed) = options.seed {
        run = run.with_seed(seed);
    }
    if options.sensitivity {
        run = run.with_sensitivity(Run::FORCE_ERROR)?;
    }
    if options.no_worst {
        run = run.without_worst();
    }
    Ok(if options.no_page { run.without_page() } else { run })
}

/// The placements that are found; where there are none, what was read is said with the error.
fn search(options: &PlaceOptions, run: &Run, terminal: &Terminal) -> Result<Placements, Failure> {
    let search = |monitor: &Monitor| (run.search(monitor), monitor.should_stop());
    let (found, was_stopped) = terminal.on_threads(options.threads, search)?;
    Ok(found.inspect_err(|error| {
        if is_short(options) {
            say_all(run.notes(), run.warnings());
        }
        if let (true, Error::Infeasible(nothing)) = (options.json, error) {
            // What cannot be printed is said as the error all the same.
            let _ = print_json(&run.infeasible_json(nothing));
        }
        if was_stopped {
            say("interrupted: this is what was found so far, not the end of the search");
        }
    })?)
}

/// Whether the result is printed in a few lines.
fn is_short(options: &PlaceOptions) -> bool {
    !options.notes && !options.json
}

pub(super) fn run(options: &PlaceOptions) -> Result<(), Failure> {
    let terminal = Terminal::start(None);
    let run = read(options, &terminal)?;
    let mut out = out_folder(options.out.as_deref(), &options.run.config, &MANUAL)?;
    out.folder = out.folder.keeping_partial(options.keep_partial);
    terminal.holds(&out.folder);
    let is_short = is_short(options);
    if !is_short {
        say_all(run.notes(), run.warnings());
    }
    say_warnings(run.certificate_warning().as_slice());
    say_notes(run.certificate_note().as_slice());

    let mut placements = search(options, &run, &terminal)?;
    let waits = placements.waits_for_certificate(&out.folder)?;
    let (mut written, mut left) = (Ok(()), String::new());
    if waits {
        say(&format!(
            "note: {} has finished results with a certificate; they are replaced when that of this run is done",
            out.folder.path().display()
        ));
    } else {
        (written, left) = write_all(&out.folder, &placements);
    }
    // Text is shown as it comes; in JSON there is one document, shown when the certificate is in it.
    if !options.json {
        let timing = placements.timing();
        let took = format!("{:.1} s on {} threads", timing.wall, timing.threads);
        let folder = if left.is_empty() { String::new() } else { format!("; results in {left}") };
        let text = match is_short {
            true => summary(options, &run, &placements, &left),
            false => format!("{placements}in {took}{folder}\n"),
        };
        written = written.and(print(text.as_bytes()));
    }
    if !is_short {
        // What was read was said before.
        say_notes(placements.notes().get(run.notes().len()..).unwrap_or_default());
        say_warnings(placements.warnings().get(run.warnings().len()..).unwrap_or_default());
    }

    let is_certified = terminal.on_threads(options.threads, |monitor| placements.certify(monitor).is_some())?;
    if is_certified {
        written = written.and(show_certificate(options, &run, &placements, &out.folder, waits));
    }
    if options.json {
        written = written.and(print_json(&placements));
    }
    written?;
    let is_cut_short = placements.certificate().is_some_and(|certificate| certificate.is_interrupted());
    if placements.outcome().interrupted || (waits && is_cut_short) { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Writes the certificate, with all files that have waited for it where they have, and shows it.
fn show_certificate(
    options: &PlaceOptions,
    run: &Run,
    placements: &Placements,
    folder: &Folder,
    waits: bool,
) -> Result<(), Failure> {
    let mut written = match waits {
        true => {
            let (written, left) = write_all(folder, placements);
            written.and(if options.json { Ok(()) } else { print(format!("results in {left}\n").as_bytes()) })
        }
        false => files_written(placements.write_certificate_in(folder)),
    };
    let Some(certificate) = placements.certificate() else { return written };
    // What cannot be certified was said before.
    if run.certificate_warning().is_none() {
        say_warnings(&certificate.warnings);
    }
    if let (false, Some(text)) = (options.json, placements.certificate_text()) {
        written = written.and(print(format!("\n{text}in {:.1} s\n", certificate.wall).as_bytes()));
    }
    written
}

/// The result in a few lines, with what to do next.
fn summary(options: &PlaceOptions, run: &Run, placements: &Placements, left: &str) -> String {
    let mut lines = placements.summary();
    if !run.is_certified() {
        lines.push(summary_line("proof", "none; --certify 1"));
    }
    lines.extend(more(placements.notes().len() + placements.warnings().len(), left));
    let config = options.run.config.display();
    let is_complete = !left.is_empty() && !placements.outcome().interrupted;
    lines.extend(is_complete.then(|| {
        let format = ProgramFormat::of_robot(&run.problem().robot).word();
        summary_line("next", format!("stead export {config} {left}/best.csv --format {format} --out {PROGRAM}"))
    }));
    summary_text(&lines)
}

/// Where the program of the best plan goes, for an example.
const PROGRAM: &str = "prog/PART";

/// Writes all files; returns where they are, nothing where that failed.
fn write_all(folder: &Folder, placements: &Placements) -> (Result<(), Failure>, String) {
    let files = placements.write_in(folder);
    let left = files.as_ref().map(|files| left_in(folder, files).display().to_string()).unwrap_or_default();
    (files_written(files), left)
}
