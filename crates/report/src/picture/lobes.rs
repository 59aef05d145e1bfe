//! Stability lobes: how deep may be cut at which spindle speed.

use super::axes::{Panel, Scale};
use super::canvas::{TextStyle, picture};
use super::colour::{BLUE, GREEN, RED};
use super::line_chart::{LineChart, Mark, Sign, legend};
use crate::units::fixed;
use std::f64::consts::PI;
use stead_simulation::milling::PassCut;
use stead_simulation::stability::Lobe;
use stead_simulation::stability_analysis::StabilityAnalysis;

/// Critical depth of cut over spindle speed by both methods, and the cut at hand: green if it is stable, red if it is not. Where
/// all depths up to `max_depth` (m) are stable a curve leaves the picture at the top.
pub fn lobes(analysis: &StabilityAnalysis, cut: &PassCut, max_depth: f64) -> String {
    let rpm = |speed: f64| speed * 30.0 / PI;
    let ends =
        [analysis.lobes.first(), analysis.lobes.last()].map(|lobe| lobe.map_or(0.0, |lobe| rpm(lobe.spindle_speed)));
    let found = analysis.lobes.iter().flat_map(|lobe| [lobe.semi_discretisation, lobe.zero_order]).flatten();
    let highest = found.fold(1.5 * cut.section.axial_depth, f64::max).min(max_depth.max(1.5 * cut.section.axial_depth));
    let (colour, word) = if analysis.cut_stability.verdict.is_stable() { (GREEN, "stable") } else { (RED, "chatters") };
    picture((1000, 520), |canvas| {
        canvas.title("How deep may be cut", (95, 26));
        let (x, y) = (Scale::new(ends[0], ends[1], 95, 970), Scale::new(0.0, highest * 1.05e3, 440, 84));
        let mut chart = LineChart::new(Panel::new(x, y, [12, 8], ["spindle speed (rpm)", "depth of cut (mm)"]));
        for (of, colour) in
            [((|lobe| lobe.zero_order) as fn(&Lobe) -> Option<f64>, BLUE), (|lobe| lobe.semi_discretisation, RED)]
        {
            let depth = |lobe: &Lobe| of(lobe).map(|depth| depth.min(highest) * 1e3);
            chart.broken_curve(analysis.lobes.iter().map(|lobe| (rpm(lobe.spindle_speed), depth(lobe))), colour);
        }
        let speed = rpm(cut.spindle_speed);
        if (ends[0]..=ends[1]).contains(&speed) {
            chart.marks.push(Mark::Dot([speed, cut.section.axial_depth * 1e3], 5, colour));
        }
        chart.draw(canvas);
        let entries = [
            (95, Sign::Line(RED), "critical depth, semi-discretisation"),
            (380, Sign::Line(BLUE), "zero-order solution"),
        ];
        legend(canvas, 52, &entries);
        canvas.dot((600.0, 52.0), 5, colour);
        let label = format!("this cut, {} mm: {word}", fixed(cut.section.axial_depth * 1e3, 2));
        canvas.text(&label, (612, 52), TextStyle::new(12.0));
    })
}
