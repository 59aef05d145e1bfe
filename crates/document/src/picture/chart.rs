//! Charts as data, drawn: the same that pages show, one below the other.

use super::axes::{Panel, Scale, Ticks, extent};
use super::canvas::{Canvas, LineStyle, TextStyle, picture};
use super::colour::{Colour, INK, PALE, SERIES};
use super::line_chart::{LineChart, Mark, Sign, legend};
use crate::cards::{Axis, Chart, Series, Style};

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
    picture((1000, charts.iter().map(|chart| panel(chart) + AROUND).sum::<i32>() + 20), |canvas| {
        let mut top = 0;
        for chart in charts {
            draw(canvas, chart, top, panel(chart));
            top += panel(chart) + AROUND;
        }
    })
}

fn draw(canvas: &mut Canvas, chart: &Chart, top: i32, panel: i32) {
    canvas.title(&chart.title, (SIDES[0], top + HEADING));
    let style = TextStyle::new(12.0).coloured(INK);
    let beside = SIDES[0] + TextStyle::new(17.0).width(&chart.title) + 10;
    canvas.text(&chart.detail, (beside, top + HEADING), style);
    let levels = chart.marks.iter().filter(|mark| mark.is_level && !mark.label.is_empty());
    let signs = chart.series.iter().filter(|series| !series.name.is_empty()).map(sign);
    let signs: Vec<_> = signs.chain(levels.map(|mark| (Sign::Dashed(INK), mark.label.as_str()))).collect();
    let mut left = SIDES[0];
    for (sign, label) in signs {
        let width = 36 + style.width(label) + 24;
        legend(canvas, top + LEGEND, &[(left, sign, label)]);
        left += width;
    }
    line_chart(chart, [top + TOP + panel, top + TOP]).draw(canvas);
}

fn colour(series: &Series) -> Colour {
    SERIES[series.color % SERIES.len()]
}

fn line(series: &Series) -> LineStyle {
    LineStyle { colour: colour(series), is_dashed: series.style == Style::Dashed }
}

fn sign(series: &Series) -> (Sign, &str) {
    let sign = match series.style {
        Style::Line | Style::Dashed => Sign::Line(line(series)),
        Style::Dots | Style::Rings | Style::Intervals => Sign::Dot(colour(series)),
    };
    (sign, &series.name)
}

/// The place of a value along an axis.
fn along(axis: &Axis, value: f64) -> f64 {
    if axis.is_log { libm::log10(value) } else { value }
}

/// A scale over values, or over the range of the axis.
fn scale(axis: &Axis, values: impl Iterator<Item = f64>, margin: f64, [start, end]: [i32; 2]) -> Scale {
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
        return Ticks::named(axis.names.clone());
    }
    // A part of a decade has no power of ten on it.
    if axis.is_log && scale.to - scale.from >= 1.0 { Ticks::decades(scale) } else { Ticks::round(scale, max) }
}

/// The chart between the lower and the upper edge of its panel.
fn line_chart(chart: &Chart, edges: [i32; 2]) -> LineChart {
    let levels = chart.marks.iter().filter(|mark| mark.is_level).map(|mark| mark.at);
    let heights = chart.series.iter().flat_map(|series| [&series.y, &series.low, &series.high]).flatten().copied();
    let places = chart.series.iter().flat_map(|series| &series.x).copied();
    let is_curve = |series: &Series| matches!(series.style, Style::Line | Style::Dashed);
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
    let mut drawn = LineChart::new(Panel { x, y, x_ticks, y_ticks, x_label, y_label });
    for mark in &chart.marks {
        if mark.is_level {
            drawn.marks.push(Mark::Dashed(along(&chart.y, mark.at), INK));
        } else if (x.from..=x.to).contains(&along(&chart.x, mark.at)) {
            let label = (!mark.label.is_empty()).then(|| mark.label.clone());
            drawn.marks.push(Mark::Vertical(along(&chart.x, mark.at), PALE, label));
        }
    }
    for series in &chart.series {
        let height = |value: f64| Some(along(&chart.y, value)).filter(|value| value.is_finite());
        let points = series.x.iter().zip(&series.y).map(|(at, value)| (along(&chart.x, *at), height(*value)));
        let points = points.map(|(at, value)| (at, value.map(|value| value.clamp(y.from, y.to))));
        match series.style {
            Style::Line | Style::Dashed => drawn.broken_curve(points, line(series)),
            Style::Dots | Style::Rings | Style::Intervals => {
                let ends = series.low.iter().zip(&series.high).zip(&series.x);
                for ((low, high), at) in ends {
                    let at = along(&chart.x, *at);
                    drawn.curve([low, high].map(|end| [at, along(&chart.y, *end)]), colour(series));
                }
                let radius = if series.style == Style::Dots { 4 } else { 6 };
                let dots = points.filter_map(|(at, value)| Some(Mark::Dot([at, value?], radius, colour(series))));
                drawn.marks.extend(dots);
            }
        }
    }
    drawn
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
        let drawn = line_chart(&Chart { is_even: true, ..chart() }, [440, 84]);
        let [x, y] = [drawn.panel.x, drawn.panel.y].map(|scale| scale.place(1.0) - scale.place(0.0));
        assert!((x + y).abs() < 1e-9 && x > 0.0, "{x} {y}");
        assert!(drawn.panel.x.from <= 0.0 && drawn.panel.x.to >= 10.0);
    }

    #[test]
    fn what_is_beyond_the_range_is_drawn_at_its_end_and_logarithms_are_decades() {
        let log = Axis { range: Some([0.01, 1.0]), ..Axis::log("answer") };
        let curve = Series::curve("", 1, [[0.0, 1e-5], [10.0, 0.1]]);
        let svg = charts(&[Chart { y: log, series: vec![curve], ..chart() }]);
        assert!(svg.contains("points=\"380,1760 3880,1048 \""), "{svg}");
        assert!(svg.contains("\n0.01\n") && svg.contains("\n0.1\n") && svg.contains("\n1\n"));
    }
}
