//! How far a study is.

use super::StudyError;
use super::lock::Lock;
use super::plan::Plan;
use super::row::CaseStatus;
use super::store::{Entries, Shard, Store};
use super::table::TableCell;
use std::path::Path;

/// How far a shard is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShardStatus {
    /// The shard.
    pub shard: Shard,
    /// Its cases.
    pub planned: usize,
    /// Those that are done, by any shard.
    pub done: usize,
    /// Of these, those without a placement.
    pub without: usize,
    /// Whether a process works on it.
    pub is_running: bool,
}

/// How far a study is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StudyStatus {
    /// All cases.
    pub planned: usize,
    /// Those that are done.
    pub done: usize,
    /// Of these, those where no placement satisfies the constraints.
    pub infeasible: usize,
    /// Of these, those that failed.
    pub failed: usize,
    /// The shards that have left anything, and with them all others of as many.
    pub shards: Vec<ShardStatus>,
    /// What is wrong in the folder and will be done again, in sentences.
    pub problems: Vec<String>,
    /// Kept cases that the study as it is now has not, by the names of their folders; filled in by the caller that
    /// keeps cases.
    pub stale: Vec<String>,
}

/// How far a study is in a folder, which need not be there.
///
/// # Errors
/// [`StudyError`]: the folder of another study, or a file that cannot be read.
pub fn status(plan: &Plan, folder: &Path) -> Result<StudyStatus, StudyError> {
    let store = Store::at(folder);
    store.check(plan)?;
    let mut problems = Vec::new();
    let finished = store.finished(&mut problems)?;
    let count = |status: CaseStatus| plan.cases.iter().filter(|case| has(&finished, &case.id, status)).count();
    let mut counts: Vec<usize> = store.found().into_iter().map(|shard| shard.count).collect();
    counts.dedup();
    let shards = counts.into_iter().flat_map(|count| (1..=count).map(move |index| Shard { index, count }));
    let (infeasible, failed) = (count(CaseStatus::Infeasible), count(CaseStatus::Failed));
    Ok(StudyStatus {
        planned: plan.cases.len(),
        done: count(CaseStatus::Placed) + infeasible + failed,
        infeasible,
        failed,
        shards: shards.map(|shard| status_of(plan, &store, &finished, shard)).collect(),
        problems,
        stale: Vec::new(),
    })
}

fn has(finished: &Entries, id: &str, status: CaseStatus) -> bool {
    finished.get(id).is_some_and(|entry| matches!(&entry.row[0], TableCell::Text(word) if word == status.word()))
}

fn status_of(plan: &Plan, store: &Store, finished: &Entries, shard: Shard) -> ShardStatus {
    let mine = || plan.cases.iter().filter(|case| shard.has(case.case.number));
    let without = |id: &str| has(finished, id, CaseStatus::Infeasible) || has(finished, id, CaseStatus::Failed);
    ShardStatus {
        shard,
        planned: mine().count(),
        done: mine().filter(|case| finished.contains_key(&case.id)).count(),
        without: mine().filter(|case| without(&case.id)).count(),
        is_running: Lock::is_held(&store.of_shard(shard, ".lock")),
    }
}
