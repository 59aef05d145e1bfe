//! What was understood of a run or a robot file.

use crate::monitor::Warning;
use crate::result::result;
use crate::robot::Arm;
use crate::{Error, Monitor, Run};
use serde_json::Value;
use std::path::Path;
use stead_format::robot::{robot_radians, says_stiffness};
use stead_numerics::message::Note;
use stead_placement::overview::Overview;
use stead_report::check::{CheckedRun, robot_json, robot_lines, run_json, run_text};
use stead_report::picture::{arm_alone, arm_of_run};

/// What was understood of a file: figures to compare with what was meant, and the arm as a picture.
#[derive(Debug, Clone)]
pub struct Checked {
    text: String,
    document: Value,
    picture: String,
    notes: Vec<Note>,
    warnings: Vec<Warning>,
}

impl Checked {
    /// Reads a run file, or a robot file, which need not state its stiffness, and says what was understood.
    ///
    /// ```
    /// let checked = stead::Checked::read("configs/caro-2013.toml")?;
    /// assert_eq!(checked.to_json()["middle"]["points_tried"], 105);
    /// assert!(checked.to_string().contains("45.0 deg from the flange axis"));
    /// # Ok::<(), stead::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Self::read_with(file, &Monitor::silent())
    }

    /// As [`Checked::read`], with a monitor: the forces of a run file with a table `[stock]` are computed, which may
    /// take long.
    ///
    /// # Errors
    /// As [`Checked::read`]; [`Error::Stopped`] when the monitor asked to stop before that was done.
    pub fn read_with(file: impl AsRef<Path>, monitor: &Monitor) -> Result<Self, Error> {
        let file = file.as_ref();
        match says_stiffness(file)? {
            Some(has_stiffness) => {
                let arm = Arm::read(file)?;
                Ok(Self::of_arm(&arm, has_stiffness, robot_radians(file)?))
            }
            None => {
                let run = Run::read_with(file, Vec::new(), monitor)?;
                Ok(Self::of_run(&run))
            }
        }
    }

    /// With what is to be said of the file beside what is said of its arm.
    fn of_arm(arm: &Arm, has_stiffness: bool, of_file: Vec<String>) -> Self {
        let robot = arm.robot();
        let of_file = of_file.into_iter().map(Note::may_be_wrong);
        let notes: Vec<Note> = of_file.chain(stead_model::plausibility::arm(robot)).collect();
        Self {
            text: robot_lines(robot, Some(has_stiffness)),
            document: robot_json(robot, has_stiffness, &notes, arm.inputs()),
            picture: arm_alone(robot),
            notes,
            warnings: Vec::new(),
        }
    }

    fn of_run(run: &Run) -> Self {
        let problem = run.problem();
        let overview = Overview::of(problem);
        let notes: Vec<Note> = run.notes().iter().cloned().chain(overview.notes()).collect();
        let warnings = run.warnings().to_vec();
        let run = CheckedRun {
            problem,
            overview: &overview,
            cut: run.cut(),
            inputs: run.inputs(),
            notes: &notes,
            warnings: &warnings,
        };
        let (text, document, picture) = (run_text(&run), run_json(&run), arm_of_run(problem, &overview));
        Self { text, document, picture, notes, warnings }
    }

    /// The arm as it was understood, as SVG.
    pub fn picture(&self) -> &str {
        &self.picture
    }
}

result! { Checked, self {
    write(folder) = folder.results("check", &[]).write(&self.files()?);
    files = Ok::<_, Error>(vec![("check.svg".to_owned(), self.picture.clone().into_bytes())]);
    document = self.document.clone();
    table = self.text.clone();
    notes = self.notes;
    warnings = self.warnings;
} }
