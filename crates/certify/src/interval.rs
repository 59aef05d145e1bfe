//! Interval arithmetic in lanes, by middle and radius, without outward rounding: what is proven with it is proven up to
//! rounding.

use super::interval_simd::Lanes;
use super::number::ZERO;

/// An interval: all numbers within `radius` of `middle`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval {
    pub middle: Lanes,
    pub radius: Lanes,
}

impl Interval {
    /// A single number.
    #[inline(always)]
    pub fn point(middle: Lanes) -> Self {
        Self { middle, radius: ZERO }
    }

    /// From its ends.
    #[inline(always)]
    pub fn between(low: Lanes, high: Lanes) -> Self {
        Self { middle: (low + high) * 0.5, radius: (high - low) * 0.5 }
    }

    /// Lower end.
    #[inline(always)]
    pub fn low(self) -> Lanes {
        self.middle - self.radius
    }

    /// Upper end.
    #[inline(always)]
    pub fn high(self) -> Lanes {
        self.middle + self.radius
    }

    /// The largest magnitude in it.
    #[inline(always)]
    pub fn magnitude(self) -> Lanes {
        self.middle.abs() + self.radius
    }

    /// What two intervals that hold the same number leave for it.
    #[inline(always)]
    pub fn cut(self, other: Self) -> Self {
        Self::between(self.low().max(other.low()), self.high().min(other.high()))
    }

    #[inline(always)]
    pub fn add(self, other: Self) -> Self {
        Self { middle: self.middle + other.middle, radius: self.radius + other.radius }
    }

    #[inline(always)]
    pub fn sub(self, other: Self) -> Self {
        Self { middle: self.middle - other.middle, radius: self.radius + other.radius }
    }

    #[inline(always)]
    pub fn mul(self, other: Self) -> Self {
        Self {
            middle: self.middle * other.middle,
            radius: self.middle.abs() * other.radius + self.radius * (other.middle.abs() + other.radius),
        }
    }

    /// The square: non-negative.
    #[inline(always)]
    pub fn square(self) -> Self {
        let m = self.middle.abs();
        let high = (m + self.radius) * (m + self.radius);
        let low = (m - self.radius).max(ZERO);
        Self::between(low * low, high)
    }

    #[inline(always)]
    pub fn scale(self, factor: f64) -> Self {
        Self { middle: self.middle * factor, radius: self.radius * factor.abs() }
    }
}
