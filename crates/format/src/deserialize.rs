//! A TOML document as serde data, such that every error has the file, line and field of the value it is about.
//!
//! What a value must be is said once, by the `expecting` of the type that reads it: it becomes the `allowed` of every
//! error about the value. Keys that a table does not have are offered as absent, so optional keys are `Option`s and a
//! missing key is refused with what its type expects; keys that the type does not declare are refused with the nearest
//! one that it does.

use crate::place::{Place, number};
use serde::de::value::StrDeserializer;
use serde::de::{DeserializeSeed, Deserializer, Error, Expected, MapAccess, SeqAccess, Unexpected, Visitor};
use std::fmt;
use std::rc::Rc;
use stead_disk::input::InputError;
use stead_disk::quote::{GARBLED, garbles};
use toml::Spanned;
use toml::de::DeValue;

/// What is wrong with a value: located already, or still by the type that refused it.
#[derive(Debug)]
pub(crate) enum Problem {
    Located(Box<InputError>),
    Unlocated(String),
}

impl Problem {
    /// The error, at this place unless it has one.
    pub(crate) fn located(self, place: &Place<'_>, allowed: &str) -> InputError {
        match self {
            Problem::Located(error) => *error,
            Problem::Unlocated(problem) => place.error(problem, allowed),
        }
    }
}

impl From<InputError> for Problem {
    fn from(error: InputError) -> Self {
        Problem::Located(Box::new(error))
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::Located(error) => error.fmt(f),
            Problem::Unlocated(problem) => f.write_str(problem),
        }
    }
}

impl std::error::Error for Problem {}

impl Error for Problem {
    fn custom<T: fmt::Display>(problem: T) -> Self {
        Problem::Unlocated(problem.to_string())
    }

    fn invalid_type(_: Unexpected<'_>, _: &dyn Expected) -> Self {
        Problem::Unlocated("is of the wrong kind".to_owned())
    }

    fn invalid_value(unexpected: Unexpected<'_>, _: &dyn Expected) -> Self {
        let is_word = matches!(unexpected, Unexpected::Str(_));
        Problem::Unlocated(if is_word { "is unknown" } else { "is out of range" }.to_owned())
    }
}

/// A value being read.
pub(crate) struct Node<'a> {
    place: Place<'a>,
    /// What the array that the value is an element of must be.
    whole: Option<Rc<str>>,
}

impl<'a> Node<'a> {
    pub(crate) fn new(place: Place<'a>) -> Self {
        Self { place, whole: None }
    }

    /// What is allowed here: what the array around expects, else what the type does.
    fn allowed<'de>(&self, visitor: &impl Visitor<'de>) -> Rc<str> {
        self.whole.clone().unwrap_or_else(|| (visitor as &dyn Expected).to_string().into())
    }

    fn required(&self, allowed: &str) -> Result<&'a DeValue<'a>, Problem> {
        Ok(self.place.value.map(Spanned::get_ref).ok_or_else(|| self.place.missing(allowed))?)
    }

    /// Reads a value of one kind: `take` picks it, `wrong` says that it is none, `visit` hands it to its type.
    fn scalar<'de, V: Visitor<'de>, T>(
        self,
        visitor: V,
        wrong: &str,
        take: impl FnOnce(&'a DeValue<'a>) -> Option<T>,
        visit: impl FnOnce(V, T) -> Result<V::Value, Problem>,
    ) -> Result<V::Value, Problem> {
        let allowed = self.allowed(&visitor);
        let value = take(self.required(&allowed)?).ok_or_else(|| self.place.error(wrong, &*allowed))?;
        visit(visitor, value).map_err(|problem| problem.located(&self.place, &allowed).into())
    }

    /// Reads an array, its elements with what is allowed for them unless their types say it.
    fn array<'de, V: Visitor<'de>>(self, visitor: V, whole: Option<Rc<str>>) -> Result<V::Value, Problem> {
        let allowed = self.allowed(&visitor);
        let count = self.place.value.and_then(|value| value.get_ref().as_array()).map_or(0, |array| array.len());
        let elements = Elements { place: &self.place, whole, next: 1, count };
        visitor.visit_seq(elements).map_err(|problem| problem.located(&self.place, &allowed).into())
    }

    /// Refuses the first key of the file that is not among those of a table, naming the nearest that is.
    fn check_keys(&self, keys: &[&str]) -> Result<(), Problem> {
        let table = self.place.value.and_then(|value| value.get_ref().as_table());
        let unknown = table.into_iter().flatten().filter(|(key, _)| !keys.contains(&key.get_ref().as_ref()));
        let Some((key, value)) = unknown.min_by_key(|(key, _)| key.span().start) else { return Ok(()) };
        let name: &str = key.get_ref();
        let path = self.place.key(name).path;
        let near = |known: &str| strsim::jaro(known, name);
        let nearest = keys.iter().max_by(|a, b| near(a).total_cmp(&near(b)));
        let hint = nearest.map(|known| format!(" (nearest known one: {known})")).unwrap_or_default();
        let file = self.place.file;
        Err(file
            .locate(InputError::new(file.file(), format!("unknown key{hint}")), key.span().start)
            .in_field(path)
            .found(file.quote(value.span()))
            .allowed(keys.join(", "))
            .into())
    }
}

