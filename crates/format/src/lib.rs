//! Files into checked domain objects.
//!
//! A run file (TOML) names a robot file (TOML) and a task file (CSV) and states the spindle, the cell, the constraints
//! and the settings of the search; [`read_run`] reads all three into a [`Run`], which holds a
//! [`Problem`](stead_placement::problem::Problem) that needs no further checks. All fields carry their unit in their
//! name; inside all is SI and radians. Whatever is wrong in a file comes back as an
//! [`InputError`](crate::input::InputError) that names file, line, field, value found and what is allowed.
//!
//! ```
//! use stead_format::read_run;
//! # fn main() -> Result<(), stead_format::input::InputError> {
//! let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
//! let run = read_run(&folder.join("../../configs/caro-2013.toml"))?;
//! assert_eq!(run.problem.robot.name(), "KUKA KR270-2");
//! assert_eq!(run.problem.task.points().len(), 105);
//! # Ok(())
//! # }
//! ```

mod arrays;
mod assess;
mod certificate;
mod compensate;
mod cutting;
mod identify;
mod inertial;
pub mod input;
mod milling;
mod path_stability;
mod points;
mod printed;
pub mod reader;
mod robot;
mod run;
mod sheet;
mod simulation;
pub mod source;
mod tables;
pub mod task;
#[cfg(test)]
mod testing;

pub use assess::{AssessRun, read_assessment};
pub use certificate::GAPS_ALLOWED;
pub use compensate::{CompensateRun, read_compensation};
pub use identify::{IdentifyRun, LocatedError, PlanRun, read_identification, read_plan};
pub use points::{PointFile, read_points};
pub use robot::{covariance, read_robot};
pub use run::{Run, read_run, read_run_to_certify};
pub use simulation::{FASTEST_RPM, MOST_DAMPING_SCALE, Overrides, SimulationRun, read_simulation, read_stability};
