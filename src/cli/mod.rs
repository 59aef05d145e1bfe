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
mod environment;
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
mod output;
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
use output::say;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::PathBuf;
use stead_report::output::ReportError;

/// Version, commit, target and profile.
const VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (commit ",
    env!("STEAD_COMMIT"),
    ", ",
    env!("STEAD_TARGET"),
    ", ",
    env!("STEAD_PROFILE"),
    ")"
);

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
    Output(#[from] ReportError),
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
        Command::Completions(options) => completions::run(&options, command()),
        Command::Man(options) => man::run(&options, command()),
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
