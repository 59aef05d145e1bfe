//! Critical depths along the path.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, Place, picture};
use super::colour::{GREEN, INK, PALE, RED};
use crate::output::ReportError;
use crate::stability::PathStability;
use crate::units::fixed;
use plotters::style::RGBColor;
use stead_placement::outcome::Plan;

const LEFT: i32 = 95;
const RIGHT: i32 = 970;

/// Critical depth of cut over the points of the path, for the best and for the worst placement, and the depth of the cut at hand.
/// Where all depths looked at are stable a curve runs along the top.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn path_stability(stability: &PathStability, plans: [&Plan; 2]) -> Result<String, ReportError> {
    let (max_depth, cut) = (stability.analysis.max_depth, stability.analysis.cut.axial_depth);
    let all = || stability.plans.iter().flatten().map(|depths| depths.semi_discretisation.unwrap_or(max_depth));
    let highest = all().fold(1.3 * cut, f64::max);
    picture("the picture of critical depths along the path", (1000, 520), |canvas| {
        canvas.text("How deep may be cut along the path", (LEFT, 26), Lettering::new(17.0).bold())?;
        let count = plans[0].points.len();
        let x = Scale::new(0.0, count.saturating_sub(1) as f64, LEFT, RIGHT);
        let y = Scale::new(0.0, highest * 1.05e3, 440, 84);
        let (x_ticks, y_ticks) = (Ticks::round(&x, 12), Ticks::round(&y, 8));
        let panel = Panel { x, y, x_ticks, y_ticks, x_label: "path point", y_label: "critical depth of cut (mm)" };
        panel.draw_grid(canvas)?;
        let mut first = 0;
        for segment in plans[0].points.chunk_by(|a, b| a.segment == b.segment) {
            if first > 0 {
                let between = panel.x.pixel(first as f64 - 0.5);
                canvas.line(vec![(between, panel.y.start), (between, panel.y.end)], PALE, 1)?;
            }
            for (depths, colour) in stability.plans.iter().zip([GREEN, RED]) {
                let place = |k: usize| {
                    let depth = depths.get(k).and_then(|at| at.semi_discretisation).unwrap_or(max_depth);
                    panel.place(k as f64, depth * 1e3)
                };
                curve(canvas, &(first..first + segment.len()).map(place).collect::<Vec<_>>(), colour)?;
            }
            first += segment.len();
        }
        let at = panel.y.pixel(cut * 1e3);
        canvas.dashed((LEFT, at), (RIGHT, at), INK)?;
        panel.draw_frame(canvas)?;
        legend(canvas, cut)
    })
}

fn curve(canvas: &Canvas<'_>, places: &[Place], colour: RGBColor) -> Drawn {
    if let [alone] = places { canvas.dot(*alone, 3, colour) } else { canvas.curve(places, colour, 2) }
}

/// The legend, in one line under the title.
fn legend(canvas: &Canvas<'_>, cut: f64) -> Drawn {
    for (left, label, colour) in [(LEFT, "best placement", GREEN), (LEFT + 170, "worst placement", RED)] {
        canvas.line(vec![(left, 52), (left + 28, 52)], colour, 2)?;
        canvas.text(label, (left + 36, 52), Lettering::new(12.0))?;
    }
    canvas.dashed((LEFT + 340, 52), (LEFT + 368, 52), INK)?;
    canvas.text(&format!("this cut, {} mm", fixed(cut * 1e3, 2)), (LEFT + 376, 52), Lettering::new(12.0))
}
