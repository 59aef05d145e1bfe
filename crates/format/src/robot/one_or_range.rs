//! A compliance as a robot file states it: one number, or two at the ends of the range of the joint.

use crate::quantity::{Expects, Reading, expecting, inline_schema};
use crate::shapes::Array;
use crate::units::{UradPerNm, ranges};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::marker::PhantomData;
use std::ops::Bound::{Included, Unbounded};

ranges! {
    /// A compliance of a joint, none stiffer than 1e6 MN m/rad. urad/(N m)
    JointCompliance: Included(1e-6), Unbounded;
}

/// One compliance, or two: at the lower and at the upper limit of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrRange {
    /// The same at every angle.
    One(UradPerNm<JointCompliance>),
    /// Linear in the angle between `min_deg` and `max_deg`.
    Range(Array<UradPerNm<JointCompliance>, 2>),
}

impl Expects for OneOrRange {
    fn expected() -> String {
        "one number above 0, from 1e-6 to 1e9, or two [at min_deg, at max_deg]".to_owned()
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
        Reading::<UradPerNm<JointCompliance>>(PhantomData).visit_f64(value).map(OneOrRange::One)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Reading::<Array<UradPerNm<JointCompliance>, 2>>(PhantomData).visit_seq(values).map(OneOrRange::Range)
    }
}

impl JsonSchema for OneOrRange {
    inline_schema!("OneOrRange");

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<UradPerNm<JointCompliance>>();
        let range = generator.subschema_for::<Array<UradPerNm<JointCompliance>, 2>>();
        json_schema!({ "anyOf": [one, range] })
    }
}
