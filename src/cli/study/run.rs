//! `stead study run`: what is left to do of a study, or of a shard of it.

use super::read::{counted_cases, folder, read, say_stale};
use crate::cli::Failure;
use crate::cli::manual::Manual;
use crate::cli::output::{print, say};
use crate::cli::progress::Terminal;
use crate::cli::values::{input_file, shard, threads};
use clap::Args;
use std::path::PathBuf;
use stead::study::Shard;

#[derive(Debug, Args)]
pub(in crate::cli) struct StudyRunOptions {
    /// Study file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Do part I of N: the cases I, I + N, and so on [default: all]
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub shard: Option<Shard>,
    /// Folder for the results [default: results/<name of the study file>]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads; it does not change the result [default: number of processors]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Remove kept cases that are not of the study as it is now, after an edit of its files
    #[arg(long)]
    pub prune: bool,
}

/// What the help and the guide say of it.
pub(in crate::cli) const MANUAL: Manual = Manual {
    examples: &[
        "stead study run configs/study-example.toml",
        "stead study run configs/study-example.toml --threads 1 --out results/again",
        "stead study run configs/study-example.toml --shard 3/4",
        "stead study run configs/study-example.toml --prune",
    ],
    files: "\
study.csv: one row for each case, once every case is done
study-timing.csv: where and how long each case was computed, and on how many threads
cases/<number>-<digest>/: with keep in the study file: what `stead place` writes
study.json, shards/: what is done so far",
    remarks: "The command may be killed at any moment: the same command continues where it was. After an edit of the \
              study file it does what the edit has changed; kept cases that are not of the study any longer are named, \
              and removed with --prune. Shards may run at the same time, on many machines, in one folder that they \
              share; the last one writes the table. The bytes of study.csv depend on neither threads \
              nor shards.",
    done: "done; cases without a placement are rows with their reason",
    failed: "a file could not be written, or another process works on the shard; finished cases are kept",
    refused: "wrong usage, bad input, or the folder of another study",
    interrupted: "Ctrl-C ended it; finished cases are kept",
    ..Manual::NEW
};

pub(super) fn run(options: &StudyRunOptions) -> Result<(), Failure> {
    let terminal = Terminal::start(None);
    let study = read(&options.config, options.threads, &terminal)?;
    let folder = folder(options.out.as_deref(), &options.config);
    let shard = options.shard.unwrap_or(Shard::WHOLE);
    if options.prune {
        let gone = study.prune(&folder)?;
        say(&format!("note: {} removed that the study has no longer", counted_cases(gone.len())));
    }
    say_stale(&study.status(&folder)?);
    let finished = terminal.on_threads(options.threads, |monitor| study.run(&folder, shard, monitor))??;
    for problem in &finished.problems {
        say(&format!("warning: {problem}"));
    }
    let what = if shard == Shard::WHOLE { "study".to_owned() } else { format!("shard {shard}") };
    let done = finished.before + finished.now;
    let mut text = format!("{what}: {done} of {} cases done, {} of them now", finished.planned, finished.now);
    if finished.is_complete {
        text.push_str(&format!("; results in {}", folder.join("study.csv").display()));
    } else if !finished.interrupted {
        text.push_str("; other shards are not done yet");
    }
    print(format!("{text}\n").as_bytes())?;
    if finished.interrupted {
        say("interrupted: finished cases are kept; the same command continues");
        return Err(Failure::Interrupted);
    }
    Ok(())
}
