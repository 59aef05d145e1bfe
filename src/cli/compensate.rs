//! `stead compensate`: correct a path, then files, then a table.

use super::arguments::CompensateOptions;
use super::progress::Terminal;
use super::{Failure, out_folder, print_json, say_notes, say_warnings};
use stead::{CompensationRun, Error};

pub(super) fn run(options: &CompensateOptions) -> Result<(), Failure> {
    let run = CompensationRun::read_with(&options.config, options.reality.as_deref())?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    say_notes(run.notes());
    let shown = Terminal::unstoppable().show(None);
    let path = if options.all_or_nothing { run.compensate_all() } else { run.compensate() };
    drop(shown);
    let path = path.inspect_err(|error| {
        if let (true, Error::NotCompensated(failure)) = (options.json, error) {
            // What cannot be printed is said as the error all the same.
            let _ = print_json(&run.not_compensated_json(failure));
        }
    })?;
    say_notes(path.notes().get(run.notes().len()..).unwrap_or_default());
    say_warnings(path.warnings());
    out.show(path.write_in(&out.folder), &path, options.json, |folder| {
        if folder.is_empty() { folder } else { format!("results in {folder}\n") }
    })
}
