//! The command line: one file per subcommand, no physics.
//!
//! Tables for people, or with `--json` one JSON document, go to standard output; progress and diagnostics to standard
//! error, progress bars only to a terminal. Exit code 0: done. 1: the job failed, or nothing is feasible. 2: wrong usage or
//! bad input.

mod arguments;
mod assess;
mod certify;
mod circularity;
mod compensate;
mod completions;
mod explain;
mod help;
mod identify;
mod man;
mod place;
mod progress;
mod score;
mod simulate;
mod stability;

use arguments::{Arguments, Command};
use clap::FromArgMatches;
use serde_json::Value;
use std::io::Write;
use std::path::{Display, Path};
use std::process::ExitCode;
use stead_assessment::comparison::AssessError;
use stead_calibration::compensation::NotCompensated;
use stead_format::input::InputError;
use stead_placement::place::Infeasible;
use stead_report::document;
use stead_report::output::{Folder, ReportError};

/// Why a command ends without its result.
#[derive(Debug, thiserror::Error)]
enum Failure {
    /// Something in a file is wrong.
    #[error("{0}")]
    Input(#[from] InputError),
    /// Something on the command line is wrong beyond what the parser sees.
    #[error("{0}")]
    Usage(String),
    /// A place to write to is wrong.
    #[error("{0}")]
    Output(ReportError),
    /// No placement is feasible.
    #[error("{0}")]
    Nothing(#[from] Infeasible),
    /// No robot can mill the benchmark, or nobody wants to know any more.
    #[error("{0}")]
    Assessment(#[from] AssessError),
    /// Some points of a path cannot be compensated.
    #[error("{0}")]
    NotCompensated(#[from] NotCompensated),
    /// The job itself failed.
    #[error("{0}")]
    Job(String),
}

impl Failure {
    fn exit_code(&self) -> u8 {
        match self {
            Failure::Input(_) | Failure::Usage(_) | Failure::Output(_) => 2,
            Failure::Nothing(_) | Failure::Assessment(_) | Failure::NotCompensated(_) | Failure::Job(_) => 1,
        }
    }
}

/// Parses the command line, runs the command, and says how it went.
pub fn main() -> ExitCode {
    let arguments = Arguments::from_arg_matches(&help::command().get_matches()).unwrap_or_else(|error| error.exit());
    let result = match arguments.command {
        Command::Place(options) => place::run(&options),
        Command::Score(options) => score::run(&options),
        Command::Explain(options) => explain::run(&options),
        Command::Assess(options) => assess::run(&options),
        Command::Compensate(options) => compensate::run(&options),
        Command::Identify(command) => identify::run(&command),
        Command::Circularity(options) => circularity::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Stability(options) => stability::run(&options),
        Command::Completions(options) => completions::run(&options),
        Command::Man(options) => man::run(&options),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(&format!("error: {failure}"));
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Writes to standard output. A reader that has gone away is no error: there is nobody left to tell.
fn print(text: &[u8]) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text).and_then(|()| out.flush());
}

/// Writes a line to standard error.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Runs a job on so many threads, or on as many as there are processors.
fn on_threads<T: Send>(threads: Option<usize>, job: impl FnOnce() -> T + Send) -> Result<(T, usize), Failure> {
    let mut builder = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = threads {
        builder = builder.num_threads(threads);
    }
    let pool = builder.build().map_err(|e| Failure::Job(format!("the threads cannot be started: {e}")))?;
    Ok((pool.install(job), pool.current_num_threads()))
}

/// Whether the files of a job that is done could be written.
fn files_written<T>(written: Result<T, ReportError>) -> Result<(), Failure> {
    written.map(|_| ()).map_err(|e| Failure::Job(e.to_string()))
}

/// The folder that results go to.
struct OutFolder {
    folder: Folder,
    is_new: bool,
}

impl OutFolder {
    /// Removes a folder that this run has made and put nothing into.
    fn give_up(&self) {
        if self.is_new {
            // Goes only if it is empty, as it should be.
            let _ = std::fs::remove_dir(self.folder.path());
        }
    }

    /// Shows a result, as a JSON document or as text with what `where_to` says of the folder that its files are in; only then
    /// says what went wrong with the files: whatever happened to them, the result of a long job is shown.
    fn show<'a, T>(
        &'a self,
        written: Result<T, ReportError>,
        is_json: bool,
        document: impl FnOnce() -> Value,
        where_to: impl FnOnce(Display<'a>) -> String,
        text: impl FnOnce(String) -> String,
    ) -> Result<(), Failure> {
        if !is_json {
            return self.tell(written, where_to, text);
        }
        print(&document::bytes(&document()));
        files_written(written)
    }

    /// Shows a result as text, as [`OutFolder::show`] does.
    fn tell<'a, T>(
        &'a self,
        written: Result<T, ReportError>,
        where_to: impl FnOnce(Display<'a>) -> String,
        text: impl FnOnce(String) -> String,
    ) -> Result<(), Failure> {
        let where_to = written.as_ref().map_or_else(|_| String::new(), |_| where_to(self.folder.path().display()));
        print(text(where_to).as_bytes());
        files_written(written)
    }
}

/// The folder asked for, or `results/` and the name of the config; tried before the long work, so that one that cannot be
/// written to is found out now.
fn out_folder(asked: Option<&Path>, config: &Path) -> Result<OutFolder, Failure> {
    out_folder_named(asked, config, "")
}

/// As [`out_folder`], with an ending to the name, for a command that shares its config with another.
fn out_folder_named(asked: Option<&Path>, config: &Path, ending: &str) -> Result<OutFolder, Failure> {
    let mut name = config.file_stem().unwrap_or_default().to_owned();
    name.push(ending);
    let path = asked.map_or_else(|| Path::new("results").join(name), Path::to_owned);
    let is_new = !path.exists();
    Ok(OutFolder { folder: Folder::create(&path).map_err(Failure::Output)?, is_new })
}
