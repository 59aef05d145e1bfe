//! Reports of single evaluations: `stead score` and `stead explain`.

use super::Context;
use super::json::{plan_clearance, unfollowed_moves};
use super::setup::{lines, put_setup};
use super::text::least_room;
use crate::columns::{aligned, line};
use crate::document::{
    cut_feed, deflection_mm, joint_travel, placement as placement_json, placement_exact, put_deviation,
};
use crate::names;
use crate::units::{Unit, fixed};
use serde_json::{Value, json};
use stead_placement::feasibility::{Explanation, Finding};
use stead_placement::outcome::{Cycle, Plan};
use stead_placement::place::{BlockingPair, Infeasible, Score};
use stead_placement::problem::Placement;

/// Degrees with the digits that a comparison with another program needs.
const FINE_DEG: Unit = Unit { decimals: 6, ..Unit::ANGLE_DEG };
/// Millimetres likewise.
const FINE_MM: Unit = Unit { decimals: 9, ..Unit::DEFLECTION_MM };

/// What `stead score --json` prints, with the critical depths along both plans where they were asked for.
pub fn score_json(score: &Score, context: &Context) -> Value {
    let plan = |plan: &Plan, cycle: &Cycle| {
        let mut value = json!({
            "objective_mm": Unit::DEFLECTION_MM.number(plan.objective),
            "mean_mm": Unit::DEFLECTION_MM.number(plan.mean),
            "max_mm": Unit::DEFLECTION_MM.number(plan.max),
            "p50_mm": Unit::DEFLECTION_MM.number(plan.percentiles[0]),
            "p95_mm": Unit::DEFLECTION_MM.number(plan.percentiles[1]),
            "deflection_mm": deflection_mm(&plan.deflection),
            "postures": plan.postures,
            "joint_travel": joint_travel(&plan.travel),
            "feed": cut_feed(&cycle.feed),
            "cutting_s": Unit::TIME_S.number(cycle.cutting),
            "cycle_s": cycle.total().map(|time| Unit::TIME_S.number(time)),
            "unfollowed_moves": unfollowed_moves(cycle),
        });
        if let Some(clearance) = &plan.clearance {
            value["clearance"] = plan_clearance(clearance);
        }
        put_deviation(&mut value, "mean_std_mm", Unit::DEFLECTION_MM, plan.mean_deviation);
        value
    };
    let mut entries = json!({
        "placement": placement_json(&score.placement),
        "placement_exact": placement_exact(&score.placement),
        "feasible": true,
        "interrupted": score.interrupted,
        "best": plan(&score.best, &score.cycles[0]),
        "worst": plan(&score.worst, &score.cycles[1]),
    });
    put_setup(&mut entries, score.orientation.as_ref(), &score.setup, &score.best.axes);
    if let Some(stability) = &context.stability {
        entries["stability"] = crate::stability::path::document(stability, true);
    }
    context.document().with(entries)
}

/// What `stead score --json` and `stead place --json` print when nothing is feasible.
pub fn infeasible_json(nothing: &Infeasible, context: &Context) -> Value {
    let finding = |finding: &Finding| {
        json!({
            "segment": finding.segment,
            "first_point": finding.points.0,
            "last_point": finding.points.1,
            "message": finding.to_string(),
        })
    };
    let mut document = json!({
        "placement": placement_json(&nothing.placement),
        "placement_exact": placement_exact(&nothing.placement),
        "feasible": false,
        "interrupted": nothing.interrupted,
        "best": Value::Null,
        "worst": Value::Null,
        "findings": nothing.findings.iter().map(finding).collect::<Vec<_>>(),
    });
    if !nothing.collisions.is_empty() {
        let pair = |pair: &BlockingPair| json!({ "pair": pair.names, "points": pair.points });
        document["collisions"] = nothing.collisions.iter().map(pair).collect();
    }
    context.document().with(document)
}

