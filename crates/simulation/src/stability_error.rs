//! Why a stability analysis is not possible.

use super::arm::Missing;
use super::stability::{PlantError, ZeroOrderError};
use stead_model::cutting::EngagementError;
use stead_numerics::monitor::Stop;

/// Why a stability analysis is not possible.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StabilityError {
    /// The robot file says too little.
    #[error("{0}")]
    Missing(#[from] Missing),
    /// The mass matrix is not positive definite, or the arm without damping is in resonance with the force.
    #[error("the arm has no mass matrix that is positive definite")]
    Singular,
    /// The cut has no width.
    #[error("{0}")]
    Engagement(#[from] EngagementError),
    /// The motion of the arm cannot be computed.
    #[error("{0}")]
    Plant(#[from] PlantError),
    /// There is no zero-order solution.
    #[error("{0}")]
    ZeroOrder(#[from] ZeroOrderError),
    /// The caller asked to stop.
    #[error("{0}")]
    Stopped(#[from] Stop),
}
