//! **stead** finds where to put a workpiece in a robot cell so that the robot machines it most accurately.
//!
//! An industrial arm is some fifty times softer than a machine tool, and its softness changes with its pose. So the place of
//! the workpiece, the posture of the arm and the free rotation of the spindle about the tool axis decide how well it
//! machines. stead takes a robot, a spindle, a tool path with cutting forces and the volume in which the workpiece may
//! stand, and finds the best placement, and the worst to show what is at stake (Caro et al. 2013).
//!
//! ```no_run
//! let run = stead::Run::read("configs/caro-2013.toml")?;
//! let placements = run.place(&stead::Monitor::silent())?;
//! placements.write("results/mine")?;
//! # Ok::<(), stead::Error>(())
//! ```
//!
//! There is one type for each kind of input file, with `read`, and one for each kind of result, with `write` for the files that
//! the command of the same name leaves, `to_json` and [`Display`](std::fmt::Display) for what it prints:
//!
//! | read | do | result | command |
//! |---|---|---|---|
//! | [`Run`] | [`place`](Run::place) | [`Placements`] | `stead place` |
//! | [`Run`] | [`score`](Run::score) | [`PlacementScore`] | `stead score` |
//! | [`Run`] | [`explain`](Run::explain) | [`Explanations`] | `stead explain` |
//! | | [`write_page`] | | `stead page` |
//! | [`Run`] | [`export`](Run::export) | [`ExportedProgram`] | `stead export` |
//! | [`Run`] | [`check_program`](Run::check_program) | [`CheckedProgram`] | `stead export --check` |
//! | [`Study`] | [`run`](Study::run) | [`Finished`] | `stead study run` |
//! | [`AssessmentRun`] | [`assess`](AssessmentRun::assess) | [`RobotAssessment`] | `stead assess` |
//! | [`FitRun`] | [`fit`](FitRun::fit) | [`IdentifiedRobot`] | `stead identify fit` |
//! | [`DesignRun`] | [`plan`](DesignRun::plan) | [`MeasurementPlan`] | `stead identify plan` |
//! | [`CompensationRun`] | [`compensate`](CompensationRun::compensate) | [`CompensatedPath`] | `stead compensate` |
//! | [`SimulationRun`] | [`simulate`](SimulationRun::simulate) | [`SimulatedPass`] | `stead simulate` |
//! | [`StabilityRun`] | [`analyse`](StabilityRun::analyse) | [`StabilityAnalysis`] | `stead stability` |
//! | | [`Checked::read`] | [`Checked`] | `stead check` |
//! | [`Arm`] | [`pose_of`](Arm::pose_of) | [`PoseOfArm`] | `stead pose` |
//! | [`Profile`] | [`circularity`](Profile::circularity) | [`Circularity`] | `stead circularity` |
//!
//! The [`guide`] has a page per command, the files with all their keys, the conventions, the method and its validation.
//!
//! [`init`] writes a commented starter set of files, [`import_robot`] makes a robot file of a URDF, [`import_path`] a task file
//! of a tool path from CAM, [`schema`] gives the JSON Schema of a kind of file. A [`Monitor`] shows the progress of a long job and stops it. Jobs use the threads of the rayon pool that they are called in; the
//! number of threads does not change a result.
//!
//! # Conventions
//!
//! SI units and radians everywhere inside; files carry the unit in the name of the field. A transform `a_from_b` takes
//! coordinates in b to coordinates in a. Library code returns typed errors: it does not print, exit or panic. The same
//! input and seed give the same bytes for any number of threads: random numbers are counter-based, reductions run in a
//! fixed order, and transcendental functions do not come from the C library of the machine.

/// The most threads that a job is given: more are a slip, and a machine that is asked for them may not answer.
pub const MAX_THREADS: usize = 1024;

mod assessment;
mod check;
mod circularity;
mod compensation;
mod error;
mod export;
pub mod guide;
mod identification;
mod page;
mod result;
mod robot;
mod run;
mod score;
mod simulation;
mod study;

pub use assessment::{AssessmentRun, RobotAssessment};
pub use check::Checked;
pub use circularity::{Circularity, Profile};
pub use compensation::{CompensatedPath, CompensationRun};
pub use error::Error;
pub use export::{CheckedProgram, ExportedProgram};
pub use identification::{DesignRun, FitRun, IdentifiedRobot, MeasurementPlan};
pub use page::write_page;
pub use robot::{Arm, PoseOfArm, ShippedArms};
pub use run::{Placements, Run};
pub use score::{Explanations, PlacementScore};
pub use simulation::{SimulatedPass, SimulationRun, StabilityAnalysis, StabilityRun, overrides};
pub use stead_assessment::roundness::Sector;
pub use stead_format::cam::gcode::Machine;
pub use stead_format::cam::{
    CamFormat, ImportedPath, LengthUnit, ReadSettings as PathSettings, Resampling, import_path,
};
pub use stead_format::catalogue::ShippedArm;
pub use stead_format::field::{FieldOverride, FieldPath};
pub use stead_format::init::{StarterSet, init, init_run};
pub use stead_format::input::InputError;
pub use stead_format::program::check::{Largest, MovePlace, ProgramCheck, ReadBackOptions};
pub use stead_format::program::{
    CorrectedPath, ExportOptions, OperatorFrame, Program, ProgramFile, ProgramFormat, Rotation,
};
pub use stead_format::schema::schema;
pub use stead_format::study::{AxisValue, StudyCase};
pub use stead_format::urdf::{Deviation, HomePose, ImportOptions, ImportedRobot, ImportedRow, import_robot};
pub use stead_format::{Existing, Overrides};
pub use stead_numerics::message::Warning;
pub use stead_numerics::monitor::{Monitor, Progress, Stop, StopHandle};
pub use stead_placement::problem::Placement;
pub use stead_report::document::Timing;
pub use stead_report::{Folder, ReportError};
pub use stead_simulation::arm::Variant;
pub use stead_study::analysis::{Analysis as StudyAnalysis, Question as StudyQuestion, SEARCH_NOISE};
pub use stead_study::cases::{
    Cell, Column, Finished, Kind as ColumnKind, PlannedCase, Shard, ShardStatus, StudyError, StudyStatus, Table,
    slurm_script,
};
pub use study::{Study, StudyReport};
