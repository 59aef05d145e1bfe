//! `report.html` of a simulated pass.

use super::json::end_words;
use crate::page::cards::{Card, Chart, Mark, Page, Series, Tile, Tiles};
use crate::stability::page::modes;
use crate::units::{figures, fixed};
use std::f64::consts::TAU;
use stead_runs::SimulationRun;
use stead_simulation::outcome::Simulation;
use stead_simulation::roughness::Profile;

/// Forces over the pass and over three turns, the way the tool was pushed, the wall it left.
pub(super) fn page(run: &SimulationRun, found: &Simulation) -> Page {
    let seconds = found.run.step * found.run.samples.len().saturating_sub(1) as f64;
    let subtitle = format!("{} · pass of {} s", run.setup.variant.word(), figures(seconds));
    let mut lead = format!("The cut is judged {}", found.judgement.word());
    if let Some([_, filtered]) = &found.roughness {
        lead.push_str(&format!(
            "; it leaves a wall of Ra {} um, Rt {} um",
            figures(filtered.mean * 1e6),
            figures(filtered.total * 1e6)
        ));
    }
    lead.push('.');
    if let (_, Some(reason)) = end_words(&found.run.end) {
        lead.push_str(&format!(" It ended early: {reason}."));
    }
    let mut page = Page::new(run.setup.robot.name(), subtitle, lead, &run.inputs)
        .messages(&found.warnings, &found.notes)
        .with(tiles(found))
        .with(Card::Chart(forces(found)))
        .with(Card::Chart(turns(found, run.cut.spindle_speed)))
        .with(Card::Chart(deflections(found)));
    for wall in walls(found) {
        page = page.with(Card::Chart(wall));
    }
    page.with(modes(&found.modes))
}

fn tiles(found: &Simulation) -> Card {
    let mut tiles = vec![Tile::new(
        "judgement",
        found.judgement.word(),
        "",
        format!("small motions: {}", found.verdict.kind().word()),
    )];
    for (axis, name) in ["force along the feed", "force towards the wall"].into_iter().enumerate() {
        if let Some(forces) = &found.forces {
            let force = &forces[axis];
            let detail = format!(
                "{} to {} N, rms {} N",
                fixed(force.min, 1),
                fixed(force.max, 1),
                fixed(force.root_mean_square, 1)
            );
            tiles.push(Tile::new(name, fixed(force.mean, 1), "N mean", detail));
        }
    }
    if let Some([raw, filtered]) = &found.roughness {
        let raw = [raw.mean, raw.root_mean_square, raw.total]
            .map(|height| format!("{} um unfiltered", figures(height * 1e6)));
        let filtered = [filtered.mean, filtered.root_mean_square, filtered.total];
        for ((name, height), raw) in ["Ra", "Rq", "Rt"].into_iter().zip(filtered).zip(raw) {
            tiles.push(Tile::new(name, figures(height * 1e6), "um", raw));
        }
    }
    Card::Tiles(Tiles { tiles })
}

/// Along the feed and towards the wall, as the tables have them.
const NAMES: [&str; 2] = ["along the feed", "towards the wall"];

pub(super) fn forces(found: &Simulation) -> Chart {
    let curve = |axis: usize, sign: f64| {
        let samples = found.run.samples.iter().enumerate();
        Series::curve(
            NAMES[axis],
            axis,
            samples.map(move |(k, sample)| [k as f64 * found.run.step, sign * sample.force[axis]]),
        )
    };
    let window = ["forces are summed up from here", "to here"].into_iter().zip(found.window);
    let inside = 0.0..=found.run.step * found.run.samples.len() as f64;
    Chart {
        detail: "smallest and largest of each stretch".to_owned(),
        marks: window
            .filter(|(_, at)| inside.contains(at))
            .map(|(label, at)| Mark { is_level: false, at, label: label.to_owned() })
            .collect(),
        is_wide: true,
        ..Chart::new("Forces on the tool over the pass", "time (s)", "force (N)", vec![curve(0, 1.0), curve(1, -1.0)])
    }
}

/// Every sample of three turns of the spindle in the middle of what is summed up, or at the end of a run that ended
/// before.
pub(super) fn turns(found: &Simulation, spindle_speed: f64) -> Chart {
    let turn = TAU / spindle_speed / found.run.step;
    let count = found.run.samples.len();
    let middle = (found.window[0] + found.window[1]) / 2.0 / found.run.step;
    let start = ((middle / turn).floor() * turn).min(count as f64 - 1.0 - 3.0 * turn).max(0.0) as usize;
    let end = (start + (3.0 * turn).round() as usize + 1).min(count);
    let curve = |axis: usize, sign: f64| {
        let samples = found.run.samples[start..end].iter().enumerate();
        Series::curve(
            NAMES[axis],
            axis,
            samples.map(move |(k, sample)| [k as f64 / turn * 360.0, sign * sample.force[axis]]),
        )
    };
    Chart {
        detail: format!("from {} s", fixed(start as f64 * found.run.step, 4)),
        ..Chart::new(
            "Forces over three turns",
            "angle of the spindle (deg)",
            "force (N)",
            vec![curve(0, 1.0), curve(1, -1.0)],
        )
    }
}

fn deflections(found: &Simulation) -> Chart {
    let curve = |axis: usize, sign: f64| {
        let samples = found.run.samples.iter().enumerate();
        let point = move |(k, sample): (usize, &stead_simulation::coupled::Sample)| {
            [k as f64 * found.run.step, sign * sample.deflection[axis] * 1e6]
        };
        Series::curve(NAMES[axis], axis, samples.map(point))
    };
    Chart::new("Tool centre off its path", "time (s)", "deflection (um)", vec![curve(0, 1.0), curve(1, -1.0)])
}

/// The wall along the feed, and what the filter leaves of it.
pub(super) fn walls(found: &Simulation) -> [Chart; 2] {
    let wall = |title: &str, profile: &Profile, color: usize| {
        let heights = profile.heights.iter().enumerate();
        let points = heights.map(|(k, height)| [(profile.start + k as f64 * profile.spacing) * 1e3, height * 1e6]);
        Chart {
            detail: if profile.heights.is_empty() { "no wall was made".to_owned() } else { String::new() },
            ..Chart::new(title.to_owned(), "along the feed (mm)", "height (um)", vec![Series::curve("", color, points)])
        }
    };
    [
        wall("Wall: height over the nominal wall", &found.wall, 3),
        wall("Roughness: without what is longer than the cutoff", &found.filtered, 1),
    ]
}
