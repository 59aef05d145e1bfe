//! `NAME-forces.html`: the page of forces from a path.

use super::ForcesFigures;
use crate::page::cards::{Chart, Page, Series, Style, Tile};
use crate::units::fixed;
use stead_removal::load::PointForces;
use stead_removal::outcome::RemovalForces;
use stead_runs::ForcesRun;

/// What was found, and the charts along the path.
pub(super) fn page(run: &ForcesRun, forces: &RemovalForces) -> Page {
    let figures = ForcesFigures::from(forces);
    let subtitle = format!("forces of the cut · {} path points, {} of them added", figures.points, figures.added);
    let force = |newtons: f64| fixed(newtons, 1);
    let lead = match figures.mean_force_n {
        Some(mean) => format!(
            "Where the path cuts, the tool is pushed by {} N in the mean over a turn, by {} N at most. The cut: {}.",
            force(mean.0),
            force(figures.max_force_n.0),
            forces.cut.map(|cut| cut.lines().join("; ")).unwrap_or_default()
        ),
        None => "No scored point of the path cuts.".to_owned(),
    };
    let notes = [run.notes.as_slice(), &forces.notes].concat();
    let title = run.problem.operation.name.trim_start_matches("../");
    Page::new(title, subtitle, lead, &run.inputs)
        .messages(&forces.warnings, &notes)
        .with(tiles(forces, &figures))
        .with_all(charts(forces))
}

fn tiles(forces: &RemovalForces, figures: &ForcesFigures) -> Vec<Tile> {
    let air = format!("{} % of the scored length cuts nothing", fixed(forces.air * 100.0, 1));
    let (cell, off) = (fixed(forces.cell * 1e3, 3), fixed(forces.difference.rms[0] * 100.0, 2));
    let error = format!("cells of {cell} mm; twice as large ones are off by {off} % rms");
    vec![
        Tile::new("largest mean force", fixed(figures.max_force_n.0, 1), "N", error),
        Tile::new("largest in a turn", fixed(figures.max_in_turn_n.0, 1), "N", "within 15 %"),
        Tile::new("largest mean moment", fixed(figures.max_moment_nm.0, 3), "N m", "about the tool centre point"),
        Tile::new("removed", fixed(forces.removed * 1e9, 0), "mm³", air),
    ]
}

/// Force, moment, height, angles and chip along the path.
pub(super) fn charts(forces: &RemovalForces) -> Vec<Chart> {
    let along = along(forces);
    let curve = |name: &str, color: usize, of: &dyn Fn(&PointForces) -> f64| {
        let points = along.iter().zip(&forces.points).map(|(at, load)| [at * 1e3, of(load)]);
        Series::curve(name, color, points)
    };
    let chart = |title: &str, y: &str, series: Vec<Series>| Chart::new(title, "length of path (mm)", y, series).wide();
    let height = |k: usize| move |load: &PointForces| load.heights.map_or(f64::NAN, |heights| heights[k] * 1e3);
    let angle = |k: usize| move |load: &PointForces| load.angles.map_or(f64::NAN, |angles| angles[k].to_degrees());
    vec![
        chart(
            "Force on the tool",
            "force (N)",
            vec![
                curve("mean over a turn", 0, &|load| load.at_feed(1.0).force.norm()),
                curve("of it, chips", 1, &|load| load.chip.force.norm()),
                curve("of it, edges", 2, &|load| load.edge.force.norm()),
                curve("largest in a turn", 3, &|load| load.largest).styled(Style::Dashed),
            ],
        ),
        chart(
            "Moment about the tool centre point",
            "moment (N m)",
            vec![curve("mean over a turn", 0, &|load| load.at_feed(1.0).moment.norm())],
        ),
        chart(
            "Height of the cut above the tool centre point",
            "height (mm)",
            vec![curve("lowest", 0, &height(0)), curve("highest", 1, &height(1))],
        ),
        chart(
            "Angles of the cut",
            "angle from where a tooth moves along the feed (deg)",
            vec![curve("entry", 0, &angle(0)), curve("exit", 1, &angle(1))],
        ),
        chart("Thickest chip", "chip (um)", vec![curve("", 0, &|load| load.chip_thickness * 1e6)]),
    ]
}

/// Length of path to each point. m
pub(super) fn along(forces: &RemovalForces) -> Vec<f64> {
    let points = forces.path.points();
    let mut along = vec![0.0];
    for (index, pair) in points.windows(2).enumerate() {
        let is_start = forces.path.segments().iter().any(|range| range.start == index + 1);
        let step = if is_start { 0.0 } else { (pair[1].position - pair[0].position).norm() };
        along.push(along[index] + step);
    }
    along
}
