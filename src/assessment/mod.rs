//! How good a machined or a computed profile is.
//!
//! - [`circle`]: roundness of points, with the four reference circles of ISO 12181.

pub mod circle;
