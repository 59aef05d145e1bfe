//! Coloured cells over two axes, the scale of their colours, and the bar that explains it: what the maps have in
//! common.

use super::axes::{Scale, Ticks};
use super::canvas::{Canvas, Pixel, TextStyle};
use super::colour::{Colour, INK, LEVELS, WHITE, viridis};
use super::merged_cells::merged_cells;
use std::borrow::Cow;

/// A grid of cells, each with a content that has a colour, or with none.
pub struct ColouredCells<T> {
    /// Edges of the columns, from left to right. Pixels
    pub columns: Vec<i32>,
    /// Edges of the rows, from the bottom up. Pixels
    pub rows: Vec<i32>,
    /// Contents, row by row from the bottom.
    pub cells: Vec<Option<T>>,
}

impl<T: Copy + PartialEq> ColouredCells<T> {
    /// What is in a cell.
    fn cell(&self, column: usize, row: usize) -> Option<T> {
        self.cells[row * (self.columns.len() - 1) + column]
    }

    /// What is at a pixel.
    pub fn at(&self, pixel: Pixel) -> Option<T> {
        let (x, y) = pixel;
        let column = self.columns.partition_point(|edge| *edge <= x).saturating_sub(1);
        let row = self.rows.partition_point(|edge| *edge > y).saturating_sub(1);
        let inside = column + 1 < self.columns.len() && row + 1 < self.rows.len();
        if inside { self.cell(column, row) } else { None }
    }

    /// Draws neighbours of one content as one polygon.
    pub fn draw_merged(&self, canvas: &mut Canvas, colour: impl Fn(T) -> Colour) {
        for cells in merged_cells(self.columns.len() - 1, &self.cells) {
            let corners = cells.outline().into_iter().map(|[column, row]| (self.columns[column], self.rows[row]));
            canvas.polygon(&corners.collect::<Vec<_>>(), colour(cells.content));
        }
    }

    /// Draws equal neighbours in a column as one rectangle; white ones are left out.
    pub fn draw_columns(&self, canvas: &mut Canvas, colour: impl Fn(T) -> Colour) {
        let rows: Vec<usize> = (0..self.rows.len() - 1).collect();
        for column in 0..self.columns.len() - 1 {
            for run in rows.chunk_by(|a, b| self.cell(column, *a) == self.cell(column, *b)) {
                let Some(colour) = self.cell(column, run[0]).map(&colour).filter(|colour| *colour != WHITE) else {
                    continue;
                };
                let upper_left = (self.columns[column], self.rows[run[0] + run.len()]);
                canvas.fill(upper_left, (self.columns[column + 1], self.rows[run[0]]), colour);
            }
        }
    }
}

/// The range of values that the colours span.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourRange {
    /// Value at the dark end.
    pub from: f64,
    /// Value at the bright end.
    pub to: f64,
}

impl ColourRange {
    /// The range from a value to the largest of some (ascending), but where few are far above all others, to the one
    /// that 97 of 100 do not pass, so that a peak does not leave the rest in the dark.
    pub fn below_peaks(from: f64, ascending: &[f64]) -> Self {
        let largest = ascending.last().copied().unwrap_or(0.0);
        let common = ascending.get(ascending.len() * 97 / 100).copied().unwrap_or(0.0);
        let is_peak = common > from && largest - from > 1.5 * (common - from);
        Self { from, to: if is_peak { common } else { largest } }
    }

    /// From nothing to the smallest of 1, 2 and 5 times a power of ten that 98 of 100 values (ascending) do not pass.
    pub fn round(ascending: &[f64]) -> Self {
        let common = ascending.get((ascending.len() * 98).div_ceil(100).saturating_sub(1)).copied().unwrap_or(0.0);
        let exponent = libm::floor(libm::log10(common)) as i32;
        let steps = [1, 2, 5, 10].map(|digit| format!("{digit}e{exponent}").parse::<f64>().unwrap_or(1.0));
        let to = steps.into_iter().find(|step| *step >= common).unwrap_or(1.0);
        Self { from: 0.0, to: if common > 0.0 { to } else { 1.0 } }
    }

    /// The level of a value; values beyond the range have the level of its end.
    pub fn level(&self, value: f64) -> usize {
        let part = if self.to > self.from { (value - self.from) / (self.to - self.from) } else { 0.0 };
        ((part * LEVELS as f64).max(0.0) as usize).min(LEVELS - 1)
    }
}

