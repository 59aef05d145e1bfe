//! Robot files.

mod compliance;
mod controller;
pub mod covariance;
mod dynamics;
mod file;
mod lender;
mod one_or_pair;
mod springs;

pub use file::{Axes23Table, CompensatorTable, ControllerTable, CovarianceTable, JointRow, RobotFile, RootTable};
pub(crate) use lender::{NoLender, lender, lent_urad_per_nm};
pub use one_or_pair::{OneOrPair, OneOrRange};
pub use springs::checked_to_score;

use crate::place::Place;
use crate::quantity::Quantity;
use crate::toml_file::TomlFile;
use compliance::{COMPENSATOR, COMPLIANCE, STIFFNESS, compliance_from};
use controller::with_controller;
use covariance::{COVARIANCE, with_covariance};
pub use dynamics::checked_to_move;
use dynamics::dynamics_from;
use springs::with_springs;
use std::path::Path;
use stead_disk::input::{InputError, InputFile};
use stead_disk::quote::garbles;
use stead_model::robot::turns::Range;
use stead_model::robot::{Axes23, Compliance, DataSheet, Joint, Robot, RobotError, SpringModel};

/// Reads a robot file: the keys of [`RobotFile`].
///
/// # Errors
/// [`InputError`] with line and field: a file that cannot be read or is no TOML, a missing or unknown key, a value of
/// the wrong kind, an arm that [`Robot::new`] refuses, or a covariance that
/// [`Uncertainty::new`](stead_model::robot::Uncertainty::new) refuses.
pub fn read_robot(file: &Path) -> Result<Robot, InputError> {
    robot_from(&TomlFile::read(file)?)
}

/// Reads a robot file for its geometry, limits and controller alone: rows may lack a stiffness, and those that do get
/// [`NOMINAL_STIFFNESS`].
///
/// # Errors
/// As [`read_robot`].
pub fn read_geometry(file: &Path) -> Result<Robot, InputError> {
    geometry_file(file).map(|(robot, _)| robot)
}

/// As [`read_geometry`], with the bytes of the file.
///
/// # Errors
/// As [`read_robot`].
pub fn geometry_file(file: &Path) -> Result<(Robot, Vec<u8>), InputError> {
    let source = TomlFile::read(file)?;
    Ok((geometry_from(&source)?, source.bytes().to_vec()))
}

/// Of a joint whose stiffness is unknown and does not matter. N m/rad
pub const NOMINAL_STIFFNESS: f64 = 1e6;

/// As [`read_geometry`], from a file already read.
pub fn geometry_from(source: &TomlFile) -> Result<Robot, InputError> {
    let document = source.parse()?;
    let mut file: RobotFile = document.read()?;
    // What is said of compliances belongs to the rows that state them.
    file.covariance = None;
    made(&file, &document.root(), |row, at| match row.has_stiffness() {
        true => compliance_from(row, at),
        false => Ok((1.0 / NOMINAL_STIFFNESS).into()),
    })
}

/// Of a robot file, whether it states the stiffness of every joint; nothing of a file of another kind, known by its
/// having no `[[joints]]`.
///
/// # Errors
/// [`InputError`]: a file that cannot be read or is no TOML, and what is wrong in a robot file.
pub fn says_stiffness(file: &Path) -> Result<Option<bool>, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    if !document.root().key("joints").is_given() {
        return Ok(None);
    }
    let file: RobotFile = document.read()?;
    Ok(Some(file.joints.iter().all(JointRow::has_stiffness)))
}

/// Angles of a robot file that look like radians, in sentences.
///
/// # Errors
/// [`InputError`]: a file that cannot be read or is no TOML.
pub fn robot_radians(file: &Path) -> Result<Vec<String>, InputError> {
    let source = TomlFile::read(file)?;
    let document = source.parse()?;
    Ok(document.root().radians("robot."))
}

/// As [`read_robot`], from a file already read.
pub fn robot_from(source: &TomlFile) -> Result<Robot, InputError> {
    let document = source.parse()?;
    made(&document.read()?, &document.root(), compliance_from)
}

