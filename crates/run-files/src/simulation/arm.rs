//! The arm of a simulation file and the pass that it makes.

use super::file::{PassTable, SimulationFile};
use stead_disk::input::{InputError, InputFile};
use stead_format::place::Place;
use stead_format::robot::moving_robot_from;
use stead_format::scalars::words;
use stead_model::robot::{Robot, Spindle};
use stead_simulation::arm::Variant;
use stead_simulation::motion::{Motion, MotionError, Pass, Ramp};
use stead_simulation::setup::Setup;

/// What the command line puts in place of the file's.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overrides {
    /// The variant.
    pub variant: Option<Variant>,
    /// What all damping is multiplied with.
    pub damping_scale: Option<f64>,
    /// The spindle speed. rad/s
    pub spindle_speed: Option<f64>,
}

/// The arm and its pass; the robot file is added to `inputs`.
///
/// # Errors
/// [`InputError`] with file, line and field: a robot or spindle without what the variant needs, a pass that the arm
/// cannot make.
pub(super) fn setup_from(
    file: &SimulationFile,
    at: &Place<'_>,
    overrides: &Overrides,
    inputs: &mut Vec<InputFile>,
) -> Result<Setup, InputError> {
    let variant = overrides.variant.or(file.variant.map(|word| word.0)).unwrap_or(Variant::Springs);
    let damping_scale = overrides.damping_scale.or(file.damping_scale.map(|scale| scale.si())).unwrap_or(1.0);
    let spindle = file.spindle.moving_spindle(&at.key("spindle"))?;
    let (source, input) = at.key("robot").named_toml("robot")?;
    let robot = moving_robot_from(&source, variant >= Variant::Orthogonal)?;
    let robot = match &file.mount {
        Some(table) => robot.mounted(&table.cell_from_base(&at.key("mount"))?),
        None => robot,
    };
    inputs.push(input);
    let motion = motion_from(&file.pass, &at.key("pass"), &robot, &spindle)?;
    Ok(Setup { robot, spindle, variant, damping_scale, motion })
}

words!(Variant);

/// The feed may be off the plane normal to the tool axis by so much. deg
const TILT_DEG: f64 = 1.0;

fn motion_from(table: &PassTable, at: &Place<'_>, robot: &Robot, spindle: &Spindle) -> Result<Motion, InputError> {
    let (start, direction) = (table.start_joints_deg.si(), table.feed_direction.vector());
    let axis = robot.forward(&start).then(&spindle.flange_from_tool).rotation.column(2).into_owned();
    let norm = direction.norm();
    if !(norm > 1e-6 && norm.is_finite()) {
        return Err(at.key("feed_direction").error("is no direction", "three numbers, not all of them 0"));
    }
    let pass = Pass { start, direction: direction / norm, length: table.length_mm.si() };
    let tilt = libm::asin(pass.direction.dot(&axis).clamp(-1.0, 1.0)).to_degrees();
    if tilt.abs() > TILT_DEG {
        let problem = format!("is {tilt:.2} deg off the plane normal to the tool axis");
        let allowed = format!("a feed normal to the tool axis, within {TILT_DEG} deg");
        return Err(at.key("feed_direction").error(problem, allowed));
    }
    let ramp = Ramp { feed: table.feed_mm_per_min.si(), time: table.ramp_s.si() };
    Motion::new(robot, spindle, &pass, ramp).map_err(|error| {
        let at_start = matches!(
            error,
            MotionError::Limit { distance_mm, .. } | MotionError::Singular { distance_mm } | MotionError::Unreachable { distance_mm, .. }
            if distance_mm == 0.0
        );
        let key = if at_start { "start_joints_deg" } else { "length_mm" };
        let allowed = "a pass that the arm can make in the posture of its start";
        at.key(key).error(format!("asks for what the arm cannot do: {error}"), allowed)
    })
}
