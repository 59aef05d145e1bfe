//! stead
pub mod robot;
