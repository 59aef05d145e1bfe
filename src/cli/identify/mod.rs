//! `stead identify`: which measurements to take, and joint compliances from them.

mod plan;

use super::arguments::{IdentifyCommand, IdentifyFitOptions};
use super::{Failure, out_folder, results_in, say_notes};
use stead::FitRun;

pub(super) fn run(command: &IdentifyCommand) -> Result<(), Failure> {
    match command {
        IdentifyCommand::Fit(options) => fit(options),
        IdentifyCommand::Plan(options) => plan::run(options),
    }
}

fn fit(options: &IdentifyFitOptions) -> Result<(), Failure> {
    let run = FitRun::read(&options.config)?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    say_notes(run.notes());
    let robot = run.fit()?;
    out.show(robot.write_in(&out.folder), &robot, options.json, results_in)
}
