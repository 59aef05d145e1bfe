//! Certificates as files and sentences.
//!
//! Bounds are rounded to the digits of a file on the side where they still hold, and gaps upwards.

mod json;
mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use json::certificate_json;
pub use tables::open_region;
pub use text::{certificate_text, ending};

use super::output::{Folder, ReportError};
use super::picture;
use crate::document::bytes;
use std::path::PathBuf;
use stead_format::input::InputFile;
use stead_placement::certify::{Bound, Region};
use stead_placement::problem::{Placement, Problem};
use stead_placement::sense::Sense;
use stead_placement::settings::CertificateSettings;

/// What is known of how far the placements found are from the best and the worst there are.
#[derive(Debug, Clone, PartialEq)]
pub struct Certificate {
    /// What was asked for.
    pub settings: CertificateSettings,
    /// No placement is better by much, or why nothing is known of that.
    pub best: Result<Proof, String>,
    /// No placement is worse by much, or why nothing is known of that.
    pub worst: Result<Proof, String>,
    /// The files the result depends on.
    pub inputs: Vec<InputFile>,
    /// Time on the clock. s
    pub wall: f64,
}

/// A bound, and what it is a bound of.
#[derive(Debug, Clone, PartialEq)]
pub struct Proof {
    /// Whether nothing is better, or nothing is worse.
    pub sense: Sense,
    /// The placement that it was compared with.
    pub placement: Placement,
    /// What no placement gets past.
    pub bound: Bound,
    /// Why the search for it ended.
    pub end: Ended,
    /// Which limits were relaxed, in words.
    pub relaxed: Vec<String>,
}

/// Why the search for a bound ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ended {
    /// The gap asked for is reached.
    Reached,
    /// What is left open is smaller than the tables can tell apart.
    Exhausted,
    /// The time was over.
    TimeLimit,
    /// The user ended it.
    Interrupted,
}

/// Percentages of gaps have this many decimals.
const GAP_DECIMALS: i32 = 4;
/// Decimals of a bound in mm, as of any deflection.
const BOUND_DECIMALS: i32 = crate::units::Unit::DEFLECTION_MM.decimals as i32;

/// Wider gaps are none to speak of in sentences.
pub const MOST_GAP_PERCENT: f64 = 1000.0;

impl Proof {
    /// Whether the bound is worth a sentence.
    pub fn is_of_use(&self) -> bool {
        self.bound_mm() > 0.0 && self.gap_percent() <= MOST_GAP_PERCENT
    }

    /// What was proven of a placement; which limits are relaxed follows from the problem and the bound.
    pub fn new(problem: &Problem, sense: Sense, placement: Placement, bound: Bound, end: Ended) -> Self {
        let relaxed = relaxed(problem, &bound);
        Self { sense, placement, bound, end, relaxed }
    }

    /// The gap in per cent, rounded up.
    pub fn gap_percent(&self) -> f64 {
        let scale = libm::pow(10.0, f64::from(GAP_DECIMALS));
        // A gap reached exactly is not rounded up for the last bits of a double.
        (self.bound.gap() * 100.0 * scale - 1e-6).ceil().max(0.0) / scale
    }

    /// The bound in mm, rounded to where it still holds.
    pub fn bound_mm(&self) -> f64 {
        self.rounded_mm(self.bound.bound)
    }

    /// A bound (m) in mm, rounded to where it still holds.
    pub(crate) fn rounded_mm(&self, bound: f64) -> f64 {
        let scale = libm::pow(10.0, f64::from(BOUND_DECIMALS));
        let scaled = bound * 1e3 * scale;
        let rounded = match self.sense {
            Sense::Min => scaled.floor(),
            Sense::Max => scaled.ceil(),
        };
        rounded / scale
    }
}

/// The limits that a bound does not keep.
fn relaxed(problem: &Problem, bound: &Bound) -> Vec<String> {
    let mut relaxed =
        vec!["steps and turns of the joints between path points".to_owned(), "limits of joints 1, 4 and 6".to_owned()];
    // Both flips of the wrist are taken to reach as far as the better one; from zero on, one of them does.
    let fifth = &problem.robot.joints()[4];
    if fifth.min > 0.0 || fifth.max < 0.0 {
        relaxed.push("limits of joint 5".to_owned());
    }
    if !bound.with_rate {
        relaxed.push("rate of beta".to_owned());
    }
    if problem.constraints.max_deflection.is_some() {
        relaxed.push("max_deflection_mm".to_owned());
    }
    if !problem.cell.is_yaw_free() {
        relaxed.push("which yaw goes with which x and y".to_owned());
    }
    relaxed
}

/// A box of placements in the user's terms: about axis 1, in the robot base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OpenBox {
    /// Distance of the workpiece origin from axis 1, from and to. m
    pub radius: [f64; 2],
    /// z of the workpiece origin, from and to. m
    pub z: [f64; 2],
    /// Yaw less the azimuth of the workpiece origin about axis 1, from and to. rad
    pub turn: [f64; 2],
    /// What no placement in it gets past. m
    pub bound: f64,
}

impl OpenBox {
    /// Boxes are seen along axis 1, so that an arm that hangs turns z and angles over.
    pub fn new(problem: &Problem, region: &Region, bound: f64) -> Self {
        let geometry = problem.robot.geometry();
        let side = geometry.base_from_root[(2, 2)].signum();
        let ends = |k: usize, sign: f64, from: f64| {
            let middle = from + sign * region.middle[k];
            [middle - region.half[k], middle + region.half[k]]
        };
        Self { radius: ends(0, 1.0, 0.0), z: ends(1, side, geometry.root_in_base.z), turn: ends(2, side, 0.0), bound }
    }
}

/// The boxes that a proof leaves open.
pub(crate) fn open_boxes(problem: &Problem, proof: &Proof) -> Vec<OpenBox> {
    proof.bound.open.iter().map(|(region, bound)| OpenBox::new(problem, region, *bound)).collect()
}

/// Writes everything that is known into a folder: `certificate.json`, `open-region.csv`, and `open-region.svg` and
/// `open-region-worst.svg` as far as there is a proof; pictures of an earlier one are removed. Returns the paths in that order.
///
/// # Errors
/// [`ReportError`]: nothing is written when a file cannot be made, and no file is ever left half written.
pub fn write_certificate(
    folder: &Folder,
    problem: &Problem,
    certificate: &Certificate,
) -> Result<Vec<PathBuf>, ReportError> {
    let mut files = vec![
        ("certificate.json", bytes(&certificate_json(certificate))),
        ("open-region.csv", open_region(problem, certificate)?),
    ];
    let mut outdated = Vec::new();
    for (name, proof) in [("open-region.svg", &certificate.best), ("open-region-worst.svg", &certificate.worst)] {
        match proof {
            Ok(proof) => files.push((name, picture::open_region(problem, proof).into_bytes())),
            Err(_) => outdated.push(name),
        }
    }
    outdated.into_iter().try_for_each(|name| folder.remove(name))?;
    files.iter().map(|(name, bytes)| folder.write(name, bytes)).collect()
}
