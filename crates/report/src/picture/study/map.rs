//! A column over two axes.

use super::super::axes::{Panel, Scale, Ticks, extent};
use super::super::canvas::{Canvas, TextStyle, picture};
use super::super::colour::{GREY, contrast, viridis};
use super::super::heat_map::{ColourBar, ColourRange, HeatMap};
use super::{TICKS, fitting, short};
use crate::units::figures;
use stead_study::analysis::Map;

const TOP: i32 = 60;
/// Widths and heights of cells are between these. Pixels
const CELL_WIDTHS: [i32; 2] = [34, 130];
const CELL_HEIGHTS: [i32; 2] = [22, 64];
/// Room for the map. Pixels
const ROOM: [i32; 2] = [820, 620];
/// Letters of a label of a row.
const LETTERS: i32 = 26;

/// Means of a column over two axes, dark where they are small, with the figure in each cell that has room for it; a
/// dash where no layout has a value.
pub fn map(map: &Map) -> String {
    let [columns, rows] = [0, 1].map(|side| map.labels[side].len() as i32);
    let cell = |side: usize, count: i32, [min, max]: [i32; 2]| (ROOM[side] / count).clamp(min, max);
    let (width, height) = (cell(0, columns, CELL_WIDTHS), cell(1, rows, CELL_HEIGHTS));
    let labels = row_labels(&map.labels[1], height);
    let widest = labels.iter().map(|label| TextStyle::new(TICKS).width(label)).max().unwrap_or(0);
    let left = 50 + widest;
    let (right, bottom) = (left + width * columns, TOP + (height * rows).max(150));
    let title = format!("{} over two axes, mean over all others", map.measure.name);
    let least = left + TextStyle::new(17.0).width(&title);
    picture(((right + 150).max(least), bottom + 60), |canvas| {
        canvas.title(&title, (left, 26));
        let values = map.cells.iter().flatten().copied();
        let [from, to] = extent([f64::INFINITY, f64::NEG_INFINITY], values);
        let range = ColourRange { from, to };
        let (x, y) = (
            Scale::new(-0.5, f64::from(columns) - 0.5, left, right),
            Scale::new(-0.5, f64::from(rows) - 0.5, bottom, TOP),
        );
        let edges = |scale: Scale, count: i32| (0..=count).map(|k| scale.pixel(f64::from(k) - 0.5)).collect::<Vec<_>>();
        let cells = map.cells.iter().map(|cell| cell.map(|value| range.level(value))).collect();
        let heat = HeatMap { columns: edges(x, columns), rows: edges(y, rows), cells };
        heat.draw_columns(canvas, viridis);
        for (k, value) in (0..).zip(&map.cells) {
            let place = (x.pixel(f64::from(k % columns)), y.pixel(f64::from(k / columns)));
            figure(canvas, *value, place, width, range);
        }
        let (x_ticks, y_ticks) = (Ticks::named(fitting(&map.labels[0], width)), Ticks::named(labels.clone()));
        let [x_label, y_label] = map.names.clone().map(Into::into);
        Panel { x, y, x_ticks, y_ticks, x_label, y_label }.draw_frame(canvas);
        let scale = Scale::new(from, to, bottom, TOP);
        let labels = ColourBar::labels(&Ticks::round(&scale, 8));
        let title = map.measure.name.clone().into();
        ColourBar { sides: [right + 24, right + 44], scale, labels, beyond: None, title, gap: 14 }.draw(canvas);
    })
}

/// The figure of a cell in its middle, where it has room.
fn figure(canvas: &mut Canvas, value: Option<f64>, place: (i32, i32), width: i32, range: ColourRange) {
    let (text, colour) = match value {
        Some(value) => (figures(value), contrast(viridis(range.level(value)))),
        None => ("–".to_owned(), GREY),
    };
    let style = TextStyle::new(11.0).centred().coloured(colour);
    if style.width(&text) <= width {
        canvas.text(&text, place, style);
    }
}

/// Labels beside rows of a height.
fn row_labels(labels: &[String], height: i32) -> Vec<String> {
    let letters = LETTERS as usize;
    let step = (18 / height.max(1)).max(1) as usize;
    let shown = |(index, label): (usize, &String)| {
        if index.is_multiple_of(step) { super::cut(&short(label), letters) } else { String::new() }
    };
    labels.iter().enumerate().map(shown).collect()
}
