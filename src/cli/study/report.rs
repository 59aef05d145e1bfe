//! `stead study report`: what a study says.

use super::folder;
use crate::cli::arguments::StudyReportOptions;
use crate::cli::{Failure, files_written, on_threads, print, print_json, results_in};
use stead::{Study, StudyQuestion};
use stead_report::output::Folder;

pub(super) fn run(options: &StudyReportOptions) -> Result<(), Failure> {
    let map = options.map.as_ref().map(|names| {
        <[String; 2]>::try_from(names.clone()).map_err(|_| {
            Failure::Usage(format!("--map {}: is no pair of axes; allowed: two axes of the study", names.join(",")))
        })
    });
    let question = StudyQuestion {
        by: options.by.clone(),
        front: options.front.clone(),
        map: map.transpose()?,
        noise: options.noise_percent,
    };
    let study = on_threads(None, || Study::read(&options.config))??;
    let folder = folder(options.out.as_deref(), &options.config);
    let report = study.report(&folder, &question)?;
    // The last shards may have ended at the same time or elsewhere, or the study may have been edited since.
    study.merge(&folder)?;
    let out = Folder::create(&folder).map_err(Failure::Output)?;
    files_written(report.write_in(&out))?;
    if options.json {
        return print_json(&report);
    }
    print(format!("{report}{}", results_in(folder.display().to_string())).as_bytes())
}
