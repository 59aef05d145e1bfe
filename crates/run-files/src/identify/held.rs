//! Springs that keep their compliance: by the number of their joint, or by name.

use super::FitModel;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Error, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use stead_calibration::identification::springs::{AXES, FULL, column, key_name, spring};
use stead_disk::input::InputError;
use stead_format::place::Place;
use stead_format::quantity::{Expects, expecting, inline_schema};
use stead_format::shapes::List;
use stead_model::robot::{About, Spring};

/// The springs of a joint by its number from 1, or one spring by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldSprings {
    /// All springs of a joint (from 0) that are sought.
    Joint(usize),
    /// One spring.
    One(Spring),
}

impl HeldSprings {
    /// The spring of a name, `joints[3].x`.
    fn of_name(name: &str) -> Option<Self> {
        (0..FULL).map(spring).find(|spring| key_name(*spring) == name).map(Self::One)
    }
}

impl Serialize for HeldSprings {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Joint(joint) => serializer.serialize_u64(*joint as u64 + 1),
            Self::One(spring) => serializer.serialize_str(&key_name(*spring)),
        }
    }
}

impl Expects for HeldSprings {
    fn expected() -> String {
        "a whole number from 1 to 6, or the name of a spring, \"joints[1].z\" (about the axis), \"joints[1].x\", \
         \"joints[1].y\" (normal to it), for joints 1 to 6"
            .to_owned()
    }

    fn expected_of_each() -> String {
        "whole numbers from 1 to 6, or names of springs: \"joints[1].z\" (about the axis), \"joints[1].x\", \"joints[1].y\" \
         (normal to it), for joints 1 to 6"
            .to_owned()
    }
}

impl<'de> Deserialize<'de> for HeldSprings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(HeldVisitor)
    }
}

/// Reads [`HeldSprings`].
struct HeldVisitor;

impl Visitor<'_> for HeldVisitor {
    type Value = HeldSprings;

    expecting!(HeldSprings);

    fn visit_str<E: Error>(self, name: &str) -> Result<Self::Value, E> {
        HeldSprings::of_name(name).ok_or_else(|| E::invalid_value(Unexpected::Str(name), &self))
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
        if number.fract() != 0.0 {
            return Err(E::custom("is not a whole number"));
        }
        let joint = (0..6).find(|joint| *joint as f64 + 1.0 == number);
        joint.map(HeldSprings::Joint).ok_or_else(|| E::invalid_value(Unexpected::Float(number), &self))
    }
}

impl JsonSchema for HeldSprings {
    inline_schema!("springs of a joint");

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({
            "anyOf": [
                { "type": "integer", "minimum": 1, "maximum": 6 },
                { "type": "string", "pattern": r"^joints\[[1-6]\]\.[xyz]$" }
            ]
        })
    }
}

/// Which springs about the axes are held, and which about x and y of each joint.
pub(super) type Held = ([bool; 6], [[bool; 2]; 6]);

/// The springs of a list, each there once.
///
/// # Errors
/// [`InputError`] at a spring that is there twice, or is not sought by the model; where none is left.
pub(super) fn held_from(list: &List<HeldSprings>, model: FitModel, at: &Place<'_>) -> Result<Held, InputError> {
    let mut held = [false; FULL];
    for (springs, place) in list.0.iter().zip(1..) {
        let columns: Vec<usize> = match springs {
            HeldSprings::Joint(joint) => {
                (0..model.columns()).filter(|column| spring(*column).joint == *joint).collect()
            }
            HeldSprings::One(spring) if spring.about != About::Z && model == FitModel::Axes => {
                let problem = "is a spring normal to its axis, and the fit is of those about the axes alone";
                let allowed = "springs about the axes, or fit.model = \"full\"";
                return Err(at.element(place).error(problem, allowed));
            }
            HeldSprings::One(spring) => vec![column(*spring)],
        };
        for column in columns {
            if std::mem::replace(&mut held[column], true) {
                let allowed = "numbers of joints from 1 to 6 and names of springs, each once";
                return Err(at.element(place).error("is there twice", allowed));
            }
        }
    }
    if held[..model.columns()].iter().all(|held| *held) {
        let allowed = match model {
            FitModel::Axes => "numbers of one to five joints, from 1 to 6, each once",
            FitModel::Full => "some springs of the arm, not all",
        };
        return Err(at.error("holds every joint, so that nothing is left to identify", allowed));
    }
    let about_axes = std::array::from_fn(|joint| held[joint]);
    Ok((about_axes, std::array::from_fn(|joint| [0, 1].map(|about| held[AXES + 2 * joint + about]))))
}
