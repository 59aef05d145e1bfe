//! Input files: their errors, values in place of theirs, starter sets, and schemas.

pub use crate::schema::schema;
pub use stead_disk::Existing;
pub use stead_disk::input::{InputError, InputFile};
pub use stead_format::field::{FieldOverride, FieldPath};
pub use stead_run_files::init::{StarterSet, init, init_forces, init_run};
