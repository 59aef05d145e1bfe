//! Numbers that the kinematics can be evaluated with: `f64`, or [`Dual`] for exact first derivatives.
//!
//! Every transcendental function goes through the pure Rust `libm`, so that a result does not depend on the C library
//! of the machine it was computed on.

use nalgebra::{ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign};
use num_traits::{One, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A real number, with or without derivatives carried along.
pub trait Scalar:
    Copy
    + Debug
    + PartialEq
    + Zero
    + One
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
    + 'static
{
    /// The number whose derivatives are all zero.
    fn constant(value: f64) -> Self;
    /// The number without its derivatives.
    fn value(self) -> f64;
    /// Square root; the derivative at zero is taken as zero.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Angle of the vector (x, self), in (-pi, pi].
    fn atan2(self, x: Self) -> Self;
    /// Multiplies by a plain number.
    fn scale(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }
    /// The absolute value.
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        libm::sqrt(self)
    }
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
    fn atan2(self, x: Self) -> Self {
        libm::atan2(self, x)
    }
}

/// A number with its gradient with respect to `N` independent variables (forward differentiation).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// The partial derivatives.
    pub gradient: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The independent variable number `index`, at `value`.
    #[inline]
    pub fn variable(value: f64, index: usize) -> Self {
        let mut gradient = [0.0; N];
        gradient[index] = 1.0;
        Self { value, gradient }
    }

    /// Applies the chain rule: `value` is f(self), `slope` its derivative f'(self).
    #[inline]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, gradient: self.gradient.map(|g| g * slope) }
    }

    /// `a * self' + b * other'` beside the given value.
    #[inline]
    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        let mut gradient = [0.0; N];
        for (k, g) in gradient.iter_mut().enumerate() {
            *g = a * self.gradient[k] + b * other.gradient[k];
        }
        Self { value, gradient }
    }
}

impl<const N: usize> Scalar for Dual<N> {
    #[inline]
    fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; N] }
    }
    #[inline]
    fn value(self) -> f64 {
        self.value
    }
    #[inline]
    fn scale(self, factor: f64) -> Self {
        self.chain(self.value * factor, factor)
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = libm::sqrt(self.value);
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = libm::sincos(self.value);
        (self.chain(sine, cosine), self.chain(cosine, -sine))
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let (a, b) = if square > 0.0 { (x.value / square, -self.value / square) } else { (0.0, 0.0) };
        self.combine(x, libm::atan2(self.value, x.value), a, b)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.combine(other, self.value + other.value, 1.0, 1.0)
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.combine(other, self.value - other.value, 1.0, -1.0)
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.combine(other, value, 1.0 / other.value, -value / other.value)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> SubAssign for Dual<N> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const N: usize> MulAssign for Dual<N> {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<const N: usize> DivAssign for Dual<N> {
    #[inline]
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl<const N: usize> Zero for Dual<N> {
    #[inline]
    fn zero() -> Self {
        Self::constant(0.0)
    }
    #[inline]
    fn is_zero(&self) -> bool {
        self.value == 0.0 && self.gradient.iter().all(|g| *g == 0.0)
    }
}

impl<const N: usize> One for Dual<N> {
    #[inline]
    fn one() -> Self {
        Self::constant(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A function that uses every operation once.
    fn sample<T: Scalar>(x: T, y: T) -> T {
        let (s, c) = (x * y).sin_cos();
        let root = (x * x + y * y + T::one()).sqrt();
        (s / root - c).abs() + y.atan2(x) - x.scale(0.3) * (-y)
    }

    proptest! {
        #[test]
        fn gradient_agrees_with_central_differences(x in 0.2..3.0_f64, y in -3.0..3.0_f64) {
            let exact = sample(Dual::<2>::variable(x, 0), Dual::<2>::variable(y, 1));
            prop_assert!((exact.value - sample(x, y)).abs() < 1e-14);
            let h = 1e-6;
            let by_x = (sample(x + h, y) - sample(x - h, y)) / (2.0 * h);
            let by_y = (sample(x, y + h) - sample(x, y - h)) / (2.0 * h);
            // Away from the kink of the absolute value.
            let (s, c) = libm::sincos(x * y);
            let inside = s / libm::sqrt(x * x + y * y + 1.0) - c;
            prop_assume!(inside.abs() > 1e-4);
            prop_assert!((exact.gradient[0] - by_x).abs() < 1e-7, "{} {}", exact.gradient[0], by_x);
            prop_assert!((exact.gradient[1] - by_y).abs() < 1e-7, "{} {}", exact.gradient[1], by_y);
        }
    }
}
