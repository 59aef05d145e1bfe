//! The JSON documents: what `stead place --json` prints, and `summary.json`.
//!
//! Both have the cases, the refinements and the counts. The printed document adds the plans point by point and how long
//! the computation took; the summary adds inputs and settings and has nothing that differs from run to run.

use super::Context;
use super::cell_json::{cell, mount};
use super::setup::{put_setup, tried};
use crate::document::{Timing, cut_feed, deflection_mm, joint_travel, placement, placement_exact, put_deviation};
use crate::names;
use crate::units::Unit;
use serde_json::{Map, Value, json};

use stead_format::input::InputFile;
use stead_placement::collision::PlanClearance;
use stead_placement::criterion::{Criterion, Direction};
use stead_placement::limit::ActiveBound;
use stead_placement::lookup::Axis;
use stead_placement::outcome::{
    CANCELLATION, Case, Cycle, ForceSensitivity, LookupSummary, Outcome, PathLevels, PlanPoint, Refinement, SetBasin,
    SetOutcome, SubsetAccuracy,
};
use stead_placement::postures::PostureRules;
use stead_placement::problem::{BetaPlan, Problem, Redundancy};
use stead_placement::settings::{LookupUse, PostureSearch};
use stead_placement::symmetry::Unsupported;
use stead_placement::transfer::Transfer;
use stead_placement::way::ShortLine;

/// What `stead place --json` prints.
pub fn place_json(outcome: &Outcome, context: &Context, timing: &Timing) -> Value {
    let mut entries = common(outcome, context, true);
    entries.insert("cases".to_owned(), cases(outcome, true));
    entries.insert("threads".to_owned(), json!(timing.threads));
    entries.insert("wall_s".to_owned(), number(Unit::TIME_S, timing.wall));
    let rate = if timing.wall > 0.0 { json!((outcome.states as f64 / timing.wall).round()) } else { Value::Null };
    entries.insert("states_per_second".to_owned(), rate);
    context.document().with(Value::Object(entries))
}

/// The content of `summary.json`: byte for byte the same for the same inputs and settings.
pub fn summary_json(problem: &Problem, outcome: &Outcome, context: &Context) -> Value {
    let mut entries = common(outcome, context, false);
    let settings = [
        ("robot", json!(problem.robot.name())),
        ("seed", json!(context.search.seed)),
        ("search", search(context)),
        ("transfer", transfer_settings(context)),
        ("cell", cell(problem)),
        ("constraints", constraints(problem)),
        ("criterion", criterion(problem)),
        ("redundancy", redundancy(problem)),
        ("task", task(problem)),
        ("cases", cases(outcome, false)),
        ("run_file", context.stated.clone()),
    ];
    entries.extend(settings.map(|(key, value)| (key.to_owned(), value)));
    entries.extend(tried(problem, outcome).map(|tried| ("setups".to_owned(), tried)));
    entries.extend(mount(problem).map(|mount| ("mount".to_owned(), mount)));
    entries.extend(postures(problem).map(|rules| ("postures".to_owned(), rules)));
    context.document().with(Value::Object(entries))
}

fn common(outcome: &Outcome, context: &Context, with_points: bool) -> Map<String, Value> {
    let reference = context
        .reference
        .as_ref()
        .map_or(Value::Null, |reference| json!({ "source": reference.source, "case_mm": reference.figures }));
    let refinements: Vec<Value> = outcome.refinements.iter().map(refinement).collect();
    let mut document = Map::from_iter([
        ("evaluations".to_owned(), json!(outcome.evaluations)),
        ("states".to_owned(), json!(outcome.states)),
        ("table".to_owned(), outcome.lookup_summary.as_ref().map_or(Value::Null, lookup_summary)),
        ("interrupted".to_owned(), json!(outcome.interrupted)),
        ("refinements".to_owned(), Value::Array(refinements)),
        ("reference".to_owned(), reference),
    ]);
    document.extend(outcome.path_levels.as_ref().map(|levels| ("path_levels".to_owned(), path_levels(levels))));
    document
        .extend((!outcome.sets.is_empty()).then(|| ("stiffness_sets".to_owned(), stiffness_sets(outcome, context))));
    document.extend(outcome.sensitivity.as_ref().map(|found| ("sensitivity".to_owned(), sensitivity(found))));
    document.extend(
        context
            .stability
            .as_ref()
            .map(|found| ("stability".to_owned(), crate::stability::path::document(found, with_points))),
    );
    document
}

