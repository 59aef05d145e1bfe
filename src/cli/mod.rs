//! The command line: one file per subcommand, no physics.
//!
//! Tables for people, or with `--json` one JSON document, go to standard output; progress and diagnostics to standard
//! error, progress bars only to a terminal and else as a line now and then. Exit code 0: done. 1: the job failed, or
//! nothing is feasible. 2: wrong usage or bad input. 130: Ctrl-C ended it early.

mod arguments;
mod assess;
mod check;
mod circularity;
mod compensate;
mod completions;
mod explain;
mod export;
mod forces;
mod given;
mod identify;
mod import;
mod init;
#[cfg(feature = "live")]
mod live;
mod man;
mod manual;
mod manuals;
mod page;
mod place;
mod pose;
mod progress;
mod robots;
mod schema;
mod score;
mod simulate;
mod stability;
mod study;
mod values;

use arguments::{Arguments, Command};
use clap::error::ContextKind;
use clap::{CommandFactory, FromArgMatches};
use manual::Manual;
use serde::Serialize;
use std::ffi::OsString;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use stead::monitor::Warning;
use stead::report::{NOTES, SummaryLine, summary_line};
use stead_report::document;
use stead_report::output::{Folder, ReportError};

/// Why a command ends without its result.
#[derive(Debug, thiserror::Error)]
enum Failure {
    /// Something in a file is wrong, or the job failed.
    #[error("{0}")]
    Stead(#[from] stead::Error),
    /// Something on the command line is wrong beyond what the parser sees.
    #[error("{0}")]
    Usage(String),
    /// A place to write to is wrong.
    #[error("{0}")]
    Output(ReportError),
    /// Ctrl-C ended the job early; what it had by then is shown, and that it was interrupted is said.
    #[error("interrupted")]
    Interrupted,
    /// A file could not be written, or the threads not be started.
    #[error("{0}")]
    Job(String),
}

impl Failure {
    fn exit_code(&self) -> u8 {
        match self {
            // It is no wrong folder, only a wrong time, or a disk without room.
            Failure::Output(error) if matches!(error, ReportError::Locked { .. }) || error.is_of_disk() => 1,
            Failure::Usage(_) | Failure::Output(_) => 2,
            Failure::Stead(error) if error.is_bad_input() => 2,
            Failure::Stead(error) if error.is_interrupted() => 130,
            Failure::Interrupted => 130,
            Failure::Stead(_) | Failure::Job(_) => 1,
        }
    }

    /// An error at an option, which is named where the error does not say it.
    fn at(option: &str, error: stead::Error) -> Self {
        match error {
            stead::Error::Argument(problem) => Failure::Usage(format!("{option}: {problem}")),
            error => Failure::Stead(error),
        }
    }
}

/// The command line with its overview. Every command is described by its own one-line summary.
fn command() -> clap::Command {
    let command = manuals::documented(Arguments::command(), "");
    let overview = manuals::overview(&command);
    // The texts are laid out by hand: no wrapping.
    command.term_width(0).help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{overview}Options:\n{{options}}{{after-help}}"
    ))
}

/// Parses a command line, the first argument of which is the program itself, runs the command, says how it went, and
/// returns the exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    outlive_file_limits();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let program = arguments.first().map(PathBuf::from).unwrap_or_default();
    let matches = command().try_get_matches_from(arguments);
    let arguments = match matches.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => arguments,
        Err(shown) => return show_usage(&shown),
    };
    let result = match arguments.command {
        Command::Place(options) => place::run(&options),
        Command::Score(options) => score::run(&options),
        Command::Explain(options) => explain::run(&options),
        Command::Export(options) => export::run(&options),
        #[cfg(feature = "live")]
        Command::Live(options) => live::run(&options),
        Command::Page(options) => page::run(&options),
        Command::Study(command) => study::run(&command, &program),
        Command::Assess(options) => assess::run(&options),
        Command::Compensate(options) => compensate::run(&options),
        Command::Forces(options) => forces::run(&options),
        Command::Identify(command) => identify::run(&command),
        Command::Circularity(options) => circularity::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Stability(options) => stability::run(&options),
        Command::Check(options) => check::run(&options),
        Command::Pose(options) => pose::run(&options),
        Command::Robots(options) => robots::run(&options),
        Command::Import(command) => import::run(&command),
        Command::Init(options) => init::run(&options),
        Command::Schema(options) => schema::run(&options),
        Command::Completions(options) => completions::run(&options),
        Command::Man(options) => man::run(&options),
    };
    match result {
        Ok(()) => 0,
        Err(failure @ Failure::Interrupted) => failure.exit_code(),
        Err(failure) => {
            say(&format!("error: {failure}"));
            failure.exit_code()
        }
    }
}

