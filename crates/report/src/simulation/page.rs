//! `report.html` of a simulated pass.

use super::json::end_words;
use crate::page::cards::{Chart, Mark, Page, Series, Tile};
use crate::stability::page::modes;
use crate::units::{figures, fixed};
use std::f64::consts::TAU;
use stead_runs::SimulationRun;
use stead_simulation::coupled::Sample;
use stead_simulation::outcome::Simulation;
use stead_simulation::roughness::Profile;

/// Forces over the pass and over three turns, the way the tool was pushed, the wall it left.
pub(super) fn page(run: &SimulationRun, found: &Simulation) -> Page {
    let seconds = found.run.step * found.run.samples.len().saturating_sub(1) as f64;
    let subtitle = format!("{} · pass of {} s", run.setup.variant.word(), figures(seconds));
    let mut lead = format!("The cut is judged {}", found.judgement.word());
    if let Some([_, filtered]) = &found.roughness {
        let [ra, rt] = [filtered.mean, filtered.total].map(|height| figures(height * 1e6));
        lead.push_str(&format!("; it leaves a wall of Ra {ra} um, Rt {rt} um"));
    }
    lead.push('.');
    if let (_, Some(reason)) = end_words(&found.run.end) {
        lead.push_str(&format!(" It ended early: {reason}."));
    }
    Page::new(run.setup.robot.name(), subtitle, lead, &run.inputs)
        .messages(&found.warnings, &found.notes)
        .with(tiles(found))
        .with(forces(found))
        .with(turns(found, run.cut.spindle_speed))
        .with(deflections(found))
        .with_all(walls(found))
        .with(modes(&found.modes))
}

fn tiles(found: &Simulation) -> Vec<Tile> {
    let motions = format!("small motions: {}", found.verdict.kind().word());
    let mut tiles = vec![Tile::new("judgement", found.judgement.word(), "", motions)];
    for (axis, name) in ["force along the feed", "force towards the wall"].into_iter().enumerate() {
        if let Some(forces) = &found.forces {
            let force = &forces[axis];
            let [min, max, rms] = [force.min, force.max, force.root_mean_square].map(|force| fixed(force, 1));
            let detail = format!("{min} to {max} N, rms {rms} N");
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
    tiles
}

/// Along the feed and towards the wall, as the tables have them.
const NAMES: [&str; 2] = ["along the feed", "towards the wall"];

/// A curve for each axis, over what the number of a sample stands for.
fn curves(samples: &[Sample], at: impl Fn(f64) -> f64, of: impl Fn(&Sample, usize) -> f64) -> [Series; 2] {
    [(0, 1.0), (1, -1.0)].map(|(axis, sign)| {
        let points = samples.iter().enumerate().map(|(k, sample)| [at(k as f64), sign * of(sample, axis)]);
        Series::curve(NAMES[axis], axis, points)
    })
}

pub(super) fn forces(found: &Simulation) -> Chart {
    let window = ["forces are summed up from here", "to here"].into_iter().zip(found.window);
    let inside = 0.0..=found.run.step * found.run.samples.len() as f64;
    let marks = window.filter(|(_, at)| inside.contains(at)).map(|(label, at)| Mark::across(at, label));
    let curves = curves(&found.run.samples, |k| k * found.run.step, |sample, axis| sample.force[axis]);
    Chart::new("Forces on the tool over the pass", "time (s)", "force (N)", curves)
        .detailed("smallest and largest of each stretch")
        .marked(marks)
        .wide()
}

/// Every sample of three turns of the spindle in the middle of what is summed up, or at the end of a run that ended
/// before.
pub(super) fn turns(found: &Simulation, spindle_speed: f64) -> Chart {
    let turn = TAU / spindle_speed / found.run.step;
    let count = found.run.samples.len();
    let middle = (found.window[0] + found.window[1]) / 2.0 / found.run.step;
    let start = ((middle / turn).floor() * turn).min(count as f64 - 1.0 - 3.0 * turn).max(0.0) as usize;
    let end = (start + (3.0 * turn).round() as usize + 1).min(count);
    let samples = &found.run.samples[start..end];
    let curves = curves(samples, |k| k / turn * 360.0, |sample, axis| sample.force[axis]);
    Chart::new("Forces over three turns", "angle of the spindle (deg)", "force (N)", curves)
        .detailed(format!("from {} s", fixed(start as f64 * found.run.step, 4)))
}

fn deflections(found: &Simulation) -> Chart {
    let of = |sample: &Sample, axis: usize| sample.deflection[axis] * 1e6;
    let curves = curves(&found.run.samples, |k| k * found.run.step, of);
    Chart::new("Tool centre off its path", "time (s)", "deflection (um)", curves)
}

/// The wall along the feed, and what the filter leaves of it.
pub(super) fn walls(found: &Simulation) -> [Chart; 2] {
    let wall = |title: &str, profile: &Profile, color: usize| {
        let heights = profile.heights.iter().enumerate();
        let points = heights.map(|(k, height)| [(profile.start + k as f64 * profile.spacing) * 1e3, height * 1e6]);
        Chart::new(title, "along the feed (mm)", "height (um)", [Series::curve("", color, points)])
            .detailed(if profile.heights.is_empty() { "no wall was made" } else { "" })
    };
    [
        wall("Wall: height over the nominal wall", &found.wall, 3),
        wall("Roughness: without what is longer than the cutoff", &found.filtered, 1),
    ]
}
