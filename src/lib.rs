//! **stead** finds where to put a workpiece in a robot cell so that the robot machines it most accurately.
//!
//! An industrial arm is some fifty times softer than a machine tool, and its softness changes with its pose. So the place of
//! the workpiece, the posture of the arm and the free rotation of the spindle about the tool axis decide how well it
//! machines. stead takes a robot, a spindle, a tool path with cutting forces and the volume in which the workpiece may
//! stand, and finds the best placement, and the worst to show what is at stake (Caro et al. 2013).
//!
//! # The rooms
//!
//! A room uses only rooms on lower floors.
//!
//! | floor | rooms | what they hold |
//! |---|---|---|
//! | 6 | the binary | starts the command line, returns its exit code |
//! | 5 | `cli` | one file per subcommand; no physics |
//! | 4 | [`config`], [`report`] | files to checked domain objects; results to CSV, JSON and pictures |
//! | 3 | [`placement`], [`assessment`], [`identification`], [`compensation`], [`simulation`] | the jobs: where to put the workpiece; how good a robot is, and how round a profile; how much its joints yield; what to command so that the loaded tool follows the path; how the arm moves while it mills, and whether that stays calm |
//! | 2 | [`stiffness`], [`cutting`] | how the arm yields, what pushes along a tool path |
//! | 1 | [`robot`], [`task`] | what the arm is, what is to be cut |
//! | 0 | [`input`], [`lanes`] | the one error for anything that a file can get wrong; several numbers worked on at once |
//!
//! # From a file to a result
//!
//! ```no_run
//! use std::path::Path;
//! use stead::{config, numerics::monitor::Monitor, placement};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let run = config::read_run(Path::new("configs/caro-2013.toml"))?;
//! let outcome = placement::place::place(&run.problem, &run.search, &run.transfer, &Monitor::silent())?;
//! for case in outcome.cases.all() {
//!     assert!(case.plan.mean >= 0.0);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! # Conventions
//!
//! SI units and radians everywhere inside; files carry the unit in the name of the field. A transform `a_from_b` takes
//! coordinates in b to coordinates in a. Library code returns typed errors: it does not print, exit or panic. The same
//! input and seed give the same bytes for any number of threads: random numbers are counter-based, reductions run in a
//! fixed order, and transcendental functions come from `libm` or from [`lanes`], not from the
//! C library of the machine.

pub use stead_assessment as assessment;
pub use stead_calibration::{compensation, identification};
pub use stead_format as config;
pub use stead_format::input;
pub use stead_model::{cutting, robot, stiffness, task};
pub use stead_numerics as numerics;
pub use stead_numerics::simd as lanes;
pub use stead_placement as placement;
pub use stead_report as report;
pub use stead_simulation as simulation;