/// As [`robot_from`], for a robot whose motion is to be computed; with `orthogonal`, in directions normal to its axes
/// too.
///
/// # Errors
/// Those of [`robot_from`], and [`InputError`] at the first joint whose row says too little, naming what is missing.
pub fn moving_robot_from(source: &TomlFile, orthogonal: bool) -> Result<Robot, InputError> {
    checked_to_move(robot_from(source)?, source, orthogonal)
}

/// The robot of a file whose rows state no stiffness, with that of a shipped arm, and the entry of that arm among the
/// inputs; nothing of a file with a row that states one. `at` is the key that names the other arm.
///
/// # Errors
/// As [`read_robot`], and [`InputError`] at the key where no shipped arm of this name has a stiffness.
pub fn robot_like(source: &TomlFile, other: &str, at: &Place<'_>) -> Result<Option<(Robot, InputFile)>, InputError> {
    let document = source.parse()?;
    let mut file: RobotFile = document.read()?;
    if file.joints.iter().any(JointRow::has_stiffness) {
        return Ok(None);
    }
    let refused = |no: NoLender| {
        let problem = format!("{}, and {} states no joint stiffness of its own", no.problem, file.name);
        at.error(problem, no.allowed)
    };
    let (other, input) = lender(other).map_err(refused)?;
    file.stiffness_like = Some(other.name);
    (file.stiffness_model, file.stiffness_measured_from) = (other.stiffness_model, other.stiffness_measured_from);
    if other.stiffness_model.is_some_and(|model| model.0 == SpringModel::Full) {
        for (row, lender) in file.joints.iter_mut().zip(&other.joints) {
            row.lent_normal_springs(lender);
        }
    }
    let mut lent = other.joints.iter().map(|row| lent_urad_per_nm(row).unwrap_or_default() * 1e-6);
    made(&file, &document.root(), |_, _| Ok(lent.next().unwrap_or_default().into())).map(|robot| Some((robot, input)))
}

