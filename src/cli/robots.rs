//! `stead robots`: the arms that stead ships with.

use super::Failure;
use super::manual::Manual;
use super::output::{print, show};
use clap::Args;
use stead::robot::ShippedArms;

#[derive(Debug, Args)]
pub(super) struct RobotsOptions {
    /// Print the robot file of this arm, to begin your own with, instead of the list
    name: Option<String>,
    /// Print the list as one JSON document
    #[arg(long, conflicts_with = "name")]
    json: bool,
}

/// What the help and the guide say of it.
pub(super) const MANUAL: Manual = Manual {
    examples: &["stead robots", "stead robots --json", "stead robots abb-irb6640-235 > my/arm.toml"],
    written: "none; a robot file goes to standard output",
    remarks: "A shipped arm takes the place of a robot file by its name: robot = \"name:kuka-kr270-2\".",
    refused: "wrong usage",
    ..Manual::NEW
};

pub(super) fn run(options: &RobotsOptions) -> Result<(), Failure> {
    if let Some(name) = &options.name {
        return print(ShippedArms::file(name)?.as_bytes());
    }
    show(&ShippedArms::all()?, options.json)
}
