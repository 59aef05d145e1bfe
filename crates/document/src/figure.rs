//! Numbers of results, each with its unit and decimals in its type: JSON documents, CSV tables and output schemas
//! follow from the type.
//!
//! A figure holds a number in SI units or radians and is written in the unit of its type. In JSON it is the rounded
//! number; a table writes all decimals, which it finds in the name under which a figure serialises; the schema states
//! both.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};
use std::borrow::Cow;

use crate::units::Unit;

/// The names under which figures serialise: their decimals.
const DECIMALS: [&str; 13] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12"];

/// Declares figures: their name, the symbol of the unit, and the unit with its decimals.
macro_rules! figures {
    ($($(#[$doc:meta])* $name:ident: $symbol:literal, $unit:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub struct $name(pub f64);

        impl $name {
            const UNIT: Unit = $unit;
        }

        impl From<f64> for $name {
            fn from(si: f64) -> Self {
                Self(si)
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                // A table rounds what it writes.
                let is_rounded = serializer.is_human_readable();
                let value = if is_rounded { Self::UNIT.number(self.0) } else { self.0 * Self::UNIT.factor };
                serializer.serialize_newtype_struct(DECIMALS[Self::UNIT.decimals], &value)
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                schema($symbol, Self::UNIT.decimals)
            }
        }
    )*};
}

fn schema(symbol: &str, decimals: usize) -> Schema {
    match symbol {
        "" => json_schema!({ "type": "number", "x-decimals": decimals }),
        symbol => json_schema!({ "type": "number", "x-unit": symbol, "x-decimals": decimals }),
    }
}

const DEG: f64 = 180.0 / std::f64::consts::PI;

figures! {
    /// A place or a length.
    PlaceMm: "mm", Unit::PLACE_MM;
    /// A place of a task file.
    TaskMm: "mm", Unit { factor: 1e3, decimals: 6 };
    /// A removed volume.
    VolumeMm3: "mm3", Unit { factor: 1e9, decimals: 1 };
    /// A volume that is removed in a time.
    RateCm3PerMin: "cm3/min", Unit { factor: 6e7, decimals: 3 };
    /// A power.
    PowerKw: "kW", Unit { factor: 1e-3, decimals: 4 };
    /// A removed volume over a length.
    RemovalMm2: "mm3/mm", Unit { factor: 1e6, decimals: 4 };
    /// A length as controllers show it.
    ControllerMm: "mm", Unit { factor: 1e3, decimals: 3 };
    /// A deflection.
    DeflectionMm: "mm", Unit::DEFLECTION_MM;
    /// A measured length that is already in mm: a nine-digit micrometre has no fewer digits.
    MeasuredMm: "mm", Unit { factor: 1.0, decimals: 12 };
    /// A deflection with the digits that a comparison with another program needs.
    FineDeflectionMm: "mm", Unit { factor: 1e3, decimals: 9 };
    /// A deflection that is already in mm.
    MmDeflection: "mm", Unit { factor: 1.0, decimals: 7 };
    /// A residual of optimality conditions.
    ResidualMm: "mm", Unit::RESIDUAL_MM;
    /// An axial depth of cut.
    DepthMm: "mm", Unit { factor: 1e3, decimals: 5 };
    /// A height over a surface.
    HeightUm: "um", Unit { factor: 1e6, decimals: 4 };
    /// A displacement for a force.
    ResponseUmPerN: "um/N", Unit { factor: 1e6, decimals: 6 };
    /// What turning of the joints adds to an objective.
    WeightMmPerRad: "mm/rad", Unit::DEFLECTION_MM;
    /// What a second of moving adds to an objective.
    WeightMmPerS: "mm/s", Unit::DEFLECTION_MM;
    /// The change of a deflection for a change of one per cent.
    MmPerPercent: "mm/%", Unit::DEFLECTION_MM;
    /// An angle.
    AngleDeg: "deg", Unit::ANGLE_DEG;
    /// An angle of a grid, in degrees as it is.
    GridDeg: "deg", Unit { factor: 1.0, decimals: 4 };
    /// An angle with the digits that a comparison with another program needs.
    FineAngleDeg: "deg", Unit { factor: DEG, decimals: 6 };
    /// An angle so fine that 3 m away it moves nothing by 1e-7 mm.
    FinestAngleDeg: "deg", Unit { factor: DEG, decimals: 9 };
    /// A force.
    ForceN: "N", Unit::FORCE_N;
    /// A moment.
    MomentNm: "N m", Unit::MOMENT_NM;
    /// A number without a unit: 1/kappa, Q4, a ratio.
    Plain: "", Unit::PLAIN;
    /// A studentised residual.
    Studentised: "", Unit { factor: 1.0, decimals: 4 };
    /// A relative error of a lookup table.
    TableError: "", Unit { factor: 1.0, decimals: 8 };
    /// A component of a direction.
    Direction: "", Unit { factor: 1.0, decimals: 9 };
    /// What moving a bound gains, in the unit that stands beside it.
    Gain: "", Unit { factor: 1.0, decimals: 7 };
    /// A share, of 1: a damping ratio, an amplitude.
    Share: "", Unit::PLAIN;
    /// An amplitude of the tip for a joint that swings by 1 rad.
    TipMm: "mm/rad", Unit::PLACE_MM;
    /// A share, of 1.
    Percent: "%", Unit { factor: 100.0, decimals: 6 };
    /// A time.
    TimeS: "s", Unit::TIME_S;
    /// A moment of a simulation.
    MomentS: "s", Unit { factor: 1.0, decimals: 7 };
    /// A step of a simulation.
    StepS: "s", Unit { factor: 1.0, decimals: 10 };
    /// A speed along a path.
    SpeedMmPerS: "mm/s", Unit::SPEED_MM_PER_S;
    /// A speed of turning.
    SpeedDegPerS: "deg/s", Unit::SPEED_DEG_PER_S;
    /// A rate of turning along a path.
    RateDegPerMm: "deg/mm", Unit::RATE_DEG_PER_MM;
    /// A spindle speed.
    SpeedRpm: "1/min", Unit { factor: 30.0 / std::f64::consts::PI, decimals: 2 };
    /// A frequency.
    FrequencyHz: "Hz", Unit { factor: 1.0, decimals: 4 };
    /// An exponent of growth.
    Exponent: "", Unit { factor: 1.0, decimals: 4 };
    /// A rate of growth.
    RatePerS: "1/s", Unit { factor: 1.0, decimals: 4 };
}

/// Figures of several numbers.
pub fn each<F: From<f64>, const N: usize>(values: [f64; N]) -> [F; N] {
    values.map(F::from)
}

/// A figure where there is a number.
pub fn some<F: From<f64>>(value: Option<f64>) -> Option<F> {
    value.map(F::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_rounded_in_their_unit() {
        let figures = (PlaceMm(1.234_567_89), AngleDeg(std::f64::consts::PI), Percent(0.125), some::<TimeS>(None));
        assert_eq!(serde_json::to_string(&figures).unwrap(), "[1234.5679,180.0,12.5,null]");
    }

    #[test]
    fn schemas_state_unit_and_decimals() {
        let schema = DeflectionMm::json_schema(&mut SchemaGenerator::default());
        assert_eq!((&schema.as_value()["x-unit"], &schema.as_value()["x-decimals"]), (&"mm".into(), &7.into()));
    }
}