/// How a long path was searched.
fn path_levels(levels: &PathLevels) -> Value {
    let subset = |subset: &SubsetAccuracy| {
        json!({
            "points": subset.points,
            "compared_placements": subset.pairs,
            "largest_error": subset.error.map(|error| number(TABLE_ERROR, error)),
        })
    };
    let [search, refinement] = &levels.subsets;
    json!({
        "points": levels.points,
        "search": subset(search),
        "refinement": subset(refinement),
        "deciding_points": levels.deciding,
        "placements_on_all_points": levels.whole,
    })
}

/// Errors of a lookup table, relative.
const TABLE_ERROR: Unit = Unit { factor: 1.0, decimals: 8 };

/// The lookup table that the search used, or why there is none.
fn lookup_summary(lookup_summary: &Result<LookupSummary, Unsupported>) -> Value {
    match lookup_summary {
        Err(unsuited) => json!({ "used": false, "reason": unsuited.to_string() }),
        Ok(LookupSummary { shape, accuracy }) => {
            let axis = |axis: &Axis| {
                json!({
                    "first_mm": number(Unit::PLACE_MM, axis.first),
                    "step_mm": number(Unit::PLACE_MM, axis.step),
                    "count": axis.count,
                })
            };
            json!({
                "used": true,
                "radius": axis(&shape.radius),
                "height": axis(&shape.height),
                "headings": shape.headings,
                "states": shape.states(),
                "bytes": shape.bytes(),
                "compared_states": accuracy.states,
                "rms_error": number(TABLE_ERROR, accuracy.rms),
                "largest_error": number(TABLE_ERROR, accuracy.largest),
                "disputed_share": number(TABLE_ERROR, accuracy.disputed),
            })
        }
    }
}

fn cases(outcome: &Outcome, with_plans: bool) -> Value {
    outcome.cases.all().into_iter().map(|entry| case(entry, with_plans)).collect()
}

fn case(case: &Case, with_plan: bool) -> Value {
    let mut value = json!({
        "case": case.number(),
        "placement": placement(&case.placement),
        "placement_exact": placement_exact(&case.placement),
        "objective_mm": number(Unit::DEFLECTION_MM, case.plan.objective),
        "mean_mm": number(Unit::DEFLECTION_MM, case.plan.mean),
        "max_mm": number(Unit::DEFLECTION_MM, case.plan.max),
        "p50_mm": number(Unit::DEFLECTION_MM, case.plan.percentiles[0]),
        "p95_mm": number(Unit::DEFLECTION_MM, case.plan.percentiles[1]),
        "deflection_mm": deflection_mm(&case.plan.deflection),
        "postures": case.plan.postures,
        "joint_travel": joint_travel(&case.plan.travel),
        "objective_by_stiffness": objective_by_stiffness(case),
        "active_bounds": case.active_bounds.as_ref().map(|bounds| bounds.iter().map(active_bound).collect::<Vec<_>>()),
        "feed": cut_feed(&case.cycle.feed),
        "cutting_s": number(Unit::TIME_S, case.cycle.cutting),
        "cycle_s": optional(Unit::TIME_S, case.cycle.total()),
        "unfollowed_moves": unfollowed_moves(&case.cycle),
        "transfers": case.cycle.transfers.iter().map(transfer).collect::<Vec<_>>(),
    });
    if let Some(clearance) = &case.plan.clearance {
        value["clearance"] = plan_clearance(clearance);
    }
    put_deviation(&mut value, "mean_std_mm", Unit::DEFLECTION_MM, case.plan.mean_deviation);
    put_setup(&mut value, case.orientation.as_ref(), &case.setup, &case.plan.axes);
    if with_plan && let Value::Object(map) = &mut value {
        map.insert("plan".to_owned(), case.plan.points.iter().map(plan_point).collect());
    }
    value
}