/// The bar of colours beside a map.
pub struct ColourBar {
    /// Left and right edge. Pixels
    pub sides: [i32; 2],
    /// Values from the lower edge to the upper one.
    pub scale: Scale,
    /// Values with a tick, and their labels.
    pub labels: Vec<(f64, String)>,
    /// The largest value, where it is beyond the scale.
    pub beyond: Option<String>,
    /// What the values are, with their unit.
    pub title: Cow<'static, str>,
    /// Space between labels and title. Pixels
    pub gap: i32,
}

impl ColourBar {
    /// Labels of ticks.
    pub fn labels(ticks: &Ticks) -> Vec<(f64, String)> {
        ticks.values.iter().map(|value| (*value, ticks.label(*value))).collect()
    }

    /// Draws the bar.
    pub fn draw(&self, canvas: &mut Canvas) {
        let ([left, right], Scale { start: bottom, end: top, .. }) = (self.sides, self.scale);
        let edges = Scale::new(0.0, LEVELS as f64, bottom, top);
        for level in 0..LEVELS {
            let (lower, upper) = (edges.pixel(level as f64), edges.pixel(level as f64 + 1.0));
            canvas.fill((left, upper), (right, lower), viridis(level));
        }
        canvas.outline((left, top), (right, bottom), INK);
        let style = TextStyle::new(12.0).coloured(INK);
        if let Some(largest) = &self.beyond {
            canvas.text(&format!("up to {largest}"), (left, top - 12), style);
        }
        let mut widest = 0;
        for (value, label) in &self.labels {
            let y = self.scale.pixel(*value);
            widest = widest.max(style.width(label));
            canvas.line(&[(right, y), (right + 5, y)], INK, 1);
            canvas.text(label, (right + 8, y), style);
        }
        let place = (right + 8 + widest + self.gap, (top + bottom) / 2);
        canvas.text(&self.title, place, TextStyle::new(13.0).centred().upwards());
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::picture;
    use super::*;

    /// Two columns of three rows, the left one without a cell in the middle.
    fn map() -> ColouredCells<usize> {
        let cells = vec![Some(0), Some(31), None, Some(31), Some(0), Some(0)];
        ColouredCells { columns: vec![10, 20, 40], rows: vec![90, 70, 50, 30], cells }
    }

    #[test]
    fn cells_are_drawn_at_their_pixels() {
        let svg = picture((100, 100), |canvas| map().draw_merged(canvas, viridis));
        let polygons: Vec<&str> = svg.lines().filter(|line| line.starts_with("<polygon")).collect();
        // In quarters of a pixel, and neighbours as one.
        assert_eq!(
            polygons,
            [
                "<polygon fill=\"#440154\" points=\"40,360 40,280 80,280 80,360 \"/>",
                "<polygon fill=\"#FDE725\" points=\"80,360 80,200 160,200 160,360 \"/>",
                "<polygon fill=\"#440154\" points=\"40,200 40,120 160,120 160,200 \"/>",
            ]
        );
        let svg = picture((100, 100), |canvas| map().draw_columns(canvas, viridis));
        let rectangles: Vec<&str> = svg.lines().filter(|line| line.starts_with("<rect")).skip(1).collect();
        assert_eq!(rectangles.len(), 4);
        let right = "<rect x=\"80\" y=\"200\" width=\"80\" height=\"160\" fill=\"#FDE725\" stroke=\"none\"/>";
        assert_eq!(rectangles[2], right);
    }

    #[test]
    fn pixels_belong_to_the_cells_drawn_there() {
        let map = map();
        assert_eq!((map.at((10, 89)), map.at((39, 60)), map.at((15, 31))), (Some(0), Some(31), Some(0)));
        assert_eq!((map.at((15, 60)), map.at((40, 60))), (None, None));
    }

    #[test]
    fn round_ranges_end_at_1_2_or_5_times_a_power_of_ten() {
        let end = |common: f64| ColourRange::round(&[vec![common; 98], vec![1e3 * common; 2]].concat()).to;
        for (common, to) in [(0.2, 0.2), (0.201, 0.5), (1.08, 2.0), (5.1e-4, 1e-3), (1e3, 1e3), (0.0, 1.0)] {
            assert_eq!(end(common), to, "{common}");
        }
    }

    #[test]
    fn a_peak_does_not_set_the_range() {
        let even: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(ColourRange::below_peaks(1.0, &even), ColourRange { from: 1.0, to: 100.0 });
        let peak: Vec<f64> = (1..=100).map(|k| if k == 100 { 1000.0 } else { f64::from(k) }).collect();
        let range = ColourRange::below_peaks(1.0, &peak);
        assert_eq!(range, ColourRange { from: 1.0, to: 98.0 });
        assert_eq!([0.0, 1.0, 49.5, 1000.0].map(|value| range.level(value)), [0, 0, 16, LEVELS - 1]);
    }
}
