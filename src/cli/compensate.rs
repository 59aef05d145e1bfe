//! `stead compensate`: correct a path, then files, then a table.

use super::arguments::CompensateOptions;
use super::{Failure, out_folder, print, say};
use stead_calibration::compensation::compensate;
use stead_format::read_compensation;
use stead_report::compensation::{compensation_json, compensation_text, not_compensated_json, write_compensation};
use stead_report::document;

pub(super) fn run(options: &CompensateOptions) -> Result<(), Failure> {
    let run = read_compensation(&options.config, options.reality.as_deref())?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    let outcome = compensate(&run.job).inspect_err(|failure| {
        if options.json {
            print(&document::bytes(&not_compensated_json(&run, failure)));
        }
        out.give_up();
    })?;
    let written = write_compensation(&out.folder, &run, &outcome);
    let document = || compensation_json(&run, &outcome);
    let where_to = |folder| format!("results in {folder}\n");
    out.show(written, options.json, document, where_to, |where_to| compensation_text(&run, &outcome) + &where_to)
}
