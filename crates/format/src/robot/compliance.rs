//! The compliance of a joint: a number, a range, or a number beside a compensator.

use super::file::JointRow;
use super::one_or_pair::OneOrRange;
use crate::place::Place;
use stead_disk::input::InputError;
use stead_model::robot::{Compensator, Compliance};

pub(super) const STIFFNESS: &str = "stiffness_mnm_per_rad";
pub(super) const COMPLIANCE: &str = "compliance_urad_per_nm";
pub(super) const COMPENSATOR: &str = "compensator";
/// How to come by the stiffness of a joint, which no robot maker states.
const WAYS: &str = "measure it (stead identify plan, from a rough value), or take that of a shipped arm \
                    (stiffness_like in the run file, stead import robot --stiffness-like)";

impl JointRow {
    /// Whether the row states its stiffness.
    pub(crate) fn has_stiffness(&self) -> bool {
        self.stiffness_mnm_per_rad.is_some() || self.compliance_urad_per_nm.is_some()
    }
}

/// The law of a joint, from whichever of its three keys are given.
pub(super) fn compliance_from(joint: &JointRow, at: &Place<'_>) -> Result<Compliance, InputError> {
    let alone = match (joint.stiffness_mnm_per_rad, joint.compliance_urad_per_nm) {
        (Some(stiffness), None) => 1e-6 / stiffness.written(),
        (None, Some(OneOrRange::One(compliance))) => compliance.si(),
        (None, Some(OneOrRange::Pair(range))) => {
            if joint.compensator.is_some() {
                return Err(at.key(COMPLIANCE).error(
                    format!("is a range beside a {COMPENSATOR}"),
                    "one number above 0, for the joint without its compensator",
                ));
            }
            let [at_min, at_max] = range.si();
            return Ok(Compliance::Range { at_min, at_max });
        }
        (Some(_), Some(_)) => {
            return Err(at.key(COMPLIANCE).error(format!("is given beside {STIFFNESS}"), "only one of the two"));
        }
        (None, None) => {
            return Err(at.key(STIFFNESS).missing(format!("{STIFFNESS} or {COMPLIANCE}, a number above 0: {WAYS}")));
        }
    };
    Ok(match joint.compensator {
        Some(spring) => Compliance::Compensated {
            alone,
            compensator: Compensator {
                spring_stiffness: spring.spring_stiffness_n_per_mm.si(),
                a: spring.a_mm.si(),
                l: spring.l_mm.si(),
                alpha: spring.alpha_deg.si(),
                free_length: spring.free_length_mm.si(),
            },
        },
        None => Compliance::Constant(alone),
    })
}
