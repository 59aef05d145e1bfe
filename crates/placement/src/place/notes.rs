//! What should be known about a result, said of the cases that are stated, when they are.

use super::calmer::{calmer, swing};
use super::job::Job;
use super::plan::plans_of;
use crate::outcome::{Case, Cases, Cycle, Plan};
use stead_model::plausibility;
use stead_model::robot::PostureWord;
use stead_model::task::lean::{Lean, LeanForce};
use stead_numerics::digits::figures;
use stead_numerics::message::{Note, Warning};
use stead_numerics::monitor::Monitor;
use stead_planning::feed::CutFeed;
use stead_planning::transfer_path::{self, ShortLine, TransferPath};
use stead_problem::criterion::{CANCELLATION, Criterion, SMALL_PART};
use stead_problem::problem::{Placement, Problem};

/// Warns of a plan that balances the deflection to nothing: a result of the criterion, not of the robot.
pub(super) fn cancellation(problem: &Problem, mean: f64) -> Option<Warning> {
    (mean <= CANCELLATION && problem.largest_force() > 0.0 && problem.criterion == Criterion::default()).then(|| {
        let message = "the best plan cancels the deflection to nothing, which no real force will; \
                       criterion.force_uncertainty makes the score the worst case over force errors";
        Warning::new("cancellation", message)
    })
}

/// What should be known about cases, those beside their plans among it, and why they may not be what was wanted.
pub(super) fn of_cases(
    job: &Job<'_>,
    cases: &Cases,
    beside: Vec<Note>,
    interrupted: bool,
) -> (Vec<Note>, Vec<Warning>) {
    let Case { placement, setup, plan, cycle, .. } = &cases.best;
    let set_up = job.problem.in_setup(setup);
    let mut notes = of(&set_up, placement, plan, &cycle.feed, job.monitor);
    notes.extend((!job.settings.worst).then(best_alone).into_iter().chain(beside));
    let named: Vec<_> = cases.all().into_iter().map(|case| (format!("case {}", case.number()), &case.cycle)).collect();
    let named: Vec<_> = named.iter().map(|(name, cycle)| (name.as_str(), *cycle)).collect();
    let moves = moves(&named, short_ends(&set_up, placement, "case 1", plan));
    let cancelled = cancellation(job.problem, plan.objective);
    (notes, cancelled.into_iter().chain(moves).chain(interrupted.then(interruption)).collect())
}

/// What should be known about a best plan though nothing is wrong with it.
pub(super) fn of(
    problem: &Problem,
    placement: &Placement,
    plan: &Plan,
    feed: &CutFeed,
    monitor: &Monitor,
) -> Vec<Note> {
    let large = plausibility::deflection(plan.deflection.total.max);
    let sags = plan.sag.as_ref().and_then(|sag| plausibility::sag(sag.path.largest));
    let wrong = small_part(problem, plan).into_iter().chain(large).chain(sags).map(Note::may_be_wrong);
    let of_travel = [swing(plan), calmer(problem, placement, plan, monitor)].into_iter().flatten();
    let of_weight = weight(problem, plan);
    let over_head = over_head(plan);
    let computed = over_head.into_iter().chain(of_weight).chain(slowed(feed)).chain(of_travel).map(Note::from);
    wrong.chain(computed).collect()
}

/// A note on segments along which the arm reaches over its head.
fn over_head(plan: &Plan) -> Option<String> {
    let numbered = plan.posture_words.iter().zip(1..);
    let back: Vec<usize> =
        numbered.filter(|(words, _)| words.has(PostureWord::Back)).map(|(_, number)| number).collect();
    let (first, count) = (*back.first()?, back.len());
    let which = match count {
        1 => format!("segment {first}"),
        _ if count == plan.posture_words.len() => "every segment".to_owned(),
        _ => format!("{count} segments, the first of them {first}"),
    };
    Some(format!(
        "the best plan goes over the back of the robot along {which} (wrist behind axis 1), where dress packs and cables may be \
         in the way: allowed = [\"front\"] in [postures] leaves such plans out"
    ))
}

/// A note on the weight, which moves the tool and is in no score, where the mass of what the flange carries is known.
fn weight(problem: &Problem, plan: &Plan) -> Option<String> {
    let (sag, mass) = (plan.sag.as_ref()?, problem.spindle.carried_mass()?.mass);
    let links = match problem.robot.dynamics() {
        Some(_) => " and of the links",
        None => " (the masses of the links are not known, and left out)",
    };
    let mm = |value: f64| figures(value * 1e3);
    Some(format!(
        "the weight of the {} kg on the flange{links} moves the tool by {} to {} mm along the best plan, differently by up to {} mm (sag_mm): \
         no score counts it, since it is there when the program is touched up; it must be calibrated out, or corrected by the controller \
         or by `stead compensate` with gravity = true",
        figures(mass),
        mm(sag.path.least),
        mm(sag.path.largest),
        mm(sag.path.spread)
    ))
}

