//! What pushes: the mean cutting force of a milling cutter over one turn, by two models that share frame and engagement.
//!
//! Frame: x along the feed, y to the left of it, z along the tool axis from the work to the spindle; forces and moments are
//! what the work does to the tool.
//!
//! - [`CuttingModel`] knows a cylindrical cutter by its tangential and radial coefficients with edge terms (after Tlusty and
//!   MacNeil 1975, the model that Caro 2013 names) and puts the mean force along a tool path.
//! - [`MillingTool`] knows the geometry of a tooth, so its force has an axial part and comes with its moment (Klimchik 2017,
//!   section 2.2).
//! - [`Engagement`] says over which arcs of a turn a tooth cuts. Means are closed forms of integrals over these arcs.
//! - [`ForceHistory`] is the wrench of a milling tool while it moves into the work, and over one turn, to be reported.

mod engagement;
mod force_history;
mod milling_tool;
mod model;
mod rotation;
#[cfg(test)]
mod tests;

pub use engagement::{Arc, Engagement, EngagementError, Integrals};
pub use force_history::{ForceHistory, Sample};
pub use milling_tool::MillingTool;
pub use model::{CuttingModel, MillingDirection, Side};
pub use rotation::Rotation;
