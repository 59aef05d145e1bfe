//! What moves with the joints of a robot file: masses, damping, play, and stiffness normal to the axes.

use super::super::inertial::{CENTRE, INERTIA, MASS, inertial_from};
use super::super::reader::{Field, Table};
use super::super::source::Source;
use super::robot_from;
use crate::input::InputError;
use stead_model::robot::{JointDynamics, Orthogonal, Robot};

const DAMPING: &str = "damping_nms_per_rad";
const BACKLASH: &str = "half_backlash_arcsec";
const COMPENSATED: &str = "gravity_compensated";
const ORTHOGONAL_STIFFNESS: &str = "orthogonal_stiffness_mnm_per_rad";
const ORTHOGONAL_DAMPING: &str = "orthogonal_damping_nms_per_rad";
const BEARING: &str = "bearing_mm";

/// The keys of a joint's row that have to do with motion.
pub(super) const KEYS: [&str; 9] =
    [MASS, CENTRE, INERTIA, DAMPING, BACKLASH, COMPENSATED, ORTHOGONAL_STIFFNESS, ORTHOGONAL_DAMPING, BEARING];

/// What the rows say of motion: nothing where none has any of these keys, else all of them must say enough.
pub(super) fn dynamics_from(rows: &[Table<'_>; 6]) -> Result<Option<[JointDynamics; 6]>, InputError> {
    if !rows.iter().any(|row| KEYS.iter().any(|key| row.field(key).is_given())) {
        return Ok(None);
    }
    let mut joints = Vec::with_capacity(6);
    for row in rows {
        joints.push(joint_from(row)?);
    }
    Ok(joints.try_into().ok())
}

fn joint_from(row: &Table<'_>) -> Result<JointDynamics, InputError> {
    let link = inertial_from(row)?;
    let not_negative = |field: &Field<'_>| field.number_where("a finite number not below 0", |value| value >= 0.0);
    let damping = not_negative(&row.field(DAMPING))?;
    let backlash = row.field(BACKLASH).optional(not_negative)?.unwrap_or_default();
    let [stiffness, friction] = [ORTHOGONAL_STIFFNESS, ORTHOGONAL_DAMPING].map(|key| row.field(key));
    let orthogonal = if stiffness.is_given() || friction.is_given() {
        Some(Orthogonal { stiffness: stiffness.positive()? * 1e6, damping: not_negative(&friction)? })
    } else {
        None
    };
    Ok(JointDynamics {
        link,
        damping,
        backlash: (backlash / 3600.0).to_radians(),
        gravity_compensated: row.field(COMPENSATED).optional(Field::boolean)?.unwrap_or_default(),
        orthogonal,
        bearing: row.field(BEARING).optional(Field::number)?.unwrap_or_default() / 1e3,
    })
}

/// As [`robot_from`], for a robot whose motion is to be computed; with `orthogonal`, in directions normal to its axes too.
///
/// # Errors
/// Those of [`robot_from`], and [`InputError`] at the first joint whose row says too little, naming what is missing.
pub(crate) fn moving_robot_from(source: &Source, orthogonal: bool) -> Result<Robot, InputError> {
    let robot = robot_from(source)?;
    let document = source.parse()?;
    let joints = Table::root(&document).field("joints");
    let lacking = |number: usize, keys: &[&str], what: &str| -> Result<InputError, InputError> {
        let rows = joints.tables()?;
        let row = rows.get(number).ok_or_else(|| joints.error("has too few rows", "six rows"))?;
        let field = keys.iter().map(|key| row.field(key)).find(|field| !field.is_given()).unwrap_or(row.field(MASS));
        Ok(field.error(format!("is missing: {what}"), format!("{} in every [[joints]]", keys.join(", "))))
    };
    match robot.dynamics() {
        None => {
            let what = "this robot file says nothing of masses and damping, so its motion cannot be computed";
            Err(lacking(0, &[MASS, CENTRE, INERTIA, DAMPING], what)?)
        }
        Some(dynamics) => match dynamics.iter().position(|joint| orthogonal && joint.orthogonal.is_none()) {
            Some(joint) => {
                let what = "the variant takes into account how joints yield normal to their axes";
                Err(lacking(joint, &[ORTHOGONAL_STIFFNESS, ORTHOGONAL_DAMPING], what)?)
            }
            None => Ok(robot),
        },
    }
}

#[cfg(test)]
mod tests;
