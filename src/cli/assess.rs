//! `stead assess`: maps of circularity, then files, then tables.

use super::arguments::AssessOptions;
use super::progress::Terminal;
use super::{Failure, on_threads, out_folder, say_notes};
use stead::AssessmentRun;

pub(super) fn run(options: &AssessOptions) -> Result<(), Failure> {
    let accuracy = options.accuracy_mm.map(|accuracy| accuracy / 1e3);
    let run = AssessmentRun::read(&options.config)?
        .selecting(accuracy, options.force_n)
        .map_err(|error| Failure::at("--accuracy-mm and --force-n", error))?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    say_notes(run.notes());
    let shown = Terminal::start(Some(&out.folder)).show(None);
    let assessment = on_threads(options.threads, || run.assess(&shown.monitor))??;
    drop(shown);
    let timing = assessment.timing();
    out.show(assessment.write_in(&out.folder), &assessment, options.json, |folder| {
        let folder = if folder.is_empty() { folder } else { format!("; results in {folder}") };
        format!("in {:.1} s on {} threads{folder}\n", timing.wall, timing.threads)
    })
}
