//! Four numbers worked on at once: plain Rust that the compiler turns into vector instructions.

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
}

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

    /// Whether every lane says yes.
    #[inline(always)]
    pub fn all(self) -> bool {
        self.0.iter().fold(u64::MAX, |all, lane| all & lane) == u64::MAX
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
