//! The arms of the catalogue.

use super::Robot;

/// An arm that stead ships with.
#[derive(Debug, Clone)]
pub struct ShippedArm {
    /// The name to ask for it by.
    pub name: &'static str,
    /// Its geometry, limits and controller.
    pub robot: Robot,
    /// Where its numbers come from.
    pub source: String,
    /// Whether the stiffness of every joint is known.
    pub has_stiffness: bool,
    /// Whether masses and damping of the links are known, for motion and stability.
    pub has_dynamics: bool,
}
