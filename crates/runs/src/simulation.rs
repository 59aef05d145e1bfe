//! A pass to be simulated, or whose stability is to be found.

use stead_disk::input::InputFile;
use stead_model::cutting::{Cutter, PassCut};
use stead_model::published::Published;
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
