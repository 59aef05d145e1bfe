//! A plan whose commands are to be corrected.

use stead_calibration::compensation::CompensationProblem;
use stead_disk::input::InputFile;
use stead_numerics::message::{Note, Warning};
use stead_problem::problem::Placement;

/// A compensation file and the files it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct CompensateRun {
    /// What is to be compensated.
    pub job: CompensationProblem,
    /// Where the workpiece stands, as the plan has it.
    pub placement: Placement,
    /// Whether the commands are played on another robot file than the run's.
    pub has_reality: bool,
    /// The files that were read: config, run, robot, task, plan, reality.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<Note>,
    /// What the user should see to in the run.
    pub warnings: Vec<Warning>,
}
