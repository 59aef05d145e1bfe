//! Fields by their paths, and values put in place of those of the files.
//!
//! A path starts in the run file: `cell.z_mm`, `spindle.xyz_mm[3]`. Where it meets a key that names a TOML file, it
//! goes on in that file: `robot.joints[1].stiffness_mnm_per_rad`. Which keys there are is known to the types that read
//! the files alone, so that keys that they gain need nothing here.

mod overrides;
mod path;
mod put;

pub use overrides::{FieldOverride, FieldOverrides};
pub use path::{FieldPath, PathError};
pub(crate) use put::{put, shifted};
