//! Progress bars on a terminal, and Ctrl-C.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};
use stead_numerics::monitor::{Monitor, Progress, StopHandle};
use stead_placement::certify::MAX_GAP_PERCENT;
use stead_report::units::figures;

/// Shows the progress of the jobs of one command, and stops them at Ctrl-C.
pub(super) struct Terminal {
    stop: StopHandle,
}

/// A monitor that draws on standard error if that is a terminal, until it is dropped.
pub(super) struct Shown {
    /// What the job reports to.
    pub monitor: Monitor,
    bar: ProgressBar,
}

impl Drop for Shown {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

impl Terminal {
    /// Takes over Ctrl-C: the first asks the jobs to stop and keep what they have, the second ends the process.
    pub fn start() -> Self {
        let stop = StopHandle::default();
        let handle = stop.clone();
        // Without a handler Ctrl-C simply ends the process, which is no reason not to run.
        let _ = ctrlc::set_handler(move || {
            if handle.stop() {
                // Nobody is left to return to.
                std::process::exit(130);
            }
        });
        Self { stop }
    }

    /// A monitor of one job, stopped by Ctrl-C, or at a deadline.
    pub fn show(&self, deadline: Option<Instant>) -> Shown {
        let bar = ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr());
        let drawn = bar.clone();
        let monitor = Monitor::new(move |progress| draw(&drawn, progress));
        Shown { monitor: monitor.with_stop(self.stop.clone()).with_deadline(deadline), bar }
    }
}

/// For jobs whose number of steps is known, and for those that end when a gap is closed.
const STEPS: &str = "{prefix:>16} [{bar:36}] {pos}/{len}  {msg}  {elapsed}";
const BOUND: &str = "{prefix:>16} {spinner} {msg}  {elapsed}";

fn draw(bar: &ProgressBar, progress: &Progress) {
    let (template, stage, steps, message) = match *progress {
        Progress::Search { stage, done, total, best } => {
            let best = best.map_or("nothing feasible yet".to_owned(), |best| format!("{:.4} mm", best * 1e3));
            (STEPS, stage, Some((done, total)), best)
        }
        Progress::Steps { stage, done, total } => (STEPS, stage, Some((done, total)), String::new()),
        Progress::Bound { stage, nodes: 0, .. } => (BOUND, stage, None, "tables are being made".to_owned()),
        Progress::Bound { stage, value, bound, gap, open, nodes } => {
            let reached = 100.0 * (1.0 - bound / value).abs();
            let reached = if bound > 0.0 && reached <= MAX_GAP_PERCENT {
                format!("gap {} %", figures(reached))
            } else {
                "no gap yet".to_owned()
            };
            let asked = figures(100.0 * gap);
            (BOUND, stage, None, format!("{reached} (asked {asked} %), {open} boxes open, {nodes} evaluated"))
        }
    };
    if bar.prefix() != stage {
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.set_prefix(stage);
        if steps.is_none() {
            bar.enable_steady_tick(Duration::from_millis(200));
        }
    }
    if let Some((done, total)) = steps {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
    }
    bar.set_message(message);
}
