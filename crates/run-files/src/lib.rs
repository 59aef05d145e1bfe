//! The files that ask for a job, read and checked.
//!
//! A run file (TOML) names a robot file (TOML) and a task file (CSV) and states the spindle, the cell, the constraints
//! and the settings of the search; [`read_run`] reads all three into a [`Run`](stead_runs::Run), which holds a
//! [`Problem`](stead_problem::problem::Problem) that needs no further checks. Files of studies, assessments,
//! identifications and simulations do the same for their jobs; [`schema`] describes all of them.
//!
//! ```
//! use stead_run_files::read_run;
//! # fn main() -> Result<(), stead_disk::input::InputError> {
//! let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
//! let run = read_run(&folder.join("../../configs/caro-2013.toml"))?;
//! assert_eq!(run.problem.robot.name(), "KUKA KR270-2");
//! assert_eq!(run.problem.task.points().len(), 105);
//! # Ok(())
//! # }
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod assess;
pub mod compensate;
pub mod forces;
#[cfg(any(test, feature = "fuzzing"))]
pub mod fuzzing;
mod guesses;
pub mod identify;
pub mod init;
mod kind;
#[cfg(test)]
mod plan_tests;
pub mod published_tables;
pub mod run;
pub mod schema;
mod sheet;
pub mod simulation;
mod stated;
pub mod study;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod whole_arm_tests;

pub use assess::read_assessment;
pub use compensate::read_compensation;
pub use forces::read_forces;
pub use identify::{read_identification, read_plan};
pub use run::{GAPS_ALLOWED, read_run, read_run_with};
pub use simulation::{MAX_DAMPING_SCALE, Overrides, read_simulation, read_stability};
pub use study::read_study;

/// The vocabulary of the words in the files of this crate ([`stead_format::scalars::Words`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vocabulary;

/// One of the words of this crate's files.
pub type Word<T> = stead_format::scalars::Word<T, Vocabulary>;