const NOT_FINITE: &str = "is not a finite number";
const NOT_TEXT: &str = "is not a text";
const TEXT: &str = "a text in quotes";
const BOOLEAN: &str = "true or false";

impl<'de, 'a> Deserializer<'de> for Node<'a> {
    type Error = Problem;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        match self.place.value.map(Spanned::get_ref) {
            Some(DeValue::Float(_) | DeValue::Integer(_)) => self.deserialize_f64(visitor),
            Some(DeValue::Array(_)) => {
                let whole = self.allowed(&visitor);
                self.array(visitor, Some(whole))
            }
            Some(DeValue::Boolean(_)) => self.deserialize_bool(visitor),
            _ => self.scalar(visitor, "is of the wrong kind", DeValue::as_str, V::visit_str),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        self.scalar(visitor, NOT_FINITE, number, V::visit_f64)
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        self.scalar(visitor, "is not a whole number", DeValue::as_integer, |visitor, integer| {
            let value = u64::from_str_radix(integer.as_str(), integer.radix());
            value.map_err(|_| Problem::custom("is out of range")).and_then(|value| visitor.visit_u64(value))
        })
    }

    fn deserialize_bool<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Problem> {
        self.whole = Some(BOOLEAN.into());
        self.scalar(visitor, "is neither true nor false", DeValue::as_bool, V::visit_bool)
    }

    fn deserialize_string<V: Visitor<'de>>(mut self, visitor: V) -> Result<V::Value, Problem> {
        self.whole = Some(TEXT.into());
        self.scalar(visitor, NOT_TEXT, DeValue::as_str, |visitor, text| {
            if text.trim().is_empty() {
                Err(Problem::custom("is blank"))
            } else if text.contains(|c| garbles(c) && !matches!(c, '\n' | '\r' | '\t')) {
                Err(Problem::custom(GARBLED))
            } else {
                visitor.visit_str(text)
            }
        })
    }

    /// One of some words.
    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        self.scalar(visitor, NOT_TEXT, DeValue::as_str, V::visit_str)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        if self.place.is_given() { visitor.visit_some(self) } else { visitor.visit_none() }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        keys: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Problem> {
        let allowed = format!("a table [{}]", self.place.path);
        if !matches!(self.required(&allowed)?, DeValue::Table(_)) {
            return Err(self.place.error("is not a table", allowed).into());
        }
        self.check_keys(keys)?;
        visitor.visit_map(Keys { place: &self.place, keys: keys.iter(), key: "" })
    }

    /// An array of tables.
    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        let allowed = format!("tables [[{}]]", self.place.path);
        match self.required(&allowed)? {
            DeValue::Array(_) => self.array(visitor, None),
            _ => Err(self.place.error("is not an array of tables", allowed).into()),
        }
    }

    /// An array of values, so many or, with a length of 0, one or more.
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Problem> {
        let allowed = self.allowed(&visitor);
        let problem = match self.required(&allowed)?.as_array().map(|array| array.len()) {
            None => "is not an array".to_owned(),
            Some(0) if length == 0 => "is empty".to_owned(),
            Some(count) if length > 0 && count != length => format!("has {count} elements and not {length}"),
            Some(_) => return self.array(visitor, Some(allowed)),
        };
        Err(self.place.error(problem, &*allowed).into())
    }

    /// Whatever is here is read by other means.
    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Problem> {
        visitor.visit_unit()
    }

    serde::forward_to_deserialize_any! {
        i8 i16 i32 i64 i128 u8 u16 u32 u128 f32 char bytes byte_buf unit unit_struct newtype_struct tuple map enum
        identifier
    }
}

/// The keys that a table may have, in their declared order, whether it has them or not.
struct Keys<'b, 'a> {
    place: &'b Place<'a>,
    keys: std::slice::Iter<'static, &'static str>,
    key: &'static str,
}

impl<'de> MapAccess<'de> for Keys<'_, '_> {
    type Error = Problem;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Problem> {
        let Some(key) = self.keys.next() else { return Ok(None) };
        self.key = key;
        seed.deserialize(StrDeserializer::new(key)).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Problem> {
        seed.deserialize(Node::new(self.place.key(self.key)))
    }
}

/// The elements of an array.
struct Elements<'b, 'a> {
    place: &'b Place<'a>,
    whole: Option<Rc<str>>,
    next: usize,
    count: usize,
}

impl<'de> SeqAccess<'de> for Elements<'_, '_> {
    type Error = Problem;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Problem> {
        if self.next > self.count {
            return Ok(None);
        }
        let place = self.place.element(self.next);
        self.next += 1;
        seed.deserialize(Node { place, whole: self.whole.clone() }).map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.count + 1 - self.next)
    }
}

#[cfg(test)]
mod tests;
