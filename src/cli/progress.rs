//! Progress bars on a terminal, and Ctrl-C.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use stead_placement::certify;
use stead_placement::control::{Control, Progress};
use stead_placement::outcome::Goal;
use stead_report::certificate::{Ended, MOST_GAP_PERCENT};
use stead_report::units::figures;

/// Watches a placement job: draws its progress if standard error is a terminal, and stops it at Ctrl-C.
pub(super) struct Watcher {
    bar: ProgressBar,
    stop: Arc<AtomicBool>,
}

impl Watcher {
    /// Takes over Ctrl-C: the first asks the job to stop and keep what it has, the second ends the process.
    pub fn start() -> Self {
        Self { bar: bar(), stop: ctrl_c() }
    }

    /// Clears the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Draws how a certificate closes, and stops it at the same Ctrl-C, or at a deadline.
    pub fn closing(&self, goal: Goal, value: f64, gap: f64, deadline: Option<Instant>) -> Closing {
        let name = match goal {
            Goal::Best => "certifying best",
            Goal::Worst => "certifying worst",
        };
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{prefix:>16} {spinner} {msg}  {elapsed}") {
            bar.set_style(style);
        }
        bar.set_prefix(name);
        bar.set_message("tables are being made");
        bar.enable_steady_tick(Duration::from_millis(200));
        Closing { bar, stop: Arc::clone(&self.stop), deadline, value, gap, ended_by: None }
    }

    fn show(&self, prefix: &'static str, done: usize, of: usize, message: String) {
        self.bar.set_prefix(prefix);
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
        self.bar.set_message(message);
    }
}

/// A bar that draws nothing when standard error is not a terminal.
fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{prefix:>16} [{bar:36}] {pos}/{len}  {msg}  {elapsed}") {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

/// A flag that the first Ctrl-C sets; the second ends the process.
fn ctrl_c() -> Arc<AtomicBool> {
    let stop = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&stop);
    // Without a handler Ctrl-C simply ends the process, which is no reason not to run.
    let _ = ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::SeqCst) {
            // Nobody is left to return to.
            std::process::exit(130);
        }
    });
    stop
}

/// Draws the progress of a job that goes on in even steps, and stops it at Ctrl-C.
pub(super) struct Steps {
    bar: ProgressBar,
    stop: Arc<AtomicBool>,
}

impl Steps {
    /// Starts the bar and takes over Ctrl-C: the first stops the job, but not the writing of its results; the second ends the
    /// process.
    pub fn start(name: &'static str) -> Self {
        let bar = bar();
        bar.set_prefix(name);
        Self { bar, stop: ctrl_c() }
    }

    /// So many steps are done; says whether to go on.
    pub fn show(&self, done: usize, of: usize) -> bool {
        self.bar.set_length(of as u64);
        self.bar.set_position(done as u64);
        !self.stop.load(Ordering::SeqCst)
    }

    /// Clears the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Draws how a certificate closes, and stops it.
pub(super) struct Closing {
    bar: ProgressBar,
    stop: Arc<AtomicBool>,
    deadline: Option<Instant>,
    /// What is compared with. m
    value: f64,
    /// The gap asked for, relative.
    gap: f64,
    ended_by: Option<Ended>,
}

impl Closing {
    /// Clears the bar, and says why the search ended.
    pub fn finish(self, end: certify::End) -> Ended {
        self.bar.finish_and_clear();
        match end {
            certify::End::Reached => Ended::Reached,
            certify::End::Exhausted => Ended::Exhausted,
            certify::End::Stopped => self.ended_by.unwrap_or(Ended::Interrupted),
        }
    }
}

impl certify::Watch for Closing {
    fn goes_on(&mut self, state: &certify::State) -> bool {
        let certify::State { bound, open, nodes, .. } = *state;
        let asked = figures(100.0 * self.gap);
        let gap = 100.0 * (1.0 - bound / self.value).abs();
        let gap = if bound > 0.0 && gap <= MOST_GAP_PERCENT {
            format!("gap {} %", figures(gap))
        } else {
            "no gap yet".to_owned()
        };
        self.bar.set_message(format!("{gap} (asked {asked} %), {open} boxes open, {nodes} looked at"));
        self.ended_by = if self.stop.load(Ordering::SeqCst) {
            Some(Ended::Interrupted)
        } else if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            Some(Ended::TimeLimit)
        } else {
            None
        };
        self.ended_by.is_none()
    }
}

impl Control for Watcher {
    fn report(&self, progress: Progress) {
        match progress {
            Progress::Generation { generation, of } => {
                let best = generation.best.map_or("nothing feasible yet".to_owned(), |m| format!("{:.4} mm", m * 1e3));
                let prefix = match generation.goal {
                    Goal::Best => "best placement",
                    Goal::Worst => "worst placement",
                };
                self.show(prefix, generation.generation, of, best);
            }
            Progress::Refined { done, of, .. } => self.show("refining", done, of, String::new()),
            Progress::Finishing => self.show("plans and maps", 0, 1, String::new()),
        }
    }

    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }
}
