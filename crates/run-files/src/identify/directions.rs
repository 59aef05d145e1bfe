//! Directions of a load: one of some words, or a list.

use crate::Word;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::marker::PhantomData;
use stead_format::quantity::{Expects, Reading, expecting, inline_schema};
use stead_format::scalars::words;
use stead_format::shapes::{List, Vector};
use stead_format::units::Number;

stead_numerics::worded! {
    /// Directions that have a word.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum NamedDirections {
        /// Any.
        Any = "any",
        /// Any horizontal one.
        Horizontal = "horizontal",
        /// Down, as a weight hangs.
        Vertical = "vertical",
    }
}

words!(NamedDirections);

/// Directions of a load: by a word, or one of a list in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Directions {
    /// By a word.
    Named(Word<NamedDirections>),
    /// One of these.
    Listed(List<Vector<Number>>),
}

impl Expects for Directions {
    fn expected() -> String {
        format!("{}, or directions [x, y, z] in the base frame, not zero", Word::<NamedDirections>::expected())
    }
}

impl<'de> Deserialize<'de> for Directions {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(DirectionsVisitor)
    }
}

/// Reads [`Directions`].
struct DirectionsVisitor;

impl<'de> Visitor<'de> for DirectionsVisitor {
    type Value = Directions;

    expecting!(Directions);

    fn visit_str<E: Error>(self, word: &str) -> Result<Self::Value, E> {
        Reading::<Word<NamedDirections>>(PhantomData).visit_str(word).map(Directions::Named)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        let list = Reading::<List<Vector<Number>>>(PhantomData).visit_seq(values)?;
        if list.0.is_empty() { Err(A::Error::custom("is empty")) } else { Ok(Directions::Listed(list)) }
    }
}

impl JsonSchema for Directions {
    inline_schema!("Directions");

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let word = generator.subschema_for::<Word<NamedDirections>>();
        let list = generator.subschema_for::<List<Vector<Number>>>();
        json_schema!({ "anyOf": [word, list] })
    }
}
