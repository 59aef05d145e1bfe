//! The short table for people.

use super::number::fixed;
use super::{Context, words};
use crate::placement::outcome::{Case, Outcome};
use crate::placement::problem::Problem;

/// Widest posture scheme that is written in full.
const POSTURES_WIDTH: usize = 14;

/// The four cases with placement, postures, mean and largest deflection and the ratio to case 1, beside the published
/// figures where there are any; then times, and the size of the search. Lines are at most 110 characters wide and end with
/// a line break.
pub fn placement_text(problem: &Problem, outcome: &Outcome, context: &Context) -> String {
    let mut text = format!(
        "{}: {} points in {} segments\n\n",
        problem.robot.name(),
        problem.task.points().len(),
        problem.task.segments().len()
    );
    text.push_str(&aligned(&case_rows(outcome, context), &[1, 2, 8]));
    if let Some(reference) = &context.reference {
        line(&mut text, &format!("ref: {}", reference.source));
    }
    text.push('\n');
    text.push_str(&aligned(&time_rows(outcome), &[]));
    text.push('\n');
    line(&mut text, &format!("{} placements and {} states evaluated", outcome.evaluations, outcome.states));
    if outcome.interrupted {
        line(&mut text, "The search was stopped before its end: this is the best result so far.");
    }
    text
}

fn case_rows(outcome: &Outcome, context: &Context) -> Vec<Vec<String>> {
    let mut header = vec![
        "case", "place", "plan", "x mm", "y mm", "z mm", "Q4", "yaw deg", "postures", "mean mm", "max mm", "ratio",
    ];
    if context.reference.is_some() {
        header.extend(["ref mm", "ratio"]);
    }
    let mut rows = vec![header.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    for (index, case) in outcome.cases.iter().enumerate() {
        let mut row = case_row(case, &outcome.cases[0]);
        if let Some(reference) = &context.reference {
            let [first, here] = [reference.case_mm[0], reference.case_mm[index]];
            row.extend([here.to_string(), fixed(here / first, 2)]);
        }
        rows.push(row);
    }
    rows
}

fn case_row(case: &Case, first: &Case) -> Vec<String> {
    let (placement_word, plan_word) = words::case(case.number);
    let placement = &case.placement;
    let mut row = vec![case.number.to_string(), placement_word.to_owned(), plan_word.to_owned()];
    row.extend([placement.x, placement.y, placement.z].map(|value| fixed(value * 1e3, 1)));
    row.push(fixed(placement.q4(), 4));
    row.push(fixed(placement.yaw.to_degrees(), 1));
    row.push(words::postures_within(&case.plan.postures, POSTURES_WIDTH));
    row.extend([case.plan.mean, case.plan.max].map(|value| fixed(value * 1e3, 4)));
    row.push(fixed(case.plan.mean / first.plan.mean, 2));
    row
}

fn time_rows(outcome: &Outcome) -> Vec<Vec<String>> {
    let mut rows = vec![["case", "cutting s", "moves s", "cycle s"].map(str::to_owned).to_vec()];
    for case in &outcome.cases {
        let total = case.cycle.total();
        let seconds = |time: Option<f64>| time.map_or_else(|| "-".to_owned(), |time| fixed(time, 1));
        let moves = total.map(|total| total - case.cycle.cutting);
        rows.push(vec![case.number.to_string(), fixed(case.cycle.cutting, 1), seconds(moves), seconds(total)]);
    }
    rows
}

/// Columns with two blanks between them, to the right but for the given ones.
fn aligned(rows: &[Vec<String>], to_the_left: &[usize]) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, width))| {
            if to_the_left.contains(&k) { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        line(&mut text, cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    text
}

fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}