/// The robot of a file, with a compliance of each row by a function.
fn made(
    file: &RobotFile,
    at: &Place<'_>,
    mut compliance: impl FnMut(&JointRow, &Place<'_>) -> Result<Compliance, InputError>,
) -> Result<Robot, InputError> {
    if file.name.contains(garbles) {
        let rule = "a text in quotes on one line";
        return Err(at.key("name").error("has a line break or another control in it", rule));
    }
    let data_sheet = DataSheet {
        payload: file.payload_kg.map(Quantity::si),
        working_radius: file.working_radius_mm.map(Quantity::si),
        price: file.price_eur.map(Quantity::si),
    };
    let rows = at.key("joints");
    let not_six = || {
        let rule = "six tables [[joints]], base first";
        rows.error("does not make a six-axis arm", rule).found(format!("{} rows", file.joints.len()))
    };
    let joints: &[JointRow; 6] = file.joints.as_slice().try_into().map_err(|_| not_six())?;
    let mut arm = Vec::with_capacity(6);
    for (row, number) in joints.iter().zip(1..) {
        let at = rows.element(number);
        arm.push(joint_from(row, compliance(row, &at)?));
    }
    let robot = Robot::new(&file.name, arm.try_into().map_err(|_| not_six())?);
    let axes_2_3 = file.axes_2_3.map(|table| Axes23 {
        linkage: table.linkage.unwrap_or(false),
        sum: Range { min: table.sum_min_deg.si(), max: table.sum_max_deg.si() },
    });
    let robot = robot.and_then(|robot| robot.with_data_sheet(data_sheet)?.with_axes_2_3(axes_2_3));
    let robot = robot.map_err(|error| locate(at, &error))?;
    let robot = with_stiffness_like(robot, file.stiffness_like.as_deref(), at)?;
    let robot = robot.with_unverified(file.unverified.as_ref().map_or_else(Vec::new, |list| list.0.clone()));
    let robot = robot.with_flange(file.flange_mm.map_or(0.0, Quantity::si));
    let robot = with_controller(robot, file, at)?;
    let robot = with_springs(robot, file, at)?;
    let robot = match dynamics_from(joints, &rows)? {
        Some(dynamics) => robot.with_dynamics(dynamics),
        None => robot,
    };
    match &file.covariance {
        Some(covariance) => with_covariance(robot, covariance, &at.key(COVARIANCE)),
        None => Ok(robot),
    }
}

/// The key of robot and run files for the arm whose stiffness is taken.
const STIFFNESS_LIKE: &str = "stiffness_like";

/// The robot with a stiffness that is that of another arm, where a file says so.
///
/// # Errors
/// [`InputError`] for a name that is none.
fn with_stiffness_like(robot: Robot, other: Option<&str>, at: &Place<'_>) -> Result<Robot, InputError> {
    match other {
        None => Ok(robot),
        Some(name) if !name.contains(garbles) => Ok(robot.with_stiffness_like(name)),
        Some(_) => {
            let rule = "the name of the other arm, a text on one line";
            Err(at.key(STIFFNESS_LIKE).error("has a line break or another control in it", rule))
        }
    }
}

fn joint_from(row: &JointRow, compliance: Compliance) -> Joint {
    Joint {
        alpha: row.alpha_deg.si(),
        a: row.a_mm.si(),
        d: row.d_mm.si(),
        min: row.min_deg.si(),
        max: row.max_deg.si(),
        max_speed: row.max_speed_deg_per_s.map(Quantity::si),
        max_acceleration: row.max_acceleration_deg_per_s2.map(Quantity::si),
        max_jerk: row.max_jerk_deg_per_s3.map(Quantity::si),
        compliance,
    }
}

/// A broken rule of the arm, at its line of the file.
fn locate(root: &Place<'_>, error: &RobotError) -> InputError {
    const POSITIVE: &str = "a number that is finite and above 0 in SI units";
    let row = |joint: usize| root.key("joints").element(joint);
    let (joint, name, problem, allowed) = match error {
        RobotError::DataSheet { field, value } => {
            return root.key(key(field)).error(format!("is {value} in SI units"), POSITIVE);
        }
        RobotError::Sum { field, reason } => {
            const ALLOWED: &str = "sum_min_deg below sum_max_deg, both within what min_deg and max_deg of joints 2 and 3 \
                                   allow, each less than 360 deg apart; with linkage one compliance of joint 3";
            return root.key("axes_2_3").key(key(field)).error(reason.clone(), ALLOWED);
        }
        RobotError::NotFinite { joint, field, value } => {
            (*joint, *field, format!("is {value} in SI units"), "a number that is finite in SI units")
        }
        RobotError::NotPositive { joint, field, value } => {
            (*joint, *field, format!("is {value} in SI units"), "a number above 0 in SI units")
        }
        RobotError::Negative { joint, field, value } => {
            (*joint, *field, format!("is {value} in SI units"), "a number not below 0 in SI units")
        }
        RobotError::Limits { joint, .. } => {
            let max = row(*joint).key("max_deg").written();
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
    let in_radians = row.radians("").into_iter().next();
    let problem = in_radians.map_or(problem.clone(), |note| format!("{problem} ({note})"));
    let field = match name.strip_prefix("compensator.") {
        Some(name) => row.key(COMPENSATOR).key(key(name)),
        None if name == "compliance" && !row.key(COMPLIANCE).is_given() => row.key(STIFFNESS),
        None => row.key(key(name)),
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
        "sum_min" => "sum_min_deg",
        "sum_max" => "sum_max_deg",
        "max" => "max_deg",
        "max_speed" => "max_speed_deg_per_s",
        "max_acceleration" => "max_acceleration_deg_per_s2",
        "max_jerk" => "max_jerk_deg_per_s3",
        "compliance" => COMPLIANCE,
        "spring_stiffness" => "spring_stiffness_n_per_mm",
        "free_length" => "free_length_mm",
        "payload" => "payload_kg",
        "working_radius" => "working_radius_mm",
        "price" => "price_eur",
        other => other,
    }
}

#[cfg(test)]
mod tests;
