//! Numbers of a file, with their unit and the range they may be in: one declaration that reads, checks, writes and
//! documents.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt::Debug;
use std::marker::PhantomData;
use std::ops::Bound::{self, Excluded, Included, Unbounded};
use std::ops::RangeBounds;

/// A value of a file whose type says what is allowed.
pub trait Expects {
    /// What is allowed, as a noun: `a finite number above 0`.
    fn expected() -> String;

    /// The same of several: `numbers above 0`.
    fn expected_of_each() -> String {
        Self::expected()
    }
}

/// What the type that is read expects, as its [`Expects`] says.
pub struct Reading<T>(pub PhantomData<T>);

/// The `expecting` of a visitor, once for all.
#[macro_export]
macro_rules! expecting {
    ($kind:ty) => {
        fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            f.write_str(&<$kind>::expected())
        }
    };
}
pub use crate::expecting;

/// What schemas of values have in common, once for all: they stand where the value is, not by name among the
/// definitions.
#[macro_export]
macro_rules! inline_schema {
    ($name:expr) => {
        fn inline_schema() -> bool {
            true
        }

        fn schema_name() -> std::borrow::Cow<'static, str> {
            $name.into()
        }
    };
}
pub use crate::inline_schema;

/// A unit of a file and what it is in SI units and radians.
pub trait Unit: Copy + Debug + PartialEq + 'static {
    /// The unit as it is written.
    const SYMBOL: &'static str;
    /// No machine has more of it, to either side: infinity where that cannot be said.
    const LARGEST: f64;
    /// A number in the unit, in SI units and radians.
    fn to_si(value: f64) -> f64;
}

/// The range that a number has to be in.
pub trait Range: Copy + Debug + PartialEq + 'static {
    /// Its ends.
    const ENDS: (Bound<f64>, Bound<f64>);
    /// What is said behind them of one number.
    const EXAMPLE: &'static str = "";
    /// What is said of one number or two of it, where the range does not say it all.
    const ONE_OR_PAIR: &'static str = "";
}

/// A finite number of a file in a unit and a range, and no larger than any machine has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity<U, R = Finite> {
    written: f64,
    kind: PhantomData<(U, R)>,
}

impl<U: Unit, R: Range> Quantity<U, R> {
    /// The number in SI units and radians.
    pub fn si(self) -> f64 {
        U::to_si(self.written)
    }

    /// The number in the unit of the file.
    pub fn written(self) -> f64 {
        self.written
    }

    /// The ends of what is allowed: those of the range, and those of the unit where the range has none.
    fn ends() -> (Bound<f64>, Bound<f64>) {
        let limited =
            |end: Bound<f64>, limit: f64| if end == Unbounded && limit.is_finite() { Included(limit) } else { end };
        let (from, to) = R::ENDS;
        (limited(from, -U::LARGEST), limited(to, U::LARGEST))
    }
}

/// What a range allows, in words, of one number or of several.
fn in_words(ends: (Bound<f64>, Bound<f64>), is_one: bool) -> String {
    let noun = if is_one { "number" } else { "numbers" };
    let finite = format!("{}finite {noun}", if is_one { "a " } else { "" });
    let any = finite.replace("finite ", "");
    match ends {
        (Unbounded, Unbounded) => finite,
        (Excluded(0.0), Unbounded) => format!("{} above 0", if is_one { &finite } else { &any }),
        (Included(from), Unbounded) => format!("{finite} not below {}", plain(from)),
        (Excluded(from), Unbounded) => format!("{finite} above {}", plain(from)),
        (Unbounded, Included(to)) => format!("{finite} not above {}", plain(to)),
        (Unbounded, Excluded(to)) => format!("{finite} below {}", plain(to)),
        (Included(from), Included(to)) => format!("{any} from {} to {}", plain(from), plain(to)),
        (Included(from), Excluded(to)) => format!("{any} from {} to below {}", plain(from), plain(to)),
        (Excluded(from), Included(to)) => format!("{any} above {} and not above {}", plain(from), plain(to)),
        (Excluded(from), Excluded(to)) => format!("{any} above {} and below {}", plain(from), plain(to)),
    }
}

/// A bound as people write it.
fn plain(value: f64) -> String {
    if (1e-4..1e6).contains(&value.abs()) || value == 0.0 { value.to_string() } else { format!("{value:e}") }
}

/// What a range allows of a unit of which no machine has more than a limit, in words, of one number or of several.
fn in_words_up_to(ends: (Bound<f64>, Bound<f64>), limit: f64, is_one: bool) -> String {
    let words = in_words(ends, is_one);
    if !limit.is_finite() {
        return words;
    }
    match ends {
        (Unbounded, Unbounded) => format!("{words} from {} to {}", plain(-limit), plain(limit)),
        (_, Unbounded) => format!("{words} and not above {}", plain(limit)),
        (Unbounded, _) => format!("{words} and not below {}", plain(-limit)),
        _ => words,
    }
}

