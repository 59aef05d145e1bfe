//! Domain model: robot, external axes, tool path, joint stiffness and deflection, cutting forces, published reference
//! figures, and what looks wrong.
//!
//! ```
//! use nalgebra::{Vector3, vector};
//! use stead_model::robot::{Frames, Joint, Posture, Robot};
//! use stead_model::stiffness::displacement;
//! // The KUKA KR270-2 of Caro et al. 2013: twists and limits in deg, offsets in m, stiffness in MN m/rad.
//! let joint = |alpha: f64, a, d, [min, max]: [f64; 2], stiffness: f64| Joint {
//!     alpha: alpha.to_radians(), a, d, min: min.to_radians(), max: max.to_radians(),
//!     max_speed: None, max_acceleration: None, max_jerk: None, compliance: (1e-6 / stiffness).into(),
//! };
//! let robot = Robot::new("KR270-2", [
//!     joint(0.0, 0.0, 0.0, [-185.0, 185.0], 0.237),
//!     joint(90.0, 0.35, 0.0, [0.0, 146.0], 3.32),
//!     joint(0.0, 1.25, 0.0, [-245.0, 29.0], 2.79),
//!     joint(-90.0, 0.055, 1.1, [-350.0, 350.0], 0.486),
//!     joint(90.0, 0.0, 0.0, [-125.0, 125.0], 0.521),
//!     joint(-90.0, 0.0, 0.0, [-350.0, 350.0], 0.38),
//! ])?;
//! let angles = [0.0, 1.2, -2.0, 0.0, 1.0, 0.0];
//! let flange = robot.forward(&angles);
//! let found = robot.inverse(&flange, Posture::of(&robot, &angles))?;
//! assert!(found.iter().zip(angles).all(|(found, angle)| (found - angle).abs() < 1e-12));
//! // 100 N to the left push the flange, 1.6 m from axis 1, mostly about that axis.
//! let (frames, compliances) = (Frames::new(&robot, &angles), robot.compliances_at(&angles));
//! let moved = displacement(&frames, &flange.translation, &compliances, &vector![0.0, 100.0, 0.0], &Vector3::zeros());
//! assert!((moved.linear.y - 1.1215e-3).abs() < 1e-7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod cutting;
pub mod external_axis;
pub mod plausibility;
pub mod published;
pub mod robot;
pub mod stiffness;
pub mod task;
#[cfg(any(test, feature = "testing"))]
pub mod testing;
