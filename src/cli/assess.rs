//! `stead assess`: maps of circularity, then files, then tables.

use super::arguments::AssessOptions;
use super::progress::Terminal;
use super::{Failure, on_threads, out_folder, say};
use std::time::Instant;
use stead_assessment::comparison::assess;
use stead_format::read_assessment;
use stead_report::assessment::{AssessmentContext, assess_json, assessment_text, write_assessment};
use stead_report::document::Timing;

pub(super) fn run(options: &AssessOptions) -> Result<(), Failure> {
    let mut run = read_assessment(&options.config)?;
    let selection = &mut run.comparison.selection;
    if let Some(accuracy_mm) = options.accuracy_mm {
        selection.accuracies = vec![accuracy_mm / 1e3];
    }
    if let Some(force) = options.force_n {
        selection.forces = vec![force];
    }
    if selection.accuracies.is_empty() != selection.forces.is_empty() {
        return Err(Failure::Usage(
            "--accuracy-mm and --force-n: only one of the two is known; allowed: both, or a table [selection]"
                .to_owned(),
        ));
    }
    let out = out_folder(options.out.as_deref(), &options.config)?;
    run.notes.iter().for_each(|note| say(&format!("note: {note}")));

    let shown = Terminal::start().show(None);
    let started = Instant::now();
    let (assessment, threads) = on_threads(options.threads, || assess(&run.comparison, &shown.monitor))?;
    let wall = started.elapsed().as_secs_f64();
    drop(shown);
    let assessment = assessment.inspect_err(|_| out.give_up())?;

    let published = run.published.map(|published| {
        let agreement = published.figures.agreement(&assessment);
        (published, agreement)
    });
    let context = AssessmentContext {
        inputs: run.inputs,
        notes: run.notes,
        range_share: run.range_share,
        published,
        force_history: run.force_history,
    };
    let written = write_assessment(&out.folder, &run.comparison, &assessment, &context);
    let document = || assess_json(&assessment, &context, &Timing { wall, threads });
    let where_to = |folder| format!("; results in {folder}");
    out.show(written, options.json, document, where_to, |where_to| {
        format!("{}in {wall:.1} s on {threads} threads{where_to}\n", assessment_text(&assessment, &context))
    })
}
