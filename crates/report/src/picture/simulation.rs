//! Pictures of a simulated pass: forces over the whole of it, over three turns, and the wall.

use super::axes::{Panel, Scale, Ticks, extent};
use super::canvas::{Canvas, TextStyle, picture};
use super::colour::{BLUE, COMPONENTS, Colour, GREY, RED};
use super::line_chart::{LineChart, Sign, legend};
use std::f64::consts::TAU;
use std::ops::Range;
use stead_simulation::outcome::Simulation;
use stead_simulation::roughness::Profile;

/// A force that is drawn: its name, its colour, and its value in a sample.
type Drawing = (&'static str, Colour, fn(&[f64; 3]) -> f64);

/// The forces that are drawn: name, colour, and the value of a sample along the feed and out of the wall.
const FORCES: [Drawing; 2] = [
    ("along the feed, F_x", COMPONENTS[0], |force| force[0]),
    ("towards the wall, F_y", COMPONENTS[1], |force| -force[1]),
];

/// Smallest and largest force in every column of pixels over the pass; shaded, the time over which forces are summed up.
pub fn forces(found: &Simulation) -> String {
    picture((1000, 500), |canvas| {
        canvas.title("Cutting forces over the pass", (85, 26));
        let count = found.run.samples.len();
        let x = Scale::new(0.0, count.saturating_sub(1) as f64 * found.run.step, 85, 975);
        let mut chart = LineChart::new(panel(found, 0..count, x, 440, "time (s)"));
        chart.shades.push(found.window);
        for (_, colour, value) in FORCES {
            let values: Vec<f64> = found.run.samples.iter().map(|sample| value(&sample.force)).collect();
            chart.ranges(&values, |time| time / found.run.step, false, colour);
        }
        chart.draw(canvas);
        force_legend(canvas);
    })
}

/// Forces over three turns of the spindle, in the middle of the time over which they are summed up or, of a run that ended
/// before, at its end.
pub fn turns(found: &Simulation, spindle_speed: f64) -> String {
    let turn = TAU / spindle_speed / found.run.step;
    let middle = (found.window[0] + found.window[1]) / 2.0 / found.run.step;
    let count = found.run.samples.len();
    let start = ((middle / turn).floor() * turn).min(count as f64 - 1.0 - 3.0 * turn).max(0.0) as usize;
    let end = (start + (3.0 * turn).round() as usize + 1).min(count);
    picture((1000, 460), |canvas| {
        let title = format!("Cutting forces over three turns, from {:.4} s", start as f64 * found.run.step);
        canvas.title(&title, (85, 26));
        let x = Scale::new(0.0, 1080.0, 85, 975);
        let panel = panel(found, start..end, x, 400, "angle of the spindle (deg)");
        let mut chart = LineChart::new(Panel { x_ticks: Ticks::every(&x, 90.0, 0), ..panel });
        for (_, colour, value) in FORCES {
            let samples = found.run.samples[start..end].iter().enumerate();
            chart.curve(samples.map(|(k, sample)| [k as f64 / turn * 360.0, value(&sample.force)]), colour);
        }
        chart.draw(canvas);
        force_legend(canvas);
    })
}

/// A panel for the forces of some samples.
fn panel(found: &Simulation, samples: Range<usize>, x: Scale, bottom: i32, x_label: &'static str) -> Panel {
    let values = found.run.samples[samples].iter().flat_map(|sample| FORCES.map(|(_, _, value)| value(&sample.force)));
    let [min, max] = extent([0.0, 0.0], values);
    let margin = 0.06 * (max - min);
    let y = Scale::new(min - margin, max + margin, bottom, 78);
    Panel::new(x, y, [12, 8], [x_label, "force on the tool (N)"])
}

/// The legend, in one line under the title.
fn force_legend(canvas: &mut Canvas) {
    let [feed, wall] = FORCES;
    legend(canvas, 52, &[(85, Sign::Line(feed.1), feed.0), (320, Sign::Line(wall.1), wall.0)]);
}

/// The wall along the feed above, and what the filter leaves of it below.
pub fn wall(found: &Simulation) -> String {
    picture((1000, 680), |canvas| {
        canvas.title("The wall that was left", (85, 26));
        profile(canvas, &found.wall, "height over the nominal wall", RED, (62, 320));
        profile(canvas, &found.filtered, "roughness: without what is longer than the cutoff", BLUE, (400, 624));
    })
}

/// A profile: smallest and largest height in every column of pixels.
fn profile(canvas: &mut Canvas, profile: &Profile, title: &str, colour: Colour, (top, bottom): (i32, i32)) {
    let Profile { start, spacing, heights, .. } = profile;
    canvas.text(title, (85, top - 12), TextStyle::new(13.0).bold().coloured(colour));
    let [min, max] = extent([f64::INFINITY, f64::NEG_INFINITY], heights.iter().copied());
    if min > max {
        return canvas.text("no wall was made", (95, (top + bottom) / 2), TextStyle::new(13.0).coloured(GREY));
    }
    let margin = (0.08 * (max - min)).max(0.05e-6);
    let x = Scale::new(start * 1e3, (start + spacing * heights.len() as f64) * 1e3, 85, 975);
    let y = Scale::new((min - margin) * 1e6, (max + margin) * 1e6, bottom, top);
    let mut chart = LineChart::new(Panel::new(x, y, [10, 7], ["along the feed (mm)", "height (um)"]));
    let heights: Vec<f64> = heights.iter().map(|height| height * 1e6).collect();
    chart.ranges(&heights, |along| (along / 1e3 - start) / spacing, true, colour);
    chart.draw(canvas);
}
