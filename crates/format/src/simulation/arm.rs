//! The arm of a simulation file and the pass that it makes.

use super::super::reader::{Field, Table};
use super::super::robot::moving_robot_from;
use super::super::spindle::SpindleTable;
use super::super::toml_file::TomlFile;
use crate::input::input_file;
use crate::input::{InputError, InputFile};
use crate::scalars::{Word, Words};
use crate::units::Number;
use crate::units::ranges;
use std::ops::Bound::Included;
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

/// Damping times more than this is none of an arm.
pub const MOST_DAMPING_SCALE: f64 = 1e4;

/// The fields of a simulation file that make a [`Setup`].
pub(super) struct ArmFields<'a> {
    pub robot: Field<'a>,
    pub variant: Field<'a>,
    pub damping_scale: Field<'a>,
    pub spindle: Field<'a>,
    pub pass: Field<'a>,
}

/// Reads the robot file, `[spindle]` and `[pass]`; the robot file is added to `inputs`.
///
/// # Errors
/// [`InputError`] with file, line and field: a robot or spindle without what the variant needs, a pass that the arm cannot
/// make.
pub(super) fn setup_from(
    fields: &ArmFields<'_>,
    overrides: &Overrides,
    inputs: &mut Vec<InputFile>,
) -> Result<Setup, InputError> {
    let variant: Option<Word<Variant>> = fields.variant.read()?;
    let damping_scale: Option<Number<DampingScale>> = fields.damping_scale.read()?;
    let variant = overrides.variant.or(variant.map(|word| word.0)).unwrap_or(Variant::Springs);
    let damping_scale = overrides.damping_scale.or(damping_scale.map(|scale| scale.si())).unwrap_or(1.0);
    let spindle = fields.spindle.read::<SpindleTable>()?.moving_spindle(&fields.spindle)?;
    let named = fields.robot.named_file()?;
    let source = TomlFile::new(&named.file, named.bytes)?;
    let robot = moving_robot_from(&source, variant >= Variant::Orthogonal)?;
    inputs.push(input_file("robot", named.name, source.bytes()));
    let motion = motion_from(&fields.pass.table()?, &robot, &spindle)?;
    Ok(Setup { robot, spindle, variant, damping_scale, motion })
}

ranges! {
    /// A factor on all damping.
    DampingScale: Included(0.0), Included(MOST_DAMPING_SCALE);
}

impl Words for Variant {
    fn words() -> Vec<(&'static str, Self)> {
        Variant::ALL.map(|variant| (variant.word(), variant)).to_vec()
    }
}

/// The key of the feed.
pub(super) const FEED: &str = "feed_mm_per_min";
/// The feed may be off the plane normal to the tool axis by so much. deg
const TILT_DEG: f64 = 1.0;
/// More than this is no pass of an arm. mm
const LONGEST_MM: f64 = 1e4;

/// Reads `[pass]`: `start_joints_deg` (in the angles of the robot file), `feed_direction` in the base frame, `length_mm`,
/// `feed_mm_per_min` and `ramp_s`.
fn motion_from(table: &Table<'_>, robot: &Robot, spindle: &Spindle) -> Result<Motion, InputError> {
    let [start, direction, length, feed, ramp] =
        table.fields(["start_joints_deg", "feed_direction", "length_mm", FEED, "ramp_s"])?;
    let angles: [f64; 6] = start.numbers_where("six angles in deg, of joints 1 to 6 of the robot file", |_| true)?;
    let mut pass =
        Pass { start: angles.map(f64::to_radians), direction: direction.vector3()?, length: LONGEST_MM / 1e3 };
    let axis = robot.forward(&pass.start).then(&spindle.flange_from_tool).rotation.column(2).into_owned();
    let norm = pass.direction.norm();
    if !(norm > 1e-6 && norm.is_finite()) {
        return Err(direction.error("is no direction", "three numbers, not all of them 0"));
    }
    pass.direction /= norm;
    let tilt = libm::asin(pass.direction.dot(&axis).clamp(-1.0, 1.0)).to_degrees();
    if tilt.abs() > TILT_DEG {
        let problem = format!("is {tilt:.2} deg off the plane normal to the tool axis");
        return Err(direction.error(problem, format!("a feed normal to the tool axis, within {TILT_DEG} deg")));
    }
    let short = format!("a number above 0 and not above {LONGEST_MM}");
    pass.length = length.number_where(&short, |value| value > 0.0 && value <= LONGEST_MM)? / 1e3;
    let time = ramp.number_where("a number of seconds from 0 to 10", |value| (0.0..=10.0).contains(&value))?;
    let ramp = Ramp { feed: feed.positive()? / 6e4, time };
    Motion::new(robot, spindle, &pass, ramp).map_err(|error| {
        let at_start = matches!(
            error,
            MotionError::Limit { distance_mm, .. } | MotionError::Singular { distance_mm } | MotionError::Unreachable { distance_mm, .. }
            if distance_mm == 0.0
        );
        let field = if at_start { &start } else { &length };
        field.error(format!("asks for what the arm cannot do: {error}"), "a pass that the arm can make in the posture of its start")
    })
}
