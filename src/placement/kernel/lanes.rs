//! Four numbers worked on at once: plain Rust that the compiler turns into vector instructions.
//!
//! Every operation is exactly the one of `f64` in each lane, so results do not depend on the width of the machine's
//! vectors. Choices are made with masks, never with branches.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// Number of lanes.
pub const WIDTH: usize = 4;

/// Four numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lanes(pub [f64; WIDTH]);

/// Four yes or no answers, all bits set for yes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mask(pub [u64; WIDTH]);

macro_rules! lanewise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $method(self, other: Lanes) -> Lanes {
                let mut out = [0.0; WIDTH];
                for k in 0..WIDTH {
                    out[k] = self.0[k] $op other.0[k];
                }
                Lanes(out)
            }
        }
        impl $trait<f64> for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $method(self, other: f64) -> Lanes {
                self $op Lanes::splat(other)
            }
        }
    };
}

lanewise!(Add, add, +);
lanewise!(Sub, sub, -);
lanewise!(Mul, mul, *);
lanewise!(Div, div, /);

impl Neg for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn neg(self) -> Lanes {
        Lanes(self.0.map(|v| -v))
    }
}

impl Lanes {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Self([value; WIDTH])
    }

    /// Four neighbours of a slice, from `start`.
    #[inline(always)]
    pub fn load(values: &[f64], start: usize) -> Self {
        let mut out = [0.0; WIDTH];
        out.copy_from_slice(&values[start..start + WIDTH]);
        Self(out)
    }

    /// Writes to four neighbours of a slice, from `start`.
    #[inline(always)]
    pub fn store(self, values: &mut [f64], start: usize) {
        values[start..start + WIDTH].copy_from_slice(&self.0);
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }

    /// Absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }

    /// The nearest whole number, for magnitudes below 2^51.
    #[inline(always)]
    pub fn round(self) -> Self {
        const SHIFT: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
        (self + SHIFT) - SHIFT
    }

    /// The smallest whole number not below, for magnitudes below 2^51.
    #[inline(always)]
    pub fn ceil(self) -> Self {
        let near = self.round();
        near.less(self).select(near + 1.0, near)
    }

    /// Which lanes are below the other's.
    #[inline(always)]
    pub fn less(self, other: Self) -> Mask {
        let mut out = [0; WIDTH];
        for k in 0..WIDTH {
            out[k] = if self.0[k] < other.0[k] { u64::MAX } else { 0 };
        }
        Mask(out)
    }

    /// Which lanes are below or equal to the other's.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> Mask {
        let mut out = [0; WIDTH];
        for k in 0..WIDTH {
            out[k] = if self.0[k] <= other.0[k] { u64::MAX } else { 0 };
        }
        Mask(out)
    }

    /// The larger of two, lane by lane.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.less(other).select(other, self)
    }

    /// The smaller of two, lane by lane.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        other.less(self).select(other, self)
    }

    /// The magnitude with the sign of `sign`.
    #[inline(always)]
    pub fn with_sign_of(self, sign: Self) -> Self {
        const SIGN: u64 = 1 << 63;
        let mut out = [0.0; WIDTH];
        for k in 0..WIDTH {
            out[k] = f64::from_bits((self.0[k].to_bits() & !SIGN) | (sign.0[k].to_bits() & SIGN));
        }
        Self(out)
    }

    /// Angle of the vector (x, self) in [-pi, pi], to 4e-16 relative; zero for the zero vector.
    #[inline(always)]
    pub fn atan2(self, x: Self) -> Self {
        use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
        // atan(sqrt z)/sqrt z on [0, tan(pi/8)^2], Chebyshev fit, relative error 1.3e-18.
        let (ax, ay) = (x.abs(), self.abs());
        let swap = ax.less(ay);
        let (big, small) = (swap.select(ay, ax), swap.select(ax, ay));
        // Beyond tan(pi/8) turn by pi/4: atan q = pi/4 + atan((q - 1) / (q + 1)).
        let far = (big * 0.414_213_562_373_095_03).less(small);
        let numerator = far.select(small - big, small);
        let denominator = far.select(small + big, big);
        let zero = denominator.at_most(Self::splat(0.0));
        let q = numerator / zero.select(Self::splat(1.0), denominator);
        let z = q * q;
        let mut p = Self::splat(ATAN[11]);
        for k in (0..11).rev() {
            p = p * z + ATAN[k];
        }
        let mut angle = p * q;
        angle = far.select(angle + FRAC_PI_4, angle);
        angle = swap.select(Self::splat(FRAC_PI_2) - angle, angle);
        angle = x.less(Self::splat(0.0)).select(Self::splat(PI) - angle, angle);
        angle.with_sign_of(self)
    }
}