/// A note that there is no worst placement to compare with.
pub(super) fn best_alone() -> Note {
    let text = "the worst placement was not looked for: there is nothing to compare the best one with";
    Note::from(text.to_owned())
}

/// That no figures of single stiffness sets are stated where the tool leans.
pub(super) fn no_sets() -> Note {
    "what each stiffness set makes of the best placement is not stated where the tool leans".to_owned().into()
}

/// That what is compared with the best placement has its external axes.
pub(super) fn held_axes() -> Note {
    let text = "what is best for one stiffness set alone, or where force errors are covered, is looked for with the external axes where \
                they stand in the best plan";
    Note::from(text.to_owned())
}

/// That no other plan than the best one was found.
pub(super) fn no_worst_plan() -> Note {
    let text = "no plan was found among those that deflect most, as in a narrow space: the best plan is stated as the worst, \
                too";
    Note::from(text.to_owned())
}

/// Notes on a tool that leans: by how much, what it gains, and what was not searched.
pub(super) fn of_lean(problem: &Problem, upright: Option<f64>, leaned: f64, has_worst: bool) -> Vec<Note> {
    let Some(space) = &problem.lean else { return Vec::new() };
    let mm = |value: f64| figures(value * 1e3);
    let mut notes = vec![match (problem.task.path().leans(), upright) {
        (None, _) => "the tool may lean, and the best plan found keeps to the axis of the path".to_owned(),
        (Some(leans), upright) => {
            let ends = |of: &dyn Fn(&Lean) -> f64| {
                let all = || leans.iter().map(|lean| of(lean).to_degrees());
                let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
                format!("{least:.1} to {most:.1} deg")
            };
            let [lead, tilt, lean] = [ends(&|lean| lean.lead), ends(&|lean| lean.tilt), ends(&Lean::angle)];
            let gain = match upright {
                Some(upright) => {
                    format!("{} mm in place of {} mm, the best with the axis of the path", mm(leaned), mm(upright))
                }
                None => format!("{} mm; with the axis of the path no placement that was tried has a plan", mm(leaned)),
            };
            format!("the tool leans from the axis of the path by {lean} (lead {lead}, tilt {tilt}): {gain}")
        }
    }];
    if problem.task.path().leans().is_some() {
        let most = problem.task.path().leans().into_iter().flatten().map(Lean::angle).fold(0.0, f64::max);
        let other = 2.0 * libm::sin(most / 2.0) * 100.0;
        notes.push(match space.rule.force {
            _ if problem.task.has_lean_forces() => {
                "forces are those of the tool as it leans: computed from the stock for five values of lead and of tilt at every point, the \
                 tool leaning so all along, and straight between them; stock, engagement and chips are shown for the axis of the path"
                    .to_owned()
            }
            LeanForce::Feed => format!(
                "forces keep the directions of feed and wall however the tool leans (lean.force = \"feed\"); if they turned with the tool \
                 they would differ by up to {other:.0} %"
            ),
            LeanForce::Tool => format!(
                "forces turn with the tool (lean.force = \"tool\"); if they kept the directions of feed and wall they would differ by up to \
                 {other:.0} %"
            ),
        });
    }
    if !problem.external_axes.is_empty() {
        notes.push(
            "external axes are where they are best with the axis of the path while placements are compared; they are planned together with \
             lead and tilt at the best few alone"
                .to_owned(),
        );
    }
    let worst = match (has_worst, upright) {
        (false, _) => "",
        (true, Some(_)) => {
            "; the worst placement is the worst with the axis of the path, with the tool leaning as well as it can there"
        }
        (true, None) => "; the worst placement is the worst of those that were drawn",
    };
    notes.push(format!(
        "lead and tilt are planned at placements that are good with the axis of the path and at the best of some drawn over the cell, and \
         refined with the placement: a place that is good only with a leaning tool may have been missed{worst}"
    ));
    notes.into_iter().map(Note::from).collect()
}

/// A note that the arm does not hold the programmed feed.
fn slowed(feed: &CutFeed) -> Option<String> {
    let (segments, limit) = (feed.slowed(), feed.highest()?);
    (segments > 0).then(|| {
        format!(
            "the best plan does not hold the programmed feed of {} mm/s but {} mm/s: {}, decides; {segments} of {} segments are \
             slower, and cutting times are with the highest feed of each",
            figures(feed.programmed * 1e3),
            figures(limit.feed * 1e3),
            feed.decided_by(&limit),
            feed.segments.len()
        )
    })
}

