//! Jobs of a command: their threads, their progress on standard error, as bars on a terminal and else as a line now and
//! then, and Ctrl-C.

use super::Failure;
use super::output::{say, say_notes};
use crate::progress::{Described, locked};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use stead_certify::{Forecast, Outlook};
use stead_numerics::monitor::{Monitor, Progress, StopHandle};
use stead_report::output::Folder;

/// Between two lines where standard error is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

/// Shows the progress of the jobs of one command, and stops them at Ctrl-C.
pub(super) struct Terminal {
    stop: StopHandle,
    /// The bar that is shown, which a word about Ctrl-C must not tear.
    bar: Arc<Mutex<ProgressBar>>,
    /// The lock file of the folder that the results go to.
    lock: Arc<Mutex<Option<PathBuf>>>,
}

/// A monitor that shows progress on standard error, until it is dropped.
struct Shown {
    /// What the job reports to.
    monitor: Monitor,
    bar: ProgressBar,
    /// What writes lines, where there is no terminal.
    _lines: Option<Lines>,
}

impl Drop for Shown {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Terminal {
    /// Takes over Ctrl-C: the first asks the jobs to stop and keep what they have, the second ends the process and with
    /// it the hold on the folder of the results.
    pub fn start(out: Option<&Folder>) -> Self {
        let bar = Arc::new(Mutex::new(ProgressBar::hidden()));
        let terminal = Self { stop: StopHandle::default(), bar, lock: Arc::default() };
        out.into_iter().for_each(|out| terminal.holds(out));
        let (stop, bar) = (terminal.stop.clone(), Arc::clone(&terminal.bar));
        let lock = Arc::clone(&terminal.lock);
        // Without a handler Ctrl-C simply ends the process, which is no reason not to run.
        let _ = ctrlc::set_handler(move || {
            if stop.stop() {
                // What stays of it would keep nobody out.
                let _ = locked(&lock).as_ref().map(std::fs::remove_file);
                // Nobody is left to return to.
                std::process::exit(130);
            }
            let word = "interrupted: ending with what there is; Ctrl-C again ends at once";
            locked(&bar).suspend(|| say(word));
        });
        #[cfg(all(windows, feature = "live"))]
        stop_at_closing(terminal.stop.clone());
        terminal
    }

    /// States the folder of the results, where it is held later.
    pub fn holds(&self, out: &Folder) {
        *locked(&self.lock) = Some(out.lock_file().to_owned());
    }

    /// Does a job with a monitor that shows its progress until it has ended, and is stopped by Ctrl-C.
    pub fn during<T>(&self, job: impl FnOnce(&Monitor) -> T) -> T {
        job(&self.show().monitor)
    }

    /// Does a job so on so many threads, or on as many as there are processors.
    pub fn on_threads<T, F>(&self, threads: Option<usize>, job: F) -> Result<T, Failure>
    where
        T: Send,
        F: FnOnce(&Monitor) -> T + Send,
    {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
        let pool = pool.map_err(|e| Failure::Job(format!("the threads cannot be started: {e}")))?;
        Ok(self.during(|monitor| pool.install(|| job(monitor))))
    }

    fn show(&self) -> Shown {
        let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr());
        *locked(&self.bar) = bar.clone();
        let (monitor, lines) = if std::io::stderr().is_terminal() {
            let drawn = bar.clone();
            if let Ok(style) = ProgressStyle::with_template(STARTING) {
                bar.set_style(style);
            }
            // Between two reports, and before the first, the time that has passed shows that the job is running.
            bar.enable_steady_tick(TICK);
            let (forecast, started) = (Mutex::<Forecast>::default(), Instant::now());
            let show = move |progress: &Progress| {
                if let Progress::Note { text } = progress {
                    return drawn.suspend(|| say_notes(&[text]));
                }
                let outlook = locked(&forecast).add(progress, started.elapsed());
                draw(&drawn, progress, outlook);
            };
            (Monitor::new(show), None)
        } else {
            let lines = Lines::start(LINE_EVERY, say);
            let (state, started) = (Arc::clone(&lines.state), Instant::now());
            let keep = move |progress: &Progress| {
                if let Progress::Note { text } = progress {
                    return say_notes(&[text]);
                }
                let mut state = locked(&state.0);
                let outlook = state.forecast.add(progress, started.elapsed());
                state.latest = Some((*progress, outlook));
            };
            (Monitor::new(keep), Some(lines))
        };
        Shown { monitor: monitor.with_stop(self.stop.clone()), bar, _lines: lines }
    }
}

/// Stops the jobs where the window is closed or the computer shut down, as the first Ctrl-C does. Windows ends the
/// process some seconds later, whatever it does.
#[cfg(all(windows, feature = "live"))]
fn stop_at_closing(stop: StopHandle) {
    use tokio::signal::windows::{ctrl_close, ctrl_shutdown};
    // The other handler of signals would let the process end at once; this one does not return.
    let (Ok(mut close), Ok(mut shutdown)) = (ctrl_close(), ctrl_shutdown()) else { return };
    let Ok(runtime) = tokio::runtime::Builder::new_current_thread().build() else { return };
    std::thread::spawn(move || {
        runtime.block_on(async {
            tokio::select! { _ = close.recv() => (), _ = shutdown.recv() => () }
        });
        stop.stop();
    });
}

