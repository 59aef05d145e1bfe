//! The text for people.

use super::RPM;
use super::tables::joint_name;
use crate::columns::table;
use crate::units::{figures, fixed};
use stead_runs::SimulationRun;
use stead_simulation::modes::Mode;
use stead_simulation::stability::Kind;
use stead_simulation::stability_analysis::StabilityAnalysis;

/// More modes than this are left to the files.
const MODES: usize = 12;

/// Modes with what moves in them, critical depths, and the verdict in a sentence.
pub fn stability_text(run: &SimulationRun, analysis: &StabilityAnalysis) -> String {
    let mut text = format!("{}, {}", run.setup.robot.name(), run.setup.variant.word());
    if run.setup.damping_scale != 1.0 {
        text.push_str(&format!(", damping times {}", run.setup.damping_scale));
    }
    text.push_str("\n\n");
    let rows = analysis.modes.iter().zip(1_usize..).take(MODES).map(|(mode, number)| {
        let (frequency, damping) = (fixed(mode.natural_frequency(), 2), fixed(mode.damping_ratio, 4));
        vec![number.to_string(), frequency, damping, moving(mode)]
    });
    text.push_str(&table(["mode", "frequency Hz", "damping ratio", "joints that move most"], rows, &[3]));
    if analysis.modes.len() > MODES {
        text.push_str(&format!("{} more in modes.csv\n", analysis.modes.len() - MODES));
    }
    let max_depth = fixed(run.analysis.max_depth * 1e3, 3);
    let depth = |depth: Option<f64>| match depth {
        Some(depth) => format!("{} mm", fixed(depth * 1e3, 3)),
        None => format!("beyond {max_depth} mm"),
    };
    let rpm = fixed(run.cut.spindle_speed * RPM.factor, 0);
    text.push_str(&format!(
        "\ncritical depth at {rpm} rpm: {} by semi-discretisation, {} by the zero-order solution\n",
        depth(analysis.cut_stability.semi_discretisation),
        depth(analysis.cut_stability.zero_order)
    ));
    text.push_str(&sentence(run, analysis));
    text
}

/// The verdict in a sentence.
fn sentence(run: &SimulationRun, analysis: &StabilityAnalysis) -> String {
    let verdict = &analysis.cut_stability.verdict;
    let (rate, depth) = (verdict.growth_rate(), fixed(run.cut.section.axial_depth * 1e3, 3));
    let how = match verdict.kind() {
        Kind::None => {
            let (time, rate) = (figures(-factor_two(rate)), figures(-rate));
            return format!(
                "the cut of {depth} mm is stable: vibrations halve every {time} ms (decay rate {rate} 1/s)\n"
            );
        }
        Kind::Flip => "flip: every second period alike",
        Kind::Hopf => "Hopf: with a frequency of its own",
    };
    let growth = libm::exp(rate * analysis.pass_time);
    let times = if growth > MANY { "far more than a million".to_owned() } else { figures(growth) };
    format!(
        "the cut of {depth} mm chatters ({how}): vibrations double every {} ms (growth rate {} 1/s), {times} times over the pass \
         of {} s\n",
        figures(factor_two(rate)),
        figures(rate),
        fixed(analysis.pass_time, 2)
    )
}

/// More often than this a growth is not worth a number.
const MANY: f64 = 1e6;

/// The time in which vibrations of a rate (1/s) become twice as large. ms
fn factor_two(rate: f64) -> f64 {
    std::f64::consts::LN_2 / rate * 1e3
}

/// The joints with at least a third of the largest amplitude.
fn moving(mode: &Mode) -> String {
    let count = mode.joints.len();
    let large = mode.joints.iter().enumerate().filter(|(_, amplitude)| amplitude.abs() > 1.0 / 3.0);
    large.map(|(k, _)| joint_name(k, count).replace("joint", "").replace('_', "")).collect::<Vec<_>>().join(", ")
}
