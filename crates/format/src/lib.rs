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

pub mod assess;
pub mod cam;
pub mod catalogue;
pub mod compensate;
mod deserialize;
pub mod document;
pub mod field;
mod file_kind;
pub mod files;
#[cfg(any(test, feature = "fuzzing"))]
pub mod fuzzing;
pub mod identify;
pub mod inertial;
pub mod init;
pub mod input;
pub mod manifest;
pub mod mesh;
pub mod mount;
pub mod orientation;
pub mod place;
mod placed;
mod plan;
mod points;
pub mod program;
pub mod published_tables;
pub mod quantity;
mod quote;
pub mod robot;
pub mod run;
pub mod scalars;
pub mod schema;
pub mod shapes;
mod sheet;
mod shipped;
pub mod simulation;
mod sources;
pub mod spindle;
mod stated;
pub mod study;
pub mod surroundings;
pub mod task;
#[cfg(test)]
mod testing;
pub mod toml_file;
pub mod tool;
pub mod units;
pub mod urdf;

pub use assess::{AssessRun, read_assessment};
pub use compensate::{CompensateRun, read_compensation};
pub use files::new::Existing;
pub use identify::{IdentifyRun, LocatedError, PlanRun, read_identification, read_plan};
pub use placed::{read_placement_of, read_setup_of};
pub use points::{PointFile, read_points};
pub use robot::{covariance, read_geometry, read_robot};
pub use run::{GAPS_ALLOWED, Run, read_run, read_run_to_certify, read_run_with};
pub use simulation::{MAX_DAMPING_SCALE, Overrides, SimulationRun, read_simulation, read_stability};
pub use study::read_study;
pub use tool::MAX_SPINDLE_SPEED_RPM;
