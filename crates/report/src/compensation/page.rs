//! `report.html` of a compensation.

use crate::page::cards::{Axis, Cell, Chart, Column, Mark, Page, Series, Style, Table, Tile};
use crate::units::{figures, fixed};
use stead_calibration::compensation::{CompensatedPath, CompensatedPoint, Deflection, MeanAndMax, reduction};
use stead_runs::CompensateRun;

/// Figures before and after, both along the path, and which points keep their target.
pub(super) fn page(run: &CompensateRun, outcome: &CompensatedPath) -> Page {
    let count = outcome.points.len();
    let kept = outcome.not_corrected().map_or_else(Vec::new, |not| not.failed);
    let subtitle = format!("compensation · {count} path points");
    let [before, after] = outcome.deflections();
    let start = if run.has_reality { "The" } else { "By the model, the" };
    let mut lead = format!(
        "{start} commands bring the mean deflection of the tool from {} mm to {} mm",
        millimetres(before.mean),
        millimetres(after.mean)
    );
    if run.has_reality {
        lead.push_str(&format!(", carried out by {}", run.job.reality.name()));
    }
    if !kept.is_empty() {
        lead.push_str(&format!("; {} of {count} points keep their target", kept.len()));
    }
    lead.push('.');
    let warnings = [run.warnings.as_slice(), &outcome.warnings].concat();
    let row = |(point, reason): &(usize, _)| vec![Cell::Number(point.to_string()), Cell::Text(format!("{reason}"))];
    let columns = vec![Column::number("point"), Column::text("reason")];
    let table = || Table::new("Points that keep their target", columns, kept.iter().map(row).collect());
    Page::new(run.job.robot.name(), subtitle, lead, &run.inputs)
        .messages(&warnings, &[run.notes.as_slice(), &outcome.notes].concat())
        .with(tiles(outcome))
        .with_all(before_and_after(outcome))
        .with(correction(outcome))
        .with_all((!kept.is_empty()).then(table))
}

fn tiles(outcome: &CompensatedPath) -> Vec<Tile> {
    let of = |what: &str, pair: [MeanAndMax; 2]| {
        let [before, after] = pair;
        let largest = |figures_: &MeanAndMax| format!("largest {} mm", millimetres(figures_.max));
        let detail = [Some(largest(&after)), change(pair)].into_iter().flatten().collect::<Vec<_>>().join("; ");
        [
            Tile::new(&format!("mean {what} before"), millimetres(before.mean), "mm", largest(&before)),
            Tile::new(&format!("mean {what} after"), millimetres(after.mean), "mm", detail),
        ]
    };
    let moved = outcome.figures(|point| Some(point.correction.linear.norm())).max * 1e3;
    let turned = outcome.figures(|point| Some(point.correction.angular.norm())).max.to_degrees();
    let detail = format!("and {}°, in at most {} iterations", figures(turned), outcome.iterations());
    let mut tiles = of("deflection", outcome.deflections()).to_vec();
    tiles.extend(of("normal to the feed", outcome.normal_parts()));
    tiles.push(Tile::new("largest correction", figures(moved), "mm", detail));
    tiles
}

/// What is smaller is how well the equations of the model are solved, and no accuracy. m
const SOLVED: f64 = 1e-6;

/// A mean or a largest deflection in mm.
fn millimetres(length: f64) -> String {
    if length < SOLVED { "below 0.001".to_owned() } else { figures(length * 1e3) }
}

/// By how much less or more a mean is behind than before, where what is left says it.
fn change(pair: [MeanAndMax; 2]) -> Option<String> {
    let share = reduction(pair).filter(|_| pair[1].mean >= SOLVED)?;
    let word = if share < 0.0 { "more" } else { "less" };
    Some(format!("{} % {word}", fixed(share.abs() * 100.0, 1)))
}

/// The deflection along the path, and its part normal to the feed.
pub(super) fn before_and_after(outcome: &CompensatedPath) -> [Chart; 2] {
    [
        along("Deflection before and after", outcome, outcome.deflections(), |deflection| deflection.linear.norm()),
        along("Normal to the feed before and after", outcome, outcome.normal_parts(), |deflection| {
            deflection.normal.abs()
        }),
    ]
}

