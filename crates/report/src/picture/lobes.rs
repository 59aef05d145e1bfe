//! Stability lobes: how deep may be cut at which spindle speed.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, picture};
use super::colour::{BLUE, GREEN, RED};
use crate::output::ReportError;
use crate::units::fixed;
use std::f64::consts::PI;
use stead_simulation::milling::Cut;
use stead_simulation::stability::Lobe;
use stead_simulation::stability_analysis::StabilityAnalysis;

/// Critical depth of cut over spindle speed by both methods, and the cut at hand: green if it is stable, red if it is not. Where
/// all depths up to `max_depth` (m) are stable a curve leaves the picture at the top.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn lobes(analysis: &StabilityAnalysis, cut: &Cut, max_depth: f64) -> Result<String, ReportError> {
    let rpm = |speed: f64| speed * 30.0 / PI;
    let ends =
        [analysis.lobes.first(), analysis.lobes.last()].map(|lobe| lobe.map_or(0.0, |lobe| rpm(lobe.spindle_speed)));
    let found = analysis.lobes.iter().flat_map(|lobe| [lobe.semi_discretisation, lobe.zero_order]).flatten();
    let highest = found.fold(1.5 * cut.axial_depth, f64::max).min(max_depth.max(1.5 * cut.axial_depth));
    picture("the picture of the lobes", (1000, 520), |canvas| {
        canvas.text("How deep may be cut", (95, 26), Lettering::new(17.0).bold())?;
        let (x, y) = (Scale::new(ends[0], ends[1], 95, 970), Scale::new(0.0, highest * 1.05e3, 440, 84));
        let (x_ticks, y_ticks) = (Ticks::round(&x, 12), Ticks::round(&y, 8));
        let panel = Panel { x, y, x_ticks, y_ticks, x_label: "spindle speed (rpm)", y_label: "depth of cut (mm)" };
        panel.draw_grid(canvas)?;
        for (of, colour) in
            [((|lobe| lobe.zero_order) as fn(&Lobe) -> Option<f64>, BLUE), (|lobe| lobe.semi_discretisation, RED)]
        {
            for run in analysis.lobes.chunk_by(|a, b| of(a).is_some() == of(b).is_some()) {
                let place =
                    |lobe: &Lobe| of(lobe).map(|depth| panel.place(rpm(lobe.spindle_speed), depth.min(highest) * 1e3));
                let places: Vec<_> = run.iter().filter_map(place).collect();
                match places[..] {
                    [] => {}
                    [alone] => canvas.dot(alone, 3, colour)?,
                    _ => canvas.curve(&places, colour, 2)?,
                }
            }
        }
        let at = panel.place(rpm(cut.spindle_speed), cut.axial_depth * 1e3);
        let is_stable = analysis.cut_stability.verdict.is_stable();
        if (ends[0]..=ends[1]).contains(&rpm(cut.spindle_speed)) {
            canvas.dot(at, 5, if is_stable { GREEN } else { RED })?;
        }
        panel.draw_frame(canvas)?;
        legend(canvas, cut, is_stable)
    })
}

/// The legend, in one line under the title.
fn legend(canvas: &Canvas<'_>, cut: &Cut, is_stable: bool) -> Drawn {
    for (left, label, colour) in [(95, "critical depth, semi-discretisation", RED), (380, "zero-order solution", BLUE)]
    {
        canvas.line(vec![(left, 52), (left + 28, 52)], colour, 2)?;
        canvas.text(label, (left + 36, 52), Lettering::new(12.0))?;
    }
    let (colour, word) = if is_stable { (GREEN, "stable") } else { (RED, "chatters") };
    canvas.dot((600.0, 52.0), 5, colour)?;
    canvas.text(&format!("this cut, {} mm: {word}", fixed(cut.axial_depth * 1e3, 2)), (612, 52), Lettering::new(12.0))
}
