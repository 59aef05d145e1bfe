//! The arguments that several commands share: a run file, those that give a placement, and those of a simulation's
//! model.

use super::Failure;
use super::progress::Terminal;
use super::values::{case, damping_scale, field, finite, input_file, quaternion, rpm, variant};
use clap::Args;
use std::path::PathBuf;
use stead::{Error, Run};
use stead_disk::Existing;
use stead_format::field::FieldOverride;
use stead_problem::problem::Placement;
use stead_run_files::Overrides;
use stead_simulation::arm::Variant;

/// A run file, and values in place of its own.
#[derive(Debug, Args)]
#[group(skip)]
pub(super) struct GivenRun {
    /// Run file (TOML)
    #[arg(value_parser = input_file())]
    pub config: PathBuf,
    /// Value in place of that of the run file, or of a file that it names, as cell.z_mm=[-300,0]; may be repeated
    #[arg(long, value_name = "PATH=VALUE", value_parser = field)]
    set: Vec<FieldOverride>,
}

impl GivenRun {
    /// The values in place of those of the file.
    #[cfg(feature = "live")]
    pub fn values(&self) -> &[FieldOverride] {
        &self.set
    }

    /// Reads the run, whose forces may have to be computed, on so many threads.
    pub fn read(&self, terminal: &Terminal, threads: Option<usize>) -> Result<Run, Failure> {
        self.read_with(None, terminal, threads)
    }

    /// The same with a certificate of a gap (relative), where one is requested, whatever the file says of one.
    pub fn read_with(&self, gap: Option<f64>, terminal: &Terminal, threads: Option<usize>) -> Result<Run, Failure> {
        let is_set = |key: &str| self.set.iter().any(|value| value.to_string().starts_with(key));
        let mut values = self.set.clone();
        if let (Some(gap), true, false) = (gap, is_set("certificate."), is_set("certificate.gap_percent=")) {
            // The table that the values make needs one.
            values.push(field(&format!("certificate.gap_percent={}", gap * 100.0)).map_err(Error::Argument)?);
        }
        let run = terminal.on_threads(threads, |monitor| Run::read_with(&self.config, values, monitor))??;
        Ok(match gap {
            Some(gap) => run.with_certificate(gap),
            None => run,
        })
    }
}

/// A placement in numbers, or that of a result.
#[derive(Debug, Args)]
#[group(skip)]
pub(super) struct GivenPlacement {
    /// x of the workpiece origin in mm
    #[arg(long, value_name = "X", value_parser = finite, allow_hyphen_values = true, required_unless_present = "placement_of")]
    x_mm: Option<f64>,
    /// y of the workpiece origin in mm
    #[arg(long, value_name = "Y", value_parser = finite, allow_hyphen_values = true, required_unless_present = "placement_of")]
    y_mm: Option<f64>,
    /// z of the workpiece origin in mm
    #[arg(long, value_name = "Z", value_parser = finite, allow_hyphen_values = true, required_unless_present = "placement_of")]
    z_mm: Option<f64>,
    #[command(flatten)]
    turn: GivenTurn,
    /// Case of the results: 1, the best placement, or 3, the worst [default: 1]
    #[arg(long, value_name = "N", value_parser = case, allow_hyphen_values = true, requires = "placement_of")]
    case: Option<u8>,
    /// Orientation of the part by its name, where the run file has several
    #[arg(long, value_name = "NAME", conflicts_with = "placement_of")]
    orientation: Option<String>,
}

/// The yaw, in one of two ways, or all of a placement.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct GivenTurn {
    /// Yaw of the workpiece as quaternion component Q4 = sin(yaw / 2), -1 to 1
    #[arg(long, value_name = "Q", value_parser = quaternion, allow_hyphen_values = true)]
    q4: Option<f64>,
    /// Yaw of the workpiece in degrees
    #[arg(long, value_name = "A", value_parser = finite, allow_hyphen_values = true)]
    yaw_deg: Option<f64>,
    /// Results folder of `stead place` from the same run file: its exact placement is taken
    #[arg(long, value_name = "RESULTS", conflicts_with_all = ["x_mm", "y_mm", "z_mm"])]
    placement_of: Option<PathBuf>,
}

impl GivenPlacement {
    /// The placement in numbers.
    fn placement(&self) -> Placement {
        let xyz_mm = [self.x_mm, self.y_mm, self.z_mm].map(|mm| mm.unwrap_or(0.0));
        match self.turn.q4 {
            Some(q4) => Placement::from_mm_q4(xyz_mm, q4),
            None => Placement::from_mm_deg(xyz_mm, self.turn.yaw_deg.unwrap_or(0.0)),
        }
    }

    /// A run with its placement: as in the results folder, or in numbers and with the part in an orientation that has
    /// to be named where there are several.
    pub fn of(&self, run: Run) -> Result<(Run, Placement), Failure> {
        match &self.turn.placement_of {
            Some(results) => Ok(run.set_up_as_in(results, self.case.unwrap_or(1))?),
            None => Ok((in_orientation(run, self.orientation.as_deref())?, self.placement())),
        }
    }
}

/// The run with the part in an orientation, which has to be named where there are several.
fn in_orientation(run: Run, name: Option<&str>) -> Result<Run, Failure> {
    let names: Vec<&str> = run.problem().orientations.iter().map(|known| known.name.as_str()).collect();
    match name {
        Some(name) => run.in_orientation(name).map_err(|error| Failure::at("--orientation", error)),
        None if names.len() > 1 => {
            let problem = format!("--orientation: is missing; allowed: {}", names.join(", "));
            Err(Error::Argument(problem).into())
        }
        None => Ok(run),
    }
}

/// What takes the place of a simulation file's.
#[derive(Debug, Args)]
#[group(skip)]
pub(super) struct ModelArguments {
    /// How much of the arm is modelled, instead of the file's: springs, gravity, orthogonal or backlash
    #[arg(long, value_name = "V", value_parser = variant)]
    pub variant: Option<Variant>,
    /// Factor on all damping of the arm, instead of the file's
    #[arg(long, value_name = "S", value_parser = damping_scale, allow_hyphen_values = true)]
    pub damping_scale: Option<f64>,
    /// Spindle speed in rev/min, instead of the file's
    #[arg(long, value_name = "N", value_parser = rpm, allow_hyphen_values = true)]
    pub spindle_rpm: Option<f64>,
}

impl From<&ModelArguments> for Overrides {
    fn from(model: &ModelArguments) -> Self {
        let spindle_speed = model.spindle_rpm.map(|rpm| rpm / 60.0 * std::f64::consts::TAU);
        Self { variant: model.variant, damping_scale: model.damping_scale, spindle_speed }
    }
}

/// Whether files that are there are replaced.
#[derive(Debug, Clone, Copy, Args)]
#[group(skip)]
pub(super) struct Force {
    /// Replace files that are there already
    #[arg(long)]
    force: bool,
}

impl Force {
    pub fn existing(self) -> Existing {
        if self.force { Existing::Replaced } else { Existing::Kept }
    }
}