/// A note on a plan whose scored part is small beside the whole deflection: it may have been balanced against itself.
fn small_part(problem: &Problem, plan: &Plan) -> Option<String> {
    let (scored, total) = (plan.mean * 1e3, plan.deflection.total.mean * 1e3);
    (problem.criterion.force_uncertainty == 0.0 && scored < SMALL_PART * total).then(|| {
        format!(
            "the scored part of the deflection, {} mm in the mean, is below a fifth of the whole, {} mm: a plan that balances one \
             part leaves the rest; criterion.direction = \"total\" scores the whole, and criterion.force_uncertainty covers errors of \
             the force",
            figures(scored),
            figures(total)
        )
    })
}

pub(super) fn interruption() -> Warning {
    Warning::new("interrupted", "interrupted: the results are the best found so far, not the end of the search")
}

/// Moves between path points that the arm cannot follow, moves between segments that have no free way, and lines into
/// and out of the cut that are shorter than they should be, of plans with their names.
pub(super) fn moves(plans: &[(&str, &Cycle)], ends: Vec<String>) -> Vec<Warning> {
    let ways = |plan: &(&str, &Cycle)| {
        let found =
            plan.1.transfers.iter().filter_map(|transfer| Some((transfer.after_segment, transfer.way.clone()?)));
        found.map(|found| (plan.0.to_owned(), found)).collect::<Vec<_>>()
    };
    let all: Vec<(String, (usize, TransferPath))> = plans.iter().flat_map(ways).collect();
    let blocked = all.iter().filter_map(|(plan, (segment, way))| {
        let names = way.blocked_by.as_ref()?;
        Some(format!("{plan} after segment {segment} ({} and {})", names[0], names[1]))
    });
    let short = all.iter().flat_map(|(plan, (segment, way))| {
        let [out, into] = &way.short_lines;
        let out = out.as_ref().map(|short| short_line(plan, short, *segment, true));
        let into = into.as_ref().map(|short| short_line(plan, short, segment + 1, false));
        out.into_iter().chain(into)
    });
    let (blocked, short): (Vec<String>, Vec<String>) = (blocked.collect(), short.chain(ends).collect());
    let blocked = (!blocked.is_empty()).then(|| {
        let text = format!(
            "NOT FREE: no free way between segments was found for {}; the time stated is that of the straight joint move",
            listed(&blocked, ", ")
        );
        Warning::new("blocked-move", text)
    });
    let short = (!short.is_empty()).then(|| {
        let text = format!(
            "the tool cannot be drawn out of the cut, or go in again, along its axis as far as transfer.retract_mm states: {}",
            listed(&short, "; ")
        );
        Warning::new("short-line", text)
    });
    let unfollowed = plans.iter().flat_map(|(plan, cycle)| {
        cycle.unfollowed.iter().map(move |(point, end)| format!("{plan} to point {point}: {end}"))
    });
    let unfollowed = unfollowed_warning(&unfollowed.collect::<Vec<_>>());
    blocked.into_iter().chain(short).chain(unfollowed).collect()
}

/// A line into a segment (from 1), or out of it, that is too short.
fn short_line(plan: &str, line: &ShortLine, segment: usize, is_out: bool) -> String {
    let [length, wanted] = [line.length, line.wanted].map(|length| figures(length * 1e3));
    let way = if is_out { "out of" } else { "into" };
    format!("{plan} {way} segment {segment}: {length} of {wanted} mm, since {}", line.end)
}

/// The lines of a program at the ends of a plan that are too short, where the moves between segments do not tell them.
pub(super) fn short_ends(problem: &Problem, placement: &Placement, name: &str, plan: &Plan) -> Vec<String> {
    let found = transfer_path::short_ends(problem, placement, &plans_of(plan, problem));
    found.iter().map(|end| short_line(name, &end.line, end.segment + 1, end.is_out)).collect()
}

/// Warns of straight moves from one path point to the next that the arm cannot follow.
fn unfollowed_warning(moves: &[String]) -> Option<Warning> {
    (!moves.is_empty()).then(|| {
        let text = format!(
            "between path points the arm cannot follow the straight line of the tool: {}; points that are closer together, a lower rate of \
             beta or of the turn of the spindle, or constraints.joint_margin_deg help",
            listed(moves, "; ")
        );
        Warning::new("unfollowed-move", text)
    })
}

/// Of many things the first are listed.
const LISTED: usize = 6;

fn listed(all: &[String], separator: &str) -> String {
    let mut text = all[..all.len().min(LISTED)].join(separator);
    if all.len() > LISTED {
        text.push_str(&format!("{separator}and {} more", all.len() - LISTED));
    }
    text
}
