//! stead
pub mod cli;
pub mod config;
pub mod cutting;
pub mod input;
pub mod placement;
pub mod report;
pub mod robot;
pub mod stiffness;
pub mod task;
