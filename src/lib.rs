//! stead
pub mod cutting;
pub mod input;
pub mod robot;
pub mod stiffness;
pub mod task;
