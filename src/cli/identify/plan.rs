//! `stead identify plan`: the measurements to take.

use super::super::arguments::IdentifyPlanOptions;
use super::super::progress::Terminal;
use super::super::{Failure, on_threads, out_folder, say_notes};
use stead::DesignRun;
use stead_report::identification::plan::SHEET;

pub(super) fn run(options: &IdentifyPlanOptions) -> Result<(), Failure> {
    let run = DesignRun::read_with(&options.config, options.seed)?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.check_folder(out.folder.path())?;
    say_notes(run.notes());
    let shown = Terminal::start(Some(&out.folder)).show(None);
    let plan = on_threads(options.threads, || run.plan(&shown.monitor))??;
    drop(shown);
    out.show(plan.write_in(&out.folder), &plan, options.json, |folder| {
        if folder.is_empty() {
            folder
        } else {
            format!("\n{SHEET} to be filled in, and what it will tell, in {folder}\n")
        }
    })
}
