//! Simulation files: the config of `stead simulate` and `stead stability`.

mod arm;
mod evaluation;
mod file;
mod stability;
#[cfg(test)]
mod tests;

pub use arm::Overrides;
pub use file::*;

use arm::setup_from;
use evaluation::{check_duration, check_step, evaluation_from};
use stability::analysis_from;
pub(crate) use stability::max_depth;
use std::path::Path;
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::toml_file::TomlFile;
use stead_format::tool::Cutting;
use stead_format::units::{Mm, Positive};
use stead_model::cutting::Cutter;
use stead_runs::SimulationRun;

/// Slices of the cutter and steps a turn, where the file does not say.
const SLICES: usize = 32;
const STEPS_PER_TURN: usize = 360;

/// Reads a simulation file, the keys of [`SimulationFile`], and the robot file that it names.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of
/// the wrong kind or out of range, a robot without masses, a pass that the arm cannot make, a cut that the cutter
/// cannot do, steps that are too coarse for the arm or too many.
pub fn read_simulation(file: &Path, overrides: &Overrides) -> Result<SimulationRun, InputError> {
    read(file, overrides, true)
}

/// The same for a stability analysis, which makes no steps: they may be as coarse and as many as they like.
///
/// # Errors
/// [`InputError`] as [`read_simulation`], but for the steps.
pub fn read_stability(file: &Path, overrides: &Overrides) -> Result<SimulationRun, InputError> {
    read(file, overrides, false)
}

fn read(file: &Path, overrides: &Overrides, steps_are_made: bool) -> Result<SimulationRun, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    let at = document.root();
    let file: SimulationFile = document.read()?;
    let mut inputs = vec![source.as_config()];
    let setup = setup_from(&file, &at, overrides, &mut inputs)?;
    let settings = file.simulation.unwrap_or_default();
    let slices = settings.slices.map_or(SLICES, |slices| slices.count());
    let steps = settings.steps_per_turn.map_or(STEPS_PER_TURN, |steps| steps.count());
    let cutting = Cutting::new(&file.tool, &file.cut, &at);
    if steps_are_made {
        cutting.without_edge_forces()?;
    }
    let (cutter, mut cut) = cutting.cutter_and_cut(file.work.length_mm.si(), slices, steps)?;
    if let Some(width) = file.work.slot_width_mm {
        check_slot(width, &cutter, &at.key("work").key("slot_width_mm"))?;
    }
    if let Some(speed) = overrides.spindle_speed {
        cut.spindle_speed = speed;
    }
    let analysis = analysis_from(&file.stability.unwrap_or_default(), &at.key("stability"), &setup, &cutter, &cut)?;
    let settings_at = at.key("simulation");
    if steps_are_made {
        check_step(&setup, &cut, &settings_at.key("steps_per_turn"))?;
        check_duration(&setup, &cut, &at.key("pass").key("feed_mm_per_min"))?;
    }
    let published = file.published.map(|table| table.published(setup.variant));
    let evaluation = evaluation_from(&settings, &settings_at, &setup, &cut, &analysis)?;
    Ok(SimulationRun { setup, cutter, cut, gap: file.work.gap_mm.si(), evaluation, analysis, published, inputs })
}

/// Refuses a slot into which the cutter does not fit.
fn check_slot(width: Mm<Positive>, cutter: &Cutter, at: &Place<'_>) -> Result<(), InputError> {
    let diameter = 2e3 * cutter.largest_radius();
    if width.written() >= diameter {
        return Ok(());
    }
    let problem = format!("is narrower than the cutter, {diameter} mm");
    Err(at.error(problem, format!("a slot into which the cutter fits, {diameter} mm or wider")))
}
