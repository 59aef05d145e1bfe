//! `stead explain`: one placement, one path point, one beta, eight postures.

use super::arguments::ExplainOptions;
use super::{Failure, print, print_json, say_notes};
use stead::Run;

pub(super) fn run(options: &ExplainOptions) -> Result<(), Failure> {
    let run = Run::read_with(&options.config, options.set.clone())?;
    let (run, placement) = options.place.of(run, options.orientation.as_deref())?;
    let beta = options.beta_deg.to_radians();
    let explanations = run.explain(&placement, options.point, beta).map_err(|error| Failure::at("--point", error))?;
    say_notes(explanations.notes());
    if options.json {
        return print_json(&explanations);
    }
    print(explanations.to_string().as_bytes())
}
