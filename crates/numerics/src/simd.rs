//! Several numbers worked on at once, by the widest vectors that the processor has.
//!
//! Every operation is exactly the one of `f64` (or of `f32`: [`LaneNumber`]) in each lane, nothing is fused and nothing
//! is summed across lanes, so results do not depend on the width of the vectors. Choices are made with masks, never
//! with branches.

mod number;

pub use number::{LaneNumber, LaneRows, Simd};

use pulp::{Arch, Scalar256b, bytemuck};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Sub};

/// Most lanes that any processor has here: rows that are read in lanes go on this far beyond their end.
pub const MAX_LANES: usize = 8;

/// Work in lanes, for any instructions of the processor.
pub trait WithSimd {
    /// What it works with.
    type Number: LaneNumber;
    /// What it gives.
    type Output;

    /// The work, where `simd` says with which instructions.
    fn with_simd<S: Simd<Number = Self::Number>>(self, simd: S) -> Self::Output;
}

/// Work for the instructions of `pulp`.
struct Work<W>(W);

impl<W: WithSimd> pulp::WithSimd for Work<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<P: pulp::Simd>(self, simd: P) -> W::Output {
        self.0.with_simd(W::Number::vectors(simd))
    }
}

/// Which instructions of the processor are used: chosen once, the same results for all.
#[derive(Debug, Clone, Copy)]
pub struct Instructions(Option<Arch>);

impl Instructions {
    /// The best that this processor has.
    pub fn best() -> Self {
        match Arch::new() {
            Arch::Scalar => Self::plain(),
            arch => Self(Some(arch)),
        }
    }

    /// What every processor has.
    pub fn plain() -> Self {
        Self(None)
    }

    /// Plain ones, and the best that this processor has.
    pub fn all() -> [Self; 2] {
        [Self::plain(), Self::best()]
    }

    /// Runs `work` with them.
    #[inline(always)]
    pub fn run<W: WithSimd>(self, work: W) -> W::Output {
        match self.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Some(Arch::V3(simd)) => pulp::Simd::vectorize(simd, Work(work)),
            #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
            Some(arch) => arch.dispatch(Work(work)),
            _ => plain(work),
        }
    }
}

/// Work with what every processor has. As with the wide instructions, a function of its own: in one with the others it
/// would add its stack to theirs in builds without optimisation, megabytes of it.
#[inline(never)]
fn plain<W: WithSimd>(work: W) -> W::Output {
    pulp::WithSimd::with_simd(Work(work), Scalar256b)
}

/// Some numbers, as many as `S` has lanes.
#[derive(Debug, Clone, Copy)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::Values,
}

/// As many yes or no answers.
#[derive(Debug, Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    bits: S::Answers,
}

macro_rules! lanewise {
    ($trait:ident, $method:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self { values: self.simd.$method(self.values, other.values), ..self }
            }
        }
        impl<S: Simd> $trait<f64> for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(Self::splat(self.simd, other))
            }
        }
    };
}

lanewise!(Add, add);
lanewise!(Sub, sub);
lanewise!(Mul, mul);
lanewise!(Div, div);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { values: self.simd.neg(self.values), ..self }
    }
}

