//! Elastic calibration: joint compliances from measurements, which measurements to take, and what to command so that
//! the loaded tool follows its path.
//!
//! ```
//! use nalgebra::{Vector3, vector};
//! use stead_calibration::compensation::{CompensationProblem, PathPoint, Settings, compensate};
//! use stead_model::robot::{Posture, testing};
//! use stead_numerics::monitor::Monitor;
//! let (robot, spindle) = (testing::kr270(), testing::spindle());
//! let joints = [0.3, 0.9, -2.1, 0.4, 1.1, 0.0];
//! let point = PathPoint {
//!     segment: 1,
//!     base_from_tool: robot.forward(&joints).then(&spindle.flange_from_tool),
//!     posture: Posture::of(&robot, &joints),
//!     joints,
//!     force: vector![120.0, -340.0, 210.0],
//!     moment: Vector3::zeros(),
//!     normal: Vector3::y(),
//!     of_part: Vector3::zeros(),
//!     free_fall: vector![0.0, 0.0, -9.81],
//! };
//! let (reality, points, settings) = (robot.clone(), vec![point], Settings::default());
//! let job = CompensationProblem { robot, reality, spindle, points, settings };
//! let path = compensate(&job, &Monitor::silent())?;
//! let [before, after] = path.deflections();
//! assert!(before.mean > 1e-4 && after.mean < 1e-9);
//! # Ok::<(), stead_numerics::monitor::Stop>(())
//! ```

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

pub mod compensation;
pub mod identification;
