//! `open-region.csv`.

use crate::csv_file::table;
use crate::names;
use crate::output::ReportError;
use crate::units::{Unit, fixed};
use stead_placement::certify::{Certificate, OpenBox};
use stead_placement::problem::Problem;

/// `open-region.csv`: the boxes of placements that may still hold one better (or worse) than the value found by more than the
/// gap asked for. Radius and azimuth of the workpiece origin are about axis 1; z and yaw are those of the robot base frame.
/// `bound_mm` is empty where nothing is known of a box.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn open_region(problem: &Problem, certificate: &Certificate) -> Result<Vec<u8>, ReportError> {
    let header = [
        "search",
        "radius_from_mm",
        "radius_to_mm",
        "z_from_mm",
        "z_to_mm",
        "yaw_less_azimuth_from_deg",
        "yaw_less_azimuth_to_deg",
        "bound_mm",
    ];
    let proofs = [&certificate.best, &certificate.worst].into_iter().flatten();
    let rows = proofs.flat_map(|proof| {
        proof.open_boxes(problem).into_iter().map(|open| {
            let OpenBox { radius, z, turn, bound } = open;
            let mut row = vec![names::sense(proof.sense).to_owned()];
            row.extend([radius, z].into_iter().flatten().map(|value| Unit::PLACE_MM.text(value)));
            row.extend(turn.map(|value| Unit::ANGLE_DEG.text(value)));
            let bound = proof.rounded_mm(bound);
            row.push(if bound.is_finite() { fixed(bound, Unit::DEFLECTION_MM.decimals) } else { String::new() });
            row
        })
    });
    table("the table of the open region", header, rows)
}
