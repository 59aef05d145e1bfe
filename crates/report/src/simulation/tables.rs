//! The CSV files of a simulated pass.

use super::super::output::ReportError;
use crate::csv_file::rows_or;
use crate::figure::{ForceN, HeightUm, MomentS, PlaceMm};
use stead_simulation::coupled::Sample;
use stead_simulation::outcome::Simulation;

records! {
    /// A step of a pass. In all columns x is along the feed and y towards the wall, as in the published tables: a tool
    /// centre in front of the wall has a negative y, and one that is pushed away from the wall a negative deflection.
    #[derive(Default)]
    pub struct SeriesRow of (time: f64, sample: &Sample, place: [f64; 2]) {
        /// Time.
        time_s: MomentS = time.into(),
        /// Force on the tool along the feed.
        force_x_n: ForceN = sample.force[0].into(),
        /// Force on the tool towards the wall.
        force_y_n: ForceN = ForceN(-sample.force[1]),
        /// Force on the tool along its axis.
        force_axial_n: ForceN = sample.force[2].into(),
        /// Place of the tool centre from the edge of the work.
        x_mm: PlaceMm = place[0].into(),
        /// Place of the tool centre from the nominal wall.
        y_mm: PlaceMm = PlaceMm(-place[1]),
        /// How far it is off its path along the feed.
        deflection_x_um: HeightUm = sample.deflection[0].into(),
        /// How far it is off its path towards the wall.
        deflection_y_um: HeightUm = HeightUm(-sample.deflection[1]),
    }
}

/// `series.csv`: a `SeriesRow` for each step.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn series(found: &Simulation) -> Result<Vec<u8>, ReportError> {
    let steps = found.run.samples.iter().zip(found.run.trail.nodes()).enumerate();
    let steps = steps.map(|(k, (sample, node))| SeriesRow::of(k as f64 * found.run.step, sample, node.place));
    rows_or("the table of forces and places", &SeriesRow::default(), steps)
}

records! {
    /// The wall at a place along the feed.
    #[derive(Default)]
    pub struct WallRow of (index: usize, height: &f64, filtered: &f64, found: &Simulation) {
        /// The place.
        x_mm: PlaceMm = PlaceMm(found.wall.start + index as f64 * found.wall.spacing),
        /// Height over the nominal wall.
        height_um: HeightUm = (*height).into(),
        /// What the filter leaves of it.
        roughness_um: HeightUm = (*filtered).into(),
    }
}

/// `wall.csv`: a `WallRow` for each place along the feed.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn wall(found: &Simulation) -> Result<Vec<u8>, ReportError> {
    let heights = found.wall.heights.iter().zip(&found.filtered.heights).enumerate();
    let places = heights.map(|(index, (height, filtered))| WallRow::of(index, height, filtered, found));
    rows_or("the table of the wall", &WallRow::default(), places)
}
