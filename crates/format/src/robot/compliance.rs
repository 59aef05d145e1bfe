//! The compliance of a joint: a number, a range, or a number beside a compensator.

use super::super::reader::Field;
use crate::input::InputError;
use stead_model::robot::{Compensator, Compliance};

pub(super) const STIFFNESS: &str = "stiffness_mnm_per_rad";
pub(super) const COMPLIANCE: &str = "compliance_urad_per_nm";
pub(super) const COMPENSATOR: &str = "compensator";

/// The law of a joint, from whichever of its three fields are given.
pub(super) fn compliance_from(
    stiffness: &Field<'_>,
    compliance: &Field<'_>,
    compensator: &Field<'_>,
) -> Result<Compliance, InputError> {
    let alone = match (stiffness.is_given(), compliance.is_given()) {
        (true, false) => 1e-6 / stiffness.positive()?,
        (false, true) if compliance.is_array() => {
            if compensator.is_given() {
                return Err(compliance.error(
                    format!("is a range beside a {COMPENSATOR}"),
                    "one number above 0, for the joint without its compensator",
                ));
            }
            let allowed = "one number above 0, or two [at min_deg, at max_deg]";
            let [at_min, at_max] = compliance.numbers_where(allowed, |value| value > 0.0)?.map(|value| value / 1e6);
            return Ok(Compliance::Range { at_min, at_max });
        }
        (false, true) => compliance.positive()? / 1e6,
        (true, true) => {
            return Err(compliance.error(format!("is given beside {STIFFNESS}"), "only one of the two"));
        }
        (false, false) => {
            return Err(stiffness.error("is missing", format!("{STIFFNESS} or {COMPLIANCE}, a number above 0")));
        }
    };
    Ok(match compensator.optional(compensator_from)? {
        Some(compensator) => Compliance::Compensated { alone, compensator },
        None => Compliance::Constant(alone),
    })
}

fn compensator_from(field: &Field<'_>) -> Result<Compensator, InputError> {
    let [spring_stiffness, a, l, alpha, free_length] =
        field.table()?.fields(["spring_stiffness_n_per_mm", "a_mm", "l_mm", "alpha_deg", "free_length_mm"])?;
    Ok(Compensator {
        spring_stiffness: spring_stiffness.positive()? * 1e3,
        a: a.positive()? / 1e3,
        l: l.positive()? / 1e3,
        alpha: alpha.number()?.to_radians(),
        free_length: free_length.positive()? / 1e3,
    })
}
