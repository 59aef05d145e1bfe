//! One milling pass of an arm that yields: simulated in time, and whether small motions die out.

pub use stead_run_files::Overrides;
pub use stead_simulation::arm::Variant;
pub use stead_simulation::{outcome, stability_analysis};

use crate::result::result;
use crate::{Error, Monitor};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use stead_format as format;
use stead_report::simulation::{simulation_files, simulation_text, timed_json};
use stead_report::stability::{stability_files, stability_json, stability_text};
use stead_run_files as run_files;
use stead_simulation::coupled::{Job, JobError};
use stead_simulation::outcome::Simulation;
use stead_simulation::stability_analysis::{StabilityAnalysis as Analysis, StabilityError};

/// A simulation file with its robot, read and checked for a simulation in time.
#[derive(Debug, Clone)]
pub struct SimulationRun {
    run: Arc<stead_runs::SimulationRun>,
}

/// A simulation file with its robot, read and checked for an analysis of stability, which takes no time steps.
#[derive(Debug, Clone)]
pub struct StabilityRun {
    run: Arc<stead_runs::SimulationRun>,
}

/// Values in place of a simulation file's: the variant of the arm by its name, the factor on all damping and the
/// spindle speed in rev/min.
///
/// # Errors
/// [`Error::Argument`] with the values that are allowed.
pub fn overrides(
    variant: Option<&str>,
    damping_scale: Option<f64>,
    spindle_rpm: Option<f64>,
) -> Result<Overrides, Error> {
    let wrong = |what: &str, found: String, allowed: String| {
        Error::Argument(format!("no such {what}, found {found}; allowed: {allowed}"))
    };
    let named = |name: &str| Variant::WORDS.iter().find(|(word, _)| *word == name).map(|(_, variant)| *variant);
    let known = || Variant::WORDS.iter().map(|(word, _)| *word).collect::<Vec<_>>().join(", ");
    let variant = variant.map(|name| named(name).ok_or_else(|| wrong("variant", name.to_owned(), known())));
    if let Some(scale) = damping_scale.filter(|scale| !(0.0..=run_files::MAX_DAMPING_SCALE).contains(scale)) {
        let allowed = format!("a number from 0 to {}", run_files::MAX_DAMPING_SCALE);
        return Err(wrong("factor on damping", scale.to_string(), allowed));
    }
    if let Some(rpm) = spindle_rpm.filter(|rpm| !(*rpm > 0.0 && *rpm <= format::MAX_SPINDLE_SPEED_RPM)) {
        let allowed = format!("rev/min above 0 and not above {}", format::MAX_SPINDLE_SPEED_RPM);
        return Err(wrong("spindle speed", rpm.to_string(), allowed));
    }
    let spindle_speed = spindle_rpm.map(|rpm| rpm / 60.0 * std::f64::consts::TAU);
    Ok(Overrides { variant: variant.transpose()?, damping_scale, spindle_speed })
}

impl SimulationRun {
    /// Reads a simulation file and the robot file that it names.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(file, &Overrides::default())
    }

    /// As [`SimulationRun::read`], with some values in place of the file's.
    ///
    /// # Errors
    /// As [`SimulationRun::read`].
    pub fn read_with(file: impl AsRef<Path>, overrides: &Overrides) -> Result<Self, Error> {
        Ok(Self { run: Arc::new(run_files::read_simulation(file.as_ref(), overrides)?) })
    }

    /// Simulates the pass with the whole kinematic chain.
    ///
    /// # Errors
    /// [`Error::Failed`] for a pass too short to be judged; [`Error::Stopped`] when the monitor asked to stop.
    pub fn simulate(&self, monitor: &Monitor) -> Result<SimulatedPass, Error> {
        let run = &self.run;
        let job = Job { setup: &run.setup, cutter: &run.cutter, cut: &run.cut, gap: run.gap };
        let start = Instant::now();
        let pass = job.run(monitor);
        let wall = start.elapsed().as_secs_f64();
        let pass = pass.map_err(|error| match error {
            JobError::Stopped(stop) => Error::Stopped(stop),
            error => Error::failed(error),
        })?;
        let simulation = Simulation::of(&job, &run.evaluation, pass).map_err(Error::failed)?;
        Ok(SimulatedPass { run: Arc::clone(run), simulation, wall })
    }
}

impl StabilityRun {
    /// Reads a simulation file and the robot file that it names; its time steps may be as coarse as they like.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(file, &Overrides::default())
    }

    /// As [`StabilityRun::read`], with some values in place of the file's.
    ///
    /// # Errors
    /// As [`StabilityRun::read`].
    pub fn read_with(file: impl AsRef<Path>, overrides: &Overrides) -> Result<Self, Error> {
        Ok(Self { run: Arc::new(run_files::read_stability(file.as_ref(), overrides)?) })
    }

    /// Modes of the arm, frequency response at the tip, critical depth and stability lobes.
    ///
    /// # Errors
    /// [`Error::Failed`] for an arm that says too little, or a cut without width; [`Error::Stopped`] when the monitor
    /// asked to stop.
    pub fn analyse(&self, monitor: &Monitor) -> Result<StabilityAnalysis, Error> {
        let run = &self.run;
        let analysis = stability_analysis::analyse(&run.setup, &run.cutter, &run.cut, &run.analysis, monitor);
        let analysis = analysis.map_err(|error| match error {
            StabilityError::Stopped(stop) => Error::Stopped(stop),
            error => Error::failed(error),
        })?;
        Ok(StabilityAnalysis { run: Arc::clone(run), analysis })
    }
}

/// A simulated pass: forces, the wall that is left, and whether the cut stayed calm.
#[derive(Debug, Clone)]
pub struct SimulatedPass {
    run: Arc<stead_runs::SimulationRun>,
    simulation: Simulation,
    wall: f64,
}

/// Whether a cut chatters.
#[derive(Debug, Clone)]
pub struct StabilityAnalysis {
    run: Arc<stead_runs::SimulationRun>,
    analysis: Analysis,
}

impl SimulatedPass {
    /// What the simulation gave, in SI units.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }
}

impl StabilityAnalysis {
    /// Modes, responses, depths and lobes, in SI units.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }
}

result! { SimulatedPass, self {
    write(folder) = folder.results("simulate", &self.run.inputs).write(&self.files()?);
    files = simulation_files(&self.run, &self.simulation);
    document = timed_json(&self.run, &self.simulation, self.wall);
    table = simulation_text(&self.run, &self.simulation, self.wall);
    notes = self.simulation.notes;
    warnings = self.simulation.warnings;
} }

result! { StabilityAnalysis, self {
    write(folder) = folder.results("stability", &self.run.inputs).write(&self.files()?);
    files = stability_files(&self.run, &self.analysis);
    document = stability_json(&self.run, &self.analysis);
    table = stability_text(&self.run, &self.analysis);
    notes = self.analysis.notes;
    warnings = self.analysis.warnings;
} }
