//! `report.html` of a stability analysis.

use super::RPM;
use crate::page::cards::{Axis, Cell, Chart, Column, Mark, Page, Series, Style, Table, Tile};
use crate::units::{figures, fixed};
use stead_runs::SimulationRun;
use stead_simulation::modes::Mode;
use stead_simulation::stability::Lobe;
use stead_simulation::stability_analysis::{FrequencyResponse, StabilityAnalysis};

/// The lobes with the cut among them, what the tip answers, and the modes.
pub(super) fn page(run: &SimulationRun, analysis: &StabilityAnalysis) -> Page {
    let verdict = &analysis.cut_stability.verdict;
    let speed = rpm(run);
    let depth = fixed(run.cut.section.axial_depth * 1e3, 3);
    let lead = if verdict.is_stable() {
        format!("The cut of {depth} mm at {speed} rpm is stable.")
    } else {
        format!("The cut of {depth} mm at {speed} rpm chatters ({}).", verdict.kind().word())
    };
    let subtitle = format!("stability · {}", run.setup.variant.word());
    Page::new(run.setup.robot.name(), subtitle, lead, &run.inputs)
        .messages(&analysis.warnings, &analysis.notes)
        .with(tiles(run, analysis))
        .with(lobes(run, analysis))
        .with(response(analysis))
        .with(modes(&analysis.modes))
}

/// Turns a minute, as few digits as say it.
fn rpm(run: &SimulationRun) -> String {
    RPM.number(run.cut.spindle_speed).to_string()
}

fn tiles(run: &SimulationRun, analysis: &StabilityAnalysis) -> Vec<Tile> {
    let found = &analysis.cut_stability;
    let verdict = &found.verdict;
    let max = format!("more than {}", fixed(run.analysis.max_depth * 1e3, 1));
    let depth = |depth: Option<f64>| depth.map_or_else(|| max.clone(), |depth| fixed(depth * 1e3, 3));
    let rate = verdict.growth_rate();
    let per_second = if rate > 0.0 { "vibrations grow" } else { "vibrations die out" };
    let at = format!("at {} rpm", rpm(run));
    vec![
        Tile::new("cut", if verdict.is_stable() { "stable" } else { "chatters" }, "", verdict.kind().word()),
        Tile::new("critical depth", depth(found.semi_discretisation), "mm", format!("semi-discretisation, {at}")),
        Tile::new("critical depth", depth(found.zero_order), "mm", format!("zero-order solution, {at}")),
        Tile::new("growth rate", figures(rate), "1/s", per_second),
    ]
}

/// Critical depth of cut over spindle speed by both methods, and the cut at hand. No value: all depths up to the
/// largest are stable.
pub(super) fn lobes(run: &SimulationRun, analysis: &StabilityAnalysis) -> Chart {
    let curve = |name: &str, color: usize, of: fn(&Lobe) -> Option<f64>| {
        let speed = |lobe: &Lobe| lobe.spindle_speed * RPM.factor;
        let points = analysis.lobes.iter().map(|lobe| [speed(lobe), of(lobe).map_or(f64::NAN, |depth| depth * 1e3)]);
        Series::curve(name, color, points)
    };
    let (speed, depth) = (run.cut.spindle_speed * RPM.factor, run.cut.section.axial_depth * 1e3);
    let verdict = if analysis.cut_stability.verdict.is_stable() { "stable" } else { "chatters" };
    let cut = Series::dots(format!("this cut, {} mm: {verdict}", fixed(depth, 2)), 3, [[speed, depth]]);
    let series = [
        curve("semi-discretisation", 0, |lobe| lobe.semi_discretisation),
        curve("zero-order solution", 1, |lobe| lobe.zero_order).styled(Style::Dashed),
        cut,
    ];
    Chart::new("Stability lobes", "spindle speed (rpm)", "critical depth of cut (mm)", series)
        .detailed("cuts below the curve are stable; no value: all depths up to the largest asked for are")
        .marked([Mark::level(depth, "depth of this cut")])
        .wide()
}

/// Decades of the response that are shown.
const DECADES: f64 = 1e4;

/// Magnitude of the response at the tip over the frequency of the force, with a line at each mode.
pub(super) fn response(analysis: &StabilityAnalysis) -> Chart {
    let curve = |name: &str, color: usize, of: fn(&FrequencyResponse) -> f64| {
        let points = analysis.frequency_response.iter().map(|at| [at.frequency, of(at) * 1e6]);
        Series::curve(name, color, points)
    };
    let all = analysis.frequency_response.iter().flat_map(|at| [at.feed, at.normal]);
    let largest = all.map(|part| part.norm() * 1e6).fold(1e-12, f64::max);
    let highest = libm::pow(10.0, libm::log10(largest).ceil());
    let y = Axis { range: Some([highest / DECADES, highest]), ..Axis::log("answer (um/N)") };
    let curves = [
        curve("along the feed", 0, |at| at.feed.norm()),
        curve("normal to the wall", 1, |at| at.normal.norm()),
        curve("across", 2, |at| at.cross.norm()).styled(Style::Dashed),
    ];
    let frequencies = analysis.modes.iter().map(|mode| mode.natural_frequency());
    Chart::new("Frequency response of the tip", "frequency (Hz)", y, curves)
        .detailed("with the frequencies of the modes")
        .marked(frequencies.map(|at| Mark::across(at, fixed(at, 1))))
        .wide()
}

/// The modes of an arm by frequency and damping.
pub(crate) fn modes(modes: &[Mode]) -> Table {
    let row = |(number, mode): (usize, &Mode)| {
        let numbers = [fixed(mode.natural_frequency(), 3), fixed(mode.damping_ratio, 5)];
        std::iter::once(Cell::Number((number + 1).to_string())).chain(numbers.map(Cell::Number)).collect()
    };
    let columns = ["mode", "frequency Hz", "damping ratio"].map(Column::number).to_vec();
    Table::new("Modes of the arm", columns, modes.iter().enumerate().map(row).collect())
}
