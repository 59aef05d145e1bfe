//! `stead identify`: which measurements to take, and joint compliances from them.

mod plan;

use super::arguments::{IdentifyCommand, IdentifyFitOptions};
use super::{Failure, out_folder, say};
use stead_calibration::identification::identify;
use stead_format::read_identification;
use stead_report::identification::{identify_json, identify_text, write_identified};

pub(super) fn run(command: &IdentifyCommand) -> Result<(), Failure> {
    match command {
        IdentifyCommand::Fit(options) => fit(options),
        IdentifyCommand::Plan(options) => plan::run(options),
    }
}

fn fit(options: &IdentifyFitOptions) -> Result<(), Failure> {
    let run = read_identification(&options.config)?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    let found = identify(&run.problem).map_err(|error| {
        out.give_up();
        run.locate(error)
    })?;
    let written = write_identified(&out.folder, &run, &found);
    let document = || identify_json(&run, &found);
    let where_to = |folder| format!("\nresults in {folder}\n");
    out.show(written, options.json, document, where_to, |where_to| identify_text(&run, &found) + &where_to)
}
