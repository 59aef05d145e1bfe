//! `stead explain`: one placement, one path point, one beta, eight postures.

use super::arguments::ExplainOptions;
use super::{Failure, print, say, warn};
use stead_format::read_run;
use stead_placement::feasibility::explain;
use stead_placement::place::outside_cell;
use stead_report::document;
use stead_report::placement::{Context, evaluation};

pub(super) fn run(options: &ExplainOptions) -> Result<(), Failure> {
    let run = read_run(&options.config)?;
    let count = run.problem.task.points().len();
    if options.point >= count {
        let last = count - 1;
        return Err(Failure::Usage(format!(
            "--point: no such path point, found {}; allowed: 0 to {last}",
            options.point
        )));
    }
    let placement = options.place.placement();
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    warn(outside_cell(&run.problem, &placement).as_slice());
    let beta = options.beta_deg.to_radians();
    let postures = explain(&run.problem, &placement, options.point, beta);
    let context = Context::new(&run, run.search);
    if options.json {
        print(&document::bytes(&evaluation::explain_json(&placement, options.point, beta, &postures, &context)));
    } else {
        print(evaluation::explain_text(&placement, options.point, beta, &postures).as_bytes());
    }
    Ok(())
}
