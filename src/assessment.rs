//! How good robots are for machining.

pub use stead_assessment::{comparison, map, published, ranking, zone};

use crate::result::result;
use crate::{Error, Monitor};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use stead_assessment::comparison::Assessment;
use stead_numerics::message::Note;
use stead_report::assessment::{AssessmentContext, assess_json, assessment_files, assessment_text};
use stead_report::document::Timing;
use stead_run_files as run_files;

/// An assessment file with the robots that it names, read and checked.
#[derive(Debug, Clone)]
pub struct AssessmentRun {
    run: Arc<stead_runs::AssessRun>,
}

impl AssessmentRun {
    /// Reads an assessment file and the files that it names.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self { run: Arc::new(run_files::read_assessment(file.as_ref())?) })
    }

    /// The same run, to rank robots by the accuracy (m) and the cutting force (N) wanted; either left out is the
    /// file's.
    ///
    /// # Errors
    /// [`Error::Argument`] when only one of the two is known.
    pub fn selecting(mut self, accuracy: Option<f64>, force: Option<f64>) -> Result<Self, Error> {
        let selection = &mut Arc::make_mut(&mut self.run).comparison.selection;
        if let Some(accuracy) = accuracy {
            selection.accuracies = vec![accuracy];
        }
        if let Some(force) = force {
            selection.forces = vec![force];
        }
        if selection.accuracies.is_empty() != selection.forces.is_empty() {
            return Err(Error::Argument(
                "only one of the two is known; allowed: both, or a table [selection]".to_owned(),
            ));
        }
        Ok(self)
    }

    /// What the user should know about the input though it is not wrong, in sentences.
    pub fn notes(&self) -> &[Note] {
        &self.run.notes
    }

    /// Maps the circularity of a milled circle over the plane for every robot, and ranks the robots.
    ///
    /// # Errors
    /// [`Error::Assessment`] when no robot can mill the circle anywhere, or the monitor asks to stop.
    pub fn assess(&self, monitor: &Monitor) -> Result<RobotAssessment, Error> {
        let started = Instant::now();
        let assessment = comparison::assess(&self.run.comparison, monitor)?;
        let timing = Timing { wall: started.elapsed().as_secs_f64(), threads: rayon::current_num_threads() };
        let run = &self.run;
        let published = run.published.clone().map(|published| {
            let agreement = published.figures.agreement(&assessment);
            (published, agreement)
        });
        let context = AssessmentContext {
            inputs: run.inputs.clone(),
            notes: run.notes.clone(),
            range_share: run.range_share,
            published,
            force_history: run.force_history.clone(),
        };
        Ok(RobotAssessment { run: Arc::clone(run), assessment, context, timing })
    }
}

/// Circularity maps, zones and rankings of robots.
#[derive(Debug, Clone)]
pub struct RobotAssessment {
    run: Arc<stead_runs::AssessRun>,
    assessment: Assessment,
    context: AssessmentContext,
    timing: Timing,
}

impl RobotAssessment {
    /// Robot by robot: maps and zones.
    pub fn assessment(&self) -> &Assessment {
        &self.assessment
    }

    /// How long it took.
    pub fn timing(&self) -> Timing {
        self.timing
    }
}

result! { RobotAssessment, self {
    write(folder) = folder.results("assess", &self.context.inputs).write(&self.files()?);
    files = assessment_files(&self.run.comparison, &self.assessment, &self.context);
    document = assess_json(&self.assessment, &self.context, &self.timing);
    table = assessment_text(&self.assessment, &self.context);
    notes = self.run.notes;
    warnings = self.assessment.warnings;
} }
