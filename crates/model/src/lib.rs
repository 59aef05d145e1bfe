//! Domain model: robot, external axes, tool path, joint stiffness and deflection, cutting forces, published reference figures, and what looks wrong.

pub mod cutting;
pub mod external_axis;
pub mod plausibility;
pub mod published;
pub mod robot;
pub mod stiffness;
pub mod task;
