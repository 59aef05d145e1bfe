//! Joint compliances from measurements, and which measurements to take.

use crate::monitor::Stop;
use crate::result::result;
use crate::{Error, Monitor};
use std::path::Path;
use std::sync::Arc;
use stead_calibration::identification::design::{Design, DesignError, design_experiment};
use stead_calibration::identification::{Identified, IdentifyError, identify};
use stead_numerics::message::Note;
use stead_report::identification::plan::{keep_readings, plan_files, plan_json, plan_text, write_plan};
use stead_report::identification::{identified_files, identify_json, identify_text};
use stead_run_files as run_files;

/// An identification file with the robot and the filled measurement sheet that it names, read and checked.
#[derive(Debug, Clone)]
pub struct FitRun {
    run: Arc<stead_runs::IdentifyRun>,
}

/// An identification file with a table `[plan]` and the robot that it names, read and checked.
#[derive(Debug, Clone)]
pub struct DesignRun {
    run: Arc<stead_runs::PlanRun>,
}

impl FitRun {
    /// Reads an identification file and the files that it names.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self { run: Arc::new(run_files::read_identification(file.as_ref())?) })
    }

    /// What the user should know about the input though it is not wrong, in sentences.
    pub fn notes(&self) -> &[Note] {
        &self.run.notes
    }

    /// Fits compliances, gravity compensator and their covariance to the sheet.
    ///
    /// # Errors
    /// [`Error::Input`] at the line of the sheet that is at fault; [`Error::Failed`] where a sound sheet gives no
    /// robot; [`Error::Stopped`] when the monitor asked to stop.
    pub fn fit(&self, monitor: &Monitor) -> Result<IdentifiedRobot, Error> {
        let identified = identify(&self.run.problem, monitor).map_err(|error| match error {
            IdentifyError::Stopped(stop) => Error::Stopped(stop),
            error => self.run.locate(error).into(),
        })?;
        Ok(IdentifiedRobot { run: Arc::clone(&self.run), identified })
    }
}

impl DesignRun {
    /// Reads an identification file and the robot that it names.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(file, None)
    }

    /// As [`DesignRun::read`], with another seed of the random numbers.
    ///
    /// # Errors
    /// As [`DesignRun::read`].
    pub fn read_with(file: impl AsRef<Path>, seed: Option<u64>) -> Result<Self, Error> {
        Ok(Self { run: Arc::new(run_files::read_plan(file.as_ref(), seed)?) })
    }

    /// What the user should know about the input though it is not wrong, in sentences.
    pub fn notes(&self) -> &[Note] {
        &self.run.notes
    }

    /// Refuses a folder whose measurement sheet has readings in it, which [`MeasurementPlan::write`] would not write
    /// over either.
    ///
    /// # Errors
    /// [`Error::Input`] naming the sheet.
    pub fn check_folder(&self, folder: impl AsRef<Path>) -> Result<(), Error> {
        Ok(keep_readings(folder.as_ref())?)
    }

    /// Chooses the configurations and loads to measure.
    ///
    /// # Errors
    /// [`Error::Input`] where too little was requested; [`Error::Failed`] where nothing was found;
    /// [`Error::Stopped`] when the monitor asked to stop before that.
    pub fn plan(&self, monitor: &Monitor) -> Result<MeasurementPlan, Error> {
        let design = design_experiment(&self.run.request, monitor).map_err(|error| match error {
            DesignError::Stopped => Error::Stopped(monitor.stop().unwrap_or(Stop::Asked)),
            error => self.run.locate(error).into(),
        })?;
        Ok(MeasurementPlan { run: Arc::clone(&self.run), design })
    }
}

/// Joint compliances with their covariance, and the robot file that states them.
#[derive(Debug, Clone)]
pub struct IdentifiedRobot {
    run: Arc<stead_runs::IdentifyRun>,
    identified: Identified,
}

/// Configurations and loads to measure, and what they will tell.
#[derive(Debug, Clone)]
pub struct MeasurementPlan {
    run: Arc<stead_runs::PlanRun>,
    design: Design,
}

impl IdentifiedRobot {
    /// Estimates, residuals and outliers, in SI units.
    pub fn identified(&self) -> &Identified {
        &self.identified
    }
}

impl MeasurementPlan {
    /// The configurations and their expected errors, in SI units.
    pub fn design(&self) -> &Design {
        &self.design
    }
}

result! { IdentifiedRobot, self {
    write(folder) = folder.results("identify fit", &self.run.inputs).write(&self.files()?);
    files = identified_files(&self.run, &self.identified);
    document = identify_json(&self.run, &self.identified);
    table = identify_text(&self.run, &self.identified);
    notes = self.run.notes;
    warnings = self.identified.warnings;
} }

result! { MeasurementPlan, self {
    write(folder) = {
        keep_readings(folder.path())?;
        write_plan(folder, &self.run, &self.design)
    };
    files = plan_files(&self.run, &self.design);
    document = plan_json(&self.run, &self.design);
    table = plan_text(&self.run, &self.design);
    notes = self.run.notes;
    warnings = self.design.warnings;
} }
