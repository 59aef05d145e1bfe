//! A number for both directions normal to a joint axis, or one for each; a compliance, or one at either limit.

use crate::quantity::{Expects, Quantity, Range, Reading, Unit, expecting, inline_schema};
use crate::shapes::Array;
use crate::units::UradPerNm;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::marker::PhantomData;
use std::ops::Bound;

/// One number, or two: about the x and about the y axis of the frame of a row.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrPair<Q> {
    /// The same about both.
    One(Q),
    /// About x, about y.
    Pair(Array<Q, 2>),
}

/// A compliance of a joint, none stiffer than 1e6 MN m/rad. urad/(N m)
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointCompliance;

impl Range for JointCompliance {
    const ENDS: (Bound<f64>, Bound<f64>) = (Bound::Included(1e-6), Bound::Unbounded);
    const ONE_OR_PAIR: &'static str = "one number above 0, from 1e-6 to 1e9, or two [at min_deg, at max_deg]";
}

/// One compliance, or two: at the lower and at the upper limit of the joint, linear in the angle between them.
pub type OneOrRange = OneOrPair<UradPerNm<JointCompliance>>;

impl<Q: Copy> OneOrPair<Q> {
    /// About x, about y.
    pub fn both(self) -> [Q; 2] {
        match self {
            Self::One(one) => [one; 2],
            Self::Pair(Array(pair)) => pair,
        }
    }
}

impl<U: Unit, R: Range> Expects for OneOrPair<Quantity<U, R>> {
    fn expected() -> String {
        if !R::ONE_OR_PAIR.is_empty() {
            return R::ONE_OR_PAIR.to_owned();
        }
        let of_each = Quantity::<U, R>::expected_of_each();
        let (noun, range) = of_each.split_once("numbers").unwrap_or((&of_each, ""));
        format!("{}, or two {noun}numbers [about x, about y]{range}", Quantity::<U, R>::expected())
    }
}

impl<'de, U: Unit, R: Range> Deserialize<'de> for OneOrPair<Quantity<U, R>> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Reading::<Self>(PhantomData))
    }
}

impl<'de, U: Unit, R: Range> Visitor<'de> for Reading<OneOrPair<Quantity<U, R>>> {
    type Value = OneOrPair<Quantity<U, R>>;

    expecting!(OneOrPair<Quantity<U, R>>);

    fn visit_f64<E: Error>(self, value: f64) -> Result<Self::Value, E> {
        Reading::<Quantity<U, R>>(PhantomData).visit_f64(value).map(OneOrPair::One)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        Reading::<Array<Quantity<U, R>, 2>>(PhantomData).visit_seq(values).map(OneOrPair::Pair)
    }
}

impl<U: Unit, R: Range> JsonSchema for OneOrPair<Quantity<U, R>> {
    inline_schema!(format!("one or a pair of {}", Quantity::<U, R>::schema_name()));

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<Quantity<U, R>>();
        let pair = generator.subschema_for::<Array<Quantity<U, R>, 2>>();
        json_schema!({ "anyOf": [one, pair] })
    }
}
