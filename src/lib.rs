//! **stead** finds where to put a workpiece in a robot cell so that the robot machines it most accurately.
//!
//! An industrial arm is some fifty times softer than a machine tool, and its softness changes with its pose. So the
//! place of the workpiece, the posture of the arm and the free rotation of the spindle about the tool axis decide how
//! well it machines. stead takes a robot, a spindle, a tool path with cutting forces and the volume in which the
//! workpiece may stand, and finds the best placement, and the worst to show what is at stake (Caro et al. 2013).
//!
//! ```no_run
//! let run = stead::Run::read("configs/caro-2013.toml")?;
//! let placements = run.place(&stead::Monitor::silent())?;
//! placements.write("results/mine")?;
//! # Ok::<(), stead::Error>(())
//! ```
//!
//! There is one type for each kind of input file, with `read`, and one for each kind of result, with `write` for the
//! files that the command of the same name leaves, `to_json` and [`Display`](std::fmt::Display) for what it prints:
//!
//! | read | do | result | command |
//! |---|---|---|---|
//! | [`Run`] | [`place`](Run::place) | [`Placements`] | `stead place` |
//! | [`Run`] | [`score`](Run::score) | [`PlacementScore`] | `stead score` |
//! | [`Run`] | [`explain`](Run::explain) | [`Explanations`] | `stead explain` |
//! | | [`report::write_page`] | | `stead page` |
//! | [`Run`] | [`export`](Run::export) | [`program::ExportedProgram`] | `stead export` |
//! | [`Run`] | [`check_program`](Run::check_program) | [`program::CheckedProgram`] | `stead export --check` |
//! | [`Study`] | [`run`](Study::run) | [`study::Finished`] | `stead study run` |
//! | [`AssessmentRun`] | [`assess`](AssessmentRun::assess) | [`RobotAssessment`] | `stead assess` |
//! | [`FitRun`] | [`fit`](FitRun::fit) | [`IdentifiedRobot`] | `stead identify fit` |
//! | [`DesignRun`] | [`plan`](DesignRun::plan) | [`MeasurementPlan`] | `stead identify plan` |
//! | [`forces::ForcesRun`] | [`compute`](forces::ForcesRun::compute) | [`forces::PathForces`] | `stead forces` |
//! | [`CompensationRun`] | [`compensate`](CompensationRun::compensate) | [`CompensatedPath`] | `stead compensate` |
//! | [`SimulationRun`] | [`simulate`](SimulationRun::simulate) | [`SimulatedPass`] | `stead simulate` |
//! | [`StabilityRun`] | [`analyse`](StabilityRun::analyse) | [`StabilityAnalysis`] | `stead stability` |
//! | | [`Checked::read`] | [`Checked`] | `stead check` |
//! | [`robot::Arm`] | [`pose_of`](robot::Arm::pose_of) | [`robot::PoseOfArm`] | `stead pose` |
//! | [`circularity::Profile`] | [`circularity`](circularity::Profile::circularity) | [`circularity::Circularity`] | `stead circularity` |
//!
//! The [`guide`] has a page per command, the files with all their keys, the conventions, the method and its validation.
//!
//! [`files::init`] writes a commented starter set of files, [`import::import_robot`] makes a robot file of a URDF,
//! [`import::import_path`] a task file of a tool path from CAM, [`files::schema`] gives the JSON Schema of a kind of
//! file. A [`Monitor`] shows the progress of a long job and stops it. Jobs use the threads of the rayon pool that they
//! are called in; the number of threads does not change a result.
//!
//! Names are in modules by what they are for: [`placement`] with the problem, built in code, and its outcome, [`model`]
//! (robot, task, stiffness, cutting), [`cell`] (shapes), [`certify`], [`program`], [`study`], [`import`], [`files`],
//! [`report`] and one for each of the other jobs; what most programs need is at the root.
//!
//! # Conventions
//!
//! SI units and radians everywhere inside; files carry the unit in the name of the field. A transform `a_from_b` takes
//! coordinates in b to coordinates in a. Library code returns typed errors: it does not print, exit or panic. The same
//! input and seed give the same bytes for any number of threads: random numbers are counter-based, reductions run in a
//! fixed order, and transcendental functions do not come from the C library of the machine.

#![cfg_attr(not(test), warn(unused_crate_dependencies))]
#![cfg_attr(
    test,
    allow(clippy::too_many_lines, clippy::excessive_nesting, reason = "tests are as long as what they try")
)]

/// The most threads that a job is given: more are a slip, and a machine that starts them may stop responding.
pub const MAX_THREADS: usize = 1024;

// The command line names the library as every other user of it does.
#[cfg(feature = "cli")]
extern crate self as stead;

pub mod assessment;
mod builder;
mod check;
pub mod circularity;
#[cfg(feature = "cli")]
#[doc(hidden)]
#[expect(rustdoc::invalid_html_tags, reason = "comments of options are what the help prints")]
pub mod cli;
pub mod compensation;
mod error;
pub mod files;
pub mod forces;
pub mod guide;
pub mod identification;
pub mod import;
#[cfg(feature = "live")]
pub mod live;
pub mod placement;
pub mod program;
#[cfg(feature = "cli")]
mod progress;
pub mod report;
mod result;
pub mod robot;
mod run;
mod schema;
mod score;
pub mod simulation;
pub mod study;

pub use assessment::{AssessmentRun, RobotAssessment};
pub use builder::{PlaceOptions, RunBuilder};
pub use check::Checked;
pub use compensation::{CompensatedPath, CompensationRun};
pub use error::Error;
pub use identification::{DesignRun, FitRun, IdentifiedRobot, MeasurementPlan};
pub use run::{Placements, Run};
pub use score::{Explanations, PlacementScore};
pub use simulation::{SimulatedPass, SimulationRun, StabilityAnalysis, StabilityRun};
pub use stead_numerics::monitor::{Monitor, Progress};
pub use stead_problem::problem::Placement;
pub use study::Study;

pub mod model {
    //! The robot, its spindle, the tool path with its loads, stiffness and cutting: built in code, or read from files.
    /// The linear algebra of which vectors, rotations and matrices are.
    pub use nalgebra;
    pub use stead_model::{cutting, external_axis, plausibility, published, robot, stiffness, task};
}

pub mod cell {
    //! Shapes around the arm and on it, which are kept apart.
    pub use stead_cell::*;
}

pub mod certify {
    //! Bounds on what any placement can reach.
    pub use stead_certify::*;
    pub use stead_problem::settings::CertificateSettings;
}

pub mod monitor {
    //! How a long job tells how far it is and is stopped, and the warnings of all jobs.
    pub use stead_numerics::message::{Note, NoteGroup, Warning};
    pub use stead_numerics::monitor::{Monitor, Progress, Stop, StopHandle};
}
