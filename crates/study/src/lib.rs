//! Use cases that take more than one job: what a run file asks for, done and joined.
//!
//! [`place`] searches for the best and the worst placement and, where the run file has a table `[stability]`, computes
//! the critical depths of cut along both plans; [`score`] does the same for a given placement. [`cases`] does many
//! runs: a study; [`analysis`] says what came out of one. The jobs themselves know nothing of each other.
//!
//! ```
//! use stead_numerics::monitor::Monitor;
//! use stead_problem::problem::Placement;
//! let run = stead_run_files::read_run("../../configs/caro-2013.toml".as_ref())?;
//! // The best placement of results/caro-2013, to the digits that are printed: what it scores with its best plan.
//! let placement = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
//! let scored = stead_study::score(&run, &placement, &Monitor::silent())?;
//! assert!((scored.score.plans.best.mean - 0.1075e-3).abs() < 1e-6);
//! // The run file has no table [stability].
//! assert!(scored.stability.is_none());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod analysis;
pub mod cases;
mod path_stability;
mod run;

pub use path_stability::PathStability;
pub use run::{Placed, RunError, Scored, outside_cell, place, score};
