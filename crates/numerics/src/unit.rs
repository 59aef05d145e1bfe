//! Numbers as files state them: units, decimals, and no minus sign before a zero.
//!
//! A [`Unit`] turns a number in SI or radians into the text of a CSV field or the number of a JSON document; both have
//! the same digits.

use crate::digits::fixed;

/// A unit of files: a factor from SI or radians, and the number of decimals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// What a number in SI or radians is multiplied by.
    pub factor: f64,
    /// Digits after the decimal point.
    pub decimals: usize,
}

impl Unit {
    /// Places, from m to mm.
    pub const PLACE_MM: Self = Self { factor: 1e3, decimals: 4 };
    /// Deflections, from m to mm.
    pub const DEFLECTION_MM: Self = Self { factor: 1e3, decimals: 7 };
    /// Residuals of optimality conditions, from m to mm.
    pub const RESIDUAL_MM: Self = Self { factor: 1e3, decimals: 10 };
    /// Angles, from rad to deg.
    pub const ANGLE_DEG: Self = Self { factor: 180.0 / std::f64::consts::PI, decimals: 4 };
    /// Forces in N.
    pub const FORCE_N: Self = Self { factor: 1.0, decimals: 4 };
    /// Moments in N m.
    pub const MOMENT_NM: Self = Self { factor: 1.0, decimals: 6 };
    /// Numbers without a unit: 1/kappa, Q4, ratios.
    pub const PLAIN: Self = Self { factor: 1.0, decimals: 6 };
    /// Times in s.
    pub const TIME_S: Self = Self { factor: 1.0, decimals: 4 };
    /// Speeds, from m/s to mm/s.
    pub const SPEED_MM_PER_S: Self = Self { factor: 1e3, decimals: 4 };
    /// Speeds of turning, from rad/s to deg/s.
    pub const SPEED_DEG_PER_S: Self = Self { factor: 180.0 / std::f64::consts::PI, decimals: 4 };
    /// Rates of turning along a path, from rad/m to deg/mm.
    pub const RATE_DEG_PER_MM: Self = Self { factor: 180.0 / std::f64::consts::PI * 1e-3, decimals: 6 };

    /// The field of a CSV file.
    pub fn text(self, value: f64) -> String {
        fixed(value * self.factor, self.decimals)
    }

    /// The number of a JSON document: the one nearest to [`Unit::text`].
    pub fn number(self, value: f64) -> f64 {
        self.text(value).parse().unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn si_becomes_the_unit_of_the_file() {
        assert_eq!(Unit::PLACE_MM.text(1e-3), "1.0000");
        assert_eq!(Unit::DEFLECTION_MM.text(8.3e-5), "0.0830000");
        assert_eq!(Unit::ANGLE_DEG.text(-std::f64::consts::PI), "-180.0000");
        assert_eq!(Unit::RATE_DEG_PER_MM.text(0.9_f64.to_radians() * 1e3), "0.900000");
        assert_eq!(Unit::DEFLECTION_MM.number(8.300_000_04e-5), 0.083);
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(fixed(-0.0, 3), "0.000");
        assert_eq!(fixed(-0.0004, 3), "0.000");
        assert_eq!(fixed(-0.0006, 3), "-0.001");
        assert_eq!(fixed(-0.2, 0), "0");
        assert!(Unit::PLAIN.number(-1e-12).is_sign_positive());
    }
}
