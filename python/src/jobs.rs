//! Long jobs: on threads of their own, while the calling thread waits without the global interpreter lock (GIL), hands
//! on the progress and listens to Ctrl-C.

use crate::errors::raised;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use stead::{Error, MAX_THREADS, Monitor, Progress};

/// Between two looks at the progress and at Ctrl-C.
const LOOK_EVERY: Duration = Duration::from_millis(150);

/// How a job is run.
#[derive(FromPyObject)]
pub struct Options {
    /// Called with stage, steps done and steps in all.
    #[pyo3(item)]
    progress: Option<Py<PyAny>>,
    /// Number of threads, or one for each processor.
    #[pyo3(item)]
    threads: Option<usize>,
    /// After so many seconds the job ends with what it has.
    #[pyo3(item)]
    time_limit_s: Option<f64>,
}

/// What the job reported last, until it is taken.
#[derive(Clone, Default)]
struct Latest(Arc<Mutex<Option<Progress>>>);

impl Latest {
    fn put(&self, progress: Progress) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(progress);
    }

    /// Calls a function with what is new.
    fn hand_on(&self, py: Python<'_>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        let latest = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        let (Some(callback), Some(progress)) = (callback, latest) else { return Ok(()) };
        let arguments = match progress {
            Progress::Search { stage, done, total, .. } | Progress::Steps { stage, done, total } => {
                (stage, done, total)
            }
            Progress::Note { text } => (text, 0, 1),
            // The tree still grows, and so does the total.
            Progress::Bound { stage, open, nodes, .. } => (stage, nodes, nodes + open),
        };
        callback.call1(py, arguments).map(|_| ())
    }
}

/// Runs a job that looks at its monitor. Returns its result, and whether Ctrl-C asked it to end before its time. The
/// second Ctrl-C does not wait for the job any more.
///
/// # Errors
/// Those of the job; what the callback raises, for which the job is stopped; `KeyboardInterrupt` at the second Ctrl-C.
pub fn run_stoppable<T: Send + 'static>(
    py: Python<'_>,
    options: &Options,
    job: impl FnOnce(&Monitor) -> T + Send + 'static,
) -> PyResult<(T, bool)> {
    let latest = Latest::default();
    let reports = latest.clone();
    let monitor = Monitor::new(move |progress| reports.put(*progress)).with_deadline(deadline(py, options)?);
    let stop = monitor.stop_handle();
    let results = started(py, options, move || job(&monitor))?;
    let mut raised: Option<PyErr> = None;
    let result = loop {
        if let Some(result) = waited(py, &results)? {
            break result;
        }
        let callback = options.progress.as_ref().filter(|_| raised.is_none());
        if let Err(error) = py.check_signals().and_then(|()| latest.hand_on(py, callback)) {
            if raised.is_some() {
                return Err(error);
            }
            stop.stop();
            raised = Some(error);
        }
    };
    // Ctrl-C may come while the last report is handed on, too: the result is there all the same.
    match raised.or_else(|| latest.hand_on(py, options.progress.as_ref()).err()) {
        None => Ok((result, false)),
        Some(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => Ok((result, true)),
        Some(error) => Err(error),
    }
}

/// The result of a job, once.
type Results<T> = Mutex<Receiver<Result<T, Error>>>;

/// Starts a job in a pool of threads of its own, which no fork and no other job of the process shares.
fn started<T: Send + 'static>(
    py: Python<'_>,
    options: &Options,
    job: impl FnOnce() -> T + Send + 'static,
) -> PyResult<Results<T>> {
    let threads = options.threads;
    if let Some(threads) = threads.filter(|threads| !(1..=MAX_THREADS).contains(threads)) {
        let problem = format!("no such number of threads, found {threads}; allowed: 1 to {MAX_THREADS}");
        return Err(raised(py, Error::Argument(problem)));
    }
    let (sender, results) = channel();
    let on_threads = move || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
        let result = pool.map(|pool| pool.install(job)).map_err(cannot_start);
        // Nobody waits for the result of a job that was left to itself.
        let _ = sender.send(result);
    };
    std::thread::Builder::new().spawn(on_threads).map_err(|error| raised(py, cannot_start(error)))?;
    Ok(Mutex::new(results))
}

fn cannot_start(problem: impl std::fmt::Display) -> Error {
    Error::Failed(format!("the threads cannot be started: {problem}"))
}

/// Waits a moment for the result, without the GIL.
fn waited<T: Send>(py: Python<'_>, results: &Results<T>) -> PyResult<Option<T>> {
    let wait = || results.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK_EVERY);
    match py.detach(wait) {
        Ok(result) => result.map(Some).map_err(|error| raised(py, error)),
        Err(RecvTimeoutError::Timeout) => Ok(None),
        Err(RecvTimeoutError::Disconnected) => {
            Err(raised(py, Error::Failed("the job ended without a result".to_owned())))
        }
    }
}

fn deadline(py: Python<'_>, options: &Options) -> PyResult<Option<Instant>> {
    let Some(limit) = options.time_limit_s else { return Ok(None) };
    match Duration::try_from_secs_f64(limit).ok().and_then(|limit| Instant::now().checked_add(limit)) {
        Some(deadline) => Ok(Some(deadline)),
        None => {
            let problem = format!("no such time limit, found {limit} s; allowed: a number from 0 to 1e9");
            Err(raised(py, Error::Argument(problem)))
        }
    }
}
