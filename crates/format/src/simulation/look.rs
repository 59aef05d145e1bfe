//! What of a simulated pass is looked at, and what it is compared with.

use super::super::reader::{Field, Table};
use crate::input::InputError;
use stead_model::published::Published;
use stead_simulation::milling::PassCut;
use stead_simulation::outcome::{EvaluationSettings, PassFigures, Statistics};
use stead_simulation::roughness::Roughness;
use stead_simulation::setup::Setup;
use stead_simulation::stability_analysis::linear_at;

/// Cutoff of the filter where the file does not say: ISO 21920-3 for a profile of this roughness. m
const CUTOFF: f64 = 2.5e-3;
/// Fewest steps in a period of the fastest mode.
const STEPS_PER_SWING: f64 = 4.0;
/// A mode that is damped more than this does not ask for steps of its own.
const DAMPED: f64 = 0.5;

/// Reads what is looked at: `window_s`, between which times forces are summed up, `wall_height_mm`, where the profile of the wall
/// is taken (the middle of the depth of cut), and `cutoff_mm` of the filter (2.5).
///
/// # Errors
/// [`InputError`] with file, line and field.
pub(super) fn evaluation_from(
    keys: Option<&[Field<'_>]>,
    setup: &Setup,
    cut: &PassCut,
) -> Result<EvaluationSettings, InputError> {
    let mut settings = EvaluationSettings { window: None, height: cut.section.axial_depth / 2.0, cutoff: CUTOFF };
    if let Some([window, height, cutoff]) = keys {
        let duration = setup.motion.duration();
        let allowed =
            format!("two times [from, to] from 0 to {duration:.4}, the duration of the pass, the first below");
        let within = |value: f64| (0.0..=duration).contains(&value);
        settings.window = window.optional(|field| field.wide_interval_where(&allowed, within))?;
        let depth_mm = cut.section.axial_depth * 1e3;
        let on_wall = format!("a number from 0 to axial_depth_mm = {depth_mm}");
        let inside = |value: f64| (0.0..=depth_mm).contains(&value);
        if let Some(mm) = height.optional(|field| field.number_where(&on_wall, inside))? {
            settings.height = mm / 1e3;
        }
        let filter = |field: &Field<'_>| field.number_where("a number from 0.08 to 25", |v| (0.08..=25.0).contains(&v));
        if let Some(mm) = cutoff.optional(filter)? {
            settings.cutoff = mm / 1e3;
        }
    }
    Ok(settings)
}

/// Reads `[published]`: `source`, for each variant an optional table with `force_x_n` and `force_y_n` (smallest, largest, mean and
/// root mean square; y towards the wall), and an optional table `profile` with `ra_um`, `rq_um` and `rt_um`.
pub(super) fn published_from(table: &Table<'_>, setup: &Setup) -> Result<Published<PassFigures>, InputError> {
    let words = ["springs", "gravity", "orthogonal", "backlash"];
    let [source, springs, gravity, orthogonal, backlash, profile] =
        table.fields(["source", words[0], words[1], words[2], words[3], "profile"])?;
    let mut forces = None;
    for (word, field) in words.iter().zip([springs, gravity, orthogonal, backlash]) {
        let found = field.optional(|field| {
            let [x, y] = field.table()?.fields(["force_x_n", "force_y_n"])?;
            Ok([statistics_from(&x)?, statistics_from(&y)?])
        })?;
        if *word == setup.variant.word() {
            forces = found;
        }
    }
    let roughness = profile.optional(|field| {
        let [mean, square, total] = field.table()?.fields(["ra_um", "rq_um", "rt_um"])?;
        let [mean, root_mean_square, total] =
            [mean.positive()?, square.positive()?, total.positive()?].map(|um| um / 1e6);
        Ok(Roughness { mean, root_mean_square, total })
    })?;
    Ok(Published { source: source.string()?.to_owned(), figures: PassFigures { forces, roughness } })
}

fn statistics_from(field: &Field<'_>) -> Result<Statistics, InputError> {
    let numbers: [f64; 4] =
        field.numbers_where("four numbers: smallest, largest, mean and root mean square", f64::is_finite)?;
    let [min, max, mean, root_mean_square] = numbers;
    Ok(Statistics { min, max, mean, root_mean_square })
}

/// Refuses steps that are too coarse for the fastest mode that swings.
///
/// # Errors
/// [`InputError`] at the field that says how many steps there are.
pub(super) fn check_step(setup: &Setup, cut: &PassCut, field: &Field<'_>) -> Result<(), InputError> {
    let Ok(modes) = linear_at(setup, 0.0).and_then(|linear| linear.modes()) else { return Ok(()) };
    let swinging = modes.iter().filter(|mode| mode.damping_ratio < DAMPED);
    let fastest = swinging.fold(0.0_f64, |max, mode| max.max(mode.frequency));
    let turns_per_second = cut.spindle_speed / std::f64::consts::TAU;
    let min = STEPS_PER_SWING * fastest / turns_per_second;
    if (cut.steps_per_turn as f64) < min {
        let problem =
            format!("makes steps of {:.3e} s, too coarse for the fastest mode of the arm, {fastest:.1} Hz", cut.step());
        return Err(field.error(problem, format!("at least {} steps a turn", min.ceil())));
    }
    Ok(())
}

/// More steps than these are not kept in memory.
const MOST_STEPS: f64 = 5e6;
/// Nor is a pass that takes longer. s
const LONGEST: f64 = 2e4;

/// Refuses a pass that takes so long that its steps cannot be kept.
///
/// # Errors
/// [`InputError`] at the feed.
pub(super) fn check_duration(setup: &Setup, cut: &PassCut, feed: &Field<'_>) -> Result<(), InputError> {
    let duration = setup.motion.duration();
    let longest = LONGEST.min(MOST_STEPS * cut.step());
    if duration <= longest {
        return Ok(());
    }
    let problem = format!("makes a pass of {duration:.3e} s, {:.3e} steps", duration / cut.step());
    Err(feed
        .error(problem, format!("at most {MOST_STEPS:e} steps and {LONGEST:e} s: a faster feed, or a shorter pass")))
}
