//! Domain model: robot, tool path, joint stiffness and deflection, cutting forces, published reference figures.

pub mod cutting;
pub mod published;
pub mod robot;
pub mod stiffness;
pub mod task;
