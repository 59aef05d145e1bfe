//! What matters of a study, in words.

use super::words::cases;
use crate::columns::{line, table};
use crate::units::{figures, fixed};
use stead_problem::sense::Sense;
use stead_study::analysis::{Analysis, AxisEffect, Failures, Front, Layouts, Measure, Method, Ranking};
use stead_study::cases::TableCell;

/// Most rows of a table; the files have all.
const ROWS: usize = 10;

/// The best layout and by how much, what each axis does, the front, and what failed and why.
pub fn study_text(name: &str, analysis: &Analysis) -> String {
    let failures = &analysis.failures;
    let mut text = format!("{name}: {} cases, {} placed", failures.cases, failures.cases - failures.count());
    for (count, what) in [(failures.infeasible, "infeasible"), (failures.failed, "failed")] {
        if count > 0 {
            text.push_str(&format!(", {count} {what}"));
        }
    }
    line(&mut text, "");
    if !analysis.layouts.tasks().is_empty() {
        let (layouts, tasks) = (analysis.layouts.all.len(), analysis.layouts.tasks().len());
        let joined = "means over the tasks by their weights, margins the smallest";
        line(&mut text, &format!("{layouts} layouts with {tasks} tasks each: {joined}"));
    }
    best(&mut text, analysis);
    analysis.notes.iter().for_each(|note| line(&mut text, &format!("  note: {note}")));
    if !analysis.tasks.is_empty() {
        line(&mut text, "\nBest for each task:");
        text.push_str(&tasks(analysis));
    }
    effects(&mut text, analysis);
    if let Some(front) = &analysis.front {
        front_text(&mut text, front, &analysis.layouts);
    }
    failures_text(&mut text, failures);
    text
}

/// A value with five digits.
fn digits(value: f64) -> String {
    let exponent = if value == 0.0 { 0.0 } else { libm::floor(libm::log10(value.abs())) };
    if (-5.0..9.0).contains(&exponent) {
        fixed(value, (4.0 - exponent).max(0.0) as usize)
    } else {
        format!("{value:.4e}")
    }
}

fn percent(share: f64) -> String {
    fixed(100.0 * share, 1)
}

fn better(measure: &Measure) -> &'static str {
    if measure.sense == Sense::Min { "smaller is better" } else { "larger is better" }
}

/// A layout by its cases and the values of the axes.
fn layout(layouts: &Layouts, index: usize) -> String {
    let layout = &layouts.all[index];
    let word = if layout.cases.len() > 1 { "cases" } else { "case" };
    let words = layouts.words(layout);
    let words = if words.is_empty() { words } else { format!(" ({words})") };
    format!("{word} {}{words}", cases(layout))
}

/// What a ranking by one column leaves out of a layout: columns, and the words around their values.
const BESIDE: [(&str, &str, &str); 6] = [
    ("best_mean_total_mm", "mean deflection in all directions ", " mm"),
    ("best_max_total_mm", "largest ", " mm"),
    ("min_joint_margin_deg", "joints ", " deg from their limits"),
    ("min_inverse_condition", "1/kappa at least ", ""),
    ("payload_kg", "payload of the arm ", " kg"),
    ("active_bounds", "held by ", ""),
];

/// What else matters of a layout, as far as it is known.
fn beside(layouts: &Layouts, index: usize) -> String {
    let value = |name: &str| {
        let column = layouts.columns.iter().position(|column| column.name == name)?;
        match layouts.all[index].row.get(column)? {
            TableCell::None => None,
            TableCell::Number(number) => Some(figures(*number)),
            cell => Some(cell.written()),
        }
    };
    let words = BESIDE.iter().filter_map(|(name, before, after)| Some(format!("{before}{}{after}", value(name)?)));
    words.collect::<Vec<_>>().join(", ")
}

