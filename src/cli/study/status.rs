//! `stead study status`: how far a study is.

use super::super::values::input_file;
use super::read::{folder, read, say_stale};
use crate::cli::Failure;
use crate::cli::manual::Manual;
use crate::cli::output::{print, print_json, say};
use crate::cli::progress::Terminal;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct StudyStatusOptions {
    /// Study file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Folder of the results [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON document instead of a table
    #[arg(long)]
    pub json: bool,
}

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &[
        "stead study status configs/study-example.toml",
        "stead study status configs/study-example.toml --json",
    ],
    written: "none",
    done: "done, whether or not the study is",
    refused: "wrong usage, bad input, or the folder of another study",
    ..Manual::NEW
};

pub(super) fn run(options: &StudyStatusOptions) -> Result<(), Failure> {
    let study = read(&options.config, None, &Terminal::start(None))?;
    let status = study.status(folder(options.out.as_deref(), &options.config))?;
    if options.json {
        return print_json(&study.status_json(&status));
    }
    for problem in &status.problems {
        say(&format!("warning: {problem}"));
    }
    say_stale(&status);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{} of {} cases done, {} infeasible, {} failed",
        status.done, status.planned, status.infeasible, status.failed
    );
    if !status.shards.is_empty() {
        let _ = writeln!(text, "\n{:>9} {:>8} {:>8} {:>18}  state", "shard", "planned", "done", "without placement");
    }
    for shard in &status.shards {
        let state = match (shard.is_running, shard.done == shard.planned) {
            (true, _) => "running",
            (false, true) => "done",
            (false, false) if shard.done == 0 => "",
            (false, false) => "stopped",
        };
        let name = shard.shard.to_string();
        let _ = writeln!(text, "{name:>9} {:>8} {:>8} {:>18}  {state}", shard.planned, shard.done, shard.without);
    }
    print(text.as_bytes())
}
