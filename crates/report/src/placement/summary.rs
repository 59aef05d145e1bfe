//! A result in a few lines: what it is, what holds it, what it rests on, what was not checked, what looks wrong.

use super::text::{placement_text, short_name};
use super::{Context, setup};
use crate::names;
use crate::units::figures;
use schemars::JsonSchema;
use serde::Serialize;
use stead_model::robot::PostureWord;
use stead_numerics::message::{Note, NoteGroup};
use stead_placement::outcome::{Case, Outcome, Plan};
use stead_placement::place::Score;
use stead_problem::criterion::{CANCELLATION, Weights};
use stead_problem::problem::{Placement, Problem};
use stead_problem::sense::BySense;

/// Bounds and springs that are named.
const NAMED: usize = 2;
/// Words of a warning that are shown.
const WORDS: usize = 10;
/// A word after which a sentence may be cut short has so many before it at least.
const FEWEST_WORDS: usize = 4;
/// Characters before the text of a line.
const INDENT: usize = 13;

/// A line of the summary of a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SummaryLine {
    /// What the line is about; empty where it goes on from the one before.
    pub(crate) about: &'static str,
    /// What is said of it.
    pub(crate) text: String,
}

/// The summary of a result, in the order in which it is to be read.
pub type Summary = Vec<SummaryLine>;

/// A line about something.
pub fn summary_line(about: &'static str, text: impl Into<String>) -> SummaryLine {
    SummaryLine { about, text: text.into() }
}

/// The lines as text, each with a line break.
pub fn summary_text(lines: &[SummaryLine]) -> String {
    let line = |line: &SummaryLine| format!("{:<INDENT$}{}\n", line.about, line.text);
    lines.iter().map(line).collect()
}

/// The summary of a placement job.
pub fn placement_summary(problem: &Problem, outcome: &Outcome, context: &Context) -> Summary {
    let best = &outcome.cases.best;
    let mut lines: Summary = outcome.interrupted.then(interrupted).into_iter().collect();
    lines.extend(of_plan("best", problem, (&best.placement, best.orientation.as_ref(), &best.plan)));
    let worst = outcome.cases.worst.as_ref().map(|worst| {
        let ratio =
            outcome.cases.ratio(&worst.best).map_or(String::new(), |ratio| format!(", {} times", figures(ratio)));
        format!("{} mm{ratio}", figures(worst.best.plan.mean * 1e3))
    });
    lines.push(summary_line("worst", worst.unwrap_or_else(|| "not looked for".to_owned())));
    lines.extend(held_by(best));
    lines.extend(rest(context));
    lines
}

/// The summary of a given placement.
pub fn score_summary(problem: &Problem, score: &Score, context: &Context) -> Summary {
    let BySense { best, worst } = &score.plans;
    let mut lines: Summary = score.interrupted.then(interrupted).into_iter().collect();
    lines.extend(of_plan("best plan", problem, (&score.placement, score.orientation.as_ref(), best)));
    lines.push(summary_line("worst plan", format!("{} mm", figures(worst.mean * 1e3))));
    lines.extend(rest(context));
    lines
}

/// That a stop came before the end.
fn interrupted() -> SummaryLine {
    summary_line("INTERRUPTED", "what was found by then, not the end")
}

/// Where the workpiece is and how it lies, and what a plan comes to there.
fn of_plan(
    about: &'static str,
    problem: &Problem,
    (placement, orientation, plan): (&Placement, Option<&String>, &Plan),
) -> Summary {
    let Placement { x, y, z, yaw } = *placement;
    let [x, y, z] = [x, y, z].map(|length| (length * 1e3).round() + 0.0);
    let frame = names::place_frame(problem);
    let mut at = format!("x {x} y {y} z {z} mm, yaw {:.0} deg ({frame} frame)", yaw.to_degrees());
    at.extend(orientation.map(|name| format!(", {name}")));
    at.extend(setup::standing_words(&plan.axes).map(|axes| format!(", {axes}")));
    at.push_str(&format!("; {}", postures(plan)));
    vec![summary_line(about, at), summary_line("", deflection(problem, plan))]
}

/// The postures of a plan in words, each kind once.
fn postures(plan: &Plan) -> String {
    let mut kinds: Vec<(String, usize)> = Vec::new();
    for words in plan.posture_words.iter().map(ToString::to_string) {
        match kinds.iter_mut().find(|(known, _)| *known == words) {
            Some((_, count)) => *count += 1,
            None => kinds.push((words, 1)),
        }
    }
    let named = kinds.iter().take(NAMED).map(|(words, count)| format!("{words} ({count})"));
    let others = kinds.len().saturating_sub(NAMED);
    match &kinds[..] {
        [(words, _)] => words.clone(),
        _ => named.chain((others > 0).then(|| format!("{others} more"))).collect::<Vec<_>>().join("; "),
    }
}

