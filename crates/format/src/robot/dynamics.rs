//! What moves with the joints of a robot file: masses, damping, play, and stiffness normal to the axes.

use super::file::JointRow;
use super::springs::{ORTHOGONAL_COMPLIANCE, ORTHOGONAL_STIFFNESS};
use crate::inertial::{CENTRE, INERTIA, MASS, inertial_from};
use crate::place::{Place, required};
use crate::quantity::Quantity;
use crate::toml_file::TomlFile;
use stead_disk::input::InputError;
use stead_model::robot::{JointDynamics, Orthogonal, Robot};

const DAMPING: &str = "damping_nms_per_rad";
const ORTHOGONAL_DAMPING: &str = "orthogonal_damping_nms_per_rad";

/// What the rows say of motion: nothing where none has any of the keys for it, else all of them must say enough.
pub(super) fn dynamics_from(rows: &[JointRow; 6], at: &Place<'_>) -> Result<Option<[JointDynamics; 6]>, InputError> {
    if !rows.iter().any(JointRow::says_motion) {
        return Ok(None);
    }
    let mut joints = Vec::with_capacity(6);
    for (row, number) in rows.iter().zip(1..) {
        joints.push(joint_from(row, &at.element(number))?);
    }
    Ok(joints.try_into().ok())
}

impl JointRow {
    /// Whether the row has any of the keys that have to do with motion; springs normal to the axis do without.
    fn says_motion(&self) -> bool {
        self.mass_kg.is_some()
            || self.centre_of_mass_mm.is_some()
            || self.inertia_kg_m2.is_some()
            || self.damping_nms_per_rad.is_some()
            || self.half_backlash_arcsec.is_some()
            || self.gravity_compensated.is_some()
            || self.orthogonal_damping_nms_per_rad.is_some()
    }
}

fn joint_from(row: &JointRow, at: &Place<'_>) -> Result<JointDynamics, InputError> {
    let is_orthogonal = row.has_normal_springs() || row.orthogonal_damping_nms_per_rad.is_some();
    Ok(JointDynamics {
        link: inertial_from(row.mass_kg, row.centre_of_mass_mm, row.inertia_kg_m2, at)?,
        damping: required!(at, row.damping_nms_per_rad)?.si(),
        backlash: row.half_backlash_arcsec.map_or(0.0, Quantity::si),
        gravity_compensated: row.gravity_compensated.unwrap_or_default(),
        orthogonal: if is_orthogonal {
            Some(Orthogonal {
                stiffness: match row.orthogonal_compliance_urad_per_nm {
                    Some(compliance) => compliance.both().map(|compliance| 1.0 / compliance.si()),
                    None => required!(at, row.orthogonal_stiffness_mnm_per_rad)?.both().map(Quantity::si),
                },
                damping: required!(at, row.orthogonal_damping_nms_per_rad)?.both().map(Quantity::si),
            })
        } else {
            None
        },
        bearing: row.bearing_mm.map_or(0.0, Quantity::si),
    })
}

/// The robot read from `source`, if its rows say enough for its motion to be computed, as
/// [`moving_robot_from`](super::moving_robot_from) has it.
///
/// # Errors
/// [`InputError`] at the first joint whose row says too little, naming what is missing.
pub fn checked_to_move(robot: Robot, source: &TomlFile, orthogonal: bool) -> Result<Robot, InputError> {
    let document = source.parse()?;
    if robot.has_linkage() {
        let problem = "is an arm whose motion is not computed: the masses of its rods are in no row, and springs are taken joint by joint";
        let allowed = "an arm without a linkage for simulate, stability and [stability]";
        return Err(document.root().key("axes_2_3").key("linkage").error(problem, allowed));
    }
    let lacking = |index: usize, keys: &[&str], what: &str| {
        let row = document.root().key("joints").element(index + 1);
        let key = keys.iter().find(|key| !row.key(key).is_given()).unwrap_or(&MASS);
        row.key(key).error(format!("is missing: {what}"), format!("{} in every [[joints]]", keys.join(", ")))
    };
    let Some(dynamics) = robot.dynamics() else {
        let what = "this robot file says nothing of masses and damping, so its motion cannot be computed";
        return Err(lacking(0, &[MASS, CENTRE, INERTIA, DAMPING], what));
    };
    if let Some(joint) = dynamics.iter().position(|joint| orthogonal && joint.orthogonal.is_none()) {
        let what = "the variant takes into account how joints yield normal to their axes";
        return Err(lacking(joint, &[ORTHOGONAL_STIFFNESS, ORTHOGONAL_DAMPING], what));
    }
    let is_rigid = |joint: &JointDynamics| {
        let springs = joint.orthogonal.filter(|_| orthogonal);
        springs.is_some_and(|springs| springs.stiffness.iter().any(|stiffness| !stiffness.is_finite()))
    };
    if let Some(joint) = dynamics.iter().position(is_rigid) {
        let at = document.root().key("joints").element(joint + 1).key(ORTHOGONAL_COMPLIANCE);
        let problem = "is rigid, but the variant asks how the joint moves normal to its axis";
        return Err(at.error(problem, "numbers above 0 where the variant is orthogonal or backlash"));
    }
    Ok(robot)
}

#[cfg(test)]
mod tests;
