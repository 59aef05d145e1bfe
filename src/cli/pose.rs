//! `stead pose`: where joint angles bring flange and tool.

use super::values::six;
use super::{Failure, print, print_json, say_notes};
use clap::Args;
use std::path::PathBuf;
use stead::Arm;

#[derive(Debug, Args)]
pub(super) struct PoseOptions {
    /// Robot file (TOML), or a shipped arm as name:kuka-kr270-2
    robot: PathBuf,
    #[command(flatten)]
    angles: Angles,
    /// File with a table [spindle], as a run file: the tool frame too
    #[arg(long, value_name = "FILE")]
    tool_of: Option<PathBuf>,
    /// Print the poses as one JSON document
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Angles {
    /// Joint angles of the rows, deg
    #[arg(long, value_name = "T1,..,T6", value_parser = six, allow_hyphen_values = true)]
    joints_deg: Option<[f64; 6]>,
    /// Angles as the controller shows them, deg
    #[arg(long, value_name = "A1,..,A6", value_parser = six, allow_hyphen_values = true)]
    controller_deg: Option<[f64; 6]>,
}

pub(super) fn run(options: &PoseOptions) -> Result<(), Failure> {
    let mut arm = Arm::read(&options.robot)?;
    if let Some(file) = &options.tool_of {
        arm = arm.with_tool_of(file)?;
    }
    let pose = match (options.angles.joints_deg, options.angles.controller_deg) {
        (Some(joints), _) => arm.pose_of(joints),
        (None, angles) => arm.pose_of_controller(angles.unwrap_or_default()),
    };
    let pose = pose.map_err(|error| Failure::at(&options.robot.display().to_string(), error))?;
    say_notes(pose.notes());
    if options.json { print_json(&pose) } else { print(pose.to_string().as_bytes()) }
}