/// A limit on the size of files is a disk that is full, and no reason to die in mid-write, which the signal that comes
/// with it would be.
fn outlive_file_limits() {
    #[cfg(unix)]
    // Where it cannot be caught, the limit is as deadly as before. Nobody looks whether it came: the write itself
    // fails.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
}

/// Options that were taken away, and what does instead.
const GONE: [(&str, &str); 1] =
    [("--fast", "nothing in its place: a pass is simulated with the whole arm, in some tenths of a second")];

/// Shows the help or the version that was requested, or what is wrong with the command line.
fn show_usage(shown: &clap::Error) -> u8 {
    let code = u8::try_from(shown.exit_code()).unwrap_or(2);
    let unknown = shown.get(ContextKind::InvalidArg).map(ToString::to_string);
    if let Some((option, instead)) = GONE.iter().find(|(option, _)| unknown.as_deref() == Some(option)) {
        say(&format!("error: {option}: there is no such option any more; allowed: {instead}"));
        return code;
    }
    match shown.print() {
        Err(error) if code == 0 && error.kind() != ErrorKind::BrokenPipe => {
            say(&format!("error: the result cannot be written to standard output: {error}"));
            1
        }
        _ => code,
    }
}

/// Writes to standard output. A reader that has gone away is no error: there is nobody left to tell. A disk that is
/// full is one.
fn print(text: &[u8]) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Job(format!("the result cannot be written to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a line to standard error.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Says what the user should know about the input.
fn say_notes(notes: &[impl Display]) {
    notes.iter().for_each(|note| say(&format!("note: {note}")));
}

/// Says why a result may not be what was wanted.
fn say_warnings(warnings: &[Warning]) {
    warnings.iter().for_each(|warning| say(&format!("warning: {warning}")));
}

/// The line of a summary on what else is said, and where.
fn more(count: usize, folder: &str) -> Option<SummaryLine> {
    let text = match (count, folder) {
        (0, "") => return None,
        (0, folder) => format!("{folder}/{NOTES}"),
        (count, "") => format!("{count} notes: --notes"),
        (count, folder) => format!("{count} notes: {folder}/{NOTES}, --notes"),
    };
    Some(summary_line("more", text))
}

/// Runs a job on so many threads, or on as many as there are processors.
fn on_threads<T: Send>(threads: Option<usize>, job: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let mut builder = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = threads {
        builder = builder.num_threads(threads);
    }
    let pool = builder.build().map_err(|e| Failure::Job(format!("the threads cannot be started: {e}")))?;
    Ok(pool.install(job))
}

/// The folder that results go to, held for this run.
struct OutFolder {
    folder: Folder,
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
    fn shown(&self) -> String {
        self.folder.path().display().to_string()
    }

    /// Writes the files of a result and shows it, as a JSON document or as text with what `ending` says of the folder
    /// that its files are in; only then says what went wrong with the files: whatever happened to them, the result of a
    /// long job is shown.
    fn show<T>(
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
fn left_in(requested: &Folder, written: &[PathBuf]) -> PathBuf {
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
fn files_written<T>(written: Result<T, impl Display>) -> Result<(), Failure> {
    written.map(|_| ()).map_err(|e| Failure::Job(e.to_string()))
}

/// Prints a result as one JSON document.
fn print_json(result: &impl Serialize) -> Result<(), Failure> {
    let document = serde_json::to_value(result).map_err(|e| Failure::Job(e.to_string()))?;
    print(&document::bytes(&document))
}

/// Prints a result, as one JSON document or as text.
fn show(result: &(impl Serialize + Display), is_json: bool) -> Result<(), Failure> {
    if is_json { print_json(result) } else { print(result.to_string().as_bytes()) }
}

/// Where results are, as the last line of a text, where they could be written.
fn results_in(folder: String) -> String {
    if folder.is_empty() { folder } else { format!("\nresults in {folder}\n") }
}

/// The folder requested, or `results/` and the name of the config; taken before the long work, so that one that cannot
/// be written to is found out now, and that no other run takes it.
fn out_folder(requested: Option<&Path>, config: &Path, manual: &Manual) -> Result<OutFolder, Failure> {
    out_folder_named(requested, config, "", manual)
}

/// As [`out_folder`], with an ending to the name, for a command that shares its config with another.
fn out_folder_named(
    requested: Option<&Path>,
    config: &Path,
    ending: &str,
    manual: &Manual,
) -> Result<OutFolder, Failure> {
    let mut name = config.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    let path = requested.map_or_else(|| Path::new("results").join(name), Path::to_owned);
    let is_new = !path.exists();
    let folder = Folder::create(&path).map_err(Failure::Output)?;
    folder.has_no_other(manual.file_names()).map_err(Failure::Output)?;
    Ok(OutFolder { folder, _made: is_new.then_some(MadeFolder(path)) })
}
