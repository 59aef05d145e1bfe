//! `stead simulate`: a pass with an arm that yields, then files, then a text.

use super::arguments::SimulateOptions;
use super::{Failure, out_folder, results_in, say_notes, say_warnings};
use stead::{Overrides, SimulationRun};

pub(super) fn run(options: &SimulateOptions) -> Result<(), Failure> {
    let run = SimulationRun::read_with(&options.config, &Overrides::from(&options.model))?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    let pass = if options.fast { run.simulate_condensed() } else { run.simulate() }?;
    say_notes(pass.notes());
    say_warnings(pass.warnings());
    out.show(pass.write_in(&out.folder), &pass, options.json, results_in)
}