/// A part of the deflection over the points, without and with the commands.
fn along(title: &str, outcome: &CompensatedPath, pair: [MeanAndMax; 2], part: fn(&Deflection) -> f64) -> Chart {
    let [before, after] = pair.map(|sizes| millimetres(sizes.mean));
    let change = change(pair).map_or_else(String::new, |change| format!(", {change}"));
    let curve = |name: &str, color: usize, of: fn(&CompensatedPoint) -> &Option<Deflection>| {
        let value = |point: &CompensatedPoint| of(point).as_ref().map(part).filter(|part| *part > 0.0);
        Series::curve(name, color, by_segment(outcome, |point| value(point).map_or(f64::NAN, |part| part * 1e3)))
    };
    let curves =
        [curve("target commanded", 1, |point| &point.before), curve("corrected command", 0, |point| &point.after)];
    Chart::new(title, "path point", Axis::log("deflection (mm)"), curves)
        .detailed(format!("mean magnitude {before} mm before, {after} mm after{change}"))
        .marked(starts(outcome))
        .wide()
}

/// By how much the command differs from the target.
fn correction(outcome: &CompensatedPath) -> Chart {
    let shift = by_segment(outcome, |point| point.correction.linear.norm() * 1e3);
    let turn = by_segment(outcome, |point| point.correction.angular.norm().to_degrees());
    let turn = Series::curve("orientation (deg)", 2, turn).styled(Style::Dashed);
    Chart::new("Corrections", "path point", "mm and deg", [Series::curve("place (mm)", 0, shift), turn])
        .detailed("of the place in mm, of the orientation in deg")
        .marked(starts(outcome))
        .wide()
}

/// A value over the path points, without a line from segment to segment.
fn by_segment(outcome: &CompensatedPath, value: impl Fn(&CompensatedPoint) -> f64) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(outcome.points.len());
    let mut segment = None;
    for (k, point) in outcome.points.iter().enumerate() {
        if segment.is_some_and(|last| last != point.segment) {
            points.push([k as f64 - 0.5, f64::NAN]);
        }
        segment = Some(point.segment);
        points.push([k as f64, value(point)]);
    }
    points
}

/// Where segments begin, but for the first.
fn starts(outcome: &CompensatedPath) -> Vec<Mark> {
    let pairs = outcome.points.windows(2).enumerate().filter(|(_, pair)| pair[0].segment != pair[1].segment);
    pairs.map(|(k, pair)| Mark::across(k as f64 + 0.5, format!("segment {}", pair[1].segment))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::charts;
    use crate::testing::assert_well_formed;
    use std::path::Path;
    use stead_calibration::compensation::compensate;
    use stead_numerics::monitor::Monitor;
    use stead_run_files::read_compensation;

    fn outcome() -> CompensatedPath {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let reality = root.join("configs/robots/kuka-kr270-2-k1-0.8.toml");
        let run =
            read_compensation(&root.join("configs/compensate-caro-2013.toml"), Some(&reality), &Monitor::silent())
                .unwrap();
        compensate(&run.job, &Monitor::silent()).unwrap()
    }

    #[test]
    fn the_picture_is_well_formed_small_the_same_each_time_and_labelled() {
        let outcome = outcome();
        let svg = charts(&before_and_after(&outcome));
        assert_eq!(svg, charts(&before_and_after(&outcome)));
        assert_well_formed(&svg);
        assert!(svg.len() < 100_000, "{}", svg.len());
        for label in ["deflection (mm)", "Normal to the feed", "target commanded", "path point", "77.0 % more"] {
            assert!(svg.contains(label), "{label}");
        }
    }

    #[test]
    fn what_is_left_by_the_solver_is_no_accuracy() {
        assert_eq!([0.0, 9e-7, 1.25e-6, 2e-4].map(millimetres), ["below 0.001", "below 0.001", "0.00125", "0.200"]);
        let of = |mean: f64| MeanAndMax { mean, max: mean };
        assert_eq!(change([of(1e-3), of(1e-12)]), None);
        assert_eq!(change([of(1e-3), of(25e-5)]).as_deref(), Some("75.0 % less"));
        assert_eq!(change([of(1e-3), of(15e-4)]).as_deref(), Some("50.0 % more"));
    }

    #[test]
    fn a_path_of_one_point_is_a_dot() {
        let mut outcome = outcome();
        outcome.points.truncate(1);
        let svg = charts(&before_and_after(&outcome));
        assert_well_formed(&svg);
        assert!(svg.contains("<circle"));
    }
}
