//! A cut whose forces are to be computed.

use crate::{KeptForces, ReadError};
use stead_disk::input::{InputError, InputFile};
use stead_model::task::ToolPath;
use stead_numerics::message::Note;
use stead_numerics::monitor::Monitor;
use stead_removal::error::ForcesError;
use stead_removal::forces::{cut, forces};
use stead_removal::leaning::leaning_forces;
use stead_removal::load::PointForces;
use stead_removal::operation::ForcesProblem;
use stead_removal::outcome::RemovalForces;

/// A forces file and the files that it names, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct ForcesRun {
    /// What is to be cut.
    pub problem: ForcesProblem,
    /// The files that were read: config, path, and others that it names.
    pub inputs: Vec<InputFile>,
    /// What the user should know about the input though it is not wrong, in sentences.
    pub notes: Vec<Note>,
    /// Where what takes long is kept, so that it is computed once.
    pub keep: Option<KeptForces>,
    /// The file with the place of the path, for errors that the job finds.
    pub places: ForcesPlaces,
}

/// Where things that only the job can find wrong are stated.
#[derive(Debug, Clone, PartialEq)]
pub struct ForcesPlaces {
    /// The stock.
    pub stock: InputError,
    /// The path.
    pub path: InputError,
    /// The size of the cells.
    pub cell: InputError,
}

impl ForcesRun {
    /// Mean force and moment over a turn at every point of the path: read where they are kept, else computed.
    ///
    /// # Errors
    /// [`ReadError`]: what the job finds wrong, a stop, and a file to keep them in that is none of this kind or cannot
    /// be written.
    pub fn forces(&self, monitor: &Monitor) -> Result<RemovalForces, ReadError> {
        let located = |error: ForcesError| self.located(&error);
        let Some(keep) = &self.keep else { return forces(&self.problem, monitor).map_err(located) };
        let keep = keep.of(&self.problem);
        let result = match keep.cut(monitor)? {
            Some(known) => known,
            None => {
                let result = cut(&self.problem, monitor).map_err(located)?;
                keep.put_cut(&result.rows())?;
                result
            }
        };
        result.forces(&self.problem).map_err(located)
    }

    /// The same for paths that are that of the run with the tool leaning, one after another, from what
    /// [`forces`](Self::forces) has found.
    ///
    /// # Errors
    /// Those of [`forces`](Self::forces).
    pub fn leaning(
        &self,
        known: &RemovalForces,
        paths: &[ToolPath],
        monitor: &Monitor,
    ) -> Result<Vec<Vec<PointForces>>, ReadError> {
        let made = || leaning_forces(&self.problem, known, paths, monitor).map_err(|error| self.located(&error));
        let Some(keep) = &self.keep else { return made() };
        let keep = keep.of(&self.problem);
        if let Some(found) = keep.leaning(paths)? {
            return Ok(found);
        }
        let made = made()?;
        keep.put_leaning(paths, &made)?;
        Ok(made)
    }

    /// What the job found wrong, at its place in the file; or that it was stopped.
    pub fn located(&self, error: &ForcesError) -> ReadError {
        let at = |place: &InputError, allowed: &str| place.clone().because(error).allowed(allowed).into();
        match error {
            ForcesError::Stopped(stop) => (*stop).into(),
            ForcesError::Form | ForcesError::Large(_) => {
                at(&self.places.stock, "a box, a cylinder or a closed mesh, at most 4.2 m long")
            }
            ForcesError::Open { .. } => at(&self.places.stock, "a closed mesh whose surface does not cross itself"),
            ForcesError::NoWall => at(
                &self.places.stock,
                "a path whose scored moves go across the tool axis, or box_mm, cylinder_mm, mesh",
            ),
            ForcesError::Untouched => {
                at(&self.places.stock, "stock that the path cuts: look at its place and its unit")
            }
            ForcesError::Memory { fits: Some(_), .. } => at(&self.places.cell, "larger cells, or more memory_gb"),
            ForcesError::Memory { fits: None, .. } => {
                at(&self.places.cell, "more memory_gb: what the path meets takes it")
            }
            ForcesError::NoFeeds(_) | ForcesError::Path(_) => at(&self.places.path, "a path with feeds"),
        }
    }
}
