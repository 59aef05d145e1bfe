//! Why no set of measurements could be chosen.

use super::super::law::LawError;
use super::super::setup::SetupError;
use super::candidates::Rejected;

/// Why no set of measurements could be chosen.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Too few configurations are allowed.
    #[error(
        "of {draws} random configurations only {found} are allowed, where {wanted} are wanted: {} would leave the volume, {} come \
         too near to the base, {} deflect too far",
        rejected.volume, rejected.radius, rejected.deflection
    )]
    TooFewCandidates {
        /// How many are allowed.
        found: usize,
        /// How many are needed.
        wanted: usize,
        /// How many were drawn.
        draws: usize,
        /// Why the others are not allowed.
        rejected: Rejected,
    },
    /// No test pose is allowed.
    #[error("no random test pose is allowed by the volume and the largest deflection")]
    NoTest,
    /// Fewer equations than unknowns.
    #[error("{equations} deflection components do not determine {unknowns} compliances")]
    TooFew {
        /// Components read.
        equations: usize,
        /// Compliances sought.
        unknowns: usize,
    },
    /// Base transform and reference points are not identifiable.
    #[error("{0}")]
    Setup(#[from] SetupError),
    /// A compensator is not identifiable from so few angles.
    #[error("{0}")]
    Law(#[from] LawError),
    /// No compliance is identifiable from any candidate.
    #[error("no compliance is identifiable under these loads")]
    NothingIdentifiable,
    /// No set of this size identifies all that the candidates identify.
    #[error("no set of {0} of the candidates was found from which every compliance is identifiable")]
    NoIdentifyingSet(usize),
    /// The caller asked to stop.
    #[error("stopped before a set was chosen")]
    Stopped,
}

impl DesignError {
    /// What is needed in place of the number of configurations requested, where that is at fault.
    pub fn needed(&self) -> Option<&'static str> {
        match self {
            Self::TooFew { .. } => {
                Some("at least as many components as compliances: more configurations or reference points")
            }
            Self::Setup(_) => {
                Some("more configurations or reference points, with the flange in different orientations")
            }
            Self::Law(_) => Some("3 or more, and as many levels_deg"),
            Self::NoIdentifyingSet(_) => Some("more configurations"),
            Self::TooFewCandidates { .. } | Self::NoTest | Self::NothingIdentifiable | Self::Stopped => None,
        }
    }
}
