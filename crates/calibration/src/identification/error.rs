//! Why nothing can be identified.

use super::law::LawError;
use super::model::Layout;
use super::normal_equations::Unidentifiable;
use super::setup::SetupError;
use stead_model::robot::RobotError;

/// Why nothing can be identified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// Base transform and reference points cannot be told.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A deflection is far larger than the load could cause on the starting arm.
    #[error("a deflection of {deflection_mm:.3} mm, where the load could cause some {expected_mm:.3} mm")]
    TooFar {
        /// Line of the reading in the sheet, from 1.
        line: usize,
        /// The deflection. mm
        deflection_mm: f64,
        /// Upper bound by the compliances of the starting arm. mm
        expected_mm: f64,
    },
    /// Fewer equations than unknowns.
    #[error("{equations} deflection components do not tell {unknowns} compliances")]
    TooFew {
        /// Components read.
        equations: usize,
        /// Compliances sought.
        unknowns: usize,
    },
    /// As many equations as unknowns, and the noise is not stated.
    #[error("{equations} deflection components for {equations} compliances leave nothing to estimate the noise from")]
    NoiseUnknown {
        /// Components read, and compliances sought.
        equations: usize,
    },
    /// Compliances, or combinations of them, that change no reading.
    #[error("the readings do not see every compliance")]
    Unidentifiable {
        /// What they do not see.
        unidentifiable: Vec<Unidentifiable>,
        /// The parameters, to name them by.
        layout: Layout,
        /// Lines of the outliers without which it is so, from 1; none where all readings together do not see them.
        outliers: Vec<usize>,
    },
    /// A compliance comes out far below zero: the arm goes against the load.
    #[error(
        "the compliance of joint {joint} comes out as {value_urad:.4} with a standard deviation of {deviation_urad:.4} \
         urad/(N m): the joint turns against its load"
    )]
    Negative {
        /// Number of the joint, from 1.
        joint: usize,
        /// The estimate. urad/(N m)
        value_urad: f64,
        /// Its standard deviation. urad/(N m)
        deviation_urad: f64,
    },
    /// The compensator cannot be told.
    #[error("{0}")]
    Law(#[from] LawError),
    /// A compliance comes out at zero or below.
    #[error(
        "the compliance of joint {joint} comes out as {value_urad:.4} with a standard deviation of {deviation_urad:.4} \
         urad/(N m): it is not told by these readings"
    )]
    NotPositive {
        /// Number of the joint, from 1.
        joint: usize,
        /// The estimate. urad/(N m)
        value_urad: f64,
        /// Its standard deviation. urad/(N m)
        deviation_urad: f64,
    },
    /// The identified arm is refused, as where the compensator makes a joint give way inside its limits.
    #[error("the identified arm is none: {0}")]
    Robot(#[from] RobotError),
}
