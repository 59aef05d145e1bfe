//! Cutter, cut, and the force of milling.
//!
//! Frame: x along the feed, y to the left of it, z along the tool axis from the work to the spindle; forces and moments
//! are what the work does to the tool.
//!
//! - [`Cutter`]: teeth, helix, rotation and [`Coefficients`], which may follow from the geometry of a [`RakeFace`].
//! - [`Cut`]: direction, width and depth of a cut along a wall, and its [`CutFrame`].
//! - [`Engagement`]: the arcs of a turn over which a tooth cuts. Means are closed forms of integrals over these arcs.
//! - [`CuttingForce`]: force and moment at an angle of the turn, and their means; [`ForceHistory`]: both over the
//!   engagement and over a turn, to be reported; [`PathForces`]: the mean force along a tool path.

mod coefficients;
mod cut;
mod cutter;
mod engagement;
mod force;
mod force_history;
mod pass_cut;
mod path_forces;
mod rotation;
#[cfg(test)]
mod tests;

pub use coefficients::{Coefficients, RakeFace};
pub use cut::{Cut, CutFrame, MillingDirection, Side};
pub use cutter::{Cutter, CutterError, Tooth};
pub use engagement::{Arc, Engagement, EngagementError, Integrals};
pub use force::CuttingForce;
pub use force_history::{ForceHistory, Sample};
pub use pass_cut::{CutError, PassCut, min_steps};
pub use path_forces::PathForces;
pub use rotation::Rotation;
