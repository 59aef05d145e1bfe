//! `open-region.csv`.

use crate::csv_file::rows_or;
use crate::figure::{AngleDeg, MmDeflection, PlaceMm};
use crate::names;
use crate::output::ReportError;
use stead_certify::{Certificate, OpenBox, Proof};
use stead_problem::problem::Problem;

records! {
    /// A box of placements that may still hold one better (or worse) than the value found by more than the gap
    /// requested. Radius and azimuth of the workpiece origin are about axis 1; z and yaw are those of the robot base
    /// frame.
    #[derive(Default)]
    pub struct OpenBoxRow of (proof: &Proof, open: &OpenBox) {
        /// `best` or `worst`.
        search: &'static str = names::sense(proof.sense),
        /// Least radius.
        radius_from_mm: PlaceMm = open.radius[0].into(),
        /// Largest radius.
        radius_to_mm: PlaceMm = open.radius[1].into(),
        /// Least z.
        z_from_mm: PlaceMm = open.z[0].into(),
        /// Largest z.
        z_to_mm: PlaceMm = open.z[1].into(),
        /// Least difference of yaw and azimuth.
        yaw_less_azimuth_from_deg: AngleDeg = open.turn[0].into(),
        /// Largest difference of yaw and azimuth.
        yaw_less_azimuth_to_deg: AngleDeg = open.turn[1].into(),
        /// No placement in the box is better; empty where nothing is known.
        bound_mm: Option<MmDeflection> =
            Some(MmDeflection(proof.rounded_mm(open.bound))).filter(|bound| bound.0.is_finite()),
        /// Name of the orientation of the part; empty where the run has one alone.
        orientation: Option<String> = open.orientation.clone(),
        /// Number of the segment that it is of, where each has a place of its own; else empty.
        segment: Option<usize> = open.segment,
    }
}

/// `open-region.csv`: an `OpenBoxRow` for each box.
///
/// # Errors
/// [`ReportError::Format`] when the CSV writer fails.
pub fn open_region(problem: &Problem, certificate: &Certificate) -> Result<Vec<u8>, ReportError> {
    let proofs = [&certificate.best, &certificate.worst].into_iter().flatten();
    let boxes = proofs.flat_map(|proof| proof.open_boxes(problem).into_iter().map(|open| OpenBoxRow::of(proof, &open)));
    rows_or("the table of the open region", &OpenBoxRow::default(), boxes)
}
