//! The text for people.

use super::json::end_words;
use crate::columns::table;
use crate::units::{figures, fixed};
use stead_runs::SimulationRun;
use stead_simulation::coupled::End;
use stead_simulation::judgement::{Judgement, MAX_PERIOD_VARIATION};
use stead_simulation::outcome::{Simulation, Statistics};
use stead_simulation::roughness::Roughness;
use stead_simulation::stability::{Kind, Verdict};

/// Forces in the window and roughness of the wall, beside published figures where there are any; whether the cut stayed
/// calm. Lines end with a line break.
pub fn simulation_text(run: &SimulationRun, found: &Simulation, wall: f64) -> String {
    let duration = found.run.step * found.run.samples.len().saturating_sub(1) as f64;
    let mut text = format!(
        "{}, {}: {} s in {} steps, {} times as fast as the pass\n\n",
        run.setup.robot.name(),
        run.setup.variant.word(),
        fixed(duration, 3),
        found.run.samples.len().saturating_sub(1),
        figures(duration / wall.max(1e-9)),
    );
    text.push_str(&forces(run, found));
    text.push_str(&roughness(run, found));
    text.push_str(&verdict(run, found));
    text
}

fn forces(run: &SimulationRun, found: &Simulation) -> String {
    let [from, to] = found.window.map(|time| fixed(time, 3));
    let Some(forces) = &found.forces else {
        let why = match found.run.end {
            End::Complete => "the pass is too short for statistics",
            _ => "the run ended before",
        };
        return format!("no forces from {from} to {to} s: {why}\n\n");
    };
    let row = |name: &str, Statistics { min, max, mean, root_mean_square }: &Statistics| {
        let cells = [min, max, mean, root_mean_square].map(|force| fixed(*force, 2));
        std::iter::once(name.to_owned()).chain(cells).collect()
    };
    let mut rows: Vec<Vec<String>> = Vec::new();
    let published = run.published.as_ref().and_then(|published| published.figures.forces.as_ref());
    for (axis, name) in ["along the feed", "towards the wall"].into_iter().enumerate() {
        rows.push(row(name, &forces[axis]));
        rows.extend(published.map(|published| row("  published", &published[axis])));
    }
    let forces = table(["", "min", "max", "mean", "rms"], rows, &[0]);
    format!("forces on the tool (N) from {from} to {to} s\n{forces}\n")
}

fn roughness(run: &SimulationRun, found: &Simulation) -> String {
    let Some([raw, filtered]) = &found.roughness else {
        return "no wall was made\n\n".to_owned();
    };
    let row = |name: &str, Roughness { mean, root_mean_square, total }: &Roughness| {
        let cells = [mean, root_mean_square, total].map(|height| fixed(height * 1e6, 2));
        std::iter::once(name.to_owned()).chain(cells).collect()
    };
    let mut rows: Vec<Vec<String>> = vec![row("wall", raw)];
    rows.push(row(&format!("filtered, {} mm", figures(run.evaluation.cutoff * 1e3)), filtered));
    let published = run.published.as_ref().and_then(|published| published.figures.roughness.as_ref());
    rows.extend(published.map(|published| row("  published", published)));
    format!("roughness of the wall (um)\n{}\n", table(["", "Ra", "Rq", "Rt"], rows, &[0]))
}

/// How the pass went, what its forces show of it, and what small motions do: in the middle of the work, and where the
/// stability analysis looks at the arm if that is another answer.
fn verdict(run: &SimulationRun, found: &Simulation) -> String {
    let (_, reason) = end_words(&found.run.end);
    let how = match found.judgement {
        Judgement::Calm => "is calm",
        Judgement::Chatter(Kind::Flip) => "chatters (flip)",
        Judgement::Chatter(_) => "chatters (Hopf)",
        Judgement::Growing(_) => "is unstable, though not for long enough to chatter",
        Judgement::Marginal => "is at the limit of stability",
        Judgement::Unsettled => "has not settled",
        Judgement::Ended if found.verdict.is_stable() => "ended early",
        Judgement::Ended => "is unstable",
    };
    let compared = match found.period_teeth {
        1 => "tooth to tooth".to_owned(),
        teeth if teeth == run.cutter.teeth().len() => "turn to turn".to_owned(),
        teeth => format!("one tooth to the next like it, {teeth} teeth later"),
    };
    let mut text = match (reason, found.period_variation) {
        (Some(reason), _) => format!("The cut {how}: {reason}.\n"),
        (None, Some(variation))
            if found.judgement == Judgement::Chatter(Kind::Flip) && variation < MAX_PERIOD_VARIATION =>
        {
            format!(
                "The cut {how}: with runout a flip repeats from {compared}, as the forces do to {} %; its growth tells of it.\n",
                figures(variation * 100.0)
            )
        }
        (None, Some(variation)) => {
            format!("The cut {how}: forces differ by {} % from {compared}.\n", figures(variation * 100.0))
        }
        (None, None) => format!("The cut {how}.\n"),
    };
    text.push_str(&small_motions(&found.verdict, ""));
    if found.verdict.is_stable() != found.analysis_verdict.is_stable() {
        let place = format!(" {} mm along the pass", figures(run.evaluation.analysis_distance * 1e3));
        text.push_str(&small_motions(&found.analysis_verdict, &place));
    }
    text
}

/// What small motions do at a place.
fn small_motions(verdict: &Verdict, place: &str) -> String {
    let rate = figures(verdict.growth_rate().abs());
    if verdict.is_stable() {
        format!("Small motions die out{place}, at {rate} per second.\n")
    } else {
        format!("Small motions grow{place} ({}), at {rate} per second.\n", verdict.kind().word())
    }
}
