//! Files into checked objects: values with their units, robots, tasks, tools, shapes, paths from CAM, arms from URDF.
//!
//! All fields carry their unit in their name; inside all is SI and radians. Whatever is wrong in a file comes back as
//! an [`InputError`](stead_disk::input::InputError) that names file, line, field, value found and what is allowed.
//!
//! ```
//! # fn main() -> Result<(), stead_disk::input::InputError> {
//! let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
//! let robot = stead_format::read_robot(&folder.join("../../configs/robots/kuka-kr270-2.toml"))?;
//! assert_eq!(robot.name(), "KUKA KR270-2");
//! # Ok(())
//! # }
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod cam;
pub mod catalogue;
pub mod compliance_matrix;
mod deserialize;
pub mod document;
pub mod field;
pub mod file_kind;
pub mod inertial;
pub mod mesh;
pub mod mount;
pub mod orientation;
pub mod place;
pub mod quantity;
pub mod robot;
pub mod scalars;
pub mod shapes;
pub mod shipped;
pub mod sources;
pub mod spindle;
pub mod surroundings;
pub mod task;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
pub mod toml_file;
pub mod tool;
pub mod units;
pub mod urdf;
pub mod written;

pub use robot::{covariance, read_geometry, read_robot};
pub use tool::MAX_SPINDLE_SPEED_RPM;

/// The vocabulary of the words in the files of this crate ([`scalars::Words`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vocabulary;
