//! The short table for people.

use super::{Context, origins, setup};
use crate::columns::{line, table};
use crate::names;
use crate::units::{figures, fixed};
use stead_model::published::Published;
use stead_placement::outcome::{Case, DeflectionFigures, ForceSensitivity, Outcome, PathLevels, Plan, SetBasin};
use stead_placement::sensitivity::SpringSlope;
use stead_planning::feed::{CutFeed, FeedLimit};
use stead_problem::collision::PlanClearance;
use stead_problem::criterion::{CANCELLATION, Over};
use stead_problem::joint_travel::Swing;
use stead_problem::problem::Problem;
use stead_problem::symmetry::Unsupported;

/// Widest posture scheme that is written in full.
const POSTURES_WIDTH: usize = 40;

/// The four cases, or the first two of them where the worst placement was not looked for: first placements and posture
/// schemes, then mean and largest score and total deflection, the ratio to case 1 beside the published figures where
/// there are any, and times, and the standard deviation of the mean of c_i where the robot's uncertainty is known; last
/// the size of the search. Lines are at most 110 characters wide and end with a line break.
pub fn placement_text(problem: &Problem, outcome: &Outcome, context: &Context) -> String {
    let (points, segments) = (problem.task.points().len(), problem.task.segments().len());
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let (points, segments) = (count(points, "point"), count(segments, "segment"));
    let mut text = format!("{}: {points} in {segments}\n\n", problem.robot.name());
    text.push_str(&placements(outcome));
    let plans = outcome.cases.all().into_iter().map(|case| &case.plan);
    names::posture_lines(plans).iter().for_each(|row| line(&mut text, row));
    text.push_str(&setup::text(problem, outcome));
    text.push('\n');
    text.push_str(&deflections(outcome, context.reference.as_ref()));
    if let Some(reference) = &context.reference {
        line(&mut text, &format!("ref: {}", reference.source));
    }
    text.push('\n');
    for case in outcome.cases.optima() {
        held_by(case).iter().for_each(|row| line(&mut text, row));
    }
    origins::of_plan(&outcome.cases.best.plan).iter().for_each(|row| line(&mut text, row));
    sag(&outcome.cases.best.plan).iter().for_each(|row| line(&mut text, &format!("best plan: {row}")));
    stiffest(&outcome.cases.best).iter().for_each(|row| line(&mut text, row));
    least_room(&outcome.cases.best.plan, "best plan").iter().for_each(|row| line(&mut text, row));
    highest_feed(&outcome.cases.best.cycle.feed).iter().for_each(|row| line(&mut text, row));
    held_feed(&outcome.cases.best.plan).iter().for_each(|row| line(&mut text, row));
    line(&mut text, &joint_travel(&outcome.cases.best.plan));
    if let [_, ..] = &outcome.sets[..] {
        text.push('\n');
        text.push_str(&sets(outcome, context));
        choice_by_regret(problem, outcome).iter().for_each(|row| line(&mut text, row));
    }
    if let Some(found) = &outcome.sensitivity {
        sensitivity(found).iter().for_each(|row| line(&mut text, row));
    }
    if let Some(stability) = &context.stability {
        text.push('\n');
        text.push_str(&crate::stability::path::text(stability, ["best placement", "worst placement"]));
    }
    text.push('\n');
    search_lines(outcome).iter().for_each(|row| line(&mut text, row));
    text
}

/// The size of the search.
fn search_lines(outcome: &Outcome) -> Vec<String> {
    let mut lines = vec![format!("{} placements and {} states evaluated", outcome.evaluations, outcome.states)];
    lines.extend(outcome.path_levels.iter().map(path_levels));
    lines.extend(outcome.lookup_summary.as_ref().map(|summary| match summary {
        Ok(lookup_summary) => {
            let (states, megabytes) = (lookup_summary.shape.states(), lookup_summary.shape.bytes() as f64 / 1e6);
            let error = figures(lookup_summary.accuracy.rms * 100.0);
            format!("most of them from a lookup table of {states} states ({megabytes:.1} MB), error {error} % (rms)")
        }
        Err(rejected @ Unsupported::Rejected) => format!("searched again without a lookup table: {rejected}"),
        Err(unsuited) => format!("none of them from a lookup table: {unsuited}"),
    }));
    if outcome.interrupted {
        lines.push("The search was stopped before its end: this is the best result so far.".to_owned());
    }
    lines
}

/// By how many points of a long path placements were compared, and how far that is off.
fn path_levels(levels: &PathLevels) -> String {
    let (search, refinement) = (levels.search, levels.refinement);
    let error = search.error.map_or(String::new(), |error| {
        let (percent, pairs) = (figures(error * 100.0), search.pairs);
        format!(": means are off by up to {percent} % there ({pairs} placements planned both ways)")
    });
    format!(
        "searched on {} and refined on {} of {} points{error}; {} placements were planned on all points",
        search.points, refinement.points, levels.points, levels.whole
    )
}

/// Bounds that are named; the others are counted.
const NAMED: usize = 3;

