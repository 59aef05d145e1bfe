//! Where to put the workpiece: the search for the best and the worst placement.
//!
//! - [`lookup`]: scores of upright tools sampled once over the cell; [`evaluator`]: the objective of a placement, by
//!   table or planner.
//! - [`search`]: the global search; [`refine`]: gradients from its basins to the optimum.
//! - [`sensitivity`]: how a result answers to the stiffness of the joints and to errors of the force.
//! - [`setup_sheet`]: what a fitter needs to set a placement up.
//! - [`place`]: the job as a whole; [`outcome`]: what it returns; [`overview`]: what a run states, before any search.
//!
//! The "worst placement" is the one with the largest mean deflection under its best plan.
//!
//! ```
//! use stead_numerics::monitor::Monitor;
//! use stead_placement::place::place;
//! use stead_problem::settings::{SearchSettings, TransferSettings};
//! use stead_problem::testing::five_segments;
//! // The published case with a search that is too small to be trusted, for the best placement alone.
//! let (usual, worst) = (SearchSettings::default(), false);
//! let settings = SearchSettings { population: 16, generations: 3, basins: 1, worst, ..usual };
//! let found = place(&five_segments(), &settings, &TransferSettings::default(), &Monitor::silent())?;
//! let best = &found.cases.best;
//! assert!((best.placement.y + 1.64).abs() < 1e-6 && best.plan.mean < 0.12e-3, "{:?}", best.placement);
//! assert!(found.cases.worst.is_none() && !found.interrupted);
//! # Ok::<(), stead_placement::place::Infeasible>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

mod case;
pub mod coordinate_search;
pub mod evaluator;
pub mod lean_map;
pub mod lookup;
pub mod outcome;
pub mod overview;
pub mod path_comparison;
pub mod path_subset;
pub mod place;
pub mod refine;
pub mod sag;
pub mod search;
pub mod sensitivity;
pub mod setup_sheet;
mod whole_path;