/// What one per cent more stiffness of each joint does to the objective: mm, and per cent of it where that is not nothing.
fn objective_by_stiffness(case: &Case) -> Value {
    let objective = case.plan.objective;
    let entry = |(slope, joint): (&f64, usize)| {
        let share = if objective > CANCELLATION { json!(Unit::PLAIN.number(slope / objective)) } else { Value::Null };
        json!({ "joint": joint, "mm_per_percent": number(Unit::DEFLECTION_MM, slope / 100.0), "percent_per_percent": share })
    };
    case.objective_by_stiffness.map_or(Value::Null, |slopes| slopes.iter().zip(1..).map(entry).collect())
}

fn active_bound(bound: &ActiveBound) -> Value {
    let (gain, unit) = names::gain(bound);
    json!({
        "bound": names::bound(bound),
        "side": if bound.side.is_upper { "upper" } else { "lower" },
        "gain": GAIN.number(gain),
        "unit": unit,
    })
}

/// What moving a bound gains.
const GAIN: Unit = Unit { factor: 1.0, decimals: 7 };

/// How far the best placement moves where scores have to cover errors of the force.
fn sensitivity(found: &ForceSensitivity) -> Value {
    let figures = |[plain, with_errors]: [f64; 2]| {
        json!({
            "objective_mm": number(Unit::DEFLECTION_MM, plain),
            "with_force_errors_mm": number(Unit::DEFLECTION_MM, with_errors),
        })
    };
    json!({
        "force_uncertainty": found.force_uncertainty,
        "nominal": figures(found.nominal),
        "robust": figures(found.robust),
        "robust_placement": placement(&found.placement),
        "distance_mm": number(Unit::PLACE_MM, found.distance),
        "turn_deg": number(Unit::ANGLE_DEG, found.turn),
    })
}

/// What each stiffness set makes of the best placement: its mean, what is best for it alone, and the regret.
fn stiffness_sets(outcome: &Outcome, context: &Context) -> Value {
    let files = context.inputs.iter().filter(|input| input.role == "stiffness");
    let set = |(set, file): (&SetOutcome, &InputFile)| {
        json!({
            "robot": file.name,
            "mean_mm": number(Unit::DEFLECTION_MM, set.mean),
            "best_alone_mm": optional(Unit::DEFLECTION_MM, set.alone),
            "regret": optional(Unit::PLAIN, set.regret()),
        })
    };
    let basin = |basin: &SetBasin| {
        json!({
            "placement": placement(&basin.placement),
            "objective_mm": number(Unit::DEFLECTION_MM, basin.objective),
            "regret": optional(Unit::PLAIN, basin.regret),
        })
    };
    let largest = |of: fn(&SetOutcome) -> Option<f64>| outcome.sets.iter().filter_map(of).reduce(f64::max);
    json!({
        "sets": outcome.sets.iter().zip(files).map(set).collect::<Vec<_>>(),
        "worst_mean_mm": optional(Unit::DEFLECTION_MM, largest(|set| Some(set.mean))),
        "largest_regret": optional(Unit::PLAIN, largest(SetOutcome::regret)),
        "basins": outcome.set_basins.iter().map(basin).collect::<Vec<_>>(),
    })
}