/// Which bounds hold a best or worst placement, and what moving them would gain: a line each.
fn held_by(case: &Case) -> Vec<String> {
    let word = names::sense(case.placement_sense);
    let Some(bounds) = &case.active_bounds else {
        return vec![format!("which bounds hold the {word} placement is not known")];
    };
    if bounds.is_empty() {
        return vec![format!("no bound holds the {word} placement: the robot and the path decide")];
    }
    let mut lines = vec![format!("the {word} placement is held by")];
    lines.extend(bounds.iter().take(NAMED).map(|bound| {
        let (gain, unit) = names::gain(bound);
        let side = names::side(bound);
        format!("  {} ({side}): {} {unit}", names::bound(bound), figures(gain))
    }));
    let others = bounds.len().saturating_sub(NAMED);
    lines.extend((others > 0).then(|| format!("  and {others} more")));
    lines
}

/// The springs of a slope in words: `joint 5 about z with joint 4 about y`.
pub(super) fn spring_name(slope: &SpringSlope) -> String {
    slope.springs.iter().map(ToString::to_string).collect::<Vec<_>>().join(" with ")
}

/// The joint of a slope where there is one for each, else its springs.
pub(super) fn short_name(slope: &SpringSlope, count: usize) -> String {
    match slope.springs.first() {
        Some(spring) if count == 6 => format!("joint {}", spring.joint + 1),
        _ => spring_name(slope),
    }
}

/// How far the weight moves the tool along a plan, where that is known.
pub(super) fn sag(plan: &Plan) -> Option<String> {
    let sag = plan.sag.as_ref()?;
    let [least, largest, spread] =
        [sag.path.least, sag.path.largest, sag.path.spread].map(|value| fixed(value * 1e3, 4));
    let within = fixed(sag.segments.iter().map(|(_, range)| range.spread).fold(0.0, f64::max) * 1e3, 4);
    Some(format!(
        "weight moves the tool by {least} to {largest} mm, differently by up to {spread} mm ({within} mm within a segment)"
    ))
}

/// The joint whose stiffness matters most to the best placement.
fn stiffest(case: &Case) -> Option<String> {
    let slopes = case.objective_by_stiffness.as_ref()?;
    let first = slopes.iter().max_by(|a, b| a.slope.abs().total_cmp(&b.slope.abs()))?;
    let slope = first.slope;
    let name = short_name(first, slopes.len());
    let share = if case.plan.objective > CANCELLATION { slope / case.plan.objective } else { 0.0 };
    Some(format!(
        "{name} matters most to the best placement: 1 % more stiffness changes what is minimised by {} %",
        figures(share)
    ))
}

/// The least room of a plan between two shapes, where there are shapes.
pub(super) fn least_room(plan: &Plan, name: &str) -> Option<String> {
    let PlanClearance { point, distance, names } = plan.clearance.as_ref()?;
    let [a, b] = names.as_ref();
    let distance = fixed(distance * 1e3, 1);
    Some(format!("least clearance of the {name}: {distance} mm between {a} and {b}, at point {point}"))
}

/// The highest feed of a best plan and what decides it, a line each, where a limit of the joints is known.
pub(super) fn highest_feed(feed: &CutFeed) -> Vec<String> {
    let lines = |limit: FeedLimit| {
        let [highest, programmed] = [limit.feed, feed.programmed].map(|feed| figures(feed * 1e3));
        vec![
            format!("the best plan holds a feed of up to {highest} mm/s (programmed: {programmed} mm/s)"),
            format!("  what decides: {}", feed.decided_by(&limit)),
        ]
    };
    feed.highest().map_or_else(Vec::new, lines)
}

/// What a best plan comes to at the feed that the arm holds, beside the programmed one, where it is known how the
/// forces change with the feed.
pub(super) fn held_feed(plan: &Plan) -> Vec<String> {
    let Some(held) = &plan.held else { return Vec::new() };
    if held.slowed == 0 {
        return vec!["forces and deflections are those of the programmed feed, which the best plan holds".to_owned()];
    }
    let row = |name: &str, mean: f64, max: f64, deflection: &DeflectionFigures| {
        let [mean, max, total, most] =
            [mean, max, deflection.total.mean, deflection.total.max].map(|value| fixed(value * 1e3, 4));
        format!(
            "  at the {name} feed: mean {mean} mm, largest {max} mm; whole deflection {total} mm, largest {most} mm"
        )
    };
    vec![
        format!("segments of the best plan that are cut slower than programmed, with less force: {}", held.slowed),
        row("programmed", plan.mean, plan.max, &plan.deflection),
        row("held", held.mean, held.max, &held.deflection),
    ]
}

/// How much a best plan turns the joints.
pub(super) fn joint_travel(plan: &Plan) -> String {
    let degrees = |angle: f64| fixed(angle.to_degrees(), 0);
    let swing = plan.travel.swing.map_or(String::new(), |Swing { joint, angle, length, .. }| {
        format!(", joint {joint} by {} deg within {} mm", degrees(angle), figures(length * 1e3))
    });
    format!("the best plan turns the joints by {} deg in all{swing}", degrees(plan.travel.total))
}

