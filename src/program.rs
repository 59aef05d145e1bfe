//! Robot programs from plans, and programs read back.

pub use stead_programs::check::{Largest, MovePlace, ProgramCheck, ReadBackOptions};
pub use stead_programs::{
    CorrectedPath, ExportOptions, OperatorFrame, Program, ProgramFile, ProgramFormat, Rotation, WrittenProgram,
};

use crate::files::Existing;
use crate::monitor::Warning;
use crate::result::printed;
use crate::{Error, Monitor, Run};
use std::path::Path;
use stead_programs::check::{self, ANGLE_DEG, POSITION_MM};
use stead_programs::{ExportError, ProgramError};
use stead_report::program::{program_check_json, program_check_text, program_json, program_text};

impl Run {
    /// Makes a robot program of a plan that [`Run::place`] wrote (`best.csv` and the like).
    ///
    /// ```
    /// use stead::program::{ExportOptions, ProgramFormat};
    /// use stead::{Monitor, Run};
    /// let run = Run::read("configs/caro-2013.toml")?;
    /// let options = ExportOptions::new(ProgramFormat::Csv, "PART");
    /// let program = run.export("results/caro-2013/best.csv", &options, &Monitor::silent())?;
    /// let (name, text) = program.files().next().unwrap_or_default();
    /// assert_eq!(name, "PART.csv");
    /// // A joint move to each of the five segments, a line to each of the 105 points, a line away from each segment.
    /// assert_eq!(text.lines().count(), 1 + 5 + 105 + 5);
    /// # Ok::<(), stead::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] for a plan that is not of this run, a corrected path that is not of this plan, and a robot file
    /// that does not say how the controller counts; [`Error::Argument`] for options that are not taken;
    /// [`Error::Failed`] where the arm does not reach a retracted point; [`Error::Stopped`] when the monitor asked to
    /// stop while free ways were looked for again.
    pub fn export(
        &self,
        plan: impl AsRef<Path>,
        options: &ExportOptions<'_>,
        monitor: &Monitor,
    ) -> Result<ExportedProgram, Error> {
        let program = stead_programs::export(&self.run, plan.as_ref(), options, monitor)?;
        Ok(ExportedProgram { program })
    }

    /// Reads a program back (its main file) and compares every pose, feed and blending in it with the plan. The options
    /// are those of the export. Nothing is shared with what writes programs.
    ///
    /// # Errors
    /// [`Error::Input`] with file and line for a program that is not understood, or a plan that is not of this run;
    /// [`Error::Stopped`] as of [`Run::export`].
    pub fn check_program(
        &self,
        plan: impl AsRef<Path>,
        program: impl AsRef<Path>,
        options: &ReadBackOptions<'_>,
        monitor: &Monitor,
    ) -> Result<CheckedProgram, Error> {
        let check = check::check(&self.run, plan.as_ref(), program.as_ref(), options, monitor)?;
        Ok(CheckedProgram { check })
    }
}

impl From<ExportError> for Error {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Input(error) => Self::Input(error),
            ExportError::Stopped(stop) => Self::Stopped(stop),
            ExportError::Program(error @ (ProgramError::Unreached { .. } | ProgramError::Blocked { .. })) => {
                Self::failed(error)
            }
            ExportError::Program(error @ ProgramError::Name { .. }) => Self::Argument(format!("--out: {error}")),
            ExportError::Program(error) => Self::Argument(error.to_string()),
        }
    }
}

/// A robot program, in memory.
#[derive(Debug, Clone)]
pub struct ExportedProgram {
    program: Program,
}

impl ExportedProgram {
    /// What it consists of.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The names and texts of its files, the one to start first.
    pub fn files(&self) -> impl Iterator<Item = (&str, &str)> {
        self.program.files.iter().map(|file| (file.name.as_str(), file.text.as_str()))
    }

    /// The frames to enter at the controller, where the robot file has its root: workpiece, tool, and the table where
    /// the program is coupled to one.
    pub fn frames(&self) -> &[OperatorFrame] {
        &self.program.frames
    }

    /// Writes the files into a folder, which is made where it is missing: all, or none where one of them is there
    /// already and to be kept. Where a program is replaced that an export has written, those of its parts that this one
    /// does not have are removed.
    ///
    /// # Errors
    /// [`Error::Input`] that names the file that is there already, or that cannot be written.
    pub fn write(&self, folder: impl AsRef<Path>, existing: Existing) -> Result<WrittenProgram, Error> {
        Ok(self.program.write(folder.as_ref(), existing)?)
    }

    /// What the user should know, in sentences.
    pub fn notes(&self) -> &[String] {
        &self.program.notes
    }

    /// Which of its moves hit what stands around, one sentence for each.
    pub fn warnings(&self) -> &[Warning] {
        &self.program.warnings
    }
}

printed! { ExportedProgram, self {
    document = program_json(&self.program);
    table = program_text(&self.program);
} }

/// A program compared with its plan.
#[derive(Debug, Clone)]
pub struct CheckedProgram {
    check: ProgramCheck,
}

impl CheckedProgram {
    /// What was found.
    pub fn check(&self) -> &ProgramCheck {
        &self.check
    }

    /// The result, if the program is that of the plan within 0.01 mm and 0.01 deg, a leaning tool touches where it
    /// should, none of the moves between segments hits what stands around, and the arm can follow all others.
    ///
    /// # Errors
    /// [`Error::Failed`] where it is not.
    pub fn sound(&self) -> Result<(), Error> {
        let file = self.check.file.display();
        let counted = |count: usize| if count == 1 { "1 move".to_owned() } else { format!("{count} moves") };
        let (hits, unfollowed) = (self.check.hits.len(), self.check.unfollowed.len());
        let (is_sound, most) = (self.check.is_sound(), self.check.contact_allowed);
        let wrong = match &self.check.contact {
            _ if is_sound && hits > 0 => {
                let hit = if hits == 1 { "hits" } else { "hit" };
                let allowed = "programs of plans with a free way between all segments";
                format!("{} {hit} what stands around; allowed: {allowed}", counted(hits))
            }
            _ if is_sound && unfollowed > 0 => {
                let allowed = "programs of plans without the warning unfollowed-move";
                format!("{} between path points cannot be followed by the arm; allowed: {allowed}", counted(unfollowed))
            }
            _ if is_sound => return Ok(()),
            Some(off) if off.value > most => format!(
                "the leaning tool touches {:.4} mm beside the contact of the task at point {}; allowed: {most} mm, \
                 lean.contact_tolerance_mm",
                off.value, off.at.point
            ),
            _ => format!(
                "is not the program of this plan within {POSITION_MM} mm and {ANGLE_DEG} deg; allowed: the main file of a program of this \
                 plan, checked with the --corrected, --approach-mm and --blend-mm that it was exported with"
            ),
        };
        Err(Error::Failed(format!("{file}: {wrong}")))
    }
}

printed! { CheckedProgram, self {
    document = program_check_json(&self.check);
    table = program_check_text(&self.check);
} }
