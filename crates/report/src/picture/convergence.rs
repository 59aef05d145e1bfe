//! The convergence of both genetic searches (Caro 2013, Fig. 6).

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, picture};
use super::colour::{BLUE, GREEN, GREY, RED};
use crate::output::ReportError;
use crate::units::fixed;
use plotters::style::{BLACK, RGBColor, WHITE};
use stead_placement::outcome::{Cases, Generation, Outcome};
use stead_placement::sense::Sense;

/// Best and average mean deflection over the generations: the search for the best placement above, for the worst below.
/// Dashed lines are the means after refinement.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn convergence(outcome: &Outcome) -> Result<String, ReportError> {
    picture("the picture of the convergence", (900, 820), |canvas| {
        canvas.text("Convergence of the genetic search", (85, 26), Lettering::new(17.0).bold())?;
        let Cases { best, worst, .. } = &outcome.cases;
        let search = |sense| outcome.convergence.iter().filter(|state| state.sense == sense).copied().collect();
        Search { sense: Sense::Min, states: search(Sense::Min), refined: best.plan.mean }.draw(canvas, 72, 375)?;
        Search { sense: Sense::Max, states: search(Sense::Max), refined: worst.plan.mean }.draw(canvas, 460, 763)
    })
}

struct Search {
    sense: Sense,
    states: Vec<Generation>,
    /// Mean deflection in the end. m
    refined: f64,
}

impl Search {
    fn draw(&self, canvas: &Canvas<'_>, top: i32, bottom: i32) -> Drawn {
        let (title, colour, least) = match self.sense {
            Sense::Min => ("Best placement: smallest mean deflection under the best plan", GREEN, 0.0),
            Sense::Max => ("Worst placement: largest mean deflection under the best plan", RED, f64::INFINITY),
        };
        let values = self.states.iter().flat_map(|state| [state.best, state.average]).flatten();
        let (low, high) =
            values.chain([self.refined]).fold((least, 0.0_f64), |(low, high), v| (low.min(v * 1e3), high.max(v * 1e3)));
        let margin = 0.06 * (high - low);
        let last = self.states.iter().map(|state| state.generation).max().unwrap_or(1).max(1);
        let x = Scale::new(0.0, last as f64, 85, 880);
        let y = Scale::new((low - margin).max(0.0), high + margin, bottom, top);
        let panel = Panel {
            x_ticks: Ticks::round(&x, 12),
            y_ticks: Ticks::round(&y, 8),
            x,
            y,
            x_label: "generation",
            y_label: "mean deflection (mm)",
        };
        panel.draw_grid(canvas)?;
        canvas.text(title, (85, top - 14), Lettering::new(13.0).bold().coloured(colour))?;
        let refined = panel.y.pixel(self.refined * 1e3);
        canvas.dashed((panel.x.start, refined), (panel.x.end, refined), BLACK)?;
        self.curve(canvas, &panel, BLUE, |state| state.average)?;
        self.curve(canvas, &panel, colour, |state| state.best)?;
        panel.draw_frame(canvas)?;
        self.legend(canvas, &panel, colour)
    }

    /// One curve, broken where there is no value.
    fn curve(
        &self,
        canvas: &Canvas<'_>,
        panel: &Panel,
        colour: RGBColor,
        value: impl Fn(&Generation) -> Option<f64>,
    ) -> Drawn {
        for run in self.states.chunk_by(|a, b| value(a).is_some() == value(b).is_some()) {
            let at = |state| value(state).map(|value| panel.place(state.generation as f64, value * 1e3));
            let points: Vec<_> = run.iter().filter_map(at).collect();
            if let [alone] = points[..] {
                canvas.dot(alone, 3, colour)?;
            } else if !points.is_empty() {
                canvas.curve(&points, colour, 2)?;
            }
        }
        Ok(())
    }

    /// The legend, at the end of the curves and away from them.
    fn legend(&self, canvas: &Canvas<'_>, panel: &Panel, colour: RGBColor) -> Drawn {
        let (left, right) = (panel.x.end - 262, panel.x.end - 10);
        let top = if self.sense == Sense::Min { panel.y.end + 10 } else { panel.y.start - 84 };
        canvas.fill((left, top), (right, top + 74), WHITE)?;
        canvas.outline((left, top), (right, top + 74), GREY)?;
        let refined = format!("after refinement: {} mm", fixed(self.refined * 1e3, 4));
        let entries = [("best so far", colour), ("average of the feasible", BLUE), (&refined, BLACK)];
        for (index, (label, colour)) in entries.into_iter().enumerate() {
            let y = top + 15 + 22 * index as i32;
            if index < 2 {
                canvas.line(vec![(left + 10, y), (left + 40, y)], colour, 2)?;
            } else {
                canvas.dashed((left + 10, y), (left + 40, y), colour)?;
            }
            canvas.text(label, (left + 50, y), Lettering::new(12.0))?;
        }
        Ok(())
    }
}
