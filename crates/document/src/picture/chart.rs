//! Charts as data, drawn: the same that pages show, one below the other.

use super::axes::{Panel, Scale, Ticks, extent};
use super::canvas::{Canvas, LineStyle, Pixel, Place, TextStyle, exact, nearest, picture};
use super::colour::{BLACK, Colour, INK, PALE, SERIES, WHITE};
use super::labels::{Label, Labeller, fitting};
use crate::cards::{Axis, Chart, Series, Style};

/// Width of a picture. Pixels
const WIDTH: i32 = 1000;
/// Left and right edge of every chart. Pixels
const SIDES: [i32; 2] = [95, 970];
/// Height of a panel, of one whose axes are to the same scale, and of what stands around it. Pixels
const PANEL: i32 = 356;
const EVEN: i32 = 620;
const AROUND: i32 = 144;
/// From the upper edge of a chart to the middle of its heading, to that of its legend and to its panel. Pixels
const HEADING: i32 = 26;
const LEGEND: i32 = 52;
const TOP: i32 = 84;
/// Share of what is between the smallest and the largest value that is left above and below.
const MARGIN: f64 = 0.06;

/// Charts one below the other, each with its heading and, where it has several series or marks with a label, its
/// legend.
pub fn charts(charts: &[Chart]) -> String {
    let panel = |chart: &Chart| if chart.is_even { EVEN } else { PANEL };
    picture((WIDTH, charts.iter().map(|chart| panel(chart) + AROUND).sum::<i32>() + 20), |canvas| {
        let mut top = 0;
        for chart in charts {
            draw(canvas, chart, top, panel(chart));
            top += panel(chart) + AROUND;
        }
    })
}

fn draw(canvas: &mut Canvas, chart: &Chart, top: i32, panel: i32) {
    canvas.title(&chart.title, (SIDES[0], top + HEADING));
    let style = TextStyle::new(12.0);
    let beside = SIDES[0] + TextStyle::new(17.0).width(&chart.title) + 10;
    canvas.text(&chart.detail, (beside, top + HEADING), style.coloured(INK));
    let named = chart.series.iter().filter(|series| !series.name.is_empty());
    let levels = chart.marks.iter().filter(|mark| mark.is_level && !mark.label.is_empty());
    let levels = levels.map(|mark| (None, &mark.label));
    let (mut x, y) = (SIDES[0], top + LEGEND);
    for (series, label) in named.map(|series| (Some(series), &series.name)).chain(levels) {
        match series {
            None => canvas.dashed((x, y), (x + 28, y), INK),
            Some(curve) if is_curve(curve) => {
                canvas.styled_curve(&[exact((x, y)), exact((x + 28, y))], line(curve), 2);
            }
            Some(dots) => canvas.dot(exact((x + 14, y)), 4, colour(dots)),
        }
        canvas.text(label, (x + 36, y), style);
        x += 36 + style.width(label) + 24;
    }
    let panel = self::panel(chart, [top + TOP + panel, top + TOP]);
    panel.draw_grid(canvas);
    draw_marks(canvas, chart, &panel);
    chart.series.iter().for_each(|series| draw_series(canvas, chart, series, &panel));
    panel.draw_frame(canvas);
    write(canvas, chart, &panel);
}

/// Levels, and lines from the bottom to the top; the label of one that would run into the label before is left out.
fn draw_marks(canvas: &mut Canvas, chart: &Chart, panel: &Panel) {
    let Panel { x, y, .. } = panel;
    let mut free_from = 0;
    for mark in &chart.marks {
        if mark.is_level {
            let at = y.pixel(along(&chart.y, mark.at));
            canvas.dashed((x.start, at), (x.end, at), INK);
        } else if (x.from..=x.to).contains(&along(&chart.x, mark.at)) {
            let at = x.pixel(along(&chart.x, mark.at));
            canvas.line(&[(at, y.start), (at, y.end)], PALE, 1);
            let style = TextStyle::new(10.0).coloured(INK).centred();
            let half = style.width(&mark.label) / 2;
            let middle = at.min(WIDTH - half);
            if !mark.label.is_empty() && middle - half > free_from {
                canvas.text(&mark.label, (middle, y.end - 8), style);
                free_from = middle + half;
            }
        }
    }
}

