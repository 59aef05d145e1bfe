//! Roundness of measured points.

pub use stead_assessment::roundness::Sector;

use crate::Error;
use crate::monitor::Warning;
use crate::result::result;
use std::path::Path;
use std::sync::Arc;
use stead_assessment::roundness::{Roundness, assess};
use stead_report::circularity::{circularity_files, circularity_json, circularity_text};
use stead_runs::{PointFile, read_points};

/// Measured points of a circular profile.
#[derive(Debug, Clone)]
pub struct Profile {
    file: Arc<PointFile>,
}

impl Profile {
    /// Reads measured points: a CSV file with `x_mm,y_mm` or `x_mm,y_mm,z_mm`.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, column, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        Ok(Self { file: Arc::new(read_points(file.as_ref())?) })
    }

    /// The four reference circles of ISO 12181 and the circularity about each, without the points of some sectors.
    ///
    /// # Errors
    /// [`Error::Input`] for points on a line, or too few.
    pub fn circularity(&self, excluded: &[Sector]) -> Result<Circularity, Error> {
        let roundness = assess(&self.file.measured, excluded).map_err(|error| self.file.locate(error))?;
        let warnings = roundness.warnings();
        Ok(Circularity { file: Arc::clone(&self.file), roundness, warnings })
    }
}

/// The four reference circles of a profile.
#[derive(Debug, Clone)]
pub struct Circularity {
    file: Arc<PointFile>,
    roundness: Roundness,
    warnings: Vec<Warning>,
}

impl Circularity {
    /// The circles and every point's deviation from them, in mm as the file has them.
    pub fn roundness(&self) -> &Roundness {
        &self.roundness
    }
}

result! { Circularity, self {
    write(folder) = folder.results("circularity", std::slice::from_ref(&self.file.input)).write(&self.files()?);
    files = circularity_files(&self.file, &self.roundness);
    document = circularity_json(&self.file, &self.roundness);
    table = circularity_text(&self.file, &self.roundness);
    warnings = self.warnings;
} }
