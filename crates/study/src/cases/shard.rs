//! A shard of a study, done: cases side by side, each finished one on the disk before the next is begun.

use super::StudyError;
use super::journal::{Entry, Journal, Timing};
use super::keeping::Keeping;
use super::merge::{best, merge};
use super::plan::{Plan, PlannedCase};
use super::row::{CaseStatus, row_of, row_without};
use super::store::{Shard, Store};
use super::table::TableCell;
use crate::run::{RunError, place};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};
use stead_certify::certify;
use stead_numerics::monitor::{Monitor, Progress};
use stead_runs::ReadError;
use stead_runs::study::Keep;

/// Where and how a shard is done.
#[derive(Clone, Copy)]
pub struct RunSettings<'s> {
    /// The folder of the study.
    pub folder: &'s Path,
    /// The shard.
    pub shard: Shard,
    /// Threads; their number does not change a result.
    pub threads: usize,
    /// Where the files of cases go.
    pub keeping: &'s dyn Keeping,
}

/// How a run of a shard ended.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Finished {
    /// Cases of the shard.
    pub planned: usize,
    /// Of those, cases that had been finished before.
    pub before: usize,
    /// Cases finished now.
    pub now: usize,
    /// Whether the caller stopped it before its end.
    pub interrupted: bool,
    /// Whether every case of the study is done, so that the table of results was written.
    pub is_complete: bool,
    /// What was found wrong in the folder and done again, in sentences.
    pub problems: Vec<String>,
}

/// Does what is left to do of a shard, and writes the table of results once every case of the study is done. A stop
/// that the monitor asks for leaves the finished cases in the journal.
///
/// # Errors
/// [`StudyError`]: the folder of another study, a shard that another process works on, a disk that is full; finished
/// cases are kept.
pub fn run(plan: &Plan, settings: &RunSettings<'_>, monitor: &Monitor) -> Result<Finished, StudyError> {
    let store = Store::at(settings.folder);
    store.begin(plan)?;
    let _lock = store.lock_shard(settings.shard)?;
    let mut finished = Finished::default();
    let known = store.finished(&mut finished.problems)?;
    let mine: Vec<&PlannedCase> = unique(plan.cases.iter().filter(|case| settings.shard.has(case.case.number)));
    finished.planned = mine.len();
    let is_done = |case: &PlannedCase| {
        known.get(&case.id).is_some_and(|entry| {
            plan.study.keep != Keep::All || !is_placed(&entry.row) || settings.keeping.is_kept(case)
        })
    };
    let pending: Vec<&PlannedCase> = mine.iter().copied().filter(|case| !is_done(case)).collect();
    finished.before = mine.len() - pending.len();
    if !pending.is_empty() {
        let whole = store.journal(settings.shard)?.whole;
        let mut journal = Journal::open(&store.of_shard(settings.shard, ".jsonl"), whole)?;
        let is_kept = plan.study.keep == Keep::All;
        side_by_side(plan, &pending, settings, is_kept, monitor, &mut |entry| {
            journal.push(&entry)?;
            finished.now += 1;
            let done = finished.before + finished.now;
            monitor.report(Progress::Steps { stage: "cases", done, total: mine.len() });
            Ok(())
        })?;
    }
    if monitor.should_stop() {
        finished.interrupted = finished.before + finished.now < mine.len();
    }
    if finished.before + finished.now < mine.len() {
        return Ok(finished);
    }
    finished.is_complete = merge(plan, settings.folder, settings.keeping)?;
    if finished.is_complete {
        keep_best(plan, settings, monitor)?;
    }
    Ok(finished)
}

/// The first of all cases with the same digest.
fn unique<'p>(cases: impl Iterator<Item = &'p PlannedCase>) -> Vec<&'p PlannedCase> {
    let mut seen = HashSet::new();
    cases.filter(|case| seen.insert(case.id.as_str())).collect()
}

fn is_placed(row: &[TableCell]) -> bool {
    row.first() == Some(&TableCell::Text(CaseStatus::Placed.word().to_owned()))
}

/// How long a shard waits before it looks again whether another one has done the best cases.
const PAUSE: Duration = Duration::from_millis(100);

