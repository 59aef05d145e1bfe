//! Simulation files: the config of `stead simulate` and `stead stability`.

mod arm;

pub use arm::Overrides;

use super::reader::Table;
use super::source::Source;
use crate::input::{InputError, InputFile};
use crate::simulation::setup::Setup;
use arm::{ArmFields, setup_from};
use std::path::Path;

/// A simulation file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationRun {
    /// The arm and its pass.
    pub setup: Setup,
    /// The files that were read: config, robot.
    pub inputs: Vec<InputFile>,
}

/// Reads a simulation file and the robot file that it names. Top-level keys: `robot` (its path relative to the folder of the
/// file), `[spindle]`, with mass, and `[pass]`; optionally `variant` and `damping_scale`. The shipped files explain each field.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of the
/// wrong kind or out of range, a robot without masses, a pass that the arm cannot make.
pub fn read_simulation(file: &Path, overrides: &Overrides) -> Result<SimulationRun, InputError> {
    let source = Source::read(file)?;
    let document = source.parse()?;
    let [robot, variant, damping_scale, spindle, pass] =
        Table::root(&document).fields(["robot", "variant", "damping_scale", "spindle", "pass"])?;
    let mut inputs = vec![source.as_config()];
    let setup = setup_from(&ArmFields { robot, variant, damping_scale, spindle, pass }, overrides, &mut inputs)?;
    Ok(SimulationRun { setup, inputs })
}
