//! How a simulated pass is evaluated, and what it is compared with.

use super::file::{ForcesTable, ProfileTable, PublishedTable, SettingsTable};
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::Quantity;
use stead_format::shapes::Span;
use stead_model::cutting::PassCut;
use stead_model::published::Published;
use stead_simulation::arm::Variant;
use stead_simulation::outcome::{EvaluationSettings, PassFigures, Statistics};
use stead_simulation::roughness::Roughness;
use stead_simulation::setup::Setup;
use stead_simulation::stability_analysis::{AnalysisSettings, linear_at};

/// Cutoff of the filter where the file does not say: ISO 21920-3 for a profile of this roughness. m
const CUTOFF: f64 = 2.5e-3;
/// Fewest steps in a period of the fastest mode.
const STEPS_PER_SWING: f64 = 4.0;
/// A mode that is damped more than this does not ask for steps of its own.
const DAMPED: f64 = 0.5;

/// How the pass is evaluated.
///
/// # Errors
/// [`InputError`] with file, line and field: a window beyond the duration of the pass, a height above the cut.
pub(super) fn evaluation_from(
    table: &SettingsTable,
    at: &Place<'_>,
    setup: &Setup,
    cut: &PassCut,
    analysis: &AnalysisSettings,
) -> Result<EvaluationSettings, InputError> {
    let (duration, depth_mm) = (setup.motion.duration(), cut.section.axial_depth * 1e3);
    let window = table.window_s.map(Span::si);
    if window.is_some_and(|[_, to]| to > duration) {
        let allowed =
            format!("two times [from, to] from 0 to {duration:.4}, the duration of the pass, the first below");
        return Err(at.key("window_s").element(2).out_of_range(allowed));
    }
    if table.wall_height_mm.is_some_and(|height| height.written() > depth_mm) {
        let allowed = format!("a number from 0 to axial_depth_mm = {depth_mm}");
        return Err(at.key("wall_height_mm").out_of_range(allowed));
    }
    Ok(EvaluationSettings {
        window,
        height: table.wall_height_mm.map_or(cut.section.axial_depth / 2.0, Quantity::si),
        cutoff: table.cutoff_mm.map_or(CUTOFF, Quantity::si),
        analysis_distance: analysis.distance,
    })
}

impl PublishedTable {
    /// The figures of a variant.
    pub(super) fn published(self, variant: Variant) -> Published<PassFigures> {
        let forces = match variant {
            Variant::Springs => self.springs,
            Variant::Gravity => self.gravity,
            Variant::Orthogonal => self.orthogonal,
            Variant::Backlash => self.backlash,
        };
        let figures = PassFigures {
            forces: forces.map(|forces| forces.statistics()),
            roughness: self.profile.map(|profile| profile.roughness()),
        };
        Published { source: self.source, figures }
    }
}

impl ForcesTable {
    fn statistics(&self) -> [Statistics; 2] {
        [self.force_x_n, self.force_y_n].map(|row| {
            let [min, max, mean, root_mean_square] = row.si();
            Statistics { min, max, mean, root_mean_square }
        })
    }
}

impl ProfileTable {
    fn roughness(&self) -> Roughness {
        let [mean, root_mean_square, total] = [self.ra_um, self.rq_um, self.rt_um].map(Quantity::si);
        Roughness { mean, root_mean_square, total }
    }
}

/// Refuses steps that are too coarse for the fastest mode that swings.
///
/// # Errors
/// [`InputError`] at the field that says how many steps there are.
pub(super) fn check_step(setup: &Setup, cut: &PassCut, at: &Place<'_>) -> Result<(), InputError> {
    let Some(modes) = linear_at(setup, 0.0).ok().and_then(|linear| linear.modes()) else { return Ok(()) };
    let swinging = modes.iter().filter(|mode| mode.damping_ratio < DAMPED);
    let fastest = swinging.fold(0.0_f64, |max, mode| max.max(mode.frequency));
    let turns_per_second = cut.spindle_speed / std::f64::consts::TAU;
    let min = STEPS_PER_SWING * fastest / turns_per_second;
    if (cut.steps_per_turn as f64) < min {
        let problem =
            format!("makes steps of {:.3e} s, too coarse for the fastest mode of the arm, {fastest:.1} Hz", cut.step());
        return Err(at.error(problem, format!("at least {} steps a turn", min.ceil())));
    }
    Ok(())
}

/// More steps than these are not kept in memory.
const MAX_STEPS: f64 = 5e6;
/// Nor is a pass that takes longer. s
const MAX_DURATION: f64 = 2e4;

/// Refuses a pass that takes so long that its steps cannot be kept.
///
/// # Errors
/// [`InputError`] at the feed.
pub(super) fn check_duration(setup: &Setup, cut: &PassCut, at: &Place<'_>) -> Result<(), InputError> {
    let duration = setup.motion.duration();
    let longest = MAX_DURATION.min(MAX_STEPS * cut.step());
    if duration <= longest {
        return Ok(());
    }
    let problem = format!("makes a pass of {duration:.3e} s, {:.3e} steps", duration / cut.step());
    Err(at.error(
        problem,
        format!("at most {MAX_STEPS:e} steps and {MAX_DURATION:e} s: a faster feed, or a shorter pass"),
    ))
}
