//! `stead identify plan`: the measurements to take.

use super::super::arguments::IdentifyPlanOptions;
use super::super::progress::Terminal;
use super::super::{Failure, on_threads, out_folder, say};
use stead_calibration::identification::design::design_experiment;
use stead_format::read_plan;
use stead_report::identification::plan::{SHEET, keep_readings, plan_json, plan_text, write_plan};

pub(super) fn run(options: &IdentifyPlanOptions) -> Result<(), Failure> {
    let run = read_plan(&options.config, options.seed)?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    keep_readings(out.folder.path())?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    let shown = Terminal::start().show(None);
    let result = on_threads(options.threads, || design_experiment(&run.request, &shown.monitor));
    drop(shown);
    let (planned, _) = result.inspect_err(|_| out.give_up())?;
    let planned = planned.map_err(|error| {
        out.give_up();
        run.locate(error)
    })?;
    let written = write_plan(&out.folder, &run, &planned);
    let document = || plan_json(&run, &planned);
    let where_to = |folder| format!("\n{SHEET} to be filled in, and what it will tell, in {folder}\n");
    out.show(written, options.json, document, where_to, |where_to| plan_text(&run, &planned) + &where_to)
}