/// The table of `stead score`; `std mm` is the standard deviation of the mean of c_i, where the robot's uncertainty is known.
pub fn score_text(score: &Score, context: &Context) -> String {
    let row = |name: &str, plan: &Plan| {
        let total = plan.deflection.total;
        let mut row = vec![name.to_owned()];
        row.extend([plan.mean, plan.max, total.mean, total.max].map(|value| fixed(value * 1e3, 4)));
        row.extend(plan.mean_deviation.map(|deviation| fixed(deviation * 1e3, 4)));
        row.push(names::postures_within(&plan.postures, 60));
        row
    };
    let mut header = vec!["plan", "mean mm", "max mm", "total mm", "max total"];
    header.extend(score.best.mean_deviation.map(|_| "std mm"));
    header.push("postures");
    let last = header.len() - 1;
    let header = header.into_iter().map(str::to_owned).collect();
    let rows = [header, row("best", &score.best), row("worst", &score.worst)];
    let stability = context
        .stability
        .as_ref()
        .map(|found| format!("\n{}", crate::stability::path::text(found, ["best plan", "worst plan"])));
    let mut feed = String::new();
    for (plan, name) in [(&score.best, "best plan"), (&score.worst, "worst plan")] {
        least_room(plan, name).iter().for_each(|row| line(&mut feed, row));
    }
    super::text::highest_feed(&score.cycles[0].feed).iter().for_each(|row| line(&mut feed, row));
    line(&mut feed, &super::text::joint_travel(&score.best));
    let feed = format!("\n{feed}");
    let stability = stability.unwrap_or_default();
    let setup: String = lines("this placement", score.orientation.as_ref(), &score.best.axes)
        .iter()
        .map(|row| format!("{row}\n"))
        .collect();
    let setup = if setup.is_empty() { setup } else { format!("\n{setup}") };
    format!("{}\n{setup}\n{}{feed}{stability}", place_text(&score.placement), aligned(&rows, &[0, last]))
}

/// What `stead explain --json` prints.
pub fn explain_json(
    placement: &Placement,
    point: usize,
    beta: f64,
    postures: &[Explanation; 8],
    context: &Context,
) -> Value {
    let posture = |e: &Explanation| {
        let state = e.state.as_ref();
        let mut value = json!({
            "posture": e.posture,
            "joints_deg": state.map(|s| s.joints.map(|angle| FINE_DEG.number(angle))),
            "inverse_condition": state.map(|s| Unit::PLAIN.number(s.inverse_condition)),
            "normal_deflection_mm": state.map(|s| FINE_MM.number(s.normal_part.abs())),
            "total_deflection_mm": state.map(|s| FINE_MM.number(s.deflection.norm())),
            "score_mm": state.map(|s| FINE_MM.number(s.score())),
            "feasible": e.is_allowed(),
            "violations": e.violations.iter().map(ToString::to_string).collect::<Vec<_>>(),
        });
        put_deviation(&mut value, "std_mm", FINE_MM, state.and_then(|s| s.own.deviation));
        value
    };
    context.document().with(json!({
        "placement": placement_json(placement),
        "point": point,
        "beta_deg": FINE_DEG.number(beta),
        "postures": postures.iter().map(posture).collect::<Vec<_>>(),
    }))
}

/// The table of `stead explain`.
pub fn explain_text(placement: &Placement, point: usize, beta: f64, postures: &[Explanation; 8]) -> String {
    let states = || postures.iter().filter_map(|e| e.state.as_ref());
    let mut header =
        vec!["posture", "th1 deg", "th2 deg", "th3 deg", "th4 deg", "th5 deg", "th6 deg", "1/kappa", "c mm"];
    header.extend(states().find_map(|s| s.own.deviation).map(|_| "std mm"));
    header.push("");
    let last = header.len() - 1;
    let mut rows = vec![header.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    let mut broken = String::new();
    for e in postures {
        let mut row = vec![e.posture.to_string()];
        match &e.state {
            Some(s) => {
                row.extend(s.joints.map(|angle| fixed(angle.to_degrees(), 3)));
                row.extend([fixed(s.inverse_condition, 4), fixed(s.own.scored.abs() * 1e3, 5)]);
                row.extend(s.own.deviation.map(|deviation| fixed(deviation * 1e3, 5)));
            }
            None => row.extend((1..last).map(|_| "-".to_owned())),
        }
        row.push(if e.is_allowed() { "allowed" } else { "refused" }.to_owned());
        rows.push(row);
        for violation in &e.violations {
            broken.push_str(&format!("  posture {}: {violation}\n", e.posture));
        }
    }
    let mut text = format!(
        "{}, point {point}, beta {} deg\n\n{}",
        place_text(placement),
        fixed(beta.to_degrees(), 3),
        aligned(&rows, &[last])
    );
    if !broken.is_empty() {
        text.push_str("\nbroken constraints\n");
        text.push_str(&broken);
    }
    text
}

fn place_text(placement: &Placement) -> String {
    format!(
        "x {} mm, y {} mm, z {} mm, yaw {} deg (Q4 {})",
        fixed(placement.x * 1e3, 1),
        fixed(placement.y * 1e3, 1),
        fixed(placement.z * 1e3, 1),
        fixed(placement.yaw.to_degrees(), 2),
        fixed(placement.q4(), 4)
    )
}
