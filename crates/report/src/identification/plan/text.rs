//! The table for people.

use super::super::json::{URAD, key};
use crate::columns::table;
use crate::units::{figures, fixed};
use stead_calibration::identification::FitModel;
use stead_calibration::identification::design::{Design, TestCases};
use stead_runs::PlanRun;

/// Expected errors of the compliances beside those of random sets, the expected error of the deflection, where the
/// candidates come from, and what the plan does not show.
pub fn plan_text(run: &PlanRun, plan: &Design) -> String {
    let request = &run.request;
    let mut text = format!(
        "{}: {} configurations chosen of {}, {} reference points, {} N, {} mm of noise\n\n",
        request.robot.name(),
        plan.load_cases.len(),
        plan.candidates,
        request.points.len(),
        figures(request.load),
        request.noise * 1e3
    );
    text += &bars(request.model, plan);
    if !plan.compensator.is_empty() {
        text += "\n";
        text += &springs(plan);
    }
    text += &errors_text(run, plan);
    let rejected = &plan.rejected;
    text += &format!(
        "\nof {} configurations drawn {} would leave the volume, {} come too near to the base, {} deflect by more than {} mm\n",
        plan.draws,
        rejected.volume,
        rejected.radius,
        rejected.deflection,
        figures(request.max_deflection * 1e3)
    );
    text += &format!(
        "total motion through them, by the joint that moves furthest in each move: {} deg\n",
        fixed(plan.travel.to_degrees(), 0)
    );
    for note in &plan.notes {
        text += &format!("note: {note}\n");
    }
    for warning in &plan.warnings {
        text += &format!("warning: {warning}\n");
    }
    text
}

/// The expected error of the deflection, beside that of random sets.
fn errors_text(run: &PlanRun, plan: &Design) -> String {
    let (request, errors) = (&run.request, &plan.errors);
    let millimetres = |value: f64| {
        if value.is_finite() {
            format!("{} mm", figures(value * 1e3))
        } else {
            "not every compliance is identifiable".to_owned()
        }
    };
    let tests = match &request.tests {
        TestCases::Given(tests) => format!("the {} tests", tests.len()),
        TestCases::Drawn(_) => {
            format!("{} random poses under {} N in any direction", plan.tests.len(), figures(request.load))
        }
    };
    let mut text = format!(
        "\nexpected error of the deflection at {tests}: {} rms, of {} rms\nbest of {} random sets: {}; their median: {}",
        millimetres(errors.planned),
        millimetres(plan.deflection),
        errors.random_sets,
        millimetres(errors.best_random),
        millimetres(errors.median_random)
    );
    if errors.unidentifiable_sets > 0 {
        text += &format!("; sets from which not every compliance is identifiable: {}", errors.unidentifiable_sets);
    }
    if !plan.unobservable.is_empty() {
        text += "\nall errors leave out unobservable compliances (see below)";
    }
    text
}

fn bars(model: FitModel, plan: &Design) -> String {
    let has_law = plan.compliances.iter().any(|bar| bar.angle.is_some());
    let first = if model == FitModel::Full { "spring" } else { "joint" };
    let mut header = vec![first, "at deg", "urad/(N m)", "std", "%"];
    header.extend(has_law.then_some("% by law"));
    header.extend(["% best random", "% median random"]);
    let rows = plan.compliances.iter().map(|bar| {
        let percent = |deviation: Option<f64>| {
            deviation.map_or_else(|| "-".to_owned(), |deviation| fixed((100.0 * deviation / bar.value).abs(), 2))
        };
        let angle = bar.angle.map_or_else(|| "-".to_owned(), |angle| fixed(angle.to_degrees(), 2));
        let deviation = bar.deviation.map_or_else(|| "-".to_owned(), |deviation| figures(deviation * URAD));
        let name = match model {
            FitModel::Axes => (bar.joint + 1).to_string(),
            FitModel::Full => plan.gauge.sum_name(bar.spring(), bar.spring().to_string()),
        };
        let mut row = vec![name, angle, fixed(bar.value * URAD, 4), deviation, percent(bar.deviation)];
        row.extend(has_law.then(|| percent(Some(bar.by_law))));
        row.extend([percent(bar.best_random), percent(bar.median_random)]);
        row
    });
    table(header, rows, &[0])
}

fn springs(plan: &Design) -> String {
    let rows = plan.compensator.iter().map(|bar| {
        let (name, factor) = key(&bar.parameter);
        let percent = fixed(100.0 * (bar.deviation / bar.value).abs(), 2);
        vec![name, figures(bar.value * factor), figures(bar.deviation * factor), percent]
    });
    table(["in the robot file", "value", "std", "%"], rows, &[0])
}
