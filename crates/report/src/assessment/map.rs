//! The circularity maps of a robot (Klimchik 2017, Fig. 15 to 19), on the page and as a picture.

use crate::page::cards::{Axis, HeatMap, MapLine, MapPoint, Outline};
use crate::picture::{ColourRange, PlaneView, heat_maps};
use crate::units::figures;
use stead_assessment::comparison::{Comparison, Configuration, ElbowNames, Load, RobotResult, Zones, obstacle_words};
use stead_assessment::map::{Elbow, Map};
use stead_assessment::zone::Zone;
use stead_document::picture::axes::{Window, around};
use stead_document::picture::labels::{lines, whole_or_figures};

/// Colours of the optimal and of the middle zones.
const COLOURS: [usize; 2] = [2, 3];
/// Most nodes along an axis of a picture: a finer map is thinned out to keep the file small.
const MAX_NODES: usize = 240;
/// The arm is shown where that widens the view by no more than this share.
const WIDENED: f64 = 0.5;
/// Letters of a line under a map.
const LETTERS: usize = 68;

/// Gives all maps one scale of colours and the same axes, so that they are compared by eye.
pub(super) fn compare(maps: &mut [HeatMap], colours: fn(&[f64]) -> ColourRange) {
    let mut ascending: Vec<f64> = maps.iter().flat_map(|map| &map.values).copied().filter(|v| v.is_finite()).collect();
    ascending.sort_by(f64::total_cmp);
    let colours = colours(&ascending);
    let ends = |places: fn(&HeatMap) -> &[f64]| {
        let halves = maps.iter().flat_map(|map| match places(map) {
            [] => vec![],
            of @ [first, .., last] => {
                let half = (last - first) / (of.len() - 1) as f64 / 2.0;
                vec![first - half, last + half]
            }
            [only] => vec![*only - 0.5, only + 0.5],
        });
        halves.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], end| [low.min(end), high.max(end)])
    };
    let (x, y) = (ends(|map| &map.columns), ends(|map| &map.rows));
    for map in maps {
        map.range = [colours.from, colours.to];
        (map.x.range, map.y.range) = (Some(x), Some(y));
    }
}

/// The map of an elbow under the test load, every so-manieth node of the part that has values.
pub(super) fn chart(view: &PlaneView, robot: &RobotResult, elbow: Elbow, map: &Map<2>, stride: usize) -> HeatMap {
    let [across, up] = map.grid.counts;
    let values = map.values(0);
    let at = |column: usize, row: usize| values[row * across + column];
    let has_value = |line: &dyn Fn(usize) -> bool, count: usize| {
        let found: Vec<usize> = (0..count).filter(|k| line(*k)).collect();
        let (first, last) = (found.first().copied().unwrap_or(0), found.last().copied().unwrap_or(0));
        (first..=last).step_by(stride).collect::<Vec<usize>>()
    };
    let columns = has_value(&|column| (0..up).any(|row| at(column, row).is_finite()), across);
    let rows = has_value(&|row| (0..across).any(|column| at(column, row).is_finite()), up);
    let shown: Vec<f64> = rows.iter().flat_map(|row| columns.iter().map(|column| at(*column, *row) * 1e3)).collect();
    let place = |column: usize, row: usize| view.shown(map.grid.at([column as f64, row as f64]));
    let found = found(robot, elbow);
    let outline = |kind: &str, color: usize, zone: Option<Zone>| {
        zone.map(|zone| {
            let ([x, y], half) = (view.shown(zone.centre), zone.side / 2.0 * 1e3);
            Outline {
                label: format!("{kind} zone, {} mm", figures(zone.side * 1e3)),
                color,
                low: [x - half, y - half],
                high: [x + half, y + half],
            }
        })
    };
    let zones = found.iter().flat_map(|found| &found.zones);
    let outlines = zones
        .flat_map(|zones| [outline("optimal", COLOURS[0], zones.optimal), outline("middle", COLOURS[1], zones.middle)]);
    let detail = found.and_then(|found| Some((found.min?, found.max?))).map_or_else(String::new, |(min, max)| {
        format!("{} to {} mm", figures(min.circularity * 1e3), figures(max.circularity * 1e3))
    });
    HeatMap {
        title: format!("{}, elbow {}", robot.name, elbow.word()),
        detail: format!("{detail}; {}", view.words()),
        x: Axis::new(view.labels[0]),
        y: Axis::new(view.labels[1]),
        columns: columns.iter().map(|column| place(*column, 0)[0]).collect(),
        rows: rows.iter().map(|row| place(0, *row)[1]).collect(),
        values: shown,
        unit: "mm".to_owned(),
        measure: "circularity (mm)".to_owned(),
        blank: "no circle fits".to_owned(),
        outlines: outlines.flatten().collect(),
        is_even: true,
        ..HeatMap::default()
    }
}

