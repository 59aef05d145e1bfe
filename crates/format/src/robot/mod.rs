//! Robot files.

mod compliance;
pub mod covariance;
mod dynamics;

use super::reader::{Field, Table};
use super::source::Source;
use crate::input::InputError;
use compliance::{COMPENSATOR, COMPLIANCE, STIFFNESS, compliance_from};
use covariance::{COVARIANCE, with_covariance};
pub(super) use dynamics::moving_robot_from;
use std::path::Path;
use stead_model::robot::{DataSheet, Joint, Robot, RobotError};

/// Reads a robot file: `name`, `source` (where its numbers come from), where known `payload_kg`, `working_radius_mm` and
/// `price_eur`, and six rows `[[joints]]`, base first, each with `alpha_deg`, `a_mm`, `d_mm`, `min_deg`, `max_deg`, either
/// `stiffness_mnm_per_rad` (in MN m/rad) or `compliance_urad_per_nm`, and where known `max_speed_deg_per_s`,
/// `max_acceleration_deg_per_s2` and `max_jerk_deg_per_s3`.
///
/// `compliance_urad_per_nm` may be a range `[at min_deg, at max_deg]` ([`Compliance::Range`](stead_model::robot::Compliance::Range)). A row may be followed by a
/// table `[joints.compensator]` with `spring_stiffness_n_per_mm`, `a_mm`, `l_mm`, `alpha_deg` and `free_length_mm`
/// ([`Compensator`](stead_model::robot::Compensator)); its stiffness or compliance is then that of the joint alone. A table
/// `[covariance]` at the end says how well the compliances are known ([`covariance`]).
///
/// Where its motion is to be computed, every row has `mass_kg`, `centre_of_mass_mm`, `inertia_kg_m2` (of the link behind the
/// joint, in the frame of the row) and `damping_nms_per_rad`, and may have `half_backlash_arcsec`, `gravity_compensated`,
/// `orthogonal_stiffness_mnm_per_rad`, `orthogonal_damping_nms_per_rad` and `bearing_mm`
/// ([`JointDynamics`](stead_model::robot::JointDynamics)).
///
/// # Errors
/// [`InputError`] with line and field: a file that cannot be read or is no TOML, a missing or unknown key, a value of
/// the wrong kind, an arm that [`Robot::new`] refuses, or a covariance that
/// [`Uncertainty::new`](stead_model::robot::Uncertainty::new) refuses.
pub fn read_robot(file: &Path) -> Result<Robot, InputError> {
    robot_from(&Source::read(file)?)
}

/// As [`read_robot`], from a file already read.
pub(super) fn robot_from(source: &Source) -> Result<Robot, InputError> {
    let document = source.parse()?;
    let [name, origin, payload, radius, price, joints, covariance] =
        Table::root(&document).fields(["name", "source", PAYLOAD, RADIUS, PRICE, "joints", COVARIANCE])?;
    let rule = "a text in quotes on one line";
    let name = name.string().and_then(|text| {
        if text.chars().any(char::is_control) {
            Err(name.error("has a line break or another control in it", rule))
        } else {
            Ok(text)
        }
    })?;
    origin.string()?;
    let data_sheet = DataSheet {
        payload: payload.optional(Field::positive)?,
        working_radius: radius.optional(Field::positive)?.map(|mm| mm / 1e3),
        price: price.optional(Field::positive)?,
    };
    let rows = joints.tables()?;
    let count = rows.len();
    let rows: [Table<'_>; 6] = rows.try_into().map_err(|_| {
        joints.error("does not make a six-axis arm", "six tables [[joints]], base first").found(format!("{count} rows"))
    })?;
    let mut arm = Vec::with_capacity(6);
    for row in &rows {
        arm.push(joint_from(row)?);
    }
    let arm: [Joint; 6] = arm.try_into().map_err(|_| joints.error("does not make a six-axis arm", "six rows"))?;
    let robot = Robot::new(name, arm).and_then(|robot| robot.with_data_sheet(data_sheet));
    let robot = robot.map_err(|error| locate(&Table::root(&document), &rows, &error))?;
    let robot = match dynamics::dynamics_from(&rows)? {
        Some(dynamics) => robot.with_dynamics(dynamics),
        None => robot,
    };
    match covariance.optional(Field::table)? {
        Some(table) => with_covariance(robot, &table),
        None => Ok(robot),
    }
}

