//! `stead identify plan`: the measurements to take.

use super::super::arguments::IdentifyPlanOptions;
use super::super::progress::Terminal;
use super::super::{Failure, on_threads, out_folder, say};
use std::path::Path;
use stead_calibration::identification::design::{DesignError, design_experiment};
use stead_format::input::InputError;
use stead_format::{PlanRun, read_plan};
use stead_report::identification::plan::{SHEET, is_form, plan_json, plan_text, write_plan};

pub(super) fn run(options: &IdentifyPlanOptions) -> Result<(), Failure> {
    let run = read_plan(&options.config, options.seed)?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    keep_readings(&out.folder.path().join(SHEET))?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    let shown = Terminal::start().show(None);
    let result = on_threads(options.threads, || design_experiment(&run.request, &shown.monitor));
    drop(shown);
    let (planned, _) = result.inspect_err(|_| out.give_up())?;
    let planned = planned.map_err(|error| {
        out.give_up();
        failure(&run, error)
    })?;
    let written = write_plan(&out.folder, &run, &planned);
    let document = || plan_json(&run, &planned);
    let where_to = |folder| format!("\n{SHEET} to be filled in, and what it will tell, in {folder}\n");
    out.show(written, options.json, document, where_to, |where_to| plan_text(&run, &planned) + &where_to)
}

/// Refuses to write over a sheet that somebody has filled in.
fn keep_readings(sheet: &Path) -> Result<(), Failure> {
    match std::fs::read(sheet) {
        Ok(bytes) if !is_form(&bytes) => {
            Err(InputError::new(sheet, "is a sheet with readings in it, which a new plan would write over")
                .allowed("another folder (--out), or no sheet.csv but an empty one there")
                .into())
        }
        _ => Ok(()),
    }
}

/// What is wrong with the numbers asked for is bad input; what nothing was found for is not.
fn failure(run: &PlanRun, error: DesignError) -> Failure {
    let size = run.request.configurations.to_string();
    let few = |allowed: &str| {
        InputError::new(&run.file, error.to_string())
            .at_line(run.configurations_line)
            .in_field("plan.configurations")
            .found(size.clone())
            .allowed(allowed)
            .into()
    };
    match error {
        DesignError::TooFew { .. } => {
            few("at least as many components as compliances: more configurations or reference points")
        }
        DesignError::Setup(_) => few("more configurations or reference points, with the flange turned every way"),
        DesignError::Law(_) => few("3 or more, and as many levels_deg"),
        DesignError::NothingTold(_) => few("more configurations"),
        DesignError::TooFewCandidates { .. }
        | DesignError::NoTest
        | DesignError::NothingSeen
        | DesignError::Stopped => Failure::Job(format!("{}:{}: plan: {error}", run.file.display(), run.table_line)),
    }
}
