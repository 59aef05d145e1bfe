//! Dynamics of a robot that mills: passes in the time domain, modal analysis, and stability of the cut.
//!
//! - [`drive`]: springs, dampers, backlash and gravity compensation about the joints of a
//!   [chain](stead_model::robot::chain); [`arm`]: both for a robot with its spindle, in one of four
//!   [`Variant`](arm::Variant)s.
//! - [`motion`]: the commanded joint angles of a straight pass; [`setup`]: an arm with its motion.
//! - [`integrator`]: Newmark's method; [`modes`]: natural frequencies, mode shapes, frequency response.
//! - [`milling`]: the force of the teeth; [`surface`]: the workpiece as earlier teeth left it; [`roughness`]: the wall
//!   that remains.
//! - [`coupled`]: arm and milling together over a pass; [`outcome`]: the figures of such a run; [`judgement`]: whether
//!   it stayed calm.
//! - [`stability`]: semi-discretisation and the zero-order solution; [`stability_analysis`]: both for an arm in a cut;
//!   [`path_stability`]: for every point of a tool path.
//!
//! ```
//! use nalgebra::DMatrix;
//! use stead_model::cutting::{Coefficients, Cut, Cutter, MillingDirection, PassCut, Rotation, Tooth};
//! use stead_simulation::stability::{Plant, SemiDiscretisation};
//! use std::f64::consts::{PI, TAU};
//! // A tool of 40 g that swings along the feed at 922 Hz, 1.1 % damped, with two teeth in a slot at 5000 rev/min.
//! let (mass, omega) = (0.03993, 922.0 * TAU);
//! let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -omega * omega, -2.0 * 0.011 * omega]);
//! let b = DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 1.0 / mass, 0.0]);
//! let plant = Plant::new(a, b, DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 0.0]))?;
//! let teeth = vec![Tooth { pitch: PI, radius: 5e-3 }; 2];
//! let cutter = Cutter::new(teeth, 0.0, None, Rotation::Clockwise, Coefficients::new(6e8, 2e8, 0.0))?;
//! let section = Cut { direction: MillingDirection::Climb, radial_depth: 0.01, axial_depth: 1e-3 };
//! let cut = PassCut { section, length: 1.0, spindle_speed: 5000.0 / 60.0 * TAU, slices: 1, steps_per_turn: 160 };
//! let small_motions = SemiDiscretisation::new(&plant, &cutter, &cut)?;
//! assert!(small_motions.verdict(0.2e-3).is_stable() && !small_motions.verdict(1e-3).is_stable());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod arm;
pub mod coupled;
pub mod drive;
pub mod integrator;
pub mod judgement;
pub mod milling;
pub mod modes;
pub mod motion;
pub mod outcome;
pub mod path_stability;
pub mod roughness;
pub mod setup;
pub mod stability;
pub mod stability_analysis;
mod stability_error;
pub mod surface;