/// Coefficients of [`Lanes::atan2`].
const ATAN: [f64; 12] = [
    1.0,
    -0.3333333333333312,
    0.1999999999994089,
    -0.1428571427925024,
    0.11111110744919396,
    -0.09090896809056438,
    0.07692045330765912,
    -0.06662951812061838,
    0.05846878285787001,
    -0.050351024039430294,
    0.037965256099576565,
    -0.017805395704537506,
];

impl Mask {
    /// Where yes `yes`, elsewhere `no`.
    #[inline(always)]
    pub fn select(self, yes: Lanes, no: Lanes) -> Lanes {
        let mut out = [0.0; WIDTH];
        for k in 0..WIDTH {
            out[k] = f64::from_bits((yes.0[k].to_bits() & self.0[k]) | (no.0[k].to_bits() & !self.0[k]));
        }
        Lanes(out)
    }

    /// Whether any lane says yes.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.iter().fold(0, |all, bits| all | bits) != 0
    }

    /// Whether every lane that the other says yes in says yes here.
    #[inline(always)]
    pub fn covers(self, other: Self) -> bool {
        (0..WIDTH).fold(0, |missing, k| missing | (other.0[k] & !self.0[k])) == 0
    }

    /// The answer of one lane.
    #[inline(always)]
    pub fn lane(self, k: usize) -> bool {
        self.0[k] != 0
    }

    /// The same answer in every lane.
    #[inline(always)]
    pub fn splat(yes: bool) -> Self {
        Self([if yes { u64::MAX } else { 0 }; WIDTH])
    }
}

impl BitAnd for Mask {
    type Output = Mask;
    #[inline(always)]
    fn bitand(self, other: Mask) -> Mask {
        let mut out = [0; WIDTH];
        for k in 0..WIDTH {
            out[k] = self.0[k] & other.0[k];
        }
        Mask(out)
    }
}

impl BitOr for Mask {
    type Output = Mask;
    #[inline(always)]
    fn bitor(self, other: Mask) -> Mask {
        let mut out = [0; WIDTH];
        for k in 0..WIDTH {
            out[k] = self.0[k] | other.0[k];
        }
        Mask(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn atan2(y: f64, x: f64) -> f64 {
        Lanes::splat(y).atan2(Lanes::splat(x)).0[0]
    }

    proptest! {
        #[test]
        fn arctangent_agrees_with_libm(angle in -PI..PI, scale in -12.0..12.0_f64) {
            let r = libm::exp(scale);
            let (y, x) = (r * libm::sin(angle), r * libm::cos(angle));
            let expected = libm::atan2(y, x);
            prop_assert!((atan2(y, x) - expected).abs() <= 4.5e-16 * expected.abs().max(1e-300), "{y} {x}");
        }

        #[test]
        fn rounding_and_choice(value in -1e6..1e6_f64, other in -1e6..1e6_f64) {
            let (a, b) = (Lanes::splat(value), Lanes::splat(other));
            prop_assert_eq!(a.ceil().0[1], value.ceil());
            prop_assert!((a.round().0[2] - value).abs() <= 0.5);
            prop_assert_eq!(a.max(b).0[3], value.max(other));
            prop_assert_eq!(a.min(b).0[3], value.min(other));
            prop_assert_eq!(a.less(b).lane(0), value < other);
            prop_assert_eq!(a.with_sign_of(b).0[0], value.copysign(other));
        }
    }

    #[test]
    fn arctangent_on_the_axes() {
        for (y, x) in
            [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (0.0, 0.0), (-0.0, -1.0)]
        {
            assert!((atan2(y, x) - libm::atan2(y, x)).abs() <= 4.5e-16, "{y} {x}");
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
        // What comes out NaN must never pass a comparison.
        assert!(!Lanes::splat(f64::NAN).at_most(Lanes::splat(1.0)).any());
    }
}