/// A curve, broken where there is no value, or dots with their intervals.
fn draw_series(canvas: &mut Canvas, chart: &Chart, series: &Series, panel: &Panel) {
    let height = |value: f64| Some(along(&chart.y, value)).filter(|value| value.is_finite());
    let place = |at: f64, value: f64| panel.place(at, value.clamp(panel.y.from, panel.y.to));
    let points = series.x.iter().zip(&series.y).map(|(at, value)| Some(place(along(&chart.x, *at), height(*value)?)));
    let points: Vec<Option<Place>> = points.collect();
    if is_curve(series) {
        for run in points.chunk_by(|a, b| a.is_some() == b.is_some()) {
            canvas.curve_or_dot(&run.iter().flatten().copied().collect::<Vec<_>>(), line(series), 2);
        }
        return;
    }
    for ((low, high), at) in series.low.iter().zip(&series.high).zip(&series.x) {
        let ends = [low, high].map(|end| panel.place(along(&chart.x, *at), along(&chart.y, *end)));
        canvas.curve_or_dot(&ends, colour(series), 2);
    }
    let radius = if series.style == Style::Dots { 4 } else { 6 };
    points.into_iter().flatten().for_each(|place| canvas.dot(place, radius, colour(series)));
}

/// What is written beside points, where it covers neither another one of them nor what is beside it.
fn write(canvas: &mut Canvas, chart: &Chart, panel: &Panel) {
    let mut labeller = Labeller::new(((panel.x.start, panel.y.end), (panel.x.end, panel.y.start)));
    let places = chart.series.iter().flat_map(|series| series.x.iter().zip(&series.y).zip(&series.written));
    let at = |x: f64, y: f64| nearest(panel.place(along(&chart.x, x), along(&chart.y, y)));
    let places: Vec<(Pixel, &String)> = places.map(|((x, y), text)| (at(*x, *y), text)).collect();
    places.iter().for_each(|((x, y), _)| labeller.take(((x - 7, y - 7), (x + 7, y + 7))));
    for ((x, y), text) in places {
        let beside = Labeller::half(text).0 + 10;
        let centres = [(beside, -8), (beside, 9), (-beside, -8), (-beside, 9), (0, -16), (0, 17)];
        let label = Label { text, colour: BLACK, ground: WHITE };
        labeller.put(canvas, &label, centres.into_iter().map(|(across, down)| (x + across, y + down)));
    }
}

fn colour(series: &Series) -> Colour {
    SERIES[series.color % SERIES.len()]
}

fn is_curve(series: &Series) -> bool {
    matches!(series.style, Style::Line | Style::Dashed)
}

fn line(series: &Series) -> LineStyle {
    LineStyle { colour: colour(series), is_dashed: series.style == Style::Dashed }
}

/// The place of a value along an axis.
fn along(axis: &Axis, value: f64) -> f64 {
    if axis.is_log { libm::log10(value) } else { value }
}

/// A scale over values, over the names of the axis, or over its range.
fn scale(axis: &Axis, values: impl Iterator<Item = f64>, margin: f64, ends: [i32; 2]) -> Scale {
    let [start, end] = ends;
    if !axis.names.is_empty() {
        return Scale::new(-0.5, axis.names.len() as f64 - 0.5, start, end);
    }
    let finite = values.map(|value| along(axis, value)).filter(|value| value.is_finite());
    let given = axis.range.map(|range| range.map(|end| along(axis, end)));
    let found = || {
        let [low, high] = extent([f64::INFINITY, f64::NEG_INFINITY], finite);
        if low > high { [0.0, 1.0] } else { [low - margin * (high - low), high + margin * (high - low)] }
    };
    let [low, high] = given.unwrap_or_else(found);
    Scale::new(low, high, start, end)
}

fn ticks(axis: &Axis, scale: &Scale, max: usize) -> Ticks {
    if !axis.names.is_empty() {
        return Ticks::named(fitting(&axis.names, (scale.end - scale.start).abs() / axis.names.len() as i32));
    }
    // A part of a decade has no power of ten on it.
    if axis.is_log && scale.to - scale.from >= 1.0 { Ticks::decades(scale) } else { Ticks::round(scale, max) }
}

