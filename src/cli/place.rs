//! `stead place`: search, then files, then a table, and then, where it is asked for, a certificate with its own files.

use super::arguments::PlaceOptions;
use super::progress::Terminal;
use super::{Failure, files_written, left_in, on_threads, out_folder, print, print_json, say, say_notes, say_warnings};
use stead::{Error, Folder, Placements, Run};

pub(super) fn run(options: &PlaceOptions) -> Result<(), Failure> {
    let mut run = Run::read_with(&options.config, options.set.clone())?;
    if let Some(gap) = options.certify {
        run = run.with_certificate(gap);
    }
    if let Some(seed) = options.seed {
        run = run.with_seed(seed);
    }
    if options.sensitivity {
        run = run.with_sensitivity(Run::FORCE_ERROR);
    }
    if options.no_worst {
        run = run.without_worst();
    }
    if options.no_page {
        run = run.without_page();
    }
    let mut out = out_folder(options.out.as_deref(), &options.config)?;
    out.folder = out.folder.keeping_partial(options.keep_partial);
    say_notes(run.notes());
    say_warnings(run.certificate_warning().as_slice());

    let terminal = Terminal::start(Some(&out.folder));
    let shown = terminal.show(None);
    let found = on_threads(options.threads, || run.search(&shown.monitor))?;
    let was_stopped = shown.monitor.should_stop();
    drop(shown);
    let mut placements = found.inspect_err(|error| {
        if let (true, Error::Infeasible(nothing)) = (options.json, error) {
            // What cannot be printed is said as the error all the same.
            let _ = print_json(&run.infeasible_json(nothing));
        }
        if was_stopped {
            say("interrupted: this is what was found so far, not the end of the search");
        }
    })?;
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
        let folder = if left.is_empty() { left } else { format!("; results in {left}") };
        let text = format!("{placements}in {:.1} s on {} threads{folder}\n", timing.wall, timing.threads);
        written = written.and(print(text.as_bytes()));
    }
    // What was read was said before.
    say_notes(placements.notes().get(run.notes().len()..).unwrap_or_default());
    say_warnings(placements.warnings());

    let shown = terminal.show(None);
    let is_certified = on_threads(options.threads, || placements.certify(&shown.monitor).is_some())?;
    drop(shown);
    if is_certified {
        written = written.and(match waits {
            true => {
                let (written, left) = write_all(&out.folder, &placements);
                written.and(if options.json { Ok(()) } else { print(format!("results in {left}\n").as_bytes()) })
            }
            false => files_written(placements.write_certificate_in(&out.folder)),
        });
        // What cannot be certified was said before.
        if run.certificate_warning().is_none() {
            say_warnings(placements.certificate().map_or(&[], |certificate| &certificate.warnings));
        }
        if let (false, Some(text), Some(certificate)) =
            (options.json, placements.certificate_text(), placements.certificate())
        {
            written = written.and(print(format!("\n{text}in {:.1} s\n", certificate.wall).as_bytes()));
        }
    }
    if options.json {
        written = written.and(print_json(&placements));
    }
    written?;
    let is_cut_short = placements.certificate().is_some_and(|certificate| certificate.is_interrupted());
    if placements.outcome().interrupted || (waits && is_cut_short) { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Writes all files; returns where they are, nothing where that failed.
fn write_all(folder: &Folder, placements: &Placements) -> (Result<(), Failure>, String) {
    let files = placements.write_in(folder);
    let left = files.as_ref().map(|files| left_in(folder, files).display().to_string()).unwrap_or_default();
    (files_written(files), left)
}
