//! What each axis does: a panel for each, to one scale.

use super::super::axes::{Panel, Scale, Ticks};
use super::super::canvas::{Canvas, TextStyle, picture};
use super::super::colour::{BLUE, Colour, INK, PALE, TEAL};
use super::super::line_chart::{LineChart, Mark};
use super::{cut, fitting, percent, roomy};
use stead_study::analysis::{AxisEffect, Effects, Layouts, Level, Method};

/// Panels in a row, their left edges, width, first upper edge, height, and the distance of rows. Pixels
const COLUMNS: usize = 2;
const LEFT: [i32; COLUMNS] = [95, 650];
const WIDTH: i32 = 425;
/// Width of a panel that is the only one. Pixels
const ALONE: i32 = 980;
const TOP: i32 = 116;
const HEIGHT: i32 = 240;
const ROW: i32 = 340;

/// What each axis does to a column, the largest share of the variance first: every layout as a pale dot, the mean of
/// each value of the axis blue, the best of them green; lines join numbers.
pub fn effects(effects: &Effects, layouts: &Layouts) -> String {
    let rows = effects.axes.len().div_ceil(COLUMNS).max(1) as i32;
    picture((1100, TOP + ROW * rows), |canvas| {
        canvas.title(&format!("Effects on {}", effects.measure.name), (LEFT[0], 26));
        let is_alone = effects.axes.len() == 1;
        let mean = if is_alone { "mean of the layouts" } else { "mean over the other axes" };
        for (colour, label, along) in [(PALE, "a layout", 0), (BLUE, mean, 110), (TEAL, "the best of them", 330)] {
            canvas.dot((f64::from(LEFT[0] + along + 5), 54.0), 4, colour);
            canvas.text(label, (LEFT[0] + along + 17, 54), TextStyle::new(12.0).coloured(INK));
        }
        for (number, axis) in effects.axes.iter().enumerate() {
            let top = TOP + ROW * (number / COLUMNS) as i32;
            let left = LEFT[number % COLUMNS];
            one(canvas, effects, layouts, axis, [left, left + if is_alone { ALONE } else { WIDTH }, top]);
        }
    })
}

fn one(canvas: &mut Canvas, effects: &Effects, layouts: &Layouts, axis: &AxisEffect, [left, right, top]: [i32; 3]) {
    let values = || layouts.valued(&effects.measure);
    let levels = axis.levels.iter().map(|level| level.value);
    let y = roomy(values().map(|(_, value)| value).chain(levels).collect::<Vec<_>>().into_iter(), top + HEIGHT, top);
    let is_line = axis.method == Method::Line;
    let number = |level: &Level| level.number.unwrap_or(0.0);
    let x = if is_line {
        roomy(axis.levels.iter().map(number), left, right)
    } else {
        Scale::new(-0.5, axis.levels.len() as f64 - 0.5, left, right)
    };
    let mut panel = Panel::new(x, y, [5, 6], [axis.name.clone(), effects.measure.name.clone()]);
    if !is_line {
        let labels: Vec<String> = axis.levels.iter().map(|level| level.label.clone()).collect();
        panel.x_ticks = Ticks::named(fitting(&labels, (right - left) / labels.len().max(1) as i32));
    }
    panel.x_label = cut(&axis.name, 54).into();
    let mut chart = LineChart::new(panel);
    let place = |layout: usize| -> Option<f64> {
        let text = layouts.all[layout].row[axis.axis].written();
        if is_line {
            text.parse().ok()
        } else {
            axis.levels.iter().position(|level| level.label == text).map(|k| k as f64)
        }
    };
    chart.marks.extend(values().filter_map(|(layout, value)| Some(Mark::Dot([place(layout)?, value], 2, PALE))));
    let means: Vec<[f64; 2]> = (0..)
        .zip(&axis.levels)
        .map(|(k, level)| [if is_line { number(level) } else { f64::from(k) }, level.value])
        .collect();
    if axis.levels.iter().all(|level| level.number.is_some()) {
        chart.curve(means.iter().copied(), BLUE);
    }
    let best = axis.best(effects.measure.sense).map(|level| level.value);
    let colour = |value: f64| -> Colour { if Some(value) == best { TEAL } else { BLUE } };
    if !is_line {
        chart.marks.extend(means.iter().map(|[x, value]| Mark::Dot([*x, *value], 5, colour(*value))));
    }
    if effects.axes.len() == 1 {
        // It explains all there is.
        return chart.draw(canvas);
    }
    let share = axis.share.map_or_else(String::new, |share| format!("{} % of the variance, ", percent(share)));
    chart.marks.push(Mark::Heading(format!("{share}by {}", axis.method.word()).into(), INK));
    chart.draw(canvas);
}
