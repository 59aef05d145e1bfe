//! Values of a file that are one whole number, one text, or one of some words.

use crate::place::Place;
use crate::quantity::{Expects, Reading, expecting, inline_schema};
use crate::shapes::List;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::marker::PhantomData;
use stead_disk::input::InputError;

/// A whole number from `MIN` to `MAX`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(transparent)]
pub struct Whole<const MIN: u64, const MAX: u64>(u64);

impl<const MIN: u64, const MAX: u64> Whole<MIN, MAX> {
    /// The number.
    pub fn get(self) -> u64 {
        self.0
    }

    /// The number of things.
    pub fn count(self) -> usize {
        self.0 as usize
    }
}

impl<const MIN: u64, const MAX: u64> Expects for Whole<MIN, MAX> {
    fn expected() -> String {
        format!("a whole number from {MIN} to {MAX}")
    }

    fn expected_of_each() -> String {
        format!("whole numbers from {MIN} to {MAX}")
    }
}

impl<'de, const MIN: u64, const MAX: u64> Deserialize<'de> for Whole<MIN, MAX> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_u64(Reading::<Self>(PhantomData))
    }
}

impl<const MIN: u64, const MAX: u64> Visitor<'_> for Reading<Whole<MIN, MAX>> {
    type Value = Whole<MIN, MAX>;

    expecting!(Whole<MIN, MAX>);

    fn visit_u64<E: Error>(self, value: u64) -> Result<Self::Value, E> {
        let is_allowed = (MIN..=MAX).contains(&value);
        if is_allowed { Ok(Whole(value)) } else { Err(E::invalid_value(Unexpected::Unsigned(value), &self)) }
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Self::Value, E> {
        let unsigned = u64::try_from(value).map_err(|_| E::invalid_value(Unexpected::Signed(value), &self))?;
        self.visit_u64(unsigned)
    }
}

impl<const MIN: u64, const MAX: u64> JsonSchema for Whole<MIN, MAX> {
    inline_schema!(Self::expected());

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "integer", "minimum": MIN, "maximum": MAX })
    }
}

/// Which of the six joints a list names.
///
/// # Errors
/// [`InputError`] at a number that is in the list twice.
pub fn joint_set(numbers: &List<Whole<1, 6>>, at: &Place<'_>) -> Result<[bool; 6], InputError> {
    let mut joints = [false; 6];
    for (number, place) in numbers.0.iter().zip(1..) {
        if std::mem::replace(&mut joints[number.count() - 1], true) {
            return Err(at.element(place).error("is there twice", "numbers of joints from 1 to 6, each once"));
        }
    }
    Ok(joints)
}

/// What the words of a field stand for, in the vocabulary of a crate: a type of its own, so that it can give words to
/// types of others.
pub trait Words<Vocabulary>: Copy + PartialEq + 'static {
    /// Every word with its meaning.
    fn words() -> Vec<(&'static str, Self)>;
}

/// Implements [`Words`] by a table of words and meanings, the one given or the constant `WORDS` of the types, in the
/// vocabulary of the crate that calls it.
#[expect(clippy::crate_in_macro_def, reason = "the vocabulary is that of the crate that calls the macro")]
#[macro_export]
macro_rules! words {
    ($($kind:ty),+) => {$(
        impl $crate::scalars::Words<crate::Vocabulary> for $kind {
            fn words() -> Vec<(&'static str, Self)> {
                Self::WORDS.to_vec()
            }
        }
    )+};
    ($kind:ty: $($word:literal => $meaning:expr),+ $(,)?) => {
        impl $crate::scalars::Words<crate::Vocabulary> for $kind {
            fn words() -> Vec<(&'static str, Self)> {
                vec![$(($word, $meaning)),+]
            }
        }
    };
}
pub use crate::words;

/// One of some words of a vocabulary, as what it stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Word<T, V = crate::Vocabulary>(pub T, PhantomData<V>);

impl<T, V> From<T> for Word<T, V> {
    fn from(meaning: T) -> Self {
        Self(meaning, PhantomData)
    }
}

impl<T: Words<V>, V> Expects for Word<T, V> {
    fn expected() -> String {
        T::words().iter().map(|(word, _)| format!("\"{word}\"")).collect::<Vec<_>>().join(" or ")
    }
}

impl<'de, T: Words<V>, V> Deserialize<'de> for Word<T, V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_str(Reading::<Self>(PhantomData))
    }
}

impl<T: Words<V>, V> Visitor<'_> for Reading<Word<T, V>> {
    type Value = Word<T, V>;

    expecting!(Word<T, V>);

    fn visit_str<E: Error>(self, text: &str) -> Result<Self::Value, E> {
        let meant = T::words().into_iter().find(|(word, _)| *word == text);
        meant.map(|(_, meaning)| meaning.into()).ok_or_else(|| E::invalid_value(Unexpected::Str(text), &self))
    }
}

impl<T: Words<V>, V> Serialize for Word<T, V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let found = T::words().into_iter().find(|(_, meaning)| *meaning == self.0);
        let (word, _) = found.ok_or_else(|| serde::ser::Error::custom("a meaning without a word"))?;
        serializer.serialize_str(word)
    }
}

impl<T: Words<V>, V> JsonSchema for Word<T, V> {
    inline_schema!(Self::expected());

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let words: Vec<&str> = T::words().into_iter().map(|(word, _)| word).collect();
        json_schema!({ "type": "string", "enum": words })
    }
}

impl Expects for String {
    fn expected() -> String {
        "a text in quotes".to_owned()
    }

    fn expected_of_each() -> String {
        "texts in quotes".to_owned()
    }
}