fn best(text: &mut String, analysis: &Analysis) {
    let (ranking, layouts) = (&analysis.ranking, &analysis.layouts);
    let Measure { name, .. } = &ranking.measure;
    let [first, ties @ ..] = ranking.best() else {
        return line(text, &format!("No case has a value of {name}."));
    };
    let noise = percent(analysis.noise);
    let better = better(&ranking.measure);
    line(text, &format!("\nBy {name} ({better}; within {noise} % layouts tie, for a search is no more exact):"));
    line(text, &format!("  best      {}  {}", digits(first.value), layout(layouts, first.layout)));
    let beside = beside(layouts, first.layout);
    if !beside.is_empty() {
        line(text, &format!("            {beside}"));
    }
    for tie in ties.iter().take(ROWS) {
        line(text, &format!("  tie       {}  {}", digits(tie.value), layout(layouts, tie.layout)));
    }
    if ties.len() > ROWS {
        line(text, &format!("  and {} more ties (study-ranking.csv)", ties.len() - ROWS));
    }
    match ranking.next() {
        None => line(text, "  all others tie with it"),
        Some(next) => {
            let behind = next.behind.map_or_else(String::new, |behind| format!(", {} % behind", percent(behind)));
            line(text, &format!("  next      {}  {}{behind}", digits(next.value), layout(layouts, next.layout)));
            if let Some(last) = ranking.ranked.last().filter(|last| last.layout != next.layout) {
                let behind = last.behind.map_or_else(String::new, |behind| format!(", {} % behind", percent(behind)));
                line(text, &format!("  last      {}  {}{behind}", digits(last.value), layout(layouts, last.layout)));
            }
        }
    }
}

fn tasks(analysis: &Analysis) -> String {
    let rows = analysis.tasks.iter().map(|task| {
        let ranking: &Ranking = &task.ranking;
        let next = ranking.next().and_then(|next| next.behind).map_or_else(|| "–".to_owned(), percent);
        match ranking.best() {
            [] => vec![task.task.clone(), "–".to_owned(), "no placement".to_owned(), next],
            [first, ties @ ..] => {
                let ties = if ties.is_empty() { String::new() } else { format!(" and {} ties", ties.len()) };
                let words = format!("{}{ties}", layout(&task.layouts, first.layout));
                vec![task.task.clone(), digits(first.value), words, next]
            }
        }
    });
    table(["task", &analysis.ranking.measure.name, "layout", "next %"], rows, &[0, 2])
}

fn effects(text: &mut String, analysis: &Analysis) {
    let effects = &analysis.effects;
    if effects.axes.is_empty() {
        return;
    }
    let name = &effects.measure.name;
    match &effects.axes[..] {
        [only] => return line(text, &alone(only, &effects.measure)),
        [first, ..] if first.share.is_some_and(|share| share > 0.0) => {
            let share = first.share.map_or_else(String::new, percent);
            line(text, &format!("\nWhat matters most for {name} is {}: {share} % of the variance.", first.name));
        }
        _ => line(text, &format!("\nNo axis changes {name}.")),
    }
    let rows = effects.axes.iter().map(|axis| effect_row(axis, &effects.measure));
    text.push_str(&table(["axis", "% of variance", "range", "per unit", "best value", "by"], rows, &[0, 4, 5]));
    if let Some(rest) = effects.remainder.filter(|rest| *rest >= 0.0005) {
        line(text, &format!("{} % is what the axes do together, beyond their effects one by one", percent(rest)));
    }
    text.push_str(&against_the_best(analysis));
    let says = |method: Method| effects.axes.iter().any(|axis| axis.method == method);
    if says(Method::AdjustedMeans) {
        line(
            text,
            "adjusted means: cases are missing or come unequally often, so that all axes were fitted together by least squares",
        );
    }
    if says(Method::Line) {
        line(
            text,
            "line: too many values for means; a straight line fitted with all other axes; beside it the rank correlation",
        );
    }
    if says(Method::MixedMeans) {
        line(
            text,
            "mixed means: axes that vary together cannot be told apart; each has the effects of the others in it",
        );
    }
}

/// Axes of which the best layout has another value than the one that is best on average.
fn against_the_best(analysis: &Analysis) -> String {
    let Some(best) = analysis.ranking.best().first() else { return String::new() };
    let (row, measure) = (&analysis.layouts.all[best.layout].row, &analysis.effects.measure);
    let mut text = String::new();
    for axis in &analysis.effects.axes {
        let Some(level) = axis.best(measure.sense) else { continue };
        let own = row[axis.axis].written();
        let other = axis.levels.iter().find(|other| other.label == own && !measure.is_tie(level.value, other.value));
        if other.is_some() {
            let (axis, average) = (&axis.name, &level.label);
            line(&mut text, &format!("{axis}: {average} is best on average, but the best layout has {own}"));
        }
    }
    text
}

