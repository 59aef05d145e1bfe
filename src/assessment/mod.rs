//! How good a machined or a computed profile is.
//!
//! - [`circle`]: the four reference circles of ISO 12181 and the circularity about each.
//! - [`roundness`]: the same for measured points, in the plane or in space, with sectors left out.

pub mod circle;
pub mod roundness;
