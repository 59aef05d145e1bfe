//! `stead simulate`: a pass with an arm that yields, then files, then a text.

use super::arguments::SimulateOptions;
use super::{Failure, out_folder_named};
use std::time::Instant;
use stead_format::{Overrides, read_simulation};
use stead_report::simulation::{Making, simulation_text, timed_json, write_simulation};
use stead_simulation::coupled::Job;
use stead_simulation::outcome::Simulation;

pub(super) fn run(options: &SimulateOptions) -> Result<(), Failure> {
    let run = read_simulation(&options.config, &Overrides::from(&options.model))?;
    let out = out_folder_named(options.out.as_deref(), &options.config, "")?;
    let job = Job { setup: &run.setup, cutter: &run.cutter, cut: &run.cut, gap: run.gap };
    let start = Instant::now();
    let pass = if options.fast { job.run_fast() } else { job.run() };
    let making = Making { is_fast: options.fast, wall: start.elapsed().as_secs_f64() };
    let found =
        pass.map_err(Into::into).and_then(|pass| Simulation::of(&job, &run.evaluation, pass)).map_err(|error| {
            out.give_up();
            Failure::Job(error.to_string())
        })?;
    let written = write_simulation(&out.folder, &run, &found, &making);
    let document = || timed_json(&run, &found, &making);
    let where_to = |folder| format!("\nresults in {folder}\n");
    out.show(written, options.json, document, where_to, |where_to| simulation_text(&run, &found, &making) + &where_to)
}
