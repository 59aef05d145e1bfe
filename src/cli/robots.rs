//! `stead robots`: the arms that stead ships with.

use super::{Failure, print, print_json};
use clap::Args;
use stead::ShippedArms;

#[derive(Debug, Args)]
pub(super) struct RobotsOptions {
    /// Print the robot file of this arm, to begin your own with, instead of the list
    name: Option<String>,
    /// Print the list as one JSON document
    #[arg(long, conflicts_with = "name")]
    json: bool,
}

pub(super) fn run(options: &RobotsOptions) -> Result<(), Failure> {
    if let Some(name) = &options.name {
        return print(ShippedArms::file(name)?.as_bytes());
    }
    let arms = ShippedArms::all()?;
    if options.json { print_json(&arms) } else { print(arms.to_string().as_bytes()) }
}
