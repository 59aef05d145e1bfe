//! Cutting forces from a tool path and the stock that it cuts.

pub use stead_removal::error::ForcesError;
pub use stead_removal::forces::forces;
pub use stead_removal::load::PointForces;
pub use stead_removal::operation::{AirPoint, EndMill, ForcesProblem, Operation, Stock};
pub use stead_removal::outcome::{ForcesDifference, RemovalForces};
pub use stead_removal::surface::Surface;
pub use stead_run_files::forces::material::Material;

use crate::monitor::Warning;
use crate::result::printed;
use crate::{Error, Monitor};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stead_disk::Existing;
use stead_disk::files::new::{check_all_new, foreign, write_all_new};
use stead_numerics::message::Note;
use stead_report::forces::{ENDINGS, forces_files, forces_json, forces_text};
use stead_run_files as run_files;

/// A forces file with the path, the stock and the part that it names, read and checked.
#[derive(Debug, Clone)]
pub struct ForcesRun {
    run: Arc<stead_runs::ForcesRun>,
}

impl ForcesRun {
    /// Reads a forces file and the files that it names.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self { run: Arc::new(run_files::read_forces(file.as_ref())?) })
    }

    /// What the user should know about the input though it is not wrong, in sentences.
    pub fn notes(&self) -> &[Note] {
        &self.run.notes
    }

    /// Refuses the [files](PathForces::files) of a task where they may not be written: to be called before the long
    /// work.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that is there already and to be kept, that is one of the inputs, or that is replaced
    /// though no `NAME-forces.json` is beside it, so that it is somebody else's.
    pub fn check_files(&self, task: impl AsRef<Path>, existing: Existing) -> Result<(), Error> {
        check_files(&self.run, task.as_ref(), existing)
    }

    /// What is to be cut.
    pub fn problem(&self) -> &ForcesProblem {
        &self.run.problem
    }

    /// Mean force and moment over a turn at every point of the path.
    ///
    /// # Errors
    /// [`Error::Input`] for a stock that the path does not touch or whose surface is not closed, for cells that take
    /// too much memory, and for a file to keep them in that is none; [`Error::Stopped`] when the monitor asked to stop
    /// before the last point.
    pub fn compute(&self, monitor: &Monitor) -> Result<PathForces, Error> {
        let forces = self.run.forces(monitor)?;
        let notes = self.run.notes.iter().chain(&forces.notes).cloned().collect();
        Ok(PathForces { run: Arc::clone(&self.run), forces, notes })
    }
}

fn check_files(run: &stead_runs::ForcesRun, task: &Path, existing: Existing) -> Result<(), Error> {
    let files = PathForces::files(task);
    check_all_new(&files, existing, &run.inputs)?;
    let is_told = files.last().is_some_and(|document| document.is_file());
    match files.iter().find(|file| existing == Existing::Replaced && !is_told && file.is_file()) {
        Some(file) => Err(foreign(file).into()),
        None => Ok(()),
    }
}

/// Forces along a path, with the files that `stead forces` writes.
#[derive(Debug, Clone)]
pub struct PathForces {
    run: Arc<stead_runs::ForcesRun>,
    forces: RemovalForces,
    notes: Vec<Note>,
}

impl PathForces {
    /// Point by point, in SI units.
    pub fn outcome(&self) -> &RemovalForces {
        &self.forces
    }

    /// The files that [`write`](Self::write) writes for a task: to see whether they may be there before the long work.
    pub fn files(task: impl AsRef<Path>) -> Vec<PathBuf> {
        let task = task.as_ref();
        let stem = task.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let name = |ending: &str| match ending {
            "" => task.to_owned(),
            ending => task.with_file_name(format!("{stem}{ending}")),
        };
        ENDINGS.into_iter().map(name).collect()
    }

    /// Writes the task with forces to a file, and beside it `NAME-engagement.csv`, `NAME-forces.svg`,
    /// `NAME-forces.html`, `NAME-stock-before.stl`, `NAME-stock-after.stl` and `NAME-forces.json`: all of them or none.
    /// Returns their paths.
    ///
    /// # Errors
    /// [`Error::Input`] for a file that is there already and to be kept, or that cannot be written.
    pub fn write(&self, task: impl AsRef<Path>, existing: Existing) -> Result<Vec<PathBuf>, Error> {
        let task = task.as_ref();
        check_files(&self.run, task, existing)?;
        let made = forces_files(&self.run, &self.forces)?;
        let texts: Vec<_> = made.iter().map(|(_, bytes)| String::from_utf8_lossy(bytes)).collect();
        let files = Self::files(task);
        let named: Vec<(PathBuf, &str)> = files.iter().cloned().zip(texts.iter().map(|text| &**text)).collect();
        write_all_new(&named, existing, &self.run.inputs)?;
        Ok(files)
    }

    /// What the user should know about the input though it is not wrong, in sentences: assumptions, and values left at
    /// their defaults.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Why the result may not be what was wanted.
    pub fn warnings(&self) -> &[Warning] {
        &self.forces.warnings
    }
}

printed! { PathForces, self {
    document = forces_json(&self.run, &self.forces);
    table = forces_text(&self.run, &self.forces);
} }
