//! The frequency response at the tool tip.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::picture;
use super::colour::{BLUE, GREEN, PALE, RED};
use super::line_chart::{LineChart, Mark, Sign, legend};
use crate::units::fixed;
use nalgebra::Complex;
use stead_simulation::stability_analysis::{FrequencyResponse, StabilityAnalysis};

/// Decades of the vertical axis.
const DECADES: f64 = 4.0;

/// Magnitude of the response at the tip over the frequency of the force: along the feed, along the normal of the wall and
/// across, on a logarithmic scale, with a line at each mode.
pub fn frequency_response(analysis: &StabilityAnalysis) -> String {
    let responses = &analysis.frequency_response;
    let magnitude = |part: Complex<f64>| libm::log10((part.norm_sqr().sqrt() * 1e6).max(1e-12));
    let all = responses.iter().flat_map(|response| [response.feed, response.normal]);
    let highest = all.map(magnitude).fold(-12.0, f64::max).ceil();
    let lowest = highest - DECADES;
    let ends = [responses.first(), responses.last()].map(|response| response.map_or(0.0, |a| a.frequency));
    picture((1000, 520), |canvas| {
        canvas.title("How the tool tip answers to a swinging force", (95, 26));
        let (x, y) = (Scale::new(ends[0], ends[1], 95, 970), Scale::new(lowest, highest, 440, 84));
        let panel = Panel::new(x, y, [12, 8], ["frequency (Hz)", "answer (um/N)"]);
        let mut chart = LineChart::new(Panel { y_ticks: Ticks::decades(&y), ..panel });
        let frequencies = analysis.modes.iter().map(|mode| mode.natural_frequency());
        let shown = frequencies.filter(|frequency| (ends[0]..=ends[1]).contains(frequency));
        chart.marks.extend(shown.map(|frequency| Mark::Vertical(frequency, PALE, Some(fixed(frequency, 1)))));
        for (of, colour) in [
            ((|response| response.cross) as fn(&FrequencyResponse) -> Complex<f64>, GREEN),
            (|response| response.feed, BLUE),
            (|response| response.normal, RED),
        ] {
            chart.curve(responses.iter().map(|at| [at.frequency, magnitude(of(at)).max(lowest)]), colour);
        }
        chart.draw(canvas);
        legend(
            canvas,
            52,
            &[
                (95, Sign::Line(BLUE), "along the feed"),
                (250, Sign::Line(RED), "along the normal of the wall"),
                (490, Sign::Line(GREEN), "across"),
            ],
        );
    })
}
