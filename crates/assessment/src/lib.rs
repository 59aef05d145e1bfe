//! Machining accuracy of robots (circularity of a milled circle over the cell), and roundness of measured profiles.
//!
//! The measure is the circularity of a milled circle (ISO 12181), after Klimchik, Ambiehl, Garnier, Furet and
//! Pashkevich, "Efficiency evaluation of robots in machining applications using industrial performance measure", 2017:
//!
//! - [`circle`]: the four reference circles of the standard and the circularity about each.
//! - [`roundness`]: the same for measured points, in the plane or in space, with sectors left out.
//! - [`benchmark`]: the deflected circle at one place of the cell.
//! - [`map`]: that at every place of a plane.
//! - [`zone`]: the best and the middle square zones of a map.
//! - [`ranking`]: which robot reaches which accuracy at which force.
//! - [`comparison`]: all of it for several robots.
//! - [`published`]: published tables, and their agreement with computed ones.
//!
//! ```
//! use stead_assessment::roundness::{Measured, assess};
//! use std::f64::consts::TAU;
//! // A groove of 30 mm radius with three lobes of 10 um.
//! let points = (0..90).map(|k| {
//!     let angle = TAU * f64::from(k) / 90.0;
//!     let radius = 30.0 + 0.01 * libm::cos(3.0 * angle);
//!     [radius * libm::cos(angle), radius * libm::sin(angle)]
//! });
//! let groove = assess(&Measured::Planar(points.collect()), &[])?;
//! assert!((groove.circles.lsc.circularity - 0.02).abs() < 1e-6);
//! assert!(groove.circles.mzc.circularity <= groove.circles.lsc.circularity);
//! # Ok::<(), stead_assessment::roundness::RoundnessError>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod benchmark;
pub mod circle;
pub mod comparison;
pub mod map;
pub mod published;
pub mod ranking;
pub mod roundness;
pub mod zone;
