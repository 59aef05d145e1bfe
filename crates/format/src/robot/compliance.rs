//! The compliance of a joint: a number, a range, or a number beside a compensator.

use super::file::JointRow;
use crate::input::InputError;
use crate::place::Place;
use crate::quantity::{Expects, Reading, expecting};
use crate::shapes::Array;
use crate::units::{Positive, UradPerNm};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::borrow::Cow;
use std::marker::PhantomData;
use stead_model::robot::{Compensator, Compliance};

pub(super) const STIFFNESS: &str = "stiffness_mnm_per_rad";
pub(super) const COMPLIANCE: &str = "compliance_urad_per_nm";
pub(super) const COMPENSATOR: &str = "compensator";

/// One compliance, or two: at the lower and at the upper limit of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrRange {
    /// The same at every angle.
    One(UradPerNm<Positive>),
    /// Linear in the angle between `min_deg` and `max_deg`.
    Range(Array<UradPerNm<Positive>, 2>),
}

impl Expects for OneOrRange {
    fn expected() -> String {
        "one number above 0, or two [at min_deg, at max_deg]".to_owned()
    }
}

impl<'de> Deserialize<'de> for OneOrRange {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Reading::<Self>(PhantomData))
    }
}

impl<'de> Visitor<'de> for Reading<OneOrRange> {
    type Value = OneOrRange;

    expecting!(OneOrRange);

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        Reading::<UradPerNm<Positive>>(PhantomData).visit_f64(value).map(OneOrRange::One)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Reading::<Array<UradPerNm<Positive>, 2>>(PhantomData).visit_seq(values).map(OneOrRange::Range)
    }
}

impl JsonSchema for OneOrRange {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "OneOrRange".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<UradPerNm<Positive>>();
        let range = generator.subschema_for::<Array<UradPerNm<Positive>, 2>>();
        json_schema!({ "anyOf": [one, range] })
    }
}

/// The law of a joint, from whichever of its three keys are given.
pub(super) fn compliance_from(joint: &JointRow, at: &Place<'_>) -> Result<Compliance, InputError> {
    let alone = match (joint.stiffness_mnm_per_rad, joint.compliance_urad_per_nm) {
        (Some(stiffness), None) => 1e-6 / stiffness.written(),
        (None, Some(OneOrRange::One(compliance))) => compliance.si(),
        (None, Some(OneOrRange::Range(range))) => {
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
            return Err(at.key(STIFFNESS).missing(format!("{STIFFNESS} or {COMPLIANCE}, a number above 0")));
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
