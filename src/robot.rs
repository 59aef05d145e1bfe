//! Arms alone: the poses of joint angles, and the arms that stead ships with.

pub use stead_model::robot::ShippedArm;

use crate::Error;
use crate::result::result;
use std::path::Path;
use stead_disk::input::{InputFile, input_file};
use stead_format::catalogue;
use stead_format::robot::geometry_file;
use stead_format::spindle::read_spindle;
use stead_model::robot::{Robot, Spindle};
use stead_numerics::message::Note;
use stead_report::robot::{ArmPose, pose_json, pose_text, robots_json, robots_text};

/// A robot file of which only geometry, limits and controller count: its stiffness need not be known.
///
/// ```
/// let arm = stead::robot::Arm::read("name:kuka-kr210-r2700")?;
/// let pose = arm.pose_of_controller([0.0, -90.0, 90.0, 0.0, 0.0, 0.0])?;
/// // The home pose that every KUKA arm has: the flange looks forwards, its x axis down.
/// assert_eq!(pose.to_json()["frames"][1]["abc_deg"], serde_json::json!([0.0, 90.0, 0.0]));
/// # Ok::<(), stead::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Arm {
    robot: Robot,
    spindle: Option<Spindle>,
    inputs: Vec<InputFile>,
}

impl Arm {
    /// Reads a robot file, or a shipped arm for `name:` and its name.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn read(file: impl AsRef<Path>) -> Result<Self, Error> {
        let (robot, bytes) = geometry_file(file.as_ref())?;
        let input = input_file("robot", file.as_ref().to_string_lossy().replace('\\', "/"), &bytes);
        Ok(Self { robot, spindle: None, inputs: vec![input] })
    }

    /// The same arm with the spindle of a file that has a table `[spindle]`, as a run file.
    ///
    /// # Errors
    /// [`Error::Input`] with file, line, field, value found and what is allowed.
    pub fn with_tool_of(mut self, file: impl AsRef<Path>) -> Result<Self, Error> {
        let (spindle, bytes) = read_spindle(file.as_ref())?;
        self.inputs.push(input_file("spindle", file.as_ref().to_string_lossy().replace('\\', "/"), &bytes));
        self.spindle = Some(spindle);
        Ok(self)
    }

    /// The files that were read.
    pub(crate) fn inputs(&self) -> &[InputFile] {
        &self.inputs
    }

    /// The kinematics of the arm.
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Flange and tool at joint angles of the rows, and all postures of that flange pose. deg
    ///
    /// # Errors
    /// [`Error::Argument`] for an angle that is not finite.
    pub fn pose_of(&self, joints_deg: [f64; 6]) -> Result<PoseOfArm, Error> {
        self.pose_at(joints_deg.map(f64::to_radians))
    }

    /// The same at angles of the controller. deg
    ///
    /// # Errors
    /// [`Error::Argument`] for an angle that is not finite, and where the robot file does not say how the controller
    /// counts.
    pub fn pose_of_controller(&self, angles_deg: [f64; 6]) -> Result<PoseOfArm, Error> {
        let controller = self.robot.controller().ok_or_else(|| {
            Error::Argument(
                "the robot file does not say how the controller counts: it has no table [controller]".to_owned(),
            )
        })?;
        self.pose_at(controller.joints(&self.robot, &angles_deg.map(f64::to_radians)))
    }

    fn pose_at(&self, joints: [f64; 6]) -> Result<PoseOfArm, Error> {
        if joints.iter().any(|angle| !angle.is_finite()) {
            return Err(Error::Argument("joint angles must be finite numbers".to_owned()));
        }
        let Self { robot, spindle, inputs } = self.clone();
        let pose = ArmPose { robot, joints, spindle, inputs };
        let notes = pose.notes();
        Ok(PoseOfArm { pose, notes })
    }
}

/// An arm at given joint angles: its frames, and all postures of that flange pose.
#[derive(Debug, Clone)]
pub struct PoseOfArm {
    pose: ArmPose,
    notes: Vec<Note>,
}

result! { PoseOfArm, self {
    document = pose_json(&self.pose);
    table = pose_text(&self.pose);
    notes = self.notes;
} }

/// The arms that stead ships with.
#[derive(Debug, Clone)]
pub struct ShippedArms {
    arms: Vec<ShippedArm>,
}

impl ShippedArms {
    /// All of them, in the order of their names.
    ///
    /// # Errors
    /// [`Error::Input`] where a shipped file is wrong, which the tests exclude.
    pub fn all() -> Result<Self, Error> {
        Ok(Self { arms: catalogue::shipped_arms()? })
    }

    /// The robot file of one of them, by its name, to begin one's own with.
    ///
    /// # Errors
    /// [`Error::Input`] where there is no arm of this name.
    pub fn file(name: &str) -> Result<&'static str, Error> {
        Ok(catalogue::robot_file(name)?)
    }

    /// Each with what is known of it.
    pub fn arms(&self) -> &[ShippedArm] {
        &self.arms
    }
}

result! { ShippedArms, self {
    document = robots_json(&self.arms);
    table = robots_text(&self.arms);
} }
