//! `stead study run`: what is left to do of a study, or of a shard of it.

use super::{counted_cases, folder, say_stale};
use crate::cli::arguments::StudyRunOptions;
use crate::cli::progress::Terminal;
use crate::cli::{Failure, on_threads, print, say};
use stead::{Shard, Study};

pub(super) fn run(options: &StudyRunOptions) -> Result<(), Failure> {
    let study = on_threads(options.threads, || Study::read(&options.config))??;
    let folder = folder(options.out.as_deref(), &options.config);
    let shard = options.shard.unwrap_or(Shard::WHOLE);
    if options.prune {
        let gone = study.prune(&folder)?;
        say(&format!("note: {} removed that the study has no longer", counted_cases(gone.len())));
    }
    say_stale(&study.status(&folder)?);
    let shown = Terminal::start(None).show(None);
    let finished = on_threads(options.threads, || study.run(&folder, shard, &shown.monitor))?;
    drop(shown);
    let finished = finished?;
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
        say("interrupted: finished cases are kept; the same command goes on");
        return Err(Failure::Interrupted);
    }
    Ok(())
}
