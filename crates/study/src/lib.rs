//! Use cases that take more than one job: what a run file asks for, done and joined.
//!
//! [`place`] searches for the best and the worst placement and, where the run file has a table `[stability]`, computes the
//! critical depths of cut along both plans; [`score`] does the same for a given placement. [`cases`] does many runs: a study;
//! [`analysis`] says what came out of one. The jobs themselves know nothing of each other.

pub mod analysis;
pub mod cases;
mod path_stability;
mod run;

pub use path_stability::PathStability;
pub use run::{Placed, RunError, Scored, outside_cell, place, score};
