//! `stead import`: what other programs write, as files of stead.

mod robot;

use super::{Failure, help};
use clap::Subcommand;

#[derive(Debug, Subcommand)]
pub(super) enum ImportCommand {
    /// Derive a robot file from a URDF: geometry, limits, speeds; states what a URDF does not know
    #[command(after_long_help = help::IMPORT_ROBOT)]
    Robot(robot::RobotOptions),
}

pub(super) fn run(command: &ImportCommand) -> Result<(), Failure> {
    match command {
        ImportCommand::Robot(options) => robot::run(options),
    }
}
