//! Curves over two axes: what the charts over time, path point, angle, frequency and speed have in common.

use super::axes::Panel;
use super::canvas::{Canvas, LineStyle, Place, TextStyle, exact};
use super::colour::{Colour, INK, SHADE};
use std::borrow::Cow;

/// A chart of curves. The grid lies over the shaded ranges and under the marks, the frame over everything.
pub struct LineChart {
    /// The axes.
    pub panel: Panel,
    /// Ranges of the horizontal axis whose ground is shaded.
    pub shades: Vec<[f64; 2]>,
    /// What is drawn, in this order.
    pub marks: Vec<Mark>,
}

/// Something drawn on a chart, in the numbers of its axes.
pub enum Mark {
    /// A heading over the upper left corner of the chart.
    Heading(Cow<'static, str>, Colour),
    /// A curve through points; a single point is a dot.
    Curve(Vec<[f64; 2]>, LineStyle),
    /// A disc of a radius in pixels about a point.
    Dot([f64; 2], i32, Colour),
    /// A line across the chart at a height.
    Horizontal(f64, Colour),
    /// A dashed line across the chart at a height.
    Dashed(f64, Colour),
    /// A line from the bottom to the top, with a label over the chart that is left out where it would run into the one
    /// before.
    Vertical(f64, Colour, Option<String>),
}

impl LineChart {
    /// A chart without anything on it yet.
    pub fn new(panel: Panel) -> Self {
        Self { panel, shades: Vec::new(), marks: Vec::new() }
    }

    /// Adds a curve.
    pub fn curve(&mut self, points: impl IntoIterator<Item = [f64; 2]>, line: impl Into<LineStyle>) {
        self.marks.push(Mark::Curve(points.into_iter().collect(), line.into()));
    }

    /// Adds a curve that is broken where there is no value.
    pub fn broken_curve(&mut self, points: impl IntoIterator<Item = (f64, Option<f64>)>, line: impl Into<LineStyle>) {
        let line = line.into();
        let points: Vec<(f64, Option<f64>)> = points.into_iter().collect();
        for run in points.chunk_by(|a, b| a.1.is_some() == b.1.is_some()) {
            self.curve(run.iter().filter_map(|(x, y)| Some([*x, (*y)?])), line);
        }
    }

    /// Draws the chart.
    pub fn draw(&self, canvas: &mut Canvas) {
        let Panel { x, y, .. } = &self.panel;
        for [from, to] in &self.shades {
            canvas.fill((x.clamped(*from), y.end), (x.clamped(*to), y.start), SHADE);
        }
        self.panel.draw_grid(canvas);
        // Where the next label has room.
        let mut free_from = 0;
        for mark in &self.marks {
            match mark {
                Mark::Heading(text, colour) => {
                    canvas.text(text, (x.start, y.end - 14), TextStyle::new(13.0).bold().coloured(*colour));
                }
                Mark::Curve(points, line) => canvas.curve_or_dot(&self.places(points), *line, 2),
                Mark::Dot([x, y], radius, colour) => canvas.dot(self.panel.place(*x, *y), *radius, *colour),
                Mark::Horizontal(at, colour) => {
                    let at = y.pixel(*at);
                    canvas.line(&[(x.start, at), (x.end, at)], *colour, 1);
                }
                Mark::Dashed(at, colour) => {
                    let at = y.pixel(*at);
                    canvas.dashed((x.start, at), (x.end, at), *colour);
                }
                Mark::Vertical(at, colour, label) => {
                    let at = x.pixel(*at);
                    canvas.line(&[(at, y.start), (at, y.end)], *colour, 1);
                    let Some(label) = label else { continue };
                    let style = TextStyle::new(10.0).coloured(INK).centred();
                    let half = style.width(label) / 2;
                    if at - half > free_from {
                        canvas.text(label, (at, y.end - 8), style);
                        free_from = at + half;
                    }
                }
            }
        }
        self.panel.draw_frame(canvas);
    }