fn plan_point(point: &PlanPoint) -> Value {
    let mut value = json!({
        "point": point.point,
        "segment": point.segment,
        "beta_deg": number(Unit::ANGLE_DEG, point.beta),
        "posture": point.posture,
        "joints_deg": point.joints.map(|angle| number(Unit::ANGLE_DEG, angle)),
        "inverse_condition": number(Unit::PLAIN, point.inverse_condition),
        "normal_mm": number(Unit::DEFLECTION_MM, point.normal_part),
        "total_mm": number(Unit::DEFLECTION_MM, point.deflection.norm()),
        "score_mm": number(Unit::DEFLECTION_MM, point.score),
    });
    put_deviation(&mut value, "std_mm", Unit::DEFLECTION_MM, point.deviation);
    value
}

/// Path points to which the arm cannot follow the straight move of the tool, or not within its joint limits.
pub(super) fn unfollowed_moves(cycle: &Cycle) -> Value {
    cycle.unfollowed.iter().map(|(point, end)| json!({ "to_point": point, "since": end.to_string() })).collect()
}

fn transfer(transfer: &Transfer) -> Value {
    let mut value = json!({
        "after_segment": transfer.after_segment,
        "duration_s": optional(Unit::TIME_S, transfer.duration),
        "travel_deg": number(Unit::ANGLE_DEG, transfer.travel),
    });
    if let Some(way) = &transfer.way {
        value["blocked_by"] = json!(way.blocked_by.as_deref().map(|[a, b]| format!("{a} and {b}")));
        value["short_lines"] =
            way.short_lines.iter().map(|line| line.as_ref().map_or(Value::Null, short_line)).collect();
        value["joints_deg"] =
            way.joints.iter().map(|joints| json!(joints.map(|angle| number(Unit::ANGLE_DEG, angle)))).collect();
        value["retracts"] = json!(way.along_axis[0]);
        value["approaches"] = json!(way.along_axis[1]);
    }
    value
}

/// A line along the tool axis that is not as long as it should be.
fn short_line(line: &ShortLine) -> Value {
    json!({
        "length_mm": number(Unit::PLACE_MM, line.length),
        "wanted_mm": number(Unit::PLACE_MM, line.wanted),
        "since": line.end.to_string(),
    })
}

/// The least room at the points of a plan.
pub(super) fn plan_clearance(clearance: &PlanClearance) -> Value {
    json!({
        "point": clearance.point,
        "distance_mm": number(Unit::PLACE_MM, clearance.distance),
        "pair": clearance.names.as_ref(),
    })
}

fn refinement(refinement: &Refinement) -> Value {
    json!({
        "search": names::sense(refinement.sense),
        "start": placement(&refinement.start),
        "start_mean_mm": number(Unit::DEFLECTION_MM, refinement.start_mean),
        "end": placement(&refinement.end),
        "end_exact": placement_exact(&refinement.end),
        "end_mean_mm": number(Unit::DEFLECTION_MM, refinement.end_mean),
        "rounds": refinement.rounds,
        "iterations": refinement.iterations,
        "kkt_residual_mm": optional(Unit::RESIDUAL_MM, refinement.kkt_residual),
        "status": names::statuses(&refinement.statuses),
    })
}

fn search(context: &Context) -> Value {
    let postures = match context.search.postures {
        PostureSearch::Exact => "exact",
        PostureSearch::Genetic => "genetic",
    };
    let tables = match context.search.tables {
        LookupUse::Auto => "auto",
        LookupUse::Always => "always",
        LookupUse::Never => "never",
    };
    let mut value = json!({
        "population": context.search.population,
        "generations": context.search.generations,
        "postures": postures,
        "basins": context.search.basins,
        "tables": tables,
    });
    if !context.search.worst {
        value["worst"] = json!(false);
    }
    value
}

fn transfer_settings(context: &Context) -> Value {
    json!({
        "acceleration_time_s": number(Unit::TIME_S, context.transfer.acceleration_time),
        "jerk_time_s": number(Unit::TIME_S, context.transfer.jerk_time),
        "blend_mm": number(Unit::PLACE_MM, context.transfer.blend),
    })
}

