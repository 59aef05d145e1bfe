//! The JSON document of a stability analysis.

use super::{DEPTH_MM, HERTZ, RATE, RPM, SHARE};
use crate::document::{Document, joined};
use crate::units::Unit;
use serde_json::{Value, json};
use stead_format::SimulationRun;
use stead_simulation::modes::Mode;
use stead_simulation::stability_analysis::{CutStability, StabilityAnalysis};

/// What `stead stability --json` prints, and the content of `summary.json`.
pub fn stability_json(run: &SimulationRun, analysis: &StabilityAnalysis) -> Value {
    let rate = analysis.cut_stability.verdict.growth_rate();
    let result = json!({
        "robot": run.setup.robot.name(),
        "variant": run.setup.variant.word(),
        "damping_scale": run.setup.damping_scale,
        "way_mm": Unit::PLACE_MM.number(run.analysis.distance),
        "spindle_rpm": RPM.number(run.cut.spindle_speed),
        "axial_depth_mm": DEPTH_MM.number(run.cut.section.axial_depth),
        "max_depth_mm": DEPTH_MM.number(run.analysis.max_depth),
        "pass_time_s": Unit::TIME_S.number(analysis.pass_time),
        "growth_in_pass": RATE.number(rate * analysis.pass_time),
        "modes": modes(&analysis.modes),
        "lobes": lobes(analysis),
    });
    Document::new(&run.inputs).notes(&analysis.notes).with(joined(result, verdict(&analysis.cut_stability)))
}

/// Critical depths and verdict.
pub(crate) fn verdict(depths: &CutStability) -> Value {
    let depth = |depth: Option<f64>| depth.map(|depth| DEPTH_MM.number(depth));
    let verdict = &depths.verdict;
    json!({
        "critical_depth_mm": {
            "semi_discretisation": depth(depths.semi_discretisation),
            "zero_order": depth(depths.zero_order),
        },
        "stable": verdict.is_stable(),
        "kind": verdict.kind().word(),
        "growth_rate_per_s": RATE.number(verdict.growth_rate()),
    })
}

/// Frequencies, damping and shapes.
pub(crate) fn modes(modes: &[Mode]) -> Value {
    let mode = |mode: &Mode| {
        json!({
            "frequency_hz": HERTZ.number(mode.natural_frequency()),
            "damping_ratio": SHARE.number(mode.damping_ratio),
            "joints": mode.joints.iter().map(|amplitude| SHARE.number(*amplitude)).collect::<Vec<_>>(),
            "tip_mm_per_rad": mode.tip.iter().map(|part| Unit::PLACE_MM.number(*part)).collect::<Vec<_>>(),
        })
    };
    modes.iter().map(mode).collect()
}

fn lobes(analysis: &StabilityAnalysis) -> Value {
    let depth = |depth: Option<f64>| depth.map(|depth| DEPTH_MM.number(depth));
    let lobe = |lobe: &stead_simulation::stability::Lobe| {
        json!({
            "spindle_rpm": RPM.number(lobe.spindle_speed),
            "critical_depth_mm": depth(lobe.semi_discretisation),
            "zero_order_mm": depth(lobe.zero_order),
        })
    };
    analysis.lobes.iter().map(lobe).collect()
}
