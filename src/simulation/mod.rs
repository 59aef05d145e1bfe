//! How a robot mills.

pub mod milling;
pub mod roughness;
pub mod surface;
