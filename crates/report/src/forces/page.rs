//! `NAME-forces.html`: the page of forces from a path.

use super::{ForcesFigures, charts};
use crate::page::cards::{Card, Page, Tile, Tiles};
use crate::units::fixed;
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
    let page = Page::new(title, subtitle, lead, &run.inputs).messages(&forces.warnings, &notes);
    charts(forces).into_iter().fold(page.with(tiles(forces, &figures)), |page, chart| page.with(Card::Chart(chart)))
}

fn tiles(forces: &RemovalForces, figures: &ForcesFigures) -> Card {
    let percent = |share: f64| fixed(share * 100.0, 1);
    let error = format!(
        "cells of {} mm; twice as large ones are off by {} % rms",
        fixed(forces.cell * 1e3, 3),
        fixed(forces.difference.rms[0] * 100.0, 2)
    );
    Card::Tiles(Tiles {
        tiles: vec![
            Tile::new("largest mean force", fixed(figures.max_force_n.0, 1), "N", error),
            Tile::new("largest in a turn", fixed(figures.max_in_turn_n.0, 1), "N", "within 15 %"),
            Tile::new("largest mean moment", fixed(figures.max_moment_nm.0, 3), "N m", "about the tool centre point"),
            Tile::new(
                "removed",
                fixed(forces.removed * 1e9, 0),
                "mm³",
                format!("{} % of the scored length cuts nothing", percent(forces.air)),
            ),
        ],
    })
}
