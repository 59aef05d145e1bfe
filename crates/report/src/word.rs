//! Fields of results that hold one of some words, the same as in the files that jobs are read from.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};
use std::borrow::Cow;
use stead_assessment::benchmark::{LimitsAt, Turning};
use stead_assessment::comparison::ElbowNames;
use stead_calibration::compensation::DeflectionModel;

/// What has a word for each of its values.
pub trait Worded: Copy + PartialEq + 'static {
    /// Each value with its word.
    const WORDS: &'static [(&'static str, Self)];
}

macro_rules! worded {
    ($($kind:ty),+) => {$(
        impl Worded for $kind {
            const WORDS: &'static [(&'static str, Self)] = <$kind>::WORDS;
        }
    )+};
}

worded!(Turning, LimitsAt, ElbowNames, DeflectionModel);

/// The word for a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Word<T>(T);

impl<T> From<T> for Word<T> {
    fn from(value: T) -> Self {
        Self(value)
    }
}

impl<T: Worded> Serialize for Word<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let found = T::WORDS.iter().find(|(_, value)| *value == self.0);
        let (word, _) = found.ok_or_else(|| serde::ser::Error::custom("a value without a word"))?;
        serializer.serialize_str(word)
    }
}

impl<T: Worded> JsonSchema for Word<T> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Word".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let words: Vec<&str> = T::WORDS.iter().map(|(word, _)| *word).collect();
        json_schema!({ "type": "string", "enum": words })
    }
}
