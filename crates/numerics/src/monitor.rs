//! The caller's side of a long job: progress comes out, a request to stop goes in.
//!
//! Every job takes one [`Monitor`]. It reports to an observer, asks whether it should stop, and then ends as soon as it
//! has something to return. Monitoring never changes a result, except that a stopped job returns less.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// How far a job has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// One more iteration of a global search is done.
    Search {
        /// What is searched for.
        stage: &'static str,
        /// Iterations done.
        done: usize,
        /// Iterations in all.
        total: usize,
        /// Best objective value so far, in SI units; `None` while nothing feasible was found.
        best: Option<f64>,
    },
    /// Some of a known number of equal steps are done.
    Steps {
        /// What is being done.
        stage: &'static str,
        /// Steps done.
        done: usize,
        /// Steps in all.
        total: usize,
    },
    /// A branch and bound has tightened its bound.
    Bound {
        /// What is bounded.
        stage: &'static str,
        /// The value that the bound is compared with, in SI units.
        value: f64,
        /// The bound so far, in SI units.
        bound: f64,
        /// The relative gap requested.
        gap: f64,
        /// Nodes still open.
        open: usize,
        /// Nodes bounded so far; zero while the bounds are being prepared.
        nodes: usize,
    },
    /// Something is done that the caller should know of, and that changes nothing of the result.
    Note {
        /// What, as a sentence without a full stop.
        text: &'static str,
    },
}

/// Why a job should end early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The caller requested it.
    Asked,
    /// The deadline has passed.
    Deadline,
}

/// As the error of a job that has nothing to return when it is stopped.
impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Asked => "stopped before it was done",
            Self::Deadline => "stopped at its deadline before it was done",
        })
    }
}

impl std::error::Error for Stop {}

/// A flag by which the caller, from any thread or signal handler, asks a job to stop.
#[derive(Debug, Clone, Default)]
pub struct StopHandle(Arc<AtomicBool>);

impl StopHandle {
    /// Asks every job that looks at this flag to stop; says whether it had been asked before.
    pub fn stop(&self) -> bool {
        self.0.swap(true, Ordering::SeqCst)
    }

    /// Whether jobs are asked to stop by it.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// A function that takes reports, from any thread.
type Observer = dyn Fn(&Progress) + Send + Sync;

/// What a job reports to and asks whether to stop. Clones share the observer and the flag.
#[derive(Clone, Default)]
pub struct Monitor {
    observer: Option<Arc<Observer>>,
    stop: StopHandle,
    deadline: Option<Instant>,
    is_unwanted_once_stopped: bool,
}

impl Monitor {
    /// Nobody observes, and nobody stops the job.
    pub fn silent() -> Self {
        Self::default()
    }

    /// Reports to an observer, which is called from several threads.
    pub fn new(observer: impl Fn(&Progress) + Send + Sync + 'static) -> Self {
        Self { observer: Some(Arc::new(observer)), ..Self::default() }
    }

    /// The same, stopped by a flag that exists already.
    pub fn with_stop(self, stop: StopHandle) -> Self {
        Self { stop, ..self }
    }

    /// The same, stopped when a time has come as well.
    pub fn with_deadline(self, deadline: Option<Instant>) -> Self {
        Self { deadline, ..self }
    }

    /// The same for a job of which nothing is wanted once the flag stops it: it ends as soon as it can, also where it
    /// would finish a part otherwise, and what it returns then means nothing.
    pub fn for_all_or_nothing(self) -> Self {
        Self { is_unwanted_once_stopped: true, ..self }
    }

    /// The flag of a job of which nothing is wanted once it is set, otherwise one that nobody sets.
    pub fn unwanted(&self) -> StopHandle {
        if self.is_unwanted_once_stopped { self.stop_handle() } else { StopHandle::default() }
    }

    /// When it is stopped at the latest, where that is limited.
    pub fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// The flag that stops the job.
    pub fn stop_handle(&self) -> StopHandle {
        self.stop.clone()
    }

    /// Takes a report of the job.
    pub fn report(&self, progress: Progress) {
        if let Some(observer) = &self.observer {
            observer(&progress);
        }
    }

    /// Why the job should end as soon as it has something to return, if it should.
    pub fn stop(&self) -> Option<Stop> {
        if self.stop.is_set() {
            Some(Stop::Asked)
        } else if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            Some(Stop::Deadline)
        } else {
            None
        }
    }

    /// For a job that has nothing to return before it is done.
    ///
    /// # Errors
    /// Why it should end.
    pub fn go_on(&self) -> Result<(), Stop> {
        self.stop().map_or(Ok(()), Err)
    }

    /// Whether the job should end as soon as it has something to return.
    pub fn should_stop(&self) -> bool {
        self.stop().is_some()
    }
}

impl fmt::Debug for Monitor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { observer, stop, deadline, is_unwanted_once_stopped } = self;
        f.debug_struct("Monitor")
            .field("is_observed", &observer.is_some())
            .field("stop", stop)
            .field("deadline", deadline)
            .field("is_unwanted_once_stopped", is_unwanted_once_stopped)
            .finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicUsize;

    #[test]
    fn reports_reach_the_observer_and_a_stop_reaches_every_clone() {
        let seen = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&seen);
        let monitor = Monitor::new(move |_| {
            count.fetch_add(1, Ordering::SeqCst);
        });
        let other = monitor.clone();
        other.report(Progress::Steps { stage: "test", done: 1, total: 2 });
        assert_eq!(seen.load(Ordering::SeqCst), 1);
        assert_eq!((other.stop(), other.go_on()), (None, Ok(())));
        assert!(!monitor.stop_handle().stop() && monitor.stop_handle().stop());
        assert_eq!((other.stop(), other.go_on()), (Some(Stop::Asked), Err(Stop::Asked)));
    }

    #[test]
    fn a_deadline_is_told_from_a_request() {
        let late = Monitor::silent().with_deadline(Some(Instant::now()));
        assert_eq!(late.stop(), Some(Stop::Deadline));
        late.stop_handle().stop();
        assert_eq!(late.stop(), Some(Stop::Asked));
        assert!(!Monitor::silent().should_stop());
    }
}