/// What a plan deflects.
fn deflection(problem: &Problem, plan: &Plan) -> String {
    let criterion = &problem.criterion;
    let total = &plan.deflection;
    let (what, without) = match criterion.weights {
        weights if weights == Weights::TOTAL => ("whole", Some(total.total)),
        weights if weights == Weights::WALL => ("normal to the wall", Some(total.wall)),
        weights if weights == Weights::SURFACE => ("normal to the surface", total.surface),
        _ => ("weighted", None),
    };
    let most = plan.points.iter().max_by(|a, b| a.score.total_cmp(&b.score));
    let place = most.map_or(String::new(), |most| format!(" (point {})", most.point));
    let [mean, max] = [plan.mean, plan.max].map(|value| figures(value * 1e3));
    let errors = (criterion.force_uncertainty > 0.0).then(|| {
        let without = without.map_or(String::new(), |without| format!(", {} without", figures(without.mean * 1e3)));
        format!("; {:.0}% force errors covered{without}", criterion.force_uncertainty * 100.0)
    });
    format!("{mean} mm mean ({what}), {max} largest{place}{}", errors.unwrap_or_default())
}

/// Which bounds hold a best placement, which springs yield, and whether it is over the back of the robot.
fn held_by(case: &Case) -> Option<SummaryLine> {
    let bounds = case.active_bounds.as_ref()?;
    let named = bounds.iter().take(NAMED).map(|bound| format!("{} ({})", names::bound(bound), names::side(bound)));
    let held = match named.collect::<Vec<_>>() {
        none if none.is_empty() => "no bound".to_owned(),
        named => named.join(", "),
    };
    let mut slopes: Vec<_> = case.objective_by_stiffness.iter().flatten().collect();
    slopes.sort_by(|a, b| b.slope.abs().total_cmp(&a.slope.abs()));
    let sum: f64 = slopes.iter().map(|slope| slope.slope.abs()).sum();
    let share = |slope: f64| format!("{:.0}%", 100.0 * slope.abs() / sum);
    let count = slopes.len();
    let yields = slopes.iter().take(NAMED).map(|slope| format!("{} {}", short_name(slope, count), share(slope.slope)));
    let yields: Vec<String> = yields.collect();
    let is_known = sum > 0.0 && case.plan.objective > CANCELLATION;
    let yields = if is_known { format!("; yields: {}", yields.join(", ")) } else { String::new() };
    let is_over = case.plan.posture_words.iter().any(|words| words.has(PostureWord::Back));
    let over = if is_over { "; over the back of the robot" } else { "" };
    Some(summary_line("held by", format!("{held}{yields}{over}")))
}

/// What is common to all results: what is cut, what it rests on, what was not checked, and what looks wrong.
pub(super) fn rest(context: &Context) -> Summary {
    let cut = context.removal.as_ref().and_then(|removal| removal.cut);
    let mut lines: Summary = cut.iter().map(|cut| summary_line("cut", cut.words())).collect();
    for (group, about) in [(NoteGroup::RestsOn, "RESTS ON"), (NoteGroup::NotChecked, "NOT CHECKED")] {
        let words = Note::shorts(&context.notes, group);
        lines.extend((!words.is_empty()).then(|| summary_line(about, words.join("; "))));
    }
    let wrong = context.notes.iter().filter(|note| note.group() == NoteGroup::MayBeWrong).map(|note| &**note);
    let warnings: Vec<&str> = context.warnings.iter().map(|warning| &*warning.message).chain(wrong).collect();
    if let Some(first) = warnings.first() {
        let more = if warnings.len() > 1 { format!(" (and {} more)", warnings.len() - 1) } else { String::new() };
        lines.push(summary_line("WARNING", format!("{}{more}", few_words(first))));
    }
    lines
}

/// A sentence up to its first stop, or its first few words.
fn few_words(sentence: &str) -> String {
    let mut words = Vec::new();
    for word in sentence.split_whitespace() {
        let is_stop = word.ends_with([':', ';']) && words.len() + 1 >= FEWEST_WORDS;
        words.push(if is_stop { word.trim_end_matches([':', ';']) } else { word });
        if is_stop {
            return words.join(" ");
        }
        if words.len() == WORDS {
            words.push("..");
            break;
        }
    }
    words.join(" ")
}

/// Everything that there is to say of a placement job: the text of `notes.txt`.
pub(super) fn placement_notes(problem: &Problem, outcome: &Outcome, context: &Context) -> String {
    let summary = placement_summary(problem, outcome, context);
    notes_text(&summary, &placement_text(problem, outcome, context), context)
}

/// The summary and the tables, then warnings and notes by their groups.
pub(super) fn notes_text(summary: &[SummaryLine], tables: &str, context: &Context) -> String {
    let mut text = format!("{}\n{}", summary_text(summary), tables);
    let mut part = |title: &str, sentences: Vec<&str>| {
        if !sentences.is_empty() {
            text.push_str(&format!("\n{title}\n"));
            sentences.iter().for_each(|sentence| text.push_str(&format!("- {sentence}\n")));
        }
    };
    part("Warnings", context.warnings.iter().map(|warning| &*warning.message).collect());
    for (group, title) in [
        (NoteGroup::MayBeWrong, "What may be wrong"),
        (NoteGroup::RestsOn, "What the result rests on"),
        (NoteGroup::NotChecked, "What was not checked"),
        (NoteGroup::Computed, "How it was computed"),
    ] {
        let of_group = context.notes.iter().filter(|note| note.group() == group);
        part(title, of_group.map(|note| &**note).collect());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sentences_end_at_their_first_stop_or_after_a_few_words() {
        assert_eq!(
            few_words("NOT FREE: no free way between segments: the time"),
            "NOT FREE: no free way between segments"
        );
        let long = ["word"; 30].join(" ");
        assert_eq!(few_words(&long), format!("{} ..", ["word"; WORDS].join(" ")));
        assert_eq!(few_words("short"), "short");
    }
}
