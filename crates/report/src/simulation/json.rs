//! The JSON documents of a simulated pass.

use super::super::stability::{HERTZ, RATE, RPM, SHARE};
use super::{HEIGHT_UM, MOMENT_S, Making, end_words};
use crate::document::Document;
use crate::units::Unit;
use serde_json::{Value, json};
use stead_format::SimulationRun;
use stead_simulation::modes::Mode;
use stead_simulation::outcome::{Simulation, Statistics};
use stead_simulation::roughness::Roughness;

/// The content of `summary.json`: byte for byte the same for the same inputs.
pub fn simulation_json(run: &SimulationRun, found: &Simulation, making: &Making) -> Value {
    let (end, reason) = end_words(&found.run.end);
    let forces = |axis: usize| found.forces.as_ref().map(|forces| statistics(&forces[axis]));
    Document::new(&run.inputs).notes(&found.notes).warnings(&found.warnings).with(json!({
        "robot": run.setup.robot.name(),
        "variant": run.setup.variant.word(),
        "damping_scale": run.setup.damping_scale,
        "fast": making.is_fast,
        "spindle_rpm": RPM.number(run.cut.spindle_speed),
        "slices": run.cut.slices,
        "steps_per_turn": run.cut.steps_per_turn,
        "step_s": Unit { factor: 1.0, decimals: 10 }.number(found.run.step),
        "steps": found.run.samples.len().saturating_sub(1),
        "evaluations": found.run.evaluations,
        "end": end,
        "end_reason": reason,
        "stable": found.is_stable(),
        "judgement": found.judgement.word(),
        "unrest": found.turn_variation.map(|variation| SHARE.number(variation)),
        "unrest_of_teeth_alike": found.period_variation.map(|variation| SHARE.number(variation)),
        "small_motions": {
            "kind": found.verdict.kind().word(),
            "growth_rate_per_s": RATE.number(found.verdict.growth_rate()),
            "where_stability_looks": {
                "way_mm": Unit::PLACE_MM.number(run.evaluation.analysis_distance),
                "kind": found.analysis_verdict.kind().word(),
                "growth_rate_per_s": RATE.number(found.analysis_verdict.growth_rate()),
            },
        },
        "window_s": found.window.map(|time| MOMENT_S.number(time)),
        "force_x": forces(0),
        "force_y": forces(1),
        "profile": found.roughness.as_ref().map(|[raw, filtered]| {
            let mut profile = roughness(filtered);
            profile["raw"] = roughness(raw);
            profile["height_mm"] = json!(Unit::PLACE_MM.number(run.evaluation.height));
            profile["cutoff_mm"] = json!(Unit::PLACE_MM.number(run.evaluation.cutoff));
            profile
        }),
        "modes": found.modes.iter().map(mode).collect::<Vec<_>>(),
        "published": run.published.as_ref().map(|published| json!({
            "source": published.source,
            "force_x": published.figures.forces.as_ref().map(|forces| statistics(&forces[0])),
            "force_y": published.figures.forces.as_ref().map(|forces| statistics(&forces[1])),
            "profile": published.figures.roughness.as_ref().map(roughness),
        })),
    }))
}

/// What `stead simulate --json` prints: the summary, and how long the run took.
pub fn timed_json(run: &SimulationRun, found: &Simulation, making: &Making) -> Value {
    let mut document = simulation_json(run, found, making);
    let duration = found.run.step * found.run.samples.len().saturating_sub(1) as f64;
    document["wall_s"] = json!(Unit::TIME_S.number(making.wall));
    document["real_time_factor"] =
        if making.wall > 0.0 { json!(Unit::TIME_S.number(duration / making.wall)) } else { Value::Null };
    document
}

fn statistics(statistics: &Statistics) -> Value {
    let Statistics { min, max, mean, root_mean_square } = statistics;
    json!({
        "min_n": Unit::FORCE_N.number(*min),
        "max_n": Unit::FORCE_N.number(*max),
        "mean_n": Unit::FORCE_N.number(*mean),
        "rms_n": Unit::FORCE_N.number(*root_mean_square),
    })
}

fn roughness(roughness: &Roughness) -> Value {
    json!({
        "ra_um": HEIGHT_UM.number(roughness.mean),
        "rq_um": HEIGHT_UM.number(roughness.root_mean_square),
        "rt_um": HEIGHT_UM.number(roughness.total),
    })
}

fn mode(mode: &Mode) -> Value {
    json!({ "frequency_hz": HERTZ.number(mode.natural_frequency()), "damping_ratio": SHARE.number(mode.damping_ratio) })
}
