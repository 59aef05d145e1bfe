//! `stead import`: what other programs write, as files of stead.

pub(super) mod path;
pub(super) mod robot;

use super::Failure;
use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum ImportCommand {
    /// Make a task file of a tool path from CAM: CLDATA or five-axis G-code
    Path(path::PathOptions),
    /// Derive a robot file from a URDF: geometry, limits, speeds; states what a URDF does not know
    Robot(robot::RobotOptions),
}

pub(super) fn run(command: &ImportCommand) -> Result<(), Failure> {
    match command {
        ImportCommand::Path(options) => path::run(options),
        ImportCommand::Robot(options) => robot::run(options),
    }
}
