//! The frequency response at the tool tip.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, picture};
use super::colour::{BLUE, GREEN, INK, PALE, RED};
use crate::output::ReportError;
use crate::units::fixed;
use nalgebra::Complex;
use stead_simulation::stability_analysis::{FrequencyResponse, StabilityAnalysis};

/// Decades of the vertical axis.
const DECADES: f64 = 4.0;

/// Size of the answer at the tip over the frequency of the force: along the feed, along the normal of the wall and across, on a
/// logarithmic scale, with a line at each mode.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn frequency_response(analysis: &StabilityAnalysis) -> Result<String, ReportError> {
    let size = |part: Complex<f64>| libm::log10((part.norm_sqr().sqrt() * 1e6).max(1e-12));
    let all = analysis.frequency_response.iter().flat_map(|response| [response.feed, response.normal]);
    let highest = all.map(size).fold(-12.0, f64::max).ceil();
    let lowest = highest - DECADES;
    let ends = [analysis.frequency_response.first(), analysis.frequency_response.last()]
        .map(|response| response.map_or(0.0, |a| a.frequency));
    picture("the picture of the frequency response", (1000, 520), |canvas| {
        canvas.text("How the tool tip answers to a swinging force", (95, 26), Lettering::new(17.0).bold())?;
        let (x, y) = (Scale::new(ends[0], ends[1], 95, 970), Scale::new(lowest, highest, 440, 84));
        let (x_ticks, y_ticks) = (Ticks::round(&x, 12), Ticks::decades(&y));
        let panel = Panel { x, y, x_ticks, y_ticks, x_label: "frequency (Hz)", y_label: "answer (um/N)" };
        panel.draw_grid(canvas)?;
        let mut free_from = 0;
        for mode in analysis.modes.iter().filter(|mode| (ends[0]..=ends[1]).contains(&mode.natural_frequency())) {
            let at = panel.x.pixel(mode.natural_frequency());
            canvas.line(vec![(at, panel.y.start), (at, panel.y.end)], PALE, 1)?;
            // Labels that would run into each other are left out.
            let (label, lettering) = (fixed(mode.natural_frequency(), 1), Lettering::new(10.0).coloured(INK).centred());
            let half = lettering.width(&label) / 2;
            if at - half > free_from {
                canvas.text(&label, (at, 76), lettering)?;
                free_from = at + half;
            }
        }
        for (of, colour) in [
            ((|response| response.cross) as fn(&FrequencyResponse) -> Complex<f64>, GREEN),
            (|response| response.feed, BLUE),
            (|response| response.normal, RED),
        ] {
            let place = |response: &FrequencyResponse| panel.place(response.frequency, size(of(response)).max(lowest));
            canvas.curve(&analysis.frequency_response.iter().map(place).collect::<Vec<_>>(), colour, 2)?;
        }
        panel.draw_frame(canvas)?;
        legend(canvas)
    })
}

/// The legend, in one line under the title.
fn legend(canvas: &Canvas<'_>) -> Drawn {
    for (left, label, colour) in
        [(95, "along the feed", BLUE), (250, "along the normal of the wall", RED), (490, "across", GREEN)]
    {
        canvas.line(vec![(left, 52), (left + 28, 52)], colour, 2)?;
        canvas.text(label, (left + 36, 52), Lettering::new(12.0))?;
    }
    Ok(())
}