    fn places(&self, points: &[[f64; 2]]) -> Vec<Place> {
        points.iter().map(|[x, y]| self.panel.place(*x, *y)).collect()
    }
}

/// What stands before a label in a legend.
pub enum Sign {
    /// A piece of a curve.
    Line(LineStyle),
    /// A piece of a dashed line.
    Dashed(Colour),
    /// A dot.
    Dot(Colour),
    /// A piece of shaded ground.
    Ground(Colour),
}

/// A legend in one line at a height: from where, the sign, and the label.
pub fn legend(canvas: &mut Canvas, y: i32, entries: &[(i32, Sign, &str)]) {
    for (left, sign, label) in entries {
        let (from, to) = ((*left, y), (left + 28, y));
        match sign {
            Sign::Line(line) => canvas.styled_curve(&[exact(from), exact(to)], *line, 2),
            Sign::Dashed(colour) => canvas.dashed(from, to, *colour),
            Sign::Dot(colour) => canvas.dot((f64::from(left + 14), f64::from(y)), 4, *colour),
            Sign::Ground(colour) => canvas.fill((from.0, y - 7), (to.0, y + 7), *colour),
        }
        canvas.text(label, (left + 36, y), TextStyle::new(12.0));
    }
}

#[cfg(test)]
mod tests {
    use super::super::axes::Scale;
    use super::super::canvas::picture;
    use super::super::colour::{BLUE, ORANGE};
    use super::*;

    /// A chart of 100 by 50 pixels at (10, 20) over 0 to 10 and 0 to 5: ten pixels to the unit both ways.
    fn chart() -> LineChart {
        let (x, y) = (Scale::new(0.0, 10.0, 10, 110), Scale::new(0.0, 5.0, 70, 20));
        LineChart::new(Panel::new(x, y, [5, 5], ["x", "y"]))
    }

    fn drawn(chart: &LineChart, element: &str) -> Vec<String> {
        let svg = picture((140, 100), |canvas| chart.draw(canvas));
        svg.lines().filter(|line| line.contains(element)).map(str::to_owned).collect()
    }

    #[test]
    fn a_known_series_is_drawn_at_its_pixels() {
        let mut chart = chart();
        chart.curve([[0.0, 0.0], [1.0, 2.5], [10.0, 5.0]], ORANGE);
        // In quarters of a pixel: (10, 70), (20, 45), (110, 20).
        assert_eq!(
            drawn(&chart, "#D55E00"),
            ["<polyline fill=\"none\" stroke=\"#D55E00\" stroke-width=\"8\" points=\"40,280 80,180 440,80 \"/>"]
        );
    }

    #[test]
    fn a_broken_curve_has_a_gap_and_a_dot() {
        let mut chart = chart();
        let values = [Some(1.0), None, Some(2.0), Some(3.0)];
        chart.broken_curve(values.into_iter().enumerate().map(|(k, value)| (k as f64, value)), BLUE);
        let dot = "<circle cx=\"40\" cy=\"240\" r=\"12\" fill=\"#6E8CBE\" stroke=\"none\" stroke-width=\"1\"/>";
        let line = "<polyline fill=\"none\" stroke=\"#6E8CBE\" stroke-width=\"8\" points=\"120,200 160,160 \"/>";
        assert_eq!(drawn(&chart, "#6E8CBE"), [dot, line]);
    }

    #[test]
    fn labels_of_lines_that_would_run_into_each_other_are_left_out() {
        let mut chart = chart();
        for at in [2.0, 2.5, 9.0] {
            chart.marks.push(Mark::Vertical(at, ORANGE, Some(format!("{at} Hz"))));
        }
        let svg = picture((140, 100), |canvas| chart.draw(canvas));
        assert!(svg.contains("2 Hz") && !svg.contains("2.5 Hz") && svg.contains("9 Hz"));
    }
}
