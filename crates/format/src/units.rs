//! The units of the files, and the ranges that numbers are commonly in.

use crate::quantity::{Quantity, Unit};
use std::f64::consts::TAU;
use std::ops::Bound::{Excluded, Included, Unbounded};

/// Declares units: their marker types, the short names of their quantities, and what no machine has more of.
macro_rules! units {
    ($($(#[$doc:meta])* $marker:ident $name:ident $symbol:literal up to $largest:expr, = |$value:ident| $si:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct $marker;

        impl Unit for $marker {
            const SYMBOL: &'static str = $symbol;
            const LARGEST: f64 = $largest;
            fn to_si($value: f64) -> f64 {
                $si
            }
        }

        $(#[$doc])*
        pub type $name<R = Finite> = Quantity<$marker, R>;
    )*};
}

units! {
    /// A number without a unit.
    One Number "1" up to 1e12, = |value| value;
    /// A length. mm
    Millimetre Mm "mm" up to 1e6, = |value| value / 1e3;
    /// A length. um
    Micrometre Um "um" up to 1e6, = |value| value / 1e6;
    /// An angle. deg
    Degree Deg "deg" up to 1e6, = |value| value.to_radians();
    /// An angle. arc seconds
    ArcSecond Arcsec "arcsec" up to 1e6, = |value| (value / 3600.0).to_radians();
    /// An angular speed. deg/s
    DegreePerSecond DegPerS "deg/s" up to 1e6, = |value| value.to_radians();
    /// An angular acceleration. deg/s^2
    DegreePerSecond2 DegPerS2 "deg/s^2" up to 1e9, = |value| value.to_radians();
    /// An angular jerk. deg/s^3
    DegreePerSecond3 DegPerS3 "deg/s^3" up to 1e12, = |value| value.to_radians();
    /// An angle per length. deg/mm
    DegreePerMillimetre DegPerMm "deg/mm" up to 1e12, = |value| value.to_radians() * 1e3;
    /// A speed. mm/s
    MillimetrePerSecond MmPerS "mm/s" up to 1e6, = |value| value / 1e3;
    /// A speed. mm/min
    MillimetrePerMinute MmPerMin "mm/min" up to 1e8, = |value| value / 6e4;
    /// An acceleration. m/s^2
    MetrePerSecond2 MPerS2 "m/s^2" up to 1e4, = |value| value;
    /// A rotational speed. 1/min
    PerMinute Rpm "1/min" up to 1e7, = |value| value / 60.0 * TAU;
    /// A frequency. Hz
    Hertz Hz "Hz" up to 1e9, = |value| value;
    /// A duration. s
    Second S "s" up to 1e9, = |value| value;
    /// A power. kW
    Kilowatt Kw "kW" up to 1e3, = |value| value * 1e3;
    /// A mass. kg
    Kilogram Kg "kg" up to 1e6, = |value| value;
    /// A moment of inertia. kg m^2
    KilogramMetre2 KgM2 "kg m^2" up to 1e9, = |value| value;
    /// A force. N
    Newton N "N" up to 1e9, = |value| value;
    /// A moment. N m
    NewtonMetre Nm "N m" up to 1e9, = |value| value;
    /// A force per length. N/mm
    NewtonPerMillimetre NPerMm "N/mm" up to 1e9, = |value| value * 1e3;
    /// A pressure. MPa
    Megapascal Mpa "MPa" up to 1e7, = |value| value * 1e6;
    /// A length per angle. mm/rad
    MillimetrePerRadian MmPerRad "mm/rad" up to 1e6, = |value| value / 1e3;
    /// A rotational stiffness. MN m/rad
    MeganewtonMetrePerRadian MnmPerRad "MN m/rad" up to 1e6, = |value| value * 1e6;
    /// A rotational compliance. urad/(N m)
    MicroradianPerNewtonMetre UradPerNm "urad/(N m)" up to 1e9, = |value| value / 1e6;
    /// A rotational damping. N m s/rad
    NewtonMetreSecondPerRadian NmsPerRad "N m s/rad" up to 1e9, = |value| value;
    /// An amount of money. EUR
    Euro Eur "EUR" up to 1e12, = |value| value;
    /// An amount of memory. GB
    Gigabyte Gb "GB" up to 1e6, = |value| value * 1e9;
    /// A share in per cent.
    Hundredth Percent "%" up to 1e6, = |value| value / 100.0;
}

pub use crate::quantity::Finite;
pub use crate::quantity::ranges;

ranges! {
    /// Above zero.
    Positive: Excluded(0.0), Unbounded;
    /// Zero or above.
    NotNegative: Included(0.0), Unbounded;
    /// From 0 to 1.
    UnitInterval: Included(0.0), Included(1.0);
    /// Above 0, up to 1.
    Share: Excluded(0.0), Included(1.0);
    /// From 0 to 10.
    ZeroToTen: Included(0.0), Included(10.0);
    /// A slope to either side. deg
    Acute: Excluded(-90.0), Excluded(90.0);
}
