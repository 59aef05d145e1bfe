//! `stead compensate`: correct a path, then files, then a table.

use super::arguments::CompensateOptions;
use super::{Failure, out_folder, print, say};
use crate::compensation::compensate;
use crate::config::read_compensation;
use crate::report::compensation::{compensation_json, compensation_text, not_compensated_json, write_compensation};
use crate::report::json;

pub(super) fn run(options: &CompensateOptions) -> Result<(), Failure> {
    let run = read_compensation(&options.config, options.reality.as_deref())?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    let outcome = compensate(&run.job).inspect_err(|failure| {
        if options.json {
            print(&json::bytes(&not_compensated_json(failure)));
        }
        out.give_up();
    })?;
    let written = write_compensation(&out.folder, &run, &outcome);
    if options.json {
        print(&json::bytes(&compensation_json(&run, &outcome)));
    } else {
        let where_to = match &written {
            Ok(_) => format!("results in {}\n", out.folder.path().display()),
            Err(_) => String::new(),
        };
        print(format!("{}{where_to}", compensation_text(&run, &outcome)).as_bytes());
    }
    written.map(|_| ()).map_err(|e| Failure::Job(e.to_string()))
}
