//! Simulation files: the config of `stead simulate` and `stead stability`.

mod arm;
mod look;
mod milling;
mod stability;
#[cfg(test)]
mod tests;

pub use arm::{MOST_DAMPING_SCALE, Overrides};
pub use milling::FASTEST_RPM;

use super::reader::{Field, Table};
use super::source::Source;
use crate::input::{InputError, InputFile};
use arm::{ArmFields, FEED, setup_from};
pub(super) use arm::{damping_scale_from, variant_from};
use look::{check_duration, check_step, evaluation_from, published_from};
pub(super) use milling::{KEYS as MILLING_KEYS, milling_from};
use stability::analysis_from;
pub(super) use stability::max_depth_from;
use std::path::Path;
use stead_model::cutting::Cutter;
use stead_model::published::Published;
use stead_simulation::milling::PassCut;
use stead_simulation::outcome::{EvaluationSettings, PassFigures};
use stead_simulation::setup::Setup;
use stead_simulation::stability_analysis::AnalysisSettings;

/// A simulation file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulationRun {
    /// The arm and its pass.
    pub setup: Setup,
    /// The cutter.
    pub cutter: Cutter,
    /// What it cuts.
    pub cut: PassCut,
    /// How far before the work the rim of the cutter is at the start. m
    pub gap: f64,
    /// How to look at the simulated pass.
    pub evaluation: EvaluationSettings,
    /// What is to be found out of its stability.
    pub analysis: AnalysisSettings,
    /// Published figures to set beside those of the simulated pass.
    pub published: Option<Published<PassFigures>>,
    /// The files that were read: config, robot.
    pub inputs: Vec<InputFile>,
}

/// Slices of the cutter and steps a turn, where the file does not say.
const SLICES: u64 = 32;
const STEPS_PER_TURN: u64 = 360;

/// Reads a simulation file and the robot file that it names. Top-level keys: `robot` (its path relative to the folder of the
/// file), `[spindle]`, with mass, `[pass]`, `[work]` and `[milling]`; optionally `variant`, `damping_scale`, `[simulation]`,
/// `[stability]` and `[published]`. The shipped files explain each field.
///
/// # Errors
/// [`InputError`] with file, line and field: a file that cannot be read or parsed, a missing or unknown key, a value of the
/// wrong kind or out of range, a robot without masses, a pass that the arm cannot make, a cut that the cutter cannot do, steps
/// that are too coarse for the arm or too many.
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
    let source = Source::read(file)?;
    let document = source.parse()?;
    let [robot, variant, damping_scale, spindle, pass, work, milling, simulation, stability, published] =
        Table::root(&document).fields([
            "robot",
            "variant",
            "damping_scale",
            "spindle",
            "pass",
            "work",
            "milling",
            "simulation",
            "stability",
            "published",
        ])?;
    let mut inputs = vec![source.as_config()];
    let feed = pass.table()?.field(FEED);
    let setup = setup_from(&ArmFields { robot, variant, damping_scale, spindle, pass }, overrides, &mut inputs)?;
    let [length, gap, slot] = work.table()?.fields(["length_mm", "gap_mm", "slot_width_mm"])?;
    let length = length.positive()? / 1e3;
    let gap = gap.number_where("a finite number not below 0", |value| value >= 0.0)? / 1e3;
    let keys = simulation.optional(Field::table)?;
    let keys = keys.map(|table| table.fields(["slices", "steps_per_turn", "window_s", "wall_height_mm", "cutoff_mm"]));
    let keys = keys.transpose()?;
    let whole = |index: usize, max, default: u64| {
        let field = keys.as_ref().map(|keys| &keys[index]);
        let found = field.map(|field| field.optional(|field| field.integer(1..=max))).transpose()?.flatten();
        Ok::<_, InputError>(found.unwrap_or(default) as usize)
    };
    let (slices, steps) = (whole(0, 1024, SLICES)?, whole(1, 100_000, STEPS_PER_TURN)?);
    let table = milling.table()?;
    table.fields(MILLING_KEYS)?;
    let (cutter, mut cut) = milling_from(&table, length, slices, steps)?;
    slot.optional(|field| fits(field, &cutter))?;
    if let Some(speed) = overrides.spindle_speed {
        cut.spindle_speed = speed;
    }
    let analysis = analysis_from(&stability, &setup, &cutter, &cut)?;
    if steps_are_made {
        check_step(&setup, &cut, keys.as_ref().map_or(&simulation, |keys| &keys[1]))?;
        check_duration(&setup, &cut, &feed)?;
    }
    let evaluation = evaluation_from(keys.as_ref().map(|keys| &keys[2..]), &setup, &cut)?;
    let published = published.optional(|field| published_from(&field.table()?, &setup))?;
    Ok(SimulationRun { setup, cutter, cut, gap, evaluation, analysis, published, inputs })
}

/// The width of the slot that the pass is part of: the cutter has to fit into it.
fn fits(field: &Field<'_>, cutter: &Cutter) -> Result<(), InputError> {
    let diameter = 2e3 * cutter.largest_radius();
    let width = field.positive()?;
    if width >= diameter {
        return Ok(());
    }
    let problem = format!("is narrower than the cutter, {diameter} mm");
    Err(field.error(problem, format!("a slot into which the cutter fits, {diameter} mm or wider")))
}
