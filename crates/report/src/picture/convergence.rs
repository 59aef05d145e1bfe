//! The convergence of both genetic searches (Caro 2013, Fig. 6).

use super::axes::{Panel, Scale, extent};
use super::canvas::{Canvas, TextStyle, picture};
use super::colour::{BLACK, BLUE, GREEN, GREY, RED, WHITE};
use super::line_chart::{LineChart, Mark};
use crate::units::fixed;
use stead_placement::outcome::{Generation, Outcome};
use stead_placement::sense::Sense;

/// Best and average mean deflection over the generations: the search for the best placement above, for the worst below.
/// Dashed lines are the means after refinement.
pub fn convergence(outcome: &Outcome) -> String {
    let height = if outcome.cases.worst.is_some() { 820 } else { 432 };
    picture((900, height), |canvas| {
        canvas.title("Convergence of the genetic search", (85, 26));
        for (case, sides) in outcome.cases.optima().into_iter().zip([(72, 375), (460, 763)]) {
            let sense = case.placement_sense;
            let generations = outcome.convergence.iter().filter(|generation| generation.sense == sense);
            search(canvas, sense, &generations.collect::<Vec<_>>(), case.plan.mean, sides);
        }
    })
}

/// One search; `refined` is the mean deflection in the end, in m.
fn search(canvas: &mut Canvas, sense: Sense, generations: &[&Generation], refined: f64, (top, bottom): (i32, i32)) {
    let (title, colour, min) = match sense {
        Sense::Min => ("Best placement: smallest mean deflection under the best plan", GREEN, 0.0),
        Sense::Max => ("Worst placement: largest mean deflection under the best plan", RED, f64::INFINITY),
    };
    let values = generations.iter().flat_map(|generation| [generation.best, generation.average]).flatten();
    let [low, high] = extent([min, 0.0], values.chain([refined]).map(|value| value * 1e3));
    let margin = 0.06 * (high - low);
    let last = generations.iter().map(|generation| generation.generation).max().unwrap_or(1).max(1);
    let x = Scale::new(0.0, last as f64, 85, 880);
    let y = Scale::new((low - margin).max(0.0), high + margin, bottom, top);
    let mut chart = LineChart::new(Panel::new(x, y, [12, 8], ["generation", "mean deflection (mm)"]));
    chart.marks.push(Mark::Heading(title.into(), colour));
    chart.marks.push(Mark::Dashed(refined * 1e3, BLACK));
    for (colour, value) in
        [(BLUE, (|generation| generation.average) as fn(&Generation) -> Option<f64>), (colour, |state| state.best)]
    {
        let at = |of: &&Generation| (of.generation as f64, value(of).map(|value| value * 1e3));
        chart.broken_curve(generations.iter().map(at), colour);
    }
    chart.draw(canvas);
    // At the end of the curves and away from them.
    let corner = if sense == Sense::Min { y.end + 10 } else { y.start - 84 };
    let refined = format!("after refinement: {} mm", fixed(refined * 1e3, 4));
    let entries = [("best so far", colour), ("average of the feasible", BLUE), (&refined, BLACK)];
    legend(canvas, (x.end - 262, corner), entries);
}

/// The legend in a box of its own: two curves and a dashed line.
fn legend(canvas: &mut Canvas, (left, top): (i32, i32), entries: [(&str, super::colour::Colour); 3]) {
    let corner = (left + 252, top + 74);
    canvas.fill((left, top), corner, WHITE);
    canvas.outline((left, top), corner, GREY);
    for ((label, colour), index) in entries.into_iter().zip(0..) {
        let y = top + 15 + 22 * index;
        let (from, to) = ((left + 10, y), (left + 40, y));
        if index < 2 {
            canvas.line(&[from, to], colour, 2)
        } else {
            canvas.dashed(from, to, colour)
        }
        canvas.text(label, (left + 50, y), TextStyle::new(12.0));
    }
}