fn joint_from(row: &Table<'_>) -> Result<Joint, InputError> {
    let [mass, centre, inertia, damping, backlash, compensated, normal, normal_damping, bearing] = dynamics::KEYS;
    let [alpha, a, d, min, max, stiffness, compliance, speed, acceleration, jerk, compensator, ..]: [Field<'_>; 20] =
        row.fields([
            "alpha_deg",
            "a_mm",
            "d_mm",
            "min_deg",
            "max_deg",
            STIFFNESS,
            COMPLIANCE,
            "max_speed_deg_per_s",
            "max_acceleration_deg_per_s2",
            "max_jerk_deg_per_s3",
            COMPENSATOR,
            mass,
            centre,
            inertia,
            damping,
            backlash,
            compensated,
            normal,
            normal_damping,
            bearing,
        ])?;
    let angle = |field: &Field<'_>| field.positive().map(f64::to_radians);
    Ok(Joint {
        alpha: alpha.number()?.to_radians(),
        a: a.number()? / 1e3,
        d: d.number()? / 1e3,
        min: min.number()?.to_radians(),
        max: max.number()?.to_radians(),
        max_speed: speed.optional(angle)?,
        max_acceleration: acceleration.optional(angle)?,
        max_jerk: jerk.optional(angle)?,
        compliance: compliance_from(&stiffness, &compliance, &compensator)?,
    })
}

const PAYLOAD: &str = "payload_kg";
const RADIUS: &str = "working_radius_mm";
const PRICE: &str = "price_eur";

/// A broken rule of the arm, at its line of the file.
fn locate(root: &Table<'_>, rows: &[Table<'_>; 6], error: &RobotError) -> InputError {
    const POSITIVE: &str = "a number that is finite and above 0 in SI units";
    let row = |joint: usize| &rows[joint.clamp(1, 6) - 1];
    let (joint, name, problem, allowed) = match error {
        RobotError::DataSheet { field, value } => {
            return root.field(key(field)).error(format!("is {value} in SI units"), POSITIVE);
        }
        RobotError::NotFinite { joint, field, value } => {
            (*joint, *field, format!("is {value} in SI units"), "a number that is finite in SI units")
        }
        RobotError::NotPositive { joint, field, value } => {
            (*joint, *field, format!("is {value} in SI units"), "a number above 0 in SI units")
        }
        RobotError::Limits { joint, .. } => {
            let max = row(*joint).field("max_deg").written();
            (*joint, "min", format!("is not below max_deg = {max}"), "a lower limit below the upper limit")
        }
        RobotError::AmbiguousRange { joint, range_deg } => {
            let problem = format!("is a range, but min_deg and max_deg are {range_deg} deg apart");
            (*joint, "compliance", problem, "one number, or limits less than 360 deg apart")
        }
        RobotError::SpringVanishes { joint, angle_deg } => {
            let problem = format!("lets the two ends of the spring meet at {angle_deg} deg");
            (*joint, "compensator.l", problem, "a spring that has a length at every angle from min_deg to max_deg")
        }
        RobotError::GivesWay { joint, angle_deg, stiffness } => {
            let problem = format!("leaves the joint a stiffness of {stiffness} N m/rad at {angle_deg} deg");
            let allowed = "a spring with which the stiffness is above 0 at every angle from min_deg to max_deg";
            (*joint, "compensator.spring_stiffness", problem, allowed)
        }
        RobotError::Geometry { joint, field, reason } => {
            (*joint, *field, reason.clone(), "an elbow arm whose last three axes meet at right angles in one point")
        }
    };
    let row = row(joint);
    let field = match name.strip_prefix("compensator.") {
        Some(name) => row.field(COMPENSATOR).table().map_or_else(|_| row.field(COMPENSATOR), |t| t.field(key(name))),
        None if name == "compliance" && !row.field(COMPLIANCE).is_given() => row.field(STIFFNESS),
        None => row.field(key(name)),
    };
    field.error(problem, allowed)
}

/// The key of a file for a number named by a [`RobotError`].
fn key(name: &str) -> &str {
    match name {
        "alpha" => "alpha_deg",
        "a" => "a_mm",
        "d" => "d_mm",
        "l" => "l_mm",
        "min" => "min_deg",
        "max" => "max_deg",
        "max_speed" => "max_speed_deg_per_s",
        "max_acceleration" => "max_acceleration_deg_per_s2",
        "max_jerk" => "max_jerk_deg_per_s3",
        "compliance" => COMPLIANCE,
        "spring_stiffness" => "spring_stiffness_n_per_mm",
        "free_length" => "free_length_mm",
        "payload" => PAYLOAD,
        "working_radius" => RADIUS,
        "price" => PRICE,
        other => other,
    }
}

#[cfg(test)]
mod tests;
