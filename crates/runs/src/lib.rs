//! What is asked of a job, read and checked, whatever file it came from, beside what its results cite; and plans and
//! placements of earlier results, which jobs go on from.
//!
//! ```
//! use stead_runs::study::Keep;
//! assert_ne!(Keep::All, Keep::Best(20));
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod assessment;
pub mod compensation;
pub mod forces;
pub mod identification;
mod kept_forces;
mod placed;
pub mod plan;
mod points;
mod read_error;
mod run;
pub mod simulation;
pub mod stated;
pub mod study;

pub use assessment::AssessRun;
pub use compensation::CompensateRun;
pub use forces::ForcesRun;
pub use identification::{IdentifyRun, LocatedError, PlanRun};
pub use kept_forces::KeptForces;
pub use placed::{read_placement_of, read_setup_of, setup_in};
pub use points::{PointFile, read_points};
pub use read_error::ReadError;
pub use run::Run;
pub use simulation::SimulationRun;
