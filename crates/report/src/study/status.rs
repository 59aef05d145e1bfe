//! How far a study is, for programs.

use crate::document::Document;
use serde_json::Value;
use stead_disk::input::InputFile;
use stead_study::cases::{ShardStatus, StudyStatus};

records! {
    /// How far a study is.
    pub struct StatusFigures of (name: &str, status: &StudyStatus) {
        /// Name of the study.
        study: String = name.to_owned(),
        /// Cases planned.
        planned: usize = status.planned,
        /// Cases done.
        done: usize = status.done,
        /// Those where nothing is feasible.
        infeasible: usize = status.infeasible,
        /// Those that failed.
        failed: usize = status.failed,
        /// The shards.
        shards: Vec<ShardFigures> = status.shards.iter().map(ShardFigures::of).collect(),
        /// Kept cases of another plan.
        stale_cases: Vec<String> = status.stale.clone(),
    }

    /// How far a shard is.
    pub struct ShardFigures of (shard: &ShardStatus) {
        /// The shard: `1/4`.
        shard: String = shard.shard.to_string(),
        /// Cases planned.
        planned: usize = shard.planned,
        /// Cases done.
        done: usize = shard.done,
        /// Those without a placement.
        without_placement: usize = shard.without,
        /// Whether a process is at work on it.
        running: bool = shard.is_running,
    }
}

/// What `stead study status --json` prints.
pub fn status_json(name: &str, status: &StudyStatus, inputs: &[InputFile]) -> Value {
    Document::new(inputs).warnings(&status.problems).with(StatusFigures::of(name, status))
}
