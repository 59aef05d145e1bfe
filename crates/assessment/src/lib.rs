//! Machining accuracy of robots (circularity of a milled circle over the cell), and roundness of measured profiles.
//!
//! The measure is the circularity of a milled circle (ISO 12181), after Klimchik, Ambiehl, Garnier, Furet and Pashkevich,
//! "Efficiency evaluation of robots in machining applications using industrial performance measure", 2017:
//!
//! - [`circle`]: the four reference circles of the standard and the circularity about each.
//! - [`roundness`]: the same for measured points, in the plane or in space, with sectors left out.
//! - [`benchmark`]: the deflected circle at one place of the cell.
//! - [`map`]: that at every place of a plane.
//! - [`zone`]: the best and the middle square zones of a map.
//! - [`ranking`]: which robot reaches which accuracy at which force.
//! - [`comparison`]: all of it for several robots.
//! - [`published`]: published tables, and their agreement with computed ones.

pub mod benchmark;
pub mod circle;
pub mod comparison;
pub mod map;
pub mod published;
pub mod ranking;
pub mod roundness;
pub mod zone;