/// The axes of a chart between the lower and the upper edge of its panel.
fn panel(chart: &Chart, edges: [i32; 2]) -> Panel {
    let levels = chart.marks.iter().filter(|mark| mark.is_level).map(|mark| mark.at);
    let heights = chart.series.iter().flat_map(|series| [&series.y, &series.low, &series.high]).flatten().copied();
    let places = chart.series.iter().flat_map(|series| &series.x).copied();
    let margin = if chart.series.iter().all(is_curve) { 0.0 } else { 0.05 };
    let mut x = scale(&chart.x, places, margin, SIDES);
    let mut y = scale(&chart.y, heights.chain(levels), MARGIN, edges);
    if chart.is_even {
        // As wide or as high as it must be for a pixel to be the same both ways.
        let of_pixel = |scale: &Scale| (scale.to - scale.from) / f64::from((scale.end - scale.start).abs());
        let pixel = of_pixel(&x).max(of_pixel(&y));
        for scale in [&mut x, &mut y] {
            let (middle, half) =
                (0.5 * (scale.from + scale.to), 0.5 * pixel * f64::from((scale.end - scale.start).abs()));
            (scale.from, scale.to) = (middle - half, middle + half);
        }
    }
    let (x_ticks, y_ticks) = (ticks(&chart.x, &x, 12), ticks(&chart.y, &y, 8));
    let [x_label, y_label] = [&chart.x, &chart.y].map(|axis| axis.label.clone().into());
    Panel { x, y, x_ticks, y_ticks, x_label, y_label }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cards::Mark as ChartMark;
    use crate::testing::assert_well_formed;

    /// A curve with a gap, over a panel of which 0 to 10 and 0 to 1 are the ends.
    fn chart() -> Chart {
        let curve = Series::curve("a", 0, [[0.0, 0.0], [5.0, f64::NAN], [6.0, 0.5], [10.0, 1.0]]);
        let y = Axis { range: Some([0.0, 1.0]), ..Axis::new("height (mm)") };
        let marks = vec![ChartMark { is_level: true, at: 0.25, label: "limit".to_owned() }];
        Chart { title: "Title".to_owned(), x: Axis::new("along"), y, series: vec![curve], marks, ..Chart::default() }
    }

    #[test]
    fn a_chart_has_its_curves_at_their_pixels_and_its_legend() {
        let svg = charts(&[chart(), Chart { title: "Second".to_owned(), ..chart() }]);
        assert_well_formed(&svg);
        for text in ["\nTitle\n", "\nSecond\n", "\na\n", "\nlimit\n", "\nheight (mm)\n", "\nalong\n"] {
            assert!(svg.contains(text), "{text}");
        }
        // In quarters of a pixel: (620, 262) to (970, 84), and 500 pixels below; the point alone is a dot.
        assert!(svg.contains("points=\"2480,1048 3880,336 \"") && svg.contains("points=\"2480,3048 3880,2336 \""));
        assert!(svg.contains("<circle cx=\"380\" cy=\"1760\" r=\"12\""));
    }

    #[test]
    fn an_even_chart_has_the_same_scale_both_ways() {
        let drawn = panel(&Chart { is_even: true, ..chart() }, [440, 84]);
        let [x, y] = [drawn.x, drawn.y].map(|scale| scale.place(1.0) - scale.place(0.0));
        assert!((x + y).abs() < 1e-9 && x > 0.0, "{x} {y}");
        assert!(drawn.x.from <= 0.0 && drawn.x.to >= 10.0);
    }

    #[test]
    fn what_is_beyond_the_range_is_drawn_at_its_end_and_logarithms_are_decades() {
        let log = Axis { range: Some([0.01, 1.0]), ..Axis::log("answer") };
        let curve = Series::curve("", 1, [[0.0, 1e-5], [10.0, 0.1]]);
        let svg = charts(&[Chart { y: log, series: vec![curve], ..chart() }]);
        assert!(svg.contains("points=\"380,1760 3880,1048 \""), "{svg}");
        assert!(svg.contains("\n0.01\n") && svg.contains("\n0.1\n") && svg.contains("\n1\n"));
    }

    #[test]
    fn a_known_series_is_drawn_at_its_pixels() {
        // 875 by 356 pixels at (95, 84) over 0 to 10 and 0 to 1, in quarters of a pixel.
        let known = Series::curve("", 2, [[0.0, 0.0], [1.0, 0.5], [10.0, 1.0]]);
        let svg = charts(&[Chart { series: vec![known], ..chart() }]);
        let lines: Vec<&str> = svg.lines().filter(|line| line.contains("#C26A00")).collect();
        assert_eq!(
            lines,
            ["<polyline fill=\"none\" stroke=\"#C26A00\" stroke-width=\"8\" points=\"380,1760 730,1048 3880,336 \"/>"]
        );
    }

    #[test]
    fn a_broken_curve_has_a_gap_and_a_dot() {
        let values = [[0.0, 0.25], [1.0, f64::NAN], [2.0, 0.5], [10.0, 0.75]];
        let svg = charts(&[Chart { series: vec![Series::curve("", 2, values)], ..chart() }]);
        let dot = "<circle cx=\"380\" cy=\"1404\" r=\"12\" fill=\"#C26A00\" stroke=\"none\" stroke-width=\"1\"/>";
        let line = "<polyline fill=\"none\" stroke=\"#C26A00\" stroke-width=\"8\" points=\"1080,1048 3880,692 \"/>";
        assert_eq!(svg.lines().filter(|line| line.contains("#C26A00")).collect::<Vec<_>>(), [dot, line]);
    }

    #[test]
    fn labels_of_lines_that_would_run_into_each_other_are_left_out() {
        let marks = [2.0, 2.2, 9.0].map(|at| ChartMark { is_level: false, at, label: format!("{at} Hz") });
        let svg = charts(&[Chart { marks: marks.to_vec(), ..chart() }]);
        assert!(svg.contains("2 Hz") && !svg.contains("2.2 Hz") && svg.contains("9 Hz"));
    }
}
