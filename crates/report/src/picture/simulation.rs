//! Pictures of a simulated pass: forces over the whole of it, over three turns, and the wall.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, Pixel, picture};
use super::colour::{BLUE, COMPONENTS, GREY, RED, SHADE};
use crate::output::ReportError;
use plotters::style::RGBColor;
use std::f64::consts::TAU;
use stead_simulation::outcome::Simulation;
use stead_simulation::roughness::Profile;

/// A force that is drawn: its name, its colour, and its value in a sample.
type Drawing = (&'static str, RGBColor, fn(&[f64; 3]) -> f64);

/// The forces that are drawn: name, colour, and the value of a sample along the feed and out of the wall.
const FORCES: [Drawing; 2] = [
    ("along the feed, F_x", COMPONENTS[0], |force| force[0]),
    ("towards the wall, F_y", COMPONENTS[1], |force| -force[1]),
];

/// Smallest and largest force in every column of pixels over the pass; shaded, the time over which forces are summed up.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn forces(found: &Simulation) -> Result<String, ReportError> {
    picture("the picture of the forces", (1000, 500), |canvas| {
        canvas.text("Cutting forces over the pass", (85, 26), Lettering::new(17.0).bold())?;
        let last = found.run.samples.len().saturating_sub(1) as f64 * found.run.step;
        let x = Scale::new(0.0, last, 85, 975);
        let panel = panel(found, 0..found.run.samples.len(), x, "time (s)");
        let [from, to] = found.window.map(|time| panel.x.clamped(time));
        canvas.fill((from, panel.y.end), (to, panel.y.start), SHADE)?;
        panel.draw_grid(canvas)?;
        for (_, colour, value) in FORCES {
            for column in panel.x.start..panel.x.end {
                let [from, to] = [column, column + 1].map(|pixel| panel.x.number(f64::from(pixel)) / found.run.step);
                let [from, to] = [from, to].map(|step| (step.max(0.0) as usize).min(found.run.samples.len()));
                let inside = found.run.samples[from..to.max(from)].iter().map(|sample| value(&sample.force));
                let [min, max] = inside.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
                if min <= max {
                    let ends = [min, max].map(|force| (column, panel.y.pixel(force)));
                    canvas.line(ends.to_vec(), colour, 1)?;
                }
            }
        }
        panel.draw_frame(canvas)?;
        legend(canvas)
    })
}

/// Forces over three turns of the spindle, in the middle of the time over which they are summed up or, of a run that ended
/// before, at its end.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn turns(found: &Simulation, spindle_speed: f64) -> Result<String, ReportError> {
    let turn = TAU / spindle_speed / found.run.step;
    let middle = (found.window[0] + found.window[1]) / 2.0 / found.run.step;
    let count = found.run.samples.len();
    let start = ((middle / turn).floor() * turn).min(count as f64 - 1.0 - 3.0 * turn).max(0.0) as usize;
    let end = (start + (3.0 * turn).round() as usize + 1).min(count);
    picture("the picture of three turns", (1000, 460), |canvas| {
        let title = format!("Cutting forces over three turns, from {:.4} s", start as f64 * found.run.step);
        canvas.text(&title, (85, 26), Lettering::new(17.0).bold())?;
        let x = Scale::new(0.0, 1080.0, 85, 975);
        let panel =
            Panel { x_ticks: Ticks::every(&x, 90.0, 0), ..panel(found, start..end, x, "angle of the spindle (deg)") };
        panel.draw_grid(canvas)?;
        for (_, colour, value) in FORCES {
            let samples = found.run.samples[start..end].iter().enumerate();
            let places: Vec<_> =
                samples.map(|(index, sample)| panel.place(index as f64 / turn * 360.0, value(&sample.force))).collect();
            if places.len() > 1 {
                canvas.curve(&places, colour, 2)?;
            }
        }
        panel.draw_frame(canvas)?;
        legend(canvas)
    })
}

/// A panel for the forces of some samples.
fn panel(found: &Simulation, samples: std::ops::Range<usize>, x: Scale, x_label: &'static str) -> Panel {
    let values = found.run.samples[samples].iter().flat_map(|sample| FORCES.map(|(_, _, value)| value(&sample.force)));
    let [min, max] = values.fold([0.0_f64, 0.0_f64], |[a, b], v| [a.min(v), b.max(v)]);
    let margin = 0.06 * (max - min);
    let y = Scale::new(min - margin, max + margin, if x.to > 100.0 { 400 } else { 440 }, 78);
    Panel {
        x_ticks: Ticks::round(&x, 12),
        y_ticks: Ticks::round(&y, 8),
        x,
        y,
        x_label,
        y_label: "force on the tool (N)",
    }
}

/// The legend, in one line under the title.
fn legend(canvas: &Canvas<'_>) -> Drawn {
    for ((label, colour, _), left) in FORCES.into_iter().zip([85, 320]) {
        canvas.line(vec![(left, 52), (left + 28, 52)], colour, 2)?;
        canvas.text(label, (left + 36, 52), Lettering::new(12.0))?;
    }
    Ok(())
}

/// The wall along the feed above, and what the filter leaves of it below.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn wall(found: &Simulation) -> Result<String, ReportError> {
    picture("the picture of the wall", (1000, 680), |canvas| {
        canvas.text("The wall that was left", (85, 26), Lettering::new(17.0).bold())?;
        let titles = ["height over the nominal wall", "roughness: without what is longer than the cutoff"];
        let both = [(&found.wall, titles[0], RED, (62, 320)), (&found.filtered, titles[1], BLUE, (400, 624))];
        both.into_iter().try_for_each(|(profile, title, colour, span)| draw(canvas, profile, title, colour, span))
    })
}

/// A profile: smallest and largest height in every column of pixels.
fn draw(canvas: &Canvas<'_>, profile: &Profile, title: &str, colour: RGBColor, (top, bottom): (i32, i32)) -> Drawn {
    let heights = &profile.heights;
    let [min, max] = heights.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &h| [a.min(h), b.max(h)]);
    canvas.text(title, (85, top - 12), Lettering::new(13.0).bold().coloured(colour))?;
    if min > max {
        return canvas.text("no wall was made", (95, (top + bottom) / 2), Lettering::new(13.0).coloured(GREY));
    }
    let margin = (0.08 * (max - min)).max(0.05e-6);
    let end = profile.start + profile.spacing * heights.len() as f64;
    let x = Scale::new(profile.start * 1e3, end * 1e3, 85, 975);
    let y = Scale::new((min - margin) * 1e6, (max + margin) * 1e6, bottom, top);
    let (x_ticks, y_ticks) = (Ticks::round(&x, 10), Ticks::round(&y, 7));
    let panel = Panel { x, y, x_ticks, y_ticks, x_label: "along the feed (mm)", y_label: "height (um)" };
    panel.draw_grid(canvas)?;
    let mut before: Option<Pixel> = None;
    for column in panel.x.start..panel.x.end {
        let [from, to] = [column, column + 1]
            .map(|pixel| (panel.x.number(f64::from(pixel)) / 1e3 - profile.start) / profile.spacing)
            .map(|index| (index.max(0.0) as usize).min(heights.len()));
        let inside = heights[from..to.max(from)].iter();
        let [min, max] = inside.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &h| [a.min(h), b.max(h)]);
        if min <= max {
            let ends = [min, max].map(|height| (column, panel.y.pixel(height * 1e6)));
            // Joined to the column before.
            canvas.line(before.into_iter().chain(ends).collect(), colour, 1)?;
            before = Some(ends[1]);
        }
    }
    panel.draw_frame(canvas)
}