/// Places the cases with the smallest objective once more, where their files are to be kept and are not there. Of
/// shards that end at the same time one does so, and the others wait for it: should it be killed, the next one goes on.
fn keep_best(plan: &Plan, settings: &RunSettings<'_>, monitor: &Monitor) -> Result<(), StudyError> {
    let Keep::Best(count) = plan.study.keep else { return Ok(()) };
    let store = Store::at(settings.folder);
    let _lock = loop {
        match store.lock_best() {
            Err(StudyError::Locked { .. }) if !monitor.should_stop() => std::thread::sleep(PAUSE),
            Err(StudyError::Locked { .. }) => return Ok(()),
            lock => break lock?,
        }
    };
    let cases: HashMap<usize, &PlannedCase> = plan.cases.iter().map(|case| (case.case.number, case)).collect();
    let missing: Vec<&PlannedCase> = best(plan, settings.folder, count)?
        .into_iter()
        .filter_map(|number| cases.get(&number).copied())
        .filter(|case| !settings.keeping.is_kept(case))
        .collect();
    let mut done = 0;
    side_by_side(plan, &missing, settings, true, monitor, &mut |_| {
        done += 1;
        monitor.report(Progress::Steps { stage: "best cases", done, total: missing.len() });
        Ok(())
    })
}

/// Does cases, as many at a time as there are threads, and hands each to a function as it is finished.
#[expect(clippy::excessive_nesting, reason = "steps of one search that share what it keeps")]
fn side_by_side(
    plan: &Plan,
    cases: &[&PlannedCase],
    settings: &RunSettings<'_>,
    is_kept: bool,
    monitor: &Monitor,
    take: &mut dyn FnMut(Entry) -> Result<(), StudyError>,
) -> Result<(), StudyError> {
    let workers = settings.threads.min(cases.len()).max(1);
    let threads = (settings.threads / workers).max(1);
    let (next, has_failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    let quiet = Monitor::silent().with_stop(monitor.stop_handle());
    let host = host();
    std::thread::scope(|scope| {
        for _ in 0..workers {
            let (sender, quiet, host, next, has_failed) = (sender.clone(), &quiet, &host, &next, &has_failed);
            scope.spawn(move || {
                let pool = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
                    Ok(pool) => pool,
                    Err(cause) => {
                        // The receiver is there as long as any worker.
                        let _ = sender.send(Err(StudyError::Keep(format!("the threads cannot be started: {cause}"))));
                        return;
                    }
                };
                while !monitor.should_stop() && !has_failed.load(Ordering::SeqCst) {
                    let Some(case) = cases.get(next.fetch_add(1, Ordering::SeqCst)) else { return };
                    let begun = Instant::now();
                    let timing = |seconds| Timing { seconds, threads, host: host.clone() };
                    let done = pool.install(|| do_case(plan, case, is_kept.then_some(settings.keeping), quiet));
                    let seconds = begun.elapsed().as_secs_f64();
                    let row = match done.transpose() {
                        Some(row) => row,
                        None => return,
                    };
                    let id = case.id.clone();
                    let _ = sender.send(row.map(|row| Entry { id, row, timing: timing(seconds) }));
                }
            });
        }
        drop(sender);
        let mut result = Ok(());
        for entry in receiver {
            if result.is_ok() {
                result = entry.and_then(&mut *take);
                has_failed.store(result.is_err(), Ordering::SeqCst);
            }
        }
        result
    })
}

/// Does one case; nothing where it was stopped.
fn do_case(
    plan: &Plan,
    case: &PlannedCase,
    keeping: Option<&dyn Keeping>,
    monitor: &Monitor,
) -> Result<Option<Vec<TableCell>>, StudyError> {
    let mut read = match plan.study.case(&case.case, monitor) {
        Err(ReadError::Stopped(_)) => return Ok(None),
        read => read?.run,
    };
    read.maps &= keeping.is_some();
    let placed = match place(&read, monitor) {
        Err(RunError::Infeasible(nothing)) if nothing.interrupted => return Ok(None),
        Err(error) => return Ok(Some(row_without(&error))),
        Ok(placed) if placed.outcome.interrupted => return Ok(None),
        Ok(placed) => placed,
    };
    let certificate = read.certificate.map(|settings| {
        let cases = &placed.outcome.cases;
        let worst = cases.worst.as_ref().map(|worst| &worst.best.placement);
        certify(&read.problem, &cases.best.placement, cases.best.plan.objective, worst, settings, monitor)
    });
    if monitor.should_stop() {
        return Ok(None);
    }
    let row = row_of(&read.problem, &placed, certificate.as_ref());
    if let Some(keeping) = keeping {
        keeping.keep(case, &read, placed, certificate).map_err(StudyError::Keep)?;
    }
    Ok(Some(row))
}

/// The name of this machine, where it tells.
fn host() -> String {
    let name = std::fs::read_to_string("/proc/sys/kernel/hostname").ok().or_else(|| std::env::var("COMPUTERNAME").ok());
    name.map_or_else(|| "unknown".to_owned(), |name| name.trim().to_owned())
}
