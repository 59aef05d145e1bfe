//! `stead stability`: whether a cut chatters, then files, then a text.

use super::arguments::StabilityOptions;
use super::{Failure, on_threads, out_folder_named};
use stead_format::{Overrides, read_stability};
use stead_report::stability::{stability_json, stability_text, write_stability};
use stead_simulation::stability_analysis::analyse;

pub(super) fn run(options: &StabilityOptions) -> Result<(), Failure> {
    let run = read_stability(&options.config, &Overrides::from(&options.model))?;
    let out = out_folder_named(options.out.as_deref(), &options.config, "-stability")?;
    let (found, _) = on_threads(options.threads, || analyse(&run.setup, &run.cutter, &run.cut, &run.analysis))?;
    let found = found.map_err(|error| {
        out.give_up();
        Failure::Job(error.to_string())
    })?;
    let written = write_stability(&out.folder, &run, &found);
    let document = || stability_json(&run, &found);
    let where_to = |folder| format!("\nresults in {folder}\n");
    out.show(written, options.json, document, where_to, |where_to| stability_text(&run, &found) + &where_to)
}
