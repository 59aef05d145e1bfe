//! What a given placement comes to, and what the postures give at one state.

use crate::Monitor;
use crate::monitor::Warning;
use crate::result::result;
use std::sync::Arc;
use stead_placement::place::Score;
use stead_planning::feasibility::{self, DeflectionMap, Explanation};
use stead_problem::problem::Placement;
use stead_report::placement::{Context, Summary, evaluation, score_files, score_summary, write_score};

/// A given placement with its best and its worst plan.
#[derive(Debug, Clone)]
pub struct PlacementScore {
    pub(crate) run: Arc<stead_runs::Run>,
    pub(crate) score: Score,
    pub(crate) map: Option<DeflectionMap>,
    pub(crate) context: Context,
}

/// What each of the eight postures gives at one path point and one free angle.
#[derive(Debug, Clone)]
pub struct Explanations {
    pub(crate) placement: Placement,
    pub(crate) point: usize,
    pub(crate) beta: f64,
    pub(crate) postures: [Explanation; 8],
    pub(crate) context: Context,
}

impl PlacementScore {
    /// Both plans, in SI units.
    pub fn score(&self) -> &Score {
        &self.score
    }

    /// The result in a few lines.
    pub fn summary(&self) -> Summary {
        score_summary(&self.run.problem, &self.score, &self.context)
    }

    /// Makes the deflection map of the placement and, where the tool may lean, the map over lead and tilt, to be
    /// written with the plans; does nothing where the run file does without. A stop that the monitor asks for leaves
    /// out that over lead and tilt, and of a long path both.
    pub fn map(&mut self, monitor: &Monitor) {
        if !self.run.maps {
            return;
        }
        self.map = feasibility::deflection_map(&self.run.problem, &self.score.placement, monitor);
        let left_out = match self.map {
            Some(_) => self.score.map_leans(&self.run.problem, monitor),
            None => Some(Warning::left_out("the deflection map is")),
        };
        self.context.warnings.extend(left_out);
        self.score.interrupted |= monitor.should_stop();
    }

    /// Makes the setup sheet of the placement, to be written with the plans; does nothing where the run leaves no page.
    /// A stop that the monitor asks for leaves out its tolerances.
    pub fn make_sheet(&mut self, monitor: &Monitor) {
        if !self.run.page {
            return;
        }
        self.context.warnings.extend(self.score.make_sheet(&self.run.problem, monitor));
        self.score.interrupted |= monitor.should_stop();
    }
}

impl Explanations {
    /// What each posture gives, in the order of their numbers.
    pub fn postures(&self) -> &[Explanation; 8] {
        &self.postures
    }
}

result! { PlacementScore, self {
    write(folder) = write_score(folder, &self.run.problem, &self.score, self.map.as_ref(), &self.context);
    files = score_files(&self.run.problem, &self.score, self.map.as_ref(), &self.context);
    document = evaluation::score_json(&self.run.problem, &self.score, &self.context);
    table = evaluation::score_text(&self.run.problem, &self.score, &self.context);
    notes = self.context.notes;
    warnings = self.context.warnings;
} }

result! { Explanations, self {
    document = evaluation::explain_json(&self.placement, self.point, self.beta, &self.postures, &self.context);
    table = evaluation::explain_text(&self.placement, self.point, self.beta, &self.postures);
    notes = self.context.notes;
    warnings = self.context.warnings;
} }