/// What was found for an elbow under the test load.
fn found(robot: &RobotResult, elbow: Elbow) -> Option<&Configuration> {
    robot.configurations.iter().find(|found| found.elbow == elbow && found.load == Load::Test)
}

/// The circularity of a robot under the test load over the plane of the study, for both elbows to the same scales, with
/// the most accurate place and the robot's axis 1 and shoulder where they lie in the plane and near the map. The axes
/// show the part of the grid that has values. A map of more than 240 nodes along an axis is thinned out evenly.
pub(crate) fn picture(comparison: &Comparison, robot: &RobotResult) -> String {
    let benchmark = &comparison.benchmark;
    let view = PlaneView::new(&benchmark.plane);
    let grid = &robot.maps[0].1.grid;
    let longest = robot.maps.iter().map(|(_, map)| nodes_across(map)).max().unwrap_or(0);
    let stride = longest.div_ceil(MAX_NODES).max(1);
    let mut maps = Vec::from_iter(robot.maps.iter().map(|(elbow, map)| drawn(&view, robot, *elbow, map, stride)));
    compare(&mut maps, without_peaks);
    let arm = comparison.robots.iter().find(|arm| arm.name() == robot.name);
    let arm = arm.and_then(|arm| view.arm(arm, grid.at(grid.counts.map(|count| count as f64 / 2.0))));
    let whole = [[-0.5; 2], grid.counts.map(|count| count as f64 - 0.5)].map(|steps| view.shown(grid.at(steps)));
    for map in &mut maps {
        let extent = match (map.x.range, map.y.range) {
            (Some(x), Some(y)) if x[0] <= x[1] => [[x[0], y[0]], [x[1], y[1]]],
            _ => whole,
        };
        let shown = arm.as_ref().map_or(extent, |arm| widened(extent, [arm.shoulder, arm.foot]));
        (map.x.range, map.y.range) = (Some([shown[0][0], shown[1][0]]), Some([shown[0][1], shown[1][1]]));
        if let Some(arm) = &arm {
            map.points.push(MapPoint { label: "shoulder (axis 2)".to_owned(), at: arm.shoulder, is_ring: true });
            map.lines.push(MapLine { label: "axis 1".to_owned(), through: arm.foot, along: arm.along });
        }
    }
    let (radius, force) = (whole_or_figures(benchmark.radius * 1e3), figures(benchmark.in_plane_force()));
    let title = format!("{}: circularity of a circle of radius {radius} mm under {force} N, mm", robot.name);
    let names = match comparison.elbow_names {
        ElbowNames::Geometric => "elbow up: above the line from the shoulder to the wrist centre",
        ElbowNames::Swapped => {
            "elbow up, by the names of this study: below the line from the shoulder to the wrist centre"
        }
    };
    let subtitle = format!("Centres of the circle in the {}; {names}", view.words());
    let notes = [
        "The largest circularity in an optimal zone is the smallest of all squares of its side; a middle zone is about the middle of the map.",
        "A square is labelled with its side in mm where there is space. Under the maps: side in mm, then the largest circularity in the zone \
         in mm.",
    ];
    heat_maps(&title, &subtitle, &maps, &notes)
}

/// Nodes along the longer side of the part of a map that has values.
fn nodes_across(map: &Map<2>) -> usize {
    let valued = map.values(0).into_iter().enumerate().filter(|(_, value)| value.is_finite());
    let columns = map.grid.counts[0];
    let extent = around(valued.map(|(node, _)| [(node % columns) as f64, (node / columns) as f64]));
    extent.map_or(0, |[low, high]| (0..2).map(|k| (high[k] - low[k]) as usize + 1).max().unwrap_or(0))
}

