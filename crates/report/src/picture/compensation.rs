//! The deflection along a path before and after its compensation.

use super::axes::{Panel, Scale, extent};
use super::canvas::{Canvas, TextStyle, picture};
use super::colour::{GREEN, INK, PALE, RED};
use super::line_chart::{LineChart, Mark, Sign, legend};
use crate::units::{figures, fixed};
use stead_calibration::compensation::{CompensatedPath, Deflection, MeanAndMax, reduction};

const LEFT: i32 = 95;
const RIGHT: i32 = 970;

/// Deflection above, its part normal to the feed below, over the points of the path: before and after. Segments are parted by
/// thin lines.
pub fn compensation(outcome: &CompensatedPath) -> String {
    picture((1000, 780), |canvas| {
        canvas.title("Deflection before and after compensation", (LEFT, 26));
        for (top, title, pair, y_label, value) in [
            (
                84,
                "Deflection",
                outcome.deflections(),
                "deflection (mm)",
                (|deflection| deflection.linear.norm()) as fn(&Deflection) -> f64,
            ),
            (444, "Part normal to the feed", outcome.normal_parts(), "normal part (mm)", |deflection| {
                deflection.normal
            }),
        ] {
            let [before, after] = pair.map(|sizes| figures(sizes.mean * 1e3));
            let title = format!("{title}: mean magnitude {before} mm before, {after} mm after{}", change(pair));
            canvas.text(&title, (LEFT, top - 16), TextStyle::new(13.0).bold().coloured(INK));
            draw(canvas, outcome, top, y_label, value);
        }
        legend(canvas, 46, &[(LEFT, Sign::Line(RED), "before"), (LEFT + 110, Sign::Line(GREEN), "after")]);
    })
}

/// By how much the mean changes, to go on with.
fn change(pair: [MeanAndMax; 2]) -> String {
    reduction(pair).map_or_else(String::new, |share| {
        let word = if share < 0.0 { "more" } else { "less" };
        format!(", {} % {word}", fixed(share.abs() * 100.0, 1))
    })
}

fn draw(
    canvas: &mut Canvas,
    outcome: &CompensatedPath,
    top: i32,
    y_label: &'static str,
    value: fn(&Deflection) -> f64,
) {
    let points = &outcome.points;
    let value_mm = |deflection: &Option<Deflection>| deflection.as_ref().map(|deflection| value(deflection) * 1e3);
    let values = points.iter().flat_map(|point| [value_mm(&point.before), value_mm(&point.after)]);
    let [low, high] = extent([0.0, 0.0], values.flatten());
    let margin = 0.06 * (high - low);
    let x = Scale::new(0.0, (points.len() - 1) as f64, LEFT, RIGHT);
    let y = Scale::new(if low < 0.0 { low - margin } else { 0.0 }, high + margin, top + 260, top);
    let mut chart = LineChart::new(Panel::new(x, y, [12, 8], ["path point", y_label]));
    chart.marks.push(Mark::Horizontal(0.0, INK));
    let segments = points.chunk_by(|a, b| a.segment == b.segment).map(<[_]>::len);
    chart.by_segment(segments, PALE, |chart, range| {
        chart.curve(range.clone().filter_map(|k| Some([k as f64, value_mm(&points[k].before)?])), RED);
        chart.curve(range.filter_map(|k| Some([k as f64, value_mm(&points[k].after)?])), GREEN);
    });
    chart.draw(canvas);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::assert_well_formed;
    use std::path::Path;
    use stead_calibration::compensation::compensate;
    use stead_format::read_compensation;

    fn outcome() -> CompensatedPath {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let reality = root.join("configs/robots/kuka-kr270-2-k1-0.8.toml");
        let run = read_compensation(&root.join("configs/compensate-caro-2013.toml"), Some(&reality)).unwrap();
        compensate(&run.job)
    }

    #[test]
    fn the_picture_is_well_formed_small_the_same_each_time_and_labelled() {
        let outcome = outcome();
        let svg = compensation(&outcome);
        assert_eq!(svg, compensation(&outcome));
        assert_well_formed(&svg);
        assert!(svg.len() < 100_000, "{}", svg.len());
        for label in ["deflection (mm)", "normal part (mm)", "before", "after", "path point", "77.0 % more"] {
            assert!(svg.contains(label), "{label}");
        }
    }

    #[test]
    fn a_path_of_one_point_is_a_dot() {
        let mut outcome = outcome();
        outcome.points.truncate(1);
        let svg = compensation(&outcome);
        assert_well_formed(&svg);
        assert!(svg.contains("<circle"));
    }
}
