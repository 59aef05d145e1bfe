//! `stead identify`: which measurements to take, and joint compliances from them.

mod plan;

use super::arguments::{IdentifyCommand, IdentifyFitOptions};
use super::{Failure, out_folder, say};
use stead_calibration::identification::law::LawError;
use stead_calibration::identification::model::{Layout, Parameter};
use stead_calibration::identification::normal_equations::Unidentifiable;
use stead_calibration::identification::setup::SetupError;
use stead_calibration::identification::{IdentifyError, identify};
use stead_format::input::InputError;
use stead_format::{IdentifyRun, read_identification};
use stead_report::identification::{identify_json, identify_text, write_identified};
use stead_report::names::compliance_name;

pub(super) fn run(command: &IdentifyCommand) -> Result<(), Failure> {
    match command {
        IdentifyCommand::Fit(options) => fit(options),
        IdentifyCommand::Plan(options) => plan::run(options),
    }
}

fn fit(options: &IdentifyFitOptions) -> Result<(), Failure> {
    let run = read_identification(&options.config)?;
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));
    let found = identify(&run.problem).map_err(|error| {
        out.give_up();
        failure(&run, error)
    })?;
    let written = write_identified(&out.folder, &run, &found);
    let document = || identify_json(&run, &found);
    let where_to = |folder| format!("\nresults in {folder}\n");
    out.show(written, options.json, document, where_to, |where_to| identify_text(&run, &found) + &where_to)
}

/// What is wrong with the sheet is bad input, at its line where there is one; what comes out of a sound sheet is not.
fn failure(run: &IdentifyRun, error: IdentifyError) -> Failure {
    let bad = |problem: String| InputError::new(&run.sheet_file, problem);
    let first = run.problem.sheet.readings.first().map_or(1, |reading| reading.line);
    match error {
        IdentifyError::TooFar { line, .. } => bad(error.to_string())
            .at_line(line)
            .in_field("loaded_x_mm")
            .allowed("places in millimetres, both of the same point, and wrenches in N and N m")
            .into(),
        IdentifyError::Setup(SetupError::Scale { .. }) => bad(error.to_string())
            .at_line(first)
            .in_field("unloaded_x_mm")
            .allowed("places in millimetres, and joint angles in degrees as the robot counts them")
            .into(),
        IdentifyError::Setup(SetupError::Misfit { line, .. }) => bad(error.to_string())
            .at_line(line)
            .in_field("unloaded_x_mm")
            .allowed(
                "places in millimetres in a right-handed frame that stands still, and joint angles in degrees as the robot \
                 file counts them, each with its own reading",
            )
            .into(),
        IdentifyError::Setup(_) => bad(error.to_string())
            .at_line(first)
            .in_field("unloaded_x_mm")
            .allowed("more configurations, with the flange turned every way")
            .into(),
        IdentifyError::TooFew { .. } => bad(error.to_string())
            .at_line(first)
            .allowed("at least as many loaded coordinates as compliances: more configurations, or more at the same q2")
            .into(),
        IdentifyError::NoiseUnknown { .. } => {
            bad(error.to_string()).at_line(first).allowed("more readings, or noise_mm in the config").into()
        }
        IdentifyError::Unidentifiable { unidentifiable, layout, outliers } if !outliers.is_empty() => {
            let lines: Vec<String> = outliers.iter().map(usize::to_string).collect();
            bad(format!("without the outliers of lines {}, {}", lines.join(", "), unidentifiable_words(&unidentifiable, &layout)))
                .at_line(outliers[0])
                .allowed("readings that agree with each other, and more of them for every compliance")
                .into()
        }
        IdentifyError::Unidentifiable { unidentifiable, layout, .. } => bad(unidentifiable_words(&unidentifiable, &layout))
            .at_line(first)
            .allowed("loads that turn every joint, each in its own way; or fit.reduce = true to keep what is not seen")
            .into(),
        IdentifyError::Negative { .. } => bad(error.to_string())
            .at_line(first)
            .in_field("force_x_n")
            .allowed("the wrench that acts on the robot, in its base frame, and the place under it as loaded_*_mm")
            .into(),
        IdentifyError::Law(LawError::TooFewAngles { joint, .. } | LawError::Unidentifiable { joint }) => bad(error.to_string())
            .at_line(first)
            .in_field(format!("theta{joint}_deg"))
            .allowed("three or more distinct angles, wide apart")
            .into(),
        IdentifyError::Law(LawError::NoSpring { .. }) | IdentifyError::NotPositive { .. } | IdentifyError::Robot(_) => {
            Failure::Job(error.to_string())
        }
    }
}

/// Every parameter or combination that is not seen, by name.
fn unidentifiable_words(unidentifiable: &[Unidentifiable], layout: &Layout) -> String {
    let name = |parameter: &Parameter| compliance_name(layout.joint(*parameter), layout.angle(*parameter));
    let words = |unidentifiable: &Unidentifiable| {
        let names: Vec<String> = unidentifiable.parameters.iter().map(name).collect();
        match &names[..] {
            [alone] => format!("{alone} turns under no load"),
            several => format!("{} cannot be told apart", several.join(", ")),
        }
    };
    let all: Vec<String> = unidentifiable.iter().map(words).collect();
    format!("the readings do not see every compliance: {}", all.join("; "))
}