/// The map of an elbow as a picture shows it: with its most accurate place and the figures of its zones.
fn drawn(view: &PlaneView, robot: &RobotResult, elbow: Elbow, map: &Map<2>, stride: usize) -> HeatMap {
    let chart = chart(view, robot, elbow, map, stride);
    let title = match elbow {
        Elbow::Up => "Elbow up".to_owned(),
        Elbow::Down => "Elbow down".to_owned(),
    };
    let Some(found) = found(robot, elbow) else { return HeatMap { title, detail: String::new(), ..chart } };
    let millimetres = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| figures(value * 1e3));
    let [min, middle, max] =
        [found.min, found.middle, found.max].map(|spot| millimetres(spot.map(|spot| spot.circularity)));
    let main = map.obstacles();
    let detail = match found.circles {
        0 => obstacle_words(&main[..main.len().min(1)], map.nodes.len()),
        1 => format!("{min} mm; one circle"),
        count => format!("smallest {min}, middle {middle}, largest {max} mm; {count} circles"),
    };
    let best = found.min.map(|spot| MapPoint {
        label: "most accurate place".to_owned(),
        at: view.shown(spot.centre),
        is_ring: false,
    });
    HeatMap { title, detail, points: best.into_iter().collect(), notes: zone_lines(found), ..chart }
}

/// From the smallest value (from zero, where all are the same) to the largest that is no peak.
fn without_peaks(ascending: &[f64]) -> ColourRange {
    match ascending {
        [min, .., max] if max > min => ColourRange::below_peaks(*min, ascending),
        [max, ..] if *max > 0.0 => ColourRange { from: 0.0, to: *max },
        _ => ColourRange { from: 0.0, to: 1.0 },
    }
}

/// An extent with points, where they are near.
fn widened(extent: Window, points: [[f64; 2]; 2]) -> Window {
    let sides = |[low, high]: Window| [0, 1].map(|k| (high[k] - low[k]).max(1e-6));
    let wider = around(extent.into_iter().chain(points)).unwrap_or(extent);
    let (before, after) = (sides(extent), sides(wider));
    if (0..2).all(|k| after[k] <= before[k] * (1.0 + WIDENED)) { wider } else { extent }
}

/// The largest circularity in the zones of each side, in the colours of the zones.
fn zone_lines(found: &Configuration) -> Vec<(String, usize)> {
    let table = |kind: &str, color: usize, zone: fn(&Zones) -> Option<Zone>| {
        let each = found.zones.iter().map(|zones| {
            let largest = zone(zones).map_or_else(|| "–".to_owned(), |zone| figures(zone.largest * 1e3));
            format!("{}: {largest}", whole_or_figures(zones.side * 1e3))
        });
        let phrases: Vec<String> = std::iter::once(kind.to_owned()).chain(each).collect();
        lines(&phrases, LETTERS).into_iter().map(move |line| (line, color)).collect::<Vec<_>>()
    };
    if found.zones.is_empty() || found.circles == 0 {
        return Vec::new();
    }
    let optimal = table("optimal zones", COLOURS[0], |zones| zones.optimal);
    [optimal, table("middle zones", COLOURS[1], |zones| zones.middle)].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_near_arm_is_in_view() {
        let arm = [[500.0, 1000.0], [0.0, 1000.0]];
        let extents = [
            ([[600.0, -400.0], [2700.0, 3200.0]], true),
            ([[300.0, 500.0], [3000.0, 1500.0]], true),
            // A flat and a small one, too far away to show the arm.
            ([[1200.0, 500.0], [2400.0, 620.0]], false),
            ([[1200.0, 800.0], [1220.0, 820.0]], false),
        ];
        for (extent, near) in extents {
            let shown = widened(extent, arm);
            assert_eq!(around(shown.into_iter().chain(extent)), Some(shown), "the map is in view");
            assert_eq!(around(shown.into_iter().chain(arm)) == Some(shown), near, "{extent:?}");
        }
    }

    #[test]
    fn a_peak_does_not_set_the_scale() {
        let scale = |values: &[f64]| {
            let range = without_peaks(values);
            [range.from, range.to]
        };
        let even: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!(scale(&even), [1.0, 100.0]);
        let peak: Vec<f64> = (1..=100).map(|k| if k == 100 { 1000.0 } else { f64::from(k) }).collect();
        assert_eq!(scale(&peak), [1.0, 98.0]);
        assert_eq!(scale(&[2.0, 2.0]), [0.0, 2.0]);
        assert_eq!(scale(&[0.0]), [0.0, 1.0]);
        assert_eq!(scale(&[]), [0.0, 1.0]);
    }
}