impl<S: Simd> Lanes<S> {
    /// Number of lanes.
    pub const COUNT: usize = S::COUNT;

    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat(S::Number::of(value)) }
    }

    /// The same number in every lane, as many as here.
    #[inline(always)]
    pub fn all(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// The same number of the lanes' kind in every lane, as many as here.
    #[inline(always)]
    pub fn all_of(self, value: S::Number) -> Self {
        Self { values: self.simd.splat(value), ..self }
    }

    /// The product with a number of the lanes' kind.
    #[inline(always)]
    pub fn times(self, factor: S::Number) -> Self {
        self * self.all_of(factor)
    }

    /// Neighbours in a slice, from `start`.
    #[inline(always)]
    pub fn load(simd: S, values: &[S::Number], start: usize) -> Self {
        Self { simd, values: S::from_slice(&values[start..start + Self::COUNT]) }
    }

    /// Writes to neighbours in a slice, from `start`.
    #[inline(always)]
    pub fn store(self, values: &mut [S::Number], start: usize) {
        S::to_slice(self.values, &mut values[start..start + Self::COUNT]);
    }

    /// The numbers, and zeros after the last lane.
    #[inline(always)]
    pub fn to_array(self) -> [S::Number; MAX_LANES] {
        let mut array = [S::Number::of(0.0); MAX_LANES];
        self.store(&mut array, 0);
        array
    }

    /// Small whole numbers, and zeros after the last lane.
    #[inline(always)]
    pub fn to_whole(self) -> [i16; MAX_LANES] {
        let shifted = (self + S::Number::SHIFT).to_array();
        let mut whole = [0; MAX_LANES];
        for (whole, shifted) in whole.iter_mut().zip(shifted) {
            *whole = shifted.low_bits();
        }
        whole
    }

    /// A function of the number in every lane.
    #[inline(always)]
    pub fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let mut array = self.to_array();
        for value in &mut array[..Self::COUNT] {
            *value = S::Number::of(function(value.get()));
        }
        Self::load(self.simd, &array, 0)
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self { values: self.simd.sqrt(self.values), ..self }
    }

    /// Absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self { values: self.simd.abs(self.values), ..self }
    }

    /// The nearest whole number, for magnitudes below 2^51 (2^22 of `f32`).
    #[inline(always)]
    pub fn round(self) -> Self {
        (self + S::Number::SHIFT) - S::Number::SHIFT
    }

    /// The smallest whole number not below, for magnitudes below 2^51.
    #[inline(always)]
    pub fn ceil(self) -> Self {
        let near = self.round();
        near.less(self).select(near + 1.0, near)
    }

    /// Which lanes are below the other's; none that is NaN.
    #[inline(always)]
    pub fn less(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, bits: self.simd.less(self.values, other.values) }
    }

    /// Which lanes are below or equal to the other's; none that is NaN.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, bits: self.simd.at_most(self.values, other.values) }
    }

    /// Which lanes are equal to the other's; none that is NaN.
    #[inline(always)]
    pub fn equal(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, bits: self.simd.equal(self.values, other.values) }
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
        Self { values: self.simd.with_sign_of(self.values, sign.values), ..self }
    }

    /// Angle of the vector (x, self) in [-pi, pi], to 4e-16 relative (2e-7 of `f32`); zero for the zero vector.
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
        let zero = denominator.at_most(self.all(0.0));
        let q = numerator / zero.select(self.all(1.0), denominator);
        let z = q * q;
        let mut p = self.all(ATAN[11]);
        for k in (0..11).rev() {
            p = p * z + ATAN[k];
        }
        let mut angle = p * q;
        angle = far.select(angle + FRAC_PI_4, angle);
        angle = swap.select(self.all(FRAC_PI_2) - angle, angle);
        angle = x.less(self.all(0.0)).select(self.all(PI) - angle, angle);
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

impl<S: Simd> Mask<S> {
    /// The same answer in every lane.
    #[inline(always)]
    pub fn splat(simd: S, yes: bool) -> Self {
        let one = Lanes::splat(simd, 1.0);
        if yes { one.at_most(one) } else { one.less(one) }
    }

    /// Where yes `yes`, elsewhere `no`.
    #[inline(always)]
    pub fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, values: self.simd.select(self.bits, yes.values, no.values) }
    }

    /// Whether any lane says yes.
    #[inline(always)]
    pub fn any(self) -> bool {
        bytemuck::bytes_of(&self.bits).iter().fold(0, |all, bits| all | bits) != 0
    }

    /// The first lane that says yes; as many as there are lanes where none does.
    #[inline(always)]
    pub fn first(self) -> usize {
        let bytes = bytemuck::bytes_of(&self.bits);
        let mut mask = 0;
        for k in 0..S::COUNT {
            mask |= (u32::from(bytes[size_of::<S::Number>() * k]) & 1) << k;
        }
        if mask == 0 { S::COUNT } else { mask.trailing_zeros() as usize }
    }

    /// Yes here but not there.
    #[inline(always)]
    pub fn and_not(self, other: Self) -> Self {
        Self { bits: self.simd.and(self.bits, self.simd.not(other.bits)), ..self }
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self { bits: self.simd.and(self.bits, other.bits), ..self }
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self { bits: self.simd.or(self.bits, other.bits), ..self }
    }
}

#[cfg(test)]
mod tests;
