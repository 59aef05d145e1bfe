//! The JSON Schema of input files and of the documents that commands write.

use crate::Error;

/// The JSON Schema (draft 7) of a kind of input file, `run`, `robot` and the like, or of a document that a command
/// writes, `place-summary` and the like.
///
/// ```
/// assert!(stead::files::schema("run")?.contains("beta_step_deg"));
/// assert!(stead::files::schema("place-summary")?.contains("objective_mm"));
/// assert!(stead::files::schema("robbot").unwrap_err().to_string().contains("nearest known one: robot"));
/// # Ok::<(), stead::Error>(())
/// ```
///
/// # Errors
/// [`Error::Argument`] when there is none of this name, with the nearest and all names.
pub fn schema(name: &str) -> Result<String, Error> {
    let of_file = |error| Error::Argument(format!("{error}, {}", stead_report::schema::names().join(", ")));
    stead_report::schema::schema(name).map_or_else(|| stead_run_files::schema::schema(name).map_err(of_file), Ok)
}
