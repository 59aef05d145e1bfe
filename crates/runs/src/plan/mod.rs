//! Plans that `stead place` wrote, read back: whether they are of a run, and where they place the workpiece.

mod rows;
mod stations;

pub use rows::{PlanRow, axis_column, rows_from};
pub use stations::{PlacedPlan, set_up};

use std::path::Path;
use stead_disk::files;
use stead_disk::input::{InputError, InputFile, input_file};
use stead_disk::manifest::{self, Unlisted};
use stead_problem::problem::Problem;

/// Reads a plan (`best.csv` and the like) of a problem from the bytes of its file. It must fit: as many points, joint
/// angles that bring the tool to the positions, one placement for all rows, the forces of the task.
///
/// # Errors
/// [`InputError`] with file, line and column for a plan that does not fit, or that its manifest does not vouch for.
pub fn plan_from(file: &Path, bytes: &[u8], problem: &Problem) -> Result<PlacedPlan, InputError> {
    manifest::check(file, bytes, Unlisted::Refused)?;
    let rows = rows::rows_from(file, bytes, problem)?;
    let mut plan = stations::set_up(file, &rows, problem)?;
    plan.notes.extend(manifest::interruption_note(file));
    Ok(plan)
}

/// As `plan_from`, from a file named on the command line; with what it was, for the result to state.
///
/// # Errors
/// As `plan_from`, and for a file that cannot be read.
pub fn read_plan(file: &Path, problem: &Problem) -> Result<(PlacedPlan, InputFile), InputError> {
    let bytes = read(file, "a plan that `stead place` wrote for this run, as best.csv")?;
    let plan = plan_from(file, &bytes, problem)?;
    let name = file.to_string_lossy().replace('\\', "/");
    Ok((plan, input_file("plan", name, &bytes)))
}

/// The bytes of a file.
pub fn read(file: &Path, allowed: &str) -> Result<Vec<u8>, InputError> {
    files::read(file).map_err(|cause| InputError::new(file, format!("cannot be read: {cause}")).allowed(allowed))
}