/// What each stiffness set makes of the best placement.
fn sets(outcome: &Outcome, context: &Context) -> String {
    let files = context.inputs.iter().filter(|input| input.role == "stiffness");
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let rows = outcome.sets.iter().zip(files).map(|(set, file)| {
        let regret = set.regret().map(|regret| fixed(regret * 100.0, 1));
        let alone = set.alone.map(|alone| fixed(alone * 1e3, 4));
        vec![file.name.clone(), fixed(set.mean * 1e3, 4), or_dash(alone), or_dash(regret)]
    });
    table(["stiffness set", "mean mm", "best alone mm", "regret %"], rows, &[0])
}

/// Which of the refined basins was taken, where their regrets decide.
fn choice_by_regret(problem: &Problem, outcome: &Outcome) -> Option<String> {
    problem.criterion.stiffness.as_ref().filter(|sets| sets.over == Over::Regret)?;
    let of_least = |of: fn(&SetBasin) -> f64| outcome.set_basins.iter().min_by(|a, b| of(a).total_cmp(&of(b)));
    let taken = of_least(|basin| basin.regret.unwrap_or(f64::INFINITY))?.regret?;
    let by_mean = of_least(|basin| basin.objective)?.regret?;
    let [taken, by_mean] = [taken, by_mean].map(|regret| fixed(regret * 100.0, 1));
    let count = outcome.set_basins.len();
    Some(format!(
        "of {count} refined basins the one of least regret is taken: {taken} %; the least objective has {by_mean} %"
    ))
}

/// What force errors do to the best placement.
fn sensitivity(found: &ForceSensitivity) -> Vec<String> {
    let [[plain, with], [robust, robust_with]] =
        [found.nominal, found.robust].map(|pair| pair.map(|value| fixed(value * 1e3, 4)));
    vec![
        format!("force errors of {} % in the worst direction:", figures(found.force_uncertainty * 100.0)),
        format!("  the best placement has {plain} mm, and {with} mm with them"),
        format!("  the best placement for them has {robust} mm, and {robust_with} mm with them"),
        format!("  it is {} mm and {} deg away", fixed(found.distance * 1e3, 1), fixed(found.turn.to_degrees(), 1)),
    ]
}

fn placements(outcome: &Outcome) -> String {
    let rows = outcome.cases.all().into_iter().map(|case| {
        let [placement_word, plan_word] = [case.placement_sense, case.plan_sense].map(names::sense);
        let placement = &case.placement;
        let mut row = vec![case.number().to_string(), placement_word.to_owned(), plan_word.to_owned()];
        row.extend([placement.x, placement.y, placement.z].map(|value| fixed(value * 1e3, 1)));
        row.push(fixed(placement.yaw.to_degrees(), 1));
        row.push(fixed(placement.q4(), 4));
        row.push(names::postures_within(&case.plan.postures, POSTURES_WIDTH));
        row
    });
    table(["case", "place", "plan", "x mm", "y mm", "z mm", "yaw deg", "Q4", "postures"], rows, &[1, 2, 8])
}

/// What the columns of deflections are, in a line.
pub(super) fn legend(problem: &Problem) -> String {
    let is_more = problem.criterion.force_uncertainty != 0.0 || problem.covers_compliance_errors();
    let [with, without] = if is_more { [" with the errors covered", ", without them"] } else { [""; 2] };
    let part = problem.scored_words();
    format!("mean and max: {part} of the scored points{with}; total: their whole deflection{without}\n")
}

fn deflections(outcome: &Outcome, reference: Option<&Published<[f64; 4]>>) -> String {
    let mut header = vec!["case", "mean mm", "max mm", "total mm", "max total"];
    header.extend(outcome.cases.best.plan.mean_deviation.map(|_| "std mm"));
    header.push("ratio");
    if reference.is_some() {
        header.extend(["ref mm", "ref ratio"]);
    }
    header.extend(["cutting s", "moves s", "cycle s"]);
    let rows = outcome.cases.all().into_iter().enumerate().map(|(index, case)| {
        let mut row = vec![case.number().to_string()];
        let total = case.plan.deflection.total;
        row.extend([case.plan.mean, case.plan.max, total.mean, total.max].map(|value| fixed(value * 1e3, 4)));
        row.extend(case.plan.mean_deviation.map(|value| fixed(value * 1e3, 4)));
        row.push(outcome.cases.ratio(case).map_or_else(|| "-".to_owned(), |ratio| fixed(ratio, 2)));
        if let Some(Published { figures: case_mm, .. }) = reference {
            row.extend([case_mm[index].to_string(), fixed(case_mm[index] / case_mm[0], 2)]);
        }
        let total = case.cycle.total();
        let moves = total.map(|total| total - case.cycle.cutting);
        let seconds = |time: Option<f64>| time.map_or_else(|| "-".to_owned(), |time| fixed(time, 1));
        row.extend([Some(case.cycle.cutting), moves, total].map(seconds));
        row
    });
    table(header, rows, &[])
}
