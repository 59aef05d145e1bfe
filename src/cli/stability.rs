//! `stead stability`: whether a cut chatters, then files, then a text.

use super::arguments::StabilityOptions;
use super::{Failure, on_threads, out_folder_named, results_in, say_notes, say_warnings};
use stead::{Overrides, StabilityRun};

pub(super) fn run(options: &StabilityOptions) -> Result<(), Failure> {
    let run = StabilityRun::read_with(&options.config, &Overrides::from(&options.model))?;
    let out = out_folder_named(options.out.as_deref(), &options.config, "-stability")?;
    let analysis = on_threads(options.threads, || run.analyse())??;
    say_notes(analysis.notes());
    say_warnings(analysis.warnings());
    out.show(analysis.write_in(&out.folder), &analysis, options.json, results_in)
}
