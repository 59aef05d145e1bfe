//! Units of length of a program, and numbers without the digits of a unit.

stead_numerics::worded! {
    /// A unit of length of a program.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum LengthUnit {
        /// Millimetres.
        Millimetre = "mm",
        /// Inches.
        Inch = "inch",
    }
}

impl LengthUnit {
    /// Its length. m
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 1e-3,
            Self::Inch => 25.4e-3,
        }
    }
}

/// A number without the digits that its unit has brought in.
pub(super) fn rounded(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}
