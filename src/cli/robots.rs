//! `stead robots`: the arms that stead ships with.

use super::{Failure, print, print_json};
use clap::Args;
use stead::ShippedArms;

#[derive(Debug, Args)]
pub(super) struct RobotsOptions {
    /// Print the list as one JSON document
    #[arg(long)]
    json: bool,
}

pub(super) fn run(options: &RobotsOptions) -> Result<(), Failure> {
    let arms = ShippedArms::all()?;
    if options.json { print_json(&arms) } else { print(arms.to_string().as_bytes()) }
}
