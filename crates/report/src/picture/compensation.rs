//! The deflection along a path before and after its compensation.

use super::axes::{Panel, Scale, Ticks};
use super::canvas::{Canvas, Drawn, Lettering, Place, picture};
use super::colour::{GREEN, INK, PALE, RED};
use crate::output::ReportError;
use crate::units::figures;
use crate::units::fixed;
use plotters::style::RGBColor;
use stead_calibration::compensation::{CompensatedPath, CompensatedPoint, Deflection, MeanAndMax, reduction};

const LEFT: i32 = 95;
const RIGHT: i32 = 970;

/// Deflection above, its part normal to the feed below, over the points of the path: before and after. Segments are parted by
/// thin lines.
///
/// # Errors
/// [`ReportError::Format`] when the drawing fails.
pub fn compensation(outcome: &CompensatedPath) -> Result<String, ReportError> {
    picture("the picture of the compensation", (1000, 780), |canvas| {
        canvas.text("Deflection before and after compensation", (LEFT, 26), Lettering::new(17.0).bold())?;
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
            canvas.text(&title, (LEFT, top - 16), Lettering::new(13.0).bold().coloured(INK))?;
            draw(canvas, outcome, top, y_label, value)?;
        }
        legend(canvas)
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
    canvas: &Canvas<'_>,
    outcome: &CompensatedPath,
    top: i32,
    y_label: &'static str,
    value: fn(&Deflection) -> f64,
) -> Drawn {
    let points = &outcome.points;
    let values = points.iter().flat_map(|point| [value(&point.before), value(&point.after)]);
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v * 1e3), high.max(v * 1e3)));
    let margin = 0.06 * (high - low);
    let x = Scale::new(0.0, (points.len() - 1) as f64, LEFT, RIGHT);
    let y = Scale::new(if low < 0.0 { low - margin } else { 0.0 }, high + margin, top + 260, top);
    let (x_ticks, y_ticks) = (Ticks::round(&x, 12), Ticks::round(&y, 8));
    let panel = Panel { x, y, x_ticks, y_ticks, x_label: "path point", y_label };
    panel.draw_grid(canvas)?;
    let zero = panel.y.pixel(0.0);
    canvas.line(vec![(LEFT, zero), (RIGHT, zero)], INK, 1)?;
    let mut first = 0;
    for segment in points.chunk_by(|a, b| a.segment == b.segment) {
        if first > 0 {
            let between = panel.x.pixel(first as f64 - 0.5);
            canvas.line(vec![(between, panel.y.start), (between, panel.y.end)], PALE, 1)?;
        }
        let curve = |of: fn(&CompensatedPoint) -> &Deflection, colour: RGBColor| {
            let place =
                |(k, point): (usize, &CompensatedPoint)| panel.place((first + k) as f64, value(of(point)) * 1e3);
            let places: Vec<Place> = segment.iter().enumerate().map(place).collect();
            if let [alone] = places[..] { canvas.dot(alone, 3, colour) } else { canvas.curve(&places, colour, 2) }
        };
        curve(|point| &point.before, RED)?;
        curve(|point| &point.after, GREEN)?;
        first += segment.len();
    }
    panel.draw_frame(canvas)
}

/// The legend, in one line under the title.
fn legend(canvas: &Canvas<'_>) -> Drawn {
    for (left, label, colour) in [(LEFT, "before", RED), (LEFT + 110, "after", GREEN)] {
        canvas.line(vec![(left, 46), (left + 28, 46)], colour, 2)?;
        canvas.text(label, (left + 36, 46), Lettering::new(12.0))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::super::testing::assert_well_formed;
    use super::*;
    use std::path::Path;
    use stead_calibration::compensation::compensate;
    use stead_format::read_compensation;

    fn outcome() -> CompensatedPath {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let reality = root.join("configs/robots/kuka-kr270-2-k1-0.8.toml");
        let run = read_compensation(&root.join("configs/compensate-caro-2013.toml"), Some(&reality)).unwrap();
        compensate(&run.job).unwrap()
    }

    #[test]
    fn the_picture_is_well_formed_small_the_same_each_time_and_labelled() {
        let outcome = outcome();
        let svg = compensation(&outcome).unwrap();
        assert_eq!(svg, compensation(&outcome).unwrap());
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
        let svg = compensation(&outcome).unwrap();
        assert_well_formed(&svg);
        assert!(svg.contains("<circle"));
    }
}