/// What an axis does that no other is varied beside: it explains all there is.
fn alone(axis: &AxisEffect, measure: &Measure) -> String {
    let at = |sense: Sense| {
        let level = axis.levels.iter().min_by(|a, b| sense.compare(a.value, b.value));
        level.map_or_else(String::new, |level| format!("{} at {}", digits(level.value), level.label))
    };
    let slope = axis.slope.map_or_else(String::new, |slope| {
        format!("; along a straight line it changes by {} per unit of {}", digits(slope), axis.name)
    });
    format!("\nOnly {} varies: {} is from {} to {}{slope}.", axis.name, measure.name, at(Sense::Min), at(Sense::Max))
}

fn effect_row(axis: &AxisEffect, measure: &Measure) -> Vec<String> {
    let is_tie = |best: f64| axis.levels.iter().all(|level| measure.is_tie(best, level.value));
    let best = match axis.best(measure.sense) {
        Some(level) if is_tie(level.value) => "tie".to_owned(),
        Some(level) => level.label.clone(),
        None => String::new(),
    };
    let correlation = axis.rank_correlation.filter(|_| axis.method == Method::Line);
    let method = correlation
        .map_or_else(|| axis.method.word().to_owned(), |c| format!("line, rank correlation {}", fixed(c, 2)));
    let share = axis.share.map_or_else(|| "–".to_owned(), percent);
    let slope = axis.slope.map_or_else(|| "–".to_owned(), digits);
    vec![axis.name.clone(), share, digits(axis.range), slope, best, method]
}

fn front_text(text: &mut String, front: &Front, layouts: &Layouts) {
    let names: Vec<String> =
        front.measures.iter().map(|measure| format!("{} ({})", measure.name, better(measure))).collect();
    let ties = front.members.iter().filter(|member| member.is_tie).count();
    let close = if ties == 0 { String::new() } else { format!(", and {ties} behind them within the noise") };
    let clear = front.members.len() - ties;
    line(text, &format!("\nOn the front of {}: {clear} of {}{close}", names.join(" and "), front.compared.len()));
    let axes = layouts.varied();
    let measures = front.measures.iter().map(|measure| measure.name.as_str());
    let header = std::iter::once("cases").chain(measures).chain(axes.iter().map(|axis| &*layouts.columns[*axis].name));
    let rows = front.members.iter().filter(|member| !member.is_tie).take(ROWS).map(|member| {
        let found = &layouts.all[member.layout];
        let mut row = vec![cases(found)];
        row.extend(member.values.iter().map(|value| digits(*value)));
        row.extend(axes.iter().map(|axis| found.row[*axis].written()));
        row
    });
    let words: Vec<usize> = (1..=axes.len()).map(|k| front.measures.len() + k).collect();
    text.push_str(&table(header, rows, &words));
    if clear > ROWS {
        line(text, &format!("and {} more (study-front.csv)", clear - ROWS));
    }
}

fn failures_text(text: &mut String, failures: &Failures) {
    if failures.count() == 0 {
        return;
    }
    line(text, &format!("\nWithout a placement: {} of {} cases", failures.count(), failures.cases));
    for (reason, count, first) in failures.reasons.iter().take(ROWS) {
        let which = if *count > 1 { format!("{count} cases, as case {first}") } else { format!("case {first}") };
        line(text, &format!("  {which}: {reason}"));
    }
    if failures.reasons.len() > ROWS {
        line(text, &format!("  and {} more reasons (study.csv)", failures.reasons.len() - ROWS));
    }
    for lost in failures.lost.iter().take(ROWS) {
        let values: Vec<String> = lost.values.iter().map(|[axis, value]| format!("{axis} = {value}")).collect();
        line(text, &format!("  none of the {} cases with {} has one", lost.cases, values.join(" and ")));
    }
}
