//! `stead pose`: where joint angles bring flange and tool.

use super::Failure;
use super::manual::Manual;
use super::output::{say_notes, show};
use super::values::{input_file, six};
use clap::Args;
use std::path::PathBuf;
use stead::robot::Arm;

#[derive(Debug, Args)]
pub(super) struct PoseOptions {
    /// Robot file (TOML), or a shipped arm as name:kuka-kr270-2
    #[arg(value_parser = input_file())]
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

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &[
        "stead pose name:kuka-kr210-r2700 --controller-deg 0,-90,90,0,30,0",
        "stead pose my/kr210.toml --joints-deg 10,80,-160,5,30,-20 --tool-of my/run.toml --json",
    ],
    written: "none",
    remarks: "Frames are printed in the base frame of the rows, and in the controller's robot root where the robot \
              file has the tables [controller] and [root]. A robot file without stiffness will do.",
    done: "done; also where an angle is beyond its limits, which is noted",
    ..Manual::NEW
};

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
    show(&pose, options.json)
}
