//! What the closed form needs of a number, and the plain one: [`Slope`], a value with its gradient, in lanes.
//!
//! The other is [`super::enclosure::Enclosure`]: intervals for value, gradient and second derivatives over a whole
//! region. One formula serves both ([`super::arm`]).

use super::continuation::{Bend, Links};
use super::interval_simd::{Lanes, Mask};
use std::ops::{Add, Mul, Neg, Sub};

/// Independent variables: radius and height of the tool centre point, heading of the spindle against its azimuth.
pub(super) const VARIABLES: usize = 3;
/// Pairs of variables, in the order of [`pairs`]: rr, zz, ee, rz, re, ze.
pub(super) const PAIRS: usize = 6;
/// Independent variables of a tool that leans: the place of the tool centre point in the frame of the workpiece about
/// axis 1, and the turn of the spindle about its axis.
pub(super) const LEANING: usize = 4;
/// Pairs of these.
pub(super) const LEANING_PAIRS: usize = 10;

/// The two variables of each pair, the diagonal first.
pub(super) const fn pairs<const V: usize, const P: usize>() -> [(usize, usize); P] {
    let mut out = [(0, 0); P];
    let (mut i, mut next) = (0, V);
    while i < V {
        out[i] = (i, i);
        let mut j = i + 1;
        while j < V {
            out[next] = (i, j);
            (next, j) = (next + 1, j + 1);
        }
        i += 1;
    }
    out
}

/// What the closed form needs of a number.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// The same plain number in every lane.
    fn constant(value: f64) -> Self;
    /// Times a plain number.
    fn scale(self, factor: f64) -> Self;
    /// Plus a plain number.
    fn plus(self, term: f64) -> Self;
    /// Square.
    fn square(self) -> Self;
    /// Square root of what is above zero.
    fn sqrt(self) -> Self;
    /// One over the square root of what is above zero.
    fn inverse_sqrt(self) -> Self;
    /// One over what is above zero, or below.
    fn reciprocal(self) -> Self;
    /// The angle of which it is the tangent, less than a quarter of a turn.
    fn arctangent(self) -> Self;
    /// Of the squared distance q of the wrist centre from the shoulder, above zero: the sine of the elbow angle, and
    /// the elbow's components along and across the line between them, alpha and beta of `elbow = alpha S + beta S'`.
    /// Each is a function of q alone.
    fn elbow(self, links: &Links) -> [Self; 3];
    /// Of the cosine of the angle between axes 4 and 6: one over its squared sine.
    fn wrist(self, bend: &Bend) -> Self;
    /// Where it is sure to be below zero.
    fn is_negative(self) -> Mask;
    /// What it is at least.
    fn low(self) -> Lanes;
    /// What it is at most.
    fn high(self) -> Lanes;
    /// The same, where it is sure to be above `floor`; elsewhere the lane leaves `sure`, and anything may come out.
    fn assume_above(self, floor: f64, sure: &mut Mask) -> Self;
}

/// A value and its gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slope<const V: usize = VARIABLES> {
    pub value: Lanes,
    pub gradient: [Lanes; V],
}

/// Zero in every lane.
pub(super) const ZERO: Lanes = Lanes([0.0; super::interval_simd::WIDTH]);

impl<const V: usize> Slope<V> {
    /// The independent variable number `index`.
    #[inline(always)]
    pub fn variable(value: Lanes, index: usize) -> Self {
        let mut gradient = [ZERO; V];
        gradient[index] = Lanes::splat(1.0);
        Self { value, gradient }
    }

    /// Sine and cosine of the heading, the last variable, given as plain numbers.
    #[inline(always)]
    pub fn heading(sine: Lanes, cosine: Lanes) -> (Self, Self) {
        let of = |value: Lanes, slope: Lanes| {
            let mut gradient = [ZERO; V];
            gradient[V - 1] = slope;
            Self { value, gradient }
        };
        (of(sine, cosine), of(cosine, -sine))
    }

    /// A function of it, from its value and derivative there.
    #[inline(always)]
    fn through(self, value: Lanes, derivative: Lanes) -> Self {
        Self { value, gradient: self.gradient.map(|g| g * derivative) }
    }
}

impl<const V: usize> Add for Slope<V> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            gradient: std::array::from_fn(|k| self.gradient[k] + other.gradient[k]),
        }
    }
}

impl<const V: usize> Sub for Slope<V> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            gradient: std::array::from_fn(|k| self.gradient[k] - other.gradient[k]),
        }
    }
}

impl<const V: usize> Mul for Slope<V> {
    type Output = Self;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule adds")]
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            gradient: std::array::from_fn(|k| self.gradient[k] * other.value + other.gradient[k] * self.value),
        }
    }
}

impl<const V: usize> Neg for Slope<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, gradient: self.gradient.map(|g| -g) }
    }
}

impl<const V: usize> Number for Slope<V> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value: Lanes::splat(value), gradient: [ZERO; V] }
    }
    #[inline(always)]
    fn scale(self, factor: f64) -> Self {
        Self { value: self.value * factor, gradient: self.gradient.map(|g| g * factor) }
    }
    #[inline(always)]
    fn plus(self, term: f64) -> Self {
        Self { value: self.value + term, gradient: self.gradient }
    }
    #[inline(always)]
    fn square(self) -> Self {
        self.through(self.value * self.value, self.value + self.value)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.through(root, Lanes::splat(0.5) / root)
    }
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        let inverse = Lanes::splat(1.0) / self.value;
        let root = inverse.sqrt();
        self.through(root, root * inverse * -0.5)
    }
    #[inline(always)]
    fn reciprocal(self) -> Self {
        let inverse = Lanes::splat(1.0) / self.value;
        self.through(inverse, -(inverse * inverse))
    }
    #[inline(always)]
    fn arctangent(self) -> Self {
        let first = Lanes::splat(1.0) / (self.value * self.value + 1.0);
        self.through(Lanes(self.value.0.map(libm::atan)), first)
    }
    #[inline(always)]
    fn elbow(self, links: &Links) -> [Self; 3] {
        let inverse = Lanes::splat(1.0) / self.value;
        let half = 0.5 * (links.upper_arm * links.upper_arm - links.forearm * links.forearm);
        let area = links.upper_arm * links.forearm;
        let [s, first, _] = links.sine(self.value);
        let alpha = inverse * half + 0.5;
        let beta = s * inverse * area;
        [
            self.through(s, first),
            self.through(alpha, -(inverse * inverse * half)),
            self.through(beta, (first - s * inverse) * inverse * area),
        ]
    }
    #[inline(always)]
    fn wrist(self, bend: &Bend) -> Self {
        let [value, first, _] = bend.inverse(self.value);
        self.through(value, first)
    }
    #[inline(always)]
    fn is_negative(self) -> Mask {
        self.value.less(ZERO)
    }
    #[inline(always)]
    fn low(self) -> Lanes {
        self.value
    }
    #[inline(always)]
    fn high(self) -> Lanes {
        self.value
    }
    #[inline(always)]
    fn assume_above(self, floor: f64, sure: &mut Mask) -> Self {
        *sure = *sure & Lanes::splat(floor).less(self.value);
        self
    }
}
