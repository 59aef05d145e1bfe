//! The CSV files of a simulated pass.

use super::super::output::ReportError;
use super::{HEIGHT_UM, MOMENT_S};
use crate::csv_file::table;
use crate::units::Unit;
use stead_simulation::outcome::Simulation;

const SERIES: &str = "time_s,force_x_n,force_y_n,force_axial_n,x_mm,y_mm,deflection_x_um,deflection_y_um";

/// `series.csv`: one row a step. Forces on the tool along the feed, towards the wall, and along the tool axis; the place of the
/// tool centre along the feed from the edge of the work, and from the nominal wall; how far it is off its path. In all of them x is
/// along the feed and y towards the wall, as in the published tables: a tool centre in front of the wall has a negative y, and one
/// that is pushed away from the wall a negative deflection.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn series(found: &Simulation) -> Result<Vec<u8>, ReportError> {
    let rows = found.run.samples.iter().zip(found.run.trail.nodes()).enumerate();
    let row = rows.map(|(index, (sample, node))| {
        let [feed, normal, axis] = sample.force;
        let mut row = vec![MOMENT_S.text(index as f64 * found.run.step)];
        row.extend([feed, -normal, axis].map(|force| Unit::FORCE_N.text(force)));
        row.extend(towards_wall(node.place).map(|place| Unit::PLACE_MM.text(place)));
        row.extend(towards_wall(sample.deflection).map(|part| HEIGHT_UM.text(part)));
        row
    });
    table("the table of forces and places", SERIES.split(','), row)
}

/// Along the feed and towards the wall, from along the feed and out of the wall.
fn towards_wall([feed, normal]: [f64; 2]) -> [f64; 2] {
    [feed, -normal]
}

/// `wall.csv`: the wall along the feed, its height over the nominal wall, and what the filter leaves of it.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn wall(found: &Simulation) -> Result<Vec<u8>, ReportError> {
    let heights = found.wall.heights.iter().zip(&found.filtered.heights).enumerate();
    let rows = heights.map(|(index, (height, filtered))| {
        let place = found.wall.start + index as f64 * found.wall.spacing;
        vec![Unit::PLACE_MM.text(place), HEIGHT_UM.text(*height), HEIGHT_UM.text(*filtered)]
    });
    table("the table of the wall", ["x_mm", "height_um", "roughness_um"], rows)
}