/// A thread that says every now and then how far a job is, until this is dropped.
struct Lines {
    state: Arc<(Mutex<LineState>, Condvar)>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct LineState {
    latest: Option<(Progress, Option<Outlook>)>,
    forecast: Forecast,
    has_ended: bool,
}

impl Lines {
    fn start(every: Duration, say: impl Fn(&str) + Send + 'static) -> Self {
        let state = Arc::<(Mutex<LineState>, Condvar)>::default();
        let shared = Arc::clone(&state);
        let started = Instant::now();
        let work = move || {
            let (state, ended) = &*shared;
            let mut state = locked(state);
            while !state.has_ended {
                let (woken, timeout) = ended.wait_timeout(state, every).unwrap_or_else(PoisonError::into_inner);
                state = woken;
                if timeout.timed_out() && !state.has_ended {
                    say(&line(state.latest.as_ref(), started.elapsed()));
                }
            }
        };
        // Without a thread there are no lines, which is no reason not to run.
        let thread = std::thread::Builder::new().name("progress".to_owned()).spawn(work).ok();
        Self { state, thread }
    }
}

impl Drop for Lines {
    fn drop(&mut self) {
        locked(&self.state.0).has_ended = true;
        self.state.1.notify_all();
        if let Some(thread) = self.thread.take() {
            // A thread that has failed has nothing left to say.
            let _ = thread.join();
        }
    }
}

/// How far a job is, as one line.
fn line(progress: Option<&(Progress, Option<Outlook>)>, elapsed: Duration) -> String {
    let elapsed = format!("{} s", elapsed.as_secs());
    let Some((progress, outlook)) = progress else { return format!("progress: {elapsed}") };
    let Described { stage, steps, message } = Described::of(progress, *outlook);
    let steps = steps.map_or_else(String::new, |(done, total)| format!("{done} of {total}"));
    let parts = [steps, message, elapsed].into_iter().filter(|part| !part.is_empty());
    format!("progress: {stage}: {}", parts.collect::<Vec<_>>().join(", "))
}

/// Between two drawings of a bar.
const TICK: Duration = Duration::from_millis(200);
/// Before a job has said anything.
const STARTING: &str = "        starting {spinner} {elapsed}";
/// For jobs whose number of steps is known, and for those that end when a gap is closed.
const STEPS: &str = "{prefix:>16} [{bar:36}] {pos}/{len}  {msg}  {elapsed}";
const BOUND: &str = "{prefix:>16} {spinner} {msg}  {elapsed}";

fn draw(bar: &ProgressBar, progress: &Progress, outlook: Option<Outlook>) {
    let Described { stage, steps, message } = Described::of(progress, outlook);
    if bar.prefix() != stage {
        let template = if steps.is_some() { STEPS } else { BOUND };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_prefix(stage);
    }
    if let Some((done, total)) = steps {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    }
    bar.set_message(message);
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;

    #[test]
    fn a_line_says_what_is_done_how_far_and_for_how_long() {
        let at = Duration::from_millis(30_400);
        assert_eq!(line(None, at), "progress: 30 s");
        let search = Progress::Search { stage: "best placement", done: 3, total: 51, best: Some(1.075e-4) };
        assert_eq!(line(Some(&(search, None)), at), "progress: best placement: 3 of 51, 0.1075 mm, 30 s");
        let steps = Progress::Steps { stage: "refining", done: 1, total: 8 };
        assert_eq!(line(Some(&(steps, None)), at), "progress: refining: 1 of 8, 30 s");
        let bound =
            Progress::Bound { stage: "certifying best", value: 1.0, bound: 0.95, gap: 0.01, open: 12, nodes: 480 };
        let outlook = Some(Outlook::Reached([40, 90].map(Duration::from_secs)));
        let said = line(Some(&(bound, outlook)), at);
        assert!(said.contains("(asked 1.00 %), 12 boxes open, about 40.0 to 90.0 s to 1.00 %"), "{said}");
    }

    #[test]
    fn lines_come_again_and_again_and_end_with_the_job() {
        let (sender, lines_said) = mpsc::channel();
        let lines = Lines::start(Duration::from_millis(1), move |line| {
            // The test may have gone on.
            let _ = sender.send(line.to_owned());
        });
        locked(&lines.state.0).latest = Some((Progress::Steps { stage: "refining", done: 1, total: 8 }, None));
        let is_told = |line: String| line.starts_with("progress: refining: 1 of 8, ");
        assert!(lines_said.iter().any(is_told) && lines_said.iter().any(is_told));
        drop(lines);
        // The sender is gone with the thread, so that this ends.
        assert!(lines_said.iter().all(is_told));
    }
}