/// The confidence is stated where there is something to be confident of.
fn criterion(problem: &Problem) -> Value {
    let Criterion { weights, aggregate, segment_weights, force_uncertainty, .. } = &problem.criterion;
    let mut value = json!({
        "direction": problem.criterion.direction().map(Direction::name),
        "weights": { "wall": weights.wall, "axis": weights.axis, "feed": weights.feed, "surface": weights.surface },
        "aggregate": aggregate.name(),
        "segment_weights": segment_weights,
        "force_uncertainty": force_uncertainty,
    });
    let weight = problem.criterion.joint_travel_weight;
    if let (true, Value::Object(map)) = (weight > 0.0, &mut value) {
        map.insert("joint_travel_weight_mm_per_rad".to_owned(), number(Unit::DEFLECTION_MM, weight));
    }
    if let (Some(sets), Value::Object(map)) = (&problem.criterion.stiffness, &mut value) {
        map.insert("over".to_owned(), json!(sets.over.name()));
    }
    if let (Some(_), Value::Object(map)) = (problem.robot.uncertainty(), &mut value) {
        map.insert("confidence".to_owned(), json!(problem.criterion.confidence));
    }
    value
}

fn constraints(problem: &Problem) -> Value {
    json!({
        "min_inverse_condition": problem.constraints.min_inverse_condition,
        "characteristic_length_mm": number(Unit::PLACE_MM, problem.constraints.characteristic_length),
        "max_deflection_mm": optional(Unit::DEFLECTION_MM, problem.constraints.max_deflection),
        "joint_margin_deg": number(Unit::ANGLE_DEG, problem.constraints.joint_margin),
        "min_base_distance_mm": number(Unit::PLACE_MM, problem.constraints.min_base_distance),
    })
}

/// The rules for postures, where there are some.
fn postures(problem: &Problem) -> Option<Value> {
    let rules = &problem.postures;
    (*rules != PostureRules::NONE).then(|| {
        json!({
            "allowed": rules.allowed().map(|posture| posture.number()).collect::<Vec<_>>(),
            "changes": if rules.may_change { "free" } else { "never" },
            "move_weight_mm_per_s": number(Unit::DEFLECTION_MM, rules.move_weight),
            "tie_percent": number(Unit::PLAIN, rules.tie * 100.0),
        })
    })
}

fn redundancy(problem: &Problem) -> Value {
    let Redundancy { beta_count, feed, max_beta_rate, max_spindle_turn, max_spindle_speed, beta } = problem.redundancy;
    let mut value = json!({ "beta_count": beta_count, "feed_mm_per_s": number(Unit::SPEED_MM_PER_S, feed) });
    for (key, unit, limit) in [
        ("max_beta_rate_deg_per_mm", Unit::RATE_DEG_PER_MM, max_beta_rate),
        ("max_spindle_turn_deg_per_mm", Unit::RATE_DEG_PER_MM, max_spindle_turn),
        ("max_spindle_turn_deg_per_s", Unit::SPEED_DEG_PER_S, max_spindle_speed),
    ] {
        if let (Some(limit), Value::Object(map)) = (limit, &mut value) {
            map.insert(key.to_owned(), number(unit, limit));
        }
    }
    if let (BetaPlan::ConstantPerSegment | BetaPlan::Constant, Value::Object(map)) = (beta, &mut value) {
        map.insert("beta".to_owned(), json!(beta.name()));
    }
    value
}

fn task(problem: &Problem) -> Value {
    json!({ "points": problem.task.points().len(), "segments": problem.task.segments().len() })
}

fn number(unit: Unit, value: f64) -> Value {
    json!(unit.number(value))
}

fn optional(unit: Unit, value: Option<f64>) -> Value {
    value.map_or(Value::Null, |value| number(unit, value))
}
