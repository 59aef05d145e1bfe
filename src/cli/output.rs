//! Words of a command: its result to standard output, notes and warnings to standard error, and the folder of its
//! results.

use super::Failure;
use super::manual::Manual;
use serde::Serialize;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use stead::monitor::Warning;
use stead::report::{NOTES, SummaryLine, summary_line};
use stead_report::document;
use stead_report::output::Folder;

/// Writes to standard output. A reader that has gone away is no error: there is nobody left to tell. A disk that is
/// full is one.
pub(super) fn print(text: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Job(format!("the result cannot be written to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error.
pub(super) fn say(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Says what the user should know about the input.
pub(super) fn say_notes(notes: &[impl Display]) {
    notes.iter().for_each(|note| say(&format!("note: {note}")));
}

/// Says why a result may not be what was wanted.
pub(super) fn say_warnings(warnings: &[Warning]) {
    warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
}

/// Says both.
pub(super) fn say_all(notes: &[impl Display], warnings: &[Warning]) {
    say_notes(notes);
    say_warnings(warnings);
}

/// The line of a summary on what else is said, and where.
pub(super) fn more(count: usize, folder: &str) -> Option<SummaryLine> {
    let text = match (count, folder) {
        (0, "") => return None,
        (0, folder) => format!("{folder}/{NOTES}"),
        (count, "") => format!("{count} notes: --notes"),
        (count, folder) => format!("{count} notes: {folder}/{NOTES}, --notes"),
    };
    Some(summary_line("more", text))
}

/// The folder that results go to, held for this run.
pub(super) struct OutFolder {
    pub folder: Folder,
    /// Dropped after the folder, whose lock file is gone then.
    _made: Option<MadeFolder>,
}

/// A folder that this run has made: removed in the end, if nothing has come into it.
struct MadeFolder(PathBuf);

impl Drop for MadeFolder {
    fn drop(&mut self) {
        // Goes only if it is empty.
        let _ = std::fs::remove_dir(&self.0);
    }
}

impl OutFolder {
    /// Where it is, for people.
    pub fn shown(&self) -> String {
        self.folder.path().display().to_string()
    }

    /// Writes the files of a result and shows it, as a JSON document or as text with what `ending` says of the folder
    /// that its files are in; only then says what went wrong with the files: whatever happened to them, the result of a
    /// long job is shown.
    pub fn show<T>(
        &self,
        written: Result<T, stead::Error>,
        result: &(impl Serialize + Display),
        is_json: bool,
        ending: impl FnOnce(String) -> String,
    ) -> Result<(), Failure> {
        let printed = if is_json {
            print_json(result)
        } else {
            let place = written.as_ref().map_or_else(|_| String::new(), |_| self.shown());
            print(format!("{result}{}", ending(place)).as_bytes())
        };
        files_written(written).and(printed)
    }
}

/// Says that a run that was interrupted has left its results beside finished ones, where that is so; returns the folder
/// that they are in.
pub(super) fn left_in(requested: &Folder, written: &[PathBuf]) -> PathBuf {
    let folder = written.first().and_then(|file| file.parent()).unwrap_or(requested.path());
    if folder != requested.path() {
        let (kept, left) = (requested.path().display(), folder.display());
        say(&format!(
            "note: {kept} has finished results and is left as it is; those of this run are in {left} (--keep-partial puts them in their place)"
        ));
    }
    folder.to_owned()
}

/// Whether the files of a job that is done could be written.
pub(super) fn files_written<T>(written: Result<T, impl Display>) -> Result<(), Failure> {
    written.map(|_| ()).map_err(|e| Failure::Job(e.to_string()))
}

/// Prints a result as one JSON document.
pub(super) fn print_json(result: &impl Serialize) -> Result<(), Failure> {
    let document = serde_json::to_value(result).map_err(|e| Failure::Job(e.to_string()))?;
    print(&document::bytes(&document))
}

/// Prints a result, as one JSON document or as text.
pub(super) fn show(result: &(impl Serialize + Display), is_json: bool) -> Result<(), Failure> {
    if is_json { print_json(result) } else { print(result.to_string().as_bytes()) }
}

/// Where results are, as the last line of a text, where they could be written.
pub(super) fn results_in(folder: String) -> String {
    if folder.is_empty() { folder } else { format!("\nresults in {folder}\n") }
}

/// The folder requested, or `results/` and the name of the config; taken before the long work, so that one that cannot
/// be written to is found out now, and that no other run takes it.
pub(super) fn out_folder(requested: Option<&Path>, config: &Path, manual: &Manual) -> Result<OutFolder, Failure> {
    out_folder_named(requested, config, "", manual)
}

/// As [`out_folder`], with an ending to the name, for a command that shares its config with another.
pub(super) fn out_folder_named(
    requested: Option<&Path>,
    config: &Path,
    ending: &str,
    manual: &Manual,
) -> Result<OutFolder, Failure> {
    let mut name = config.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    let path = requested.map_or_else(|| Path::new("results").join(name), Path::to_owned);
    let is_new = !path.exists();
    let folder = Folder::create(&path)?;
    folder.has_no_other(manual.file_names())?;
    Ok(OutFolder { folder, _made: is_new.then_some(MadeFolder(path)) })
}
