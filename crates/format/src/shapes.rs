//! Values of a file that are several: vectors, matrices, intervals, lists.

use crate::quantity::{Expects, Quantity, Range, Reading, Unit, expecting, inline_schema};
use crate::units::Number;
use nalgebra::{Matrix3, Vector3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::marker::PhantomData;

/// `N` values of a kind.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Array<T, const N: usize>(pub [T; N]);

/// Three numbers `[x, y, z]`.
pub type Vector<Q> = Array<Q, 3>;
/// Three rows of three numbers.
pub type Matrix = Array<Array<Number, 3>, 3>;

/// What a matrix may not be below, in words.
pub(crate) const SEMIDEFINITE: &str =
    "a positive semidefinite matrix: no load is answered against its own direction (no eigenvalue below 0)";

impl<U: Unit, R: Range, const N: usize> Array<Quantity<U, R>, N> {
    /// The numbers in SI units and radians.
    pub fn si(self) -> [f64; N] {
        self.0.map(Quantity::si)
    }
}

impl<U: Unit, R: Range> Vector<Quantity<U, R>> {
    /// The vector in SI units.
    pub fn vector(self) -> Vector3<f64> {
        self.si().into()
    }
}

impl Matrix {
    /// The matrix.
    pub fn matrix(self) -> Matrix3<f64> {
        Matrix3::from_fn(|row, column| self.0[row].0[column].written())
    }
}

impl<T: Expects, const N: usize> Expects for Array<T, N> {
    fn expected() -> String {
        let count = ["no", "one", "two", "three", "four", "five", "six"];
        let count = count.get(N).map_or_else(|| N.to_string(), |word| (*word).to_owned());
        let letters = if N == 3 && !T::expected_of_each().contains("of ") { " [x, y, z]" } else { "" };
        format!("{count} {}{letters}", T::expected_of_each())
    }

    fn expected_of_each() -> String {
        format!("rows of {}", Self::expected().replace(" [x, y, z]", ""))
    }
}

/// Reads arrays of a known length.
impl<'de, T: Expects + Deserialize<'de>, const N: usize> Deserialize<'de> for Array<T, N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple_struct("Array", N, Reading::<Self>(PhantomData))
    }
}

impl<'de, T: Expects + Deserialize<'de>, const N: usize> Visitor<'de> for Reading<Array<T, N>> {
    type Value = Array<T, N>;

    expecting!(Array<T, N>);

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        let values: [T; N] = all(values)?.try_into().map_err(|values: Vec<T>| wrong_length(values.len(), N))?;
        Ok(Array(values))
    }
}

fn all<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(mut values: A) -> Result<Vec<T>, A::Error> {
    let mut all = Vec::with_capacity(values.size_hint().unwrap_or_default());
    while let Some(value) = values.next_element()? {
        all.push(value);
    }
    Ok(all)
}

fn wrong_length<E: Error>(found: usize, expected: usize) -> E {
    E::custom(format!("has {found} elements and not {expected}"))
}

impl<T: Serialize, const N: usize> Serialize for Array<T, N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(&self.0)
    }
}

impl<T: JsonSchema + Expects, const N: usize> JsonSchema for Array<T, N> {
    inline_schema!(Self::expected());

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let items = generator.subschema_for::<T>();
        json_schema!({ "type": "array", "items": items, "minItems": N, "maxItems": N })
    }
}

/// Two numbers in ascending order; `APART` where they may not be equal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Ends<Q, const APART: bool>(Array<Q, 2>);

/// Two numbers, the first not above the second.
pub type Interval<Q> = Ends<Q, false>;
/// Two numbers, the first below the second.
pub type Span<Q> = Ends<Q, true>;

impl<U: Unit, R: Range, const APART: bool> Ends<Quantity<U, R>, APART> {
    /// Both ends in the unit of the file.
    pub fn written(self) -> [f64; 2] {
        self.0.0.map(Quantity::written)
    }

    /// Both ends in SI units and radians.
    pub fn si(self) -> [f64; 2] {
        self.0.si()
    }
}

impl<U: Unit, R: Range, const APART: bool> Expects for Ends<Quantity<U, R>, APART> {
    fn expected() -> String {
        // The range of the numbers stands between what else is said of them:
        // `two numbers [min, max] from -1 to 1 with ..`.
        let of_each = Quantity::<U, R>::expected_of_each();
        let (noun, range) = of_each.split_once("numbers").unwrap_or((&of_each, ""));
        let (ends, rule) = match APART {
            false => ("[min, max]", " with min not above max"),
            true => ("[from, to]", ", the first below the second"),
        };
        format!("two {noun}numbers {ends}{range}{rule}")
    }

    fn expected_of_each() -> String {
        format!("pairs of {}", Quantity::<U, R>::expected_of_each())
    }
}

impl<'de, U: Unit, R: Range, const APART: bool> Deserialize<'de> for Ends<Quantity<U, R>, APART> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple_struct("Ends", 2, Reading::<Self>(PhantomData))
    }
}

impl<'de, U: Unit, R: Range, const APART: bool> Visitor<'de> for Reading<Ends<Quantity<U, R>, APART>> {
    type Value = Ends<Quantity<U, R>, APART>;

    expecting!(Self::Value);

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        let ends = Reading::<Array<Quantity<U, R>, 2>>(PhantomData).visit_seq(values)?;
        match ends.0.map(Quantity::written) {
            [from, to] if from > to => Err(A::Error::custom("has its lower end above its upper end")),
            [from, to] if APART && from == to => Err(A::Error::custom("has no width")),
            _ => Ok(Ends(ends)),
        }
    }
}

impl<Q: JsonSchema + Expects, const APART: bool> JsonSchema for Ends<Q, APART> {
    inline_schema!(Array::<Q, 2>::schema_name());

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = Array::<Q, 2>::json_schema(generator);
        let rule = if APART { "below" } else { "not above" };
        schema.insert("description".to_owned(), format!("Two numbers, the first {rule} the second.").into());
        schema
    }
}

/// One value of a kind or more.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(transparent)]
pub struct List<T>(pub Vec<T>);

impl<U: Unit, R: Range> List<Quantity<U, R>> {
    /// The numbers in SI units and radians.
    pub fn si(&self) -> Vec<f64> {
        self.0.iter().map(|value| value.si()).collect()
    }
}

impl<T: Expects> Expects for List<T> {
    fn expected() -> String {
        format!("one or more {}", T::expected_of_each())
    }

    fn expected_of_each() -> String {
        format!("rows of {}", T::expected_of_each())
    }
}

impl<'de, T: Expects + Deserialize<'de>> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple_struct("List", 0, Reading::<Self>(PhantomData))
    }
}

impl<'de, T: Expects + Deserialize<'de>> Visitor<'de> for Reading<List<T>> {
    type Value = List<T>;

    expecting!(List<T>);

    fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Self::Value, A::Error> {
        all(values).map(List)
    }
}

impl<T: JsonSchema> JsonSchema for List<T> {
    inline_schema!(format!("list of {}", T::schema_name()));

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let items = generator.subschema_for::<T>();
        json_schema!({ "type": "array", "items": items, "minItems": 1 })
    }
}
