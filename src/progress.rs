//! Progress in words, for terminal and page.

use std::sync::{Mutex, MutexGuard, PoisonError};
use stead_certify::{MAX_GAP_PERCENT, Outlook};
use stead_numerics::monitor::Progress;
use stead_report::units::figures;

/// A report of progress in words.
pub(crate) struct Described {
    /// What is being done.
    pub stage: &'static str,
    /// Done and in all, where that is known.
    pub steps: Option<(usize, usize)>,
    /// What else there is to say.
    pub message: String,
}

impl Described {
    pub fn of(progress: &Progress, outlook: Option<Outlook>) -> Self {
        let (stage, steps, message) = match *progress {
            Progress::Search { stage, done, total, best } => {
                let best = best.map_or("nothing feasible yet".to_owned(), |best| format!("{:.4} mm", best * 1e3));
                (stage, Some((done, total)), best)
            }
            Progress::Steps { stage, done, total } => (stage, Some((done, total)), String::new()),
            Progress::Note { text } => (text, None, String::new()),
            Progress::Bound { stage, nodes: 0, .. } => (stage, None, "tables are being made".to_owned()),
            Progress::Bound { stage, value, bound, gap, open, nodes } => {
                let reached = 100.0 * (1.0 - bound / value).abs();
                let reached = if bound > 0.0 && reached <= MAX_GAP_PERCENT {
                    format!("gap {} %", figures(reached))
                } else {
                    "no gap yet".to_owned()
                };
                let requested = figures(100.0 * gap);
                let outlook = match outlook {
                    Some(Outlook::Reached(left)) => {
                        let [least, most] = left.map(|left| figures(left.as_secs_f64()));
                        let band = if least == most { least } else { format!("{least} to {most}") };
                        format!(", about {band} s to {requested} %")
                    }
                    Some(Outlook::Hardly) => ", hardly closing".to_owned(),
                    None => String::new(),
                };
                (stage, None, format!("{reached} (asked {requested} %), {open} boxes open{outlook}, {nodes} evaluated"))
            }
        };
        Self { stage, steps, message }
    }
}

/// What a mutex guards, whatever became of a thread that held it: progress is worth no failure.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