impl<U: Unit, R: Range> Expects for Quantity<U, R> {
    fn expected() -> String {
        in_words_up_to(R::ENDS, U::LARGEST, true) + R::EXAMPLE
    }

    fn expected_of_each() -> String {
        in_words_up_to(R::ENDS, U::LARGEST, false)
    }
}

impl<'de, U: Unit, R: Range> Deserialize<'de> for Quantity<U, R> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_f64(Reading::<Self>(PhantomData))
    }
}

impl<U: Unit, R: Range> Visitor<'_> for Reading<Quantity<U, R>> {
    type Value = Quantity<U, R>;

    expecting!(Quantity<U, R>);

    fn visit_f64<E: Error>(self, written: f64) -> Result<Self::Value, E> {
        if written.is_finite() && Quantity::<U, R>::ends().contains(&written) {
            Ok(Quantity { written, kind: PhantomData })
        } else {
            Err(E::invalid_value(Unexpected::Float(written), &self))
        }
    }

    fn visit_i64<E: Error>(self, written: i64) -> Result<Self::Value, E> {
        self.visit_f64(written as f64)
    }

    fn visit_u64<E: Error>(self, written: u64) -> Result<Self::Value, E> {
        self.visit_f64(written as f64)
    }
}

impl<U, R> Serialize for Quantity<U, R> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.written)
    }
}

impl<U: Unit, R: Range> JsonSchema for Quantity<U, R> {
    inline_schema!(format!("{} in {}", Self::expected(), U::SYMBOL));

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = json_schema!({ "type": "number", "x-unit": U::SYMBOL });
        let (from, to) = Self::ends();
        let (key, value) = match from {
            Included(from) => ("minimum", Some(from)),
            Excluded(from) => ("exclusiveMinimum", Some(from)),
            Unbounded => ("", None),
        };
        value.map(|value| schema.insert(key.to_owned(), value.into()));
        let (key, value) = match to {
            Included(to) => ("maximum", Some(to)),
            Excluded(to) => ("exclusiveMaximum", Some(to)),
            Unbounded => ("", None),
        };
        value.map(|value| schema.insert(key.to_owned(), value.into()));
        schema
    }
}

/// Declares ranges of numbers.
#[macro_export]
macro_rules! ranges {
    ($($(#[$doc:meta])* $name:ident: $from:expr, $to:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $name;

        impl $crate::quantity::Range for $name {
            const ENDS: (std::ops::Bound<f64>, std::ops::Bound<f64>) = ($from, $to);
        }
    )*};
}
pub use crate::ranges;

ranges! {
    /// Any finite number.
    Finite: Bound::Unbounded, Bound::Unbounded;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Acute, Mm, MnmPerRad, NotNegative, Positive, Share};

    #[test]
    fn ranges_are_said_in_words() {
        for (range, one, several) in [
            (Finite::ENDS, "a finite number", "finite numbers"),
            (Positive::ENDS, "a finite number above 0", "numbers above 0"),
            (NotNegative::ENDS, "a finite number not below 0", "finite numbers not below 0"),
            (Share::ENDS, "a number above 0 and not above 1", "numbers above 0 and not above 1"),
            ((Included(-1e7), Included(1e7)), "a number from -1e7 to 1e7", "numbers from -1e7 to 1e7"),
            ((Included(0.0), Excluded(1.0)), "a number from 0 to below 1", "numbers from 0 to below 1"),
            (Acute::ENDS, "a number above -90 and below 90", "numbers above -90 and below 90"),
        ] {
            assert_eq!((in_words(range, true).as_str(), in_words(range, false).as_str()), (one, several));
        }
    }

    #[test]
    fn what_no_machine_has_is_out_of_range() {
        let up_to = |range, is_one| in_words_up_to(range, 1e6, is_one);
        assert_eq!(up_to(Finite::ENDS, true), "a finite number from -1e6 to 1e6");
        assert_eq!(up_to(Positive::ENDS, true), "a finite number above 0 and not above 1e6");
        assert_eq!(up_to(Positive::ENDS, false), "numbers above 0 and not above 1e6");
        assert_eq!(up_to(NotNegative::ENDS, true), "a finite number not below 0 and not above 1e6");
        assert_eq!(up_to(Share::ENDS, true), in_words(Share::ENDS, true));
        assert_eq!(in_words_up_to(Finite::ENDS, f64::INFINITY, true), "a finite number");
        let read =
            |written: f64| Reading::<MnmPerRad<Positive>>(PhantomData).visit_f64::<serde::de::value::Error>(written);
        assert_eq!(read(1e6).unwrap().si(), 1e12);
        for refused in [2e6, 1e308, f64::INFINITY, 0.0, -1.0] {
            let message = read(refused).unwrap_err().to_string();
            assert!(message.contains("a finite number above 0 and not above 1e6"), "{message}");
        }
        let schema = Mm::<Finite>::json_schema(&mut SchemaGenerator::default());
        assert_eq!((schema.get("minimum"), schema.get("maximum")), (Some(&(-1e6).into()), Some(&1e6.into())));
    }
}
