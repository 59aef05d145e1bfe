//! The short tables for people.

use super::AssessmentContext;
use crate::columns::table;
use crate::units::{figures, fixed};
use stead_assessment::comparison::{Assessment, Configuration, RobotResult};
use stead_assessment::published::{PublishedTables, Quantity};

/// Every configuration with its smallest, largest and middle circularity and the best zone of each size (published
/// values in parentheses where there are any), the robots for each wanted accuracy and force, and how far ours and the
/// published tables agree.
pub fn assessment_text(assessment: &Assessment, context: &AssessmentContext) -> String {
    let published = context.published.as_ref().map(|(published, _)| &published.figures);
    let mut text = configurations(assessment, published);
    for warning in &assessment.warnings {
        text += &format!("warning: {warning}\n");
    }
    if !assessment.capable.is_empty() {
        let mut forces: Vec<f64> = assessment.capable.iter().map(|cell| cell.force).collect();
        forces.sort_by(f64::total_cmp);
        forces.dedup();
        let forces: Vec<String> = forces.into_iter().map(|force| fixed(force, 0)).collect();
        text += &format!("\naccuracy reached at the best place up to which of {} N:\n", forces.join(", "));
        text += &selection(assessment);
    }
    text += &format!("\nmost accurate first: {}\n", assessment.order.join(", "));
    if let Some((published, agreement)) = &context.published {
        let same = |same: bool| if same { "the same" } else { "another" };
        text += &format!(
            "in parentheses: {}\nrms difference {} % over {} values, {} more on one side only\n\
             best robot {}, worst {}, order {}; robots for accuracy and force the same in {} of {} cells\n",
            published.source,
            fixed(agreement.rms * 100.0, 1),
            agreement.readings,
            agreement.one_sided,
            same(agreement.same_best),
            same(agreement.same_worst),
            same(agreement.same_order),
            agreement.capable.1,
            agreement.capable.0,
        );
    }
    text
}

fn configurations(assessment: &Assessment, published: Option<&PublishedTables>) -> String {
    let header = ["robot", "elbow", "load", "force N", "min mm", "max mm", "middle mm"].map(str::to_owned);
    let first = assessment.robots.first().and_then(|robot| robot.configurations.first());
    let sides: Vec<f64> = first.map_or(vec![], |configuration| configuration.zones.iter().map(|z| z.side).collect());
    let header = header.into_iter().chain(sides.iter().map(|side| format!("in {0}x{0}", fixed(side * 1e3, 0))));
    let every = assessment.robots.iter().flat_map(|robot| robot.configurations.iter().map(move |c| (robot, c)));
    let rows = every.map(|(robot, configuration)| {
        let mut row =
            vec![robot.name.clone(), configuration.elbow.word().to_owned(), configuration.load.word().to_owned()];
        row.push(fixed(configuration.force, 0));
        let zones = sides.iter().map(|side| Quantity::OptimalZone(*side));
        let quantities = [Quantity::Minimum, Quantity::Maximum, Quantity::Middle].into_iter().chain(zones);
        row.extend(quantities.map(|quantity| cell(robot, configuration, quantity, published)));
        row
    });
    table(header, rows, &[0, 1, 2])
}

/// Our value, and the published one in parentheses.
fn cell(robot: &RobotResult, of: &Configuration, quantity: Quantity, published: Option<&PublishedTables>) -> String {
    let number =
        |value: Option<f64>, write: fn(f64) -> String| value.map_or_else(|| "-".to_owned(), |v| write(v * 1e3));
    let ours = number(quantity.of(of), figures);
    match published.and_then(|published| published.value(&robot.name, of.elbow, of.load, quantity)) {
        Some(value) => format!("{ours} ({})", number(value, |mm| fixed(mm, 2))),
        None => ours,
    }
}

/// Robots by accuracies: the largest of the forces at which a robot reaches the accuracy. A robot that does at one
/// force does at any smaller one.
fn selection(assessment: &Assessment) -> String {
    let mut accuracies: Vec<f64> = Vec::new();
    for cell in &assessment.capable {
        if accuracies.last() != Some(&cell.accuracy) {
            accuracies.push(cell.accuracy);
        }
    }
    let millimetres = |accuracy: &f64| format!("{} mm", (accuracy * 1e9).round() / 1e6);
    let header = std::iter::once("robot".to_owned()).chain(accuracies.iter().map(millimetres));
    let rows = assessment.robots.iter().map(|robot| {
        let largest = |accuracy: &f64| {
            let cells = assessment.capable.iter().filter(|cell| cell.accuracy == *accuracy);
            let able = cells.filter(|cell| cell.robots.contains(&robot.name)).map(|cell| cell.force);
            able.reduce(f64::max).map_or_else(|| "-".to_owned(), |force| format!("{} N", fixed(force, 0)))
        };
        std::iter::once(robot.name.clone()).chain(accuracies.iter().map(largest)).collect()
    });
    table(header, rows, &[0])
}
