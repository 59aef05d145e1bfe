//! How a long job talks to its caller: progress out, a wish to stop in.

use super::outcome::{Generation, Goal};

/// What a job reports while it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// A generation of a genetic search is done.
    Generation {
        /// Its figures.
        generation: Generation,
        /// Generations in all.
        of: usize,
    },
    /// A basin has been refined.
    Refined {
        /// Which search.
        goal: Goal,
        /// Basins refined so far.
        done: usize,
        /// Basins in all.
        of: usize,
    },
    /// The final plans and maps are being made.
    Finishing,
}

/// The caller's side of a job. Called from several threads.
pub trait Control: Sync {
    /// Takes a report.
    fn report(&self, _progress: Progress) {}

    /// Whether the job should end as soon as it has something to return.
    fn should_stop(&self) -> bool {
        false
    }
}

/// Nobody is watching: the job runs to its end.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Control for Unwatched {}
