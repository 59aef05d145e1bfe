//! Deflections read beside those of the identified arm.

use super::axes::{Panel, Scale};
use super::canvas::{Canvas, TextStyle, nearest, picture};
use super::colour::{COMPONENTS, GREY, INK, RED, WHITE};
use crate::units::fixed;
use stead_calibration::identification::Identified;

/// Above: every component of every deflection, read over predicted, with the line on which both are the same; below: what is left,
/// over the predicted one. Outliers are ringed.
pub fn deflections(found: &Identified) -> String {
    picture((820, 1010), |canvas| {
        canvas.title("Deflection read and by the identified arm", (85, 26));
        let (above, below) = (upper(found), lower(found));
        draw(canvas, found, &above, |measured, _| measured);
        let [from, to] = [above.x.from, above.x.to].map(|value| nearest(above.place(value, value)));
        canvas.dashed(from, to, GREY);
        above.draw_frame(canvas);
        legend(canvas, found, &above);
        draw(canvas, found, &below, |measured, predicted| measured - predicted);
        let zero = below.y.pixel(0.0);
        canvas.dashed((below.x.start, zero), (below.x.end, zero), GREY);
        below.draw_frame(canvas)
    })
}

/// Left and right edge of both panels. Pixels
const SIDES: (i32, i32) = (85, 790);

fn panel(x: Scale, y: Scale, y_label: &'static str) -> Panel {
    let ticks = [9, if y.start - y.end > 400 { 9 } else { 6 }];
    Panel::new(x, y, ticks, ["predicted component (mm)", y_label])
}

/// Predicted and measured components in mm, whether they are of an outlier, and which axis.
fn components(found: &Identified) -> impl Iterator<Item = (f64, f64, bool, usize)> {
    found.rows.iter().flat_map(|row| {
        (0..3).map(move |axis| (row.predicted[axis] * 1e3, row.measured[axis] * 1e3, row.is_outlier, axis))
    })
}

/// The largest of some numbers, and a little more.
fn reach(values: impl Iterator<Item = f64>) -> f64 {
    let max = values.fold(0.0, |max: f64, value| max.max(value.abs()));
    if max > 0.0 { 1.08 * max } else { 1.0 }
}

fn upper(found: &Identified) -> Panel {
    let max = reach(components(found).flat_map(|(predicted, measured, ..)| [predicted, measured]));
    let (x, y) = (Scale::new(-max, max, SIDES.0, SIDES.1), Scale::new(-max, max, 640, 50));
    panel(x, y, "component read (mm)")
}

fn lower(found: &Identified) -> Panel {
    let max = reach(components(found).flat_map(|(predicted, measured, ..)| [predicted, measured]));
    let left = reach(components(found).map(|(predicted, measured, ..)| measured - predicted));
    let (x, y) = (Scale::new(-max, max, SIDES.0, SIDES.1), Scale::new(-left, left, 950, 715));
    panel(x, y, "read less predicted (mm)")
}

fn draw(canvas: &mut Canvas, found: &Identified, panel: &Panel, height: impl Fn(f64, f64) -> f64) {
    panel.draw_grid(canvas);
    for (predicted, measured, is_outlier, axis) in components(found) {
        let place = panel.place(predicted, height(measured, predicted));
        if is_outlier {
            canvas.dot(place, 6, RED);
        }
        canvas.dot(place, 3, COMPONENTS[axis]);
    }
}

fn legend(canvas: &mut Canvas, found: &Identified, panel: &Panel) {
    let (left, top) = (panel.x.start + 12, panel.y.end + 12);
    let outliers = found.outliers().count();
    let lines = if outliers > 0 { 5 } else { 4 };
    canvas.fill((left, top), (left + 235, top + 10 + 20 * lines), WHITE);
    canvas.outline((left, top), (left + 235, top + 10 + 20 * lines), GREY);
    let style = TextStyle::new(12.0).coloured(INK);
    let line = |index: i32| top + 15 + 20 * index;
    for (axis, name) in ["x of the base frame", "y", "z"].into_iter().enumerate() {
        let y = line(axis as i32);
        canvas.dot((f64::from(left + 14), f64::from(y)), 3, COMPONENTS[axis]);
        canvas.text(name, (left + 28, y), style);
    }
    let residual = format!("residual {} mm rms", fixed(found.residual_rms * 1e3, 4));
    canvas.text(&residual, (left + 28, line(3)), style);
    if outliers > 0 {
        canvas.dot((f64::from(left + 14), f64::from(line(4))), 6, RED);
        canvas.text(&format!("readings left out: {outliers}"), (left + 28, line(4)), style);
    }
}
