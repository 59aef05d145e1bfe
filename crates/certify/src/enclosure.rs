//! Intervals that are sure to hold the value, the gradient and the second derivatives of a function over a region.
//!
//! Interval arithmetic is in lanes, by middle and radius, without outward rounding: what is proven with it is proven up
//! to rounding.

mod functions;

use super::interval_simd::{Lanes, WIDTH};
use super::number::{Number, PAIRS, VARIABLES, ZERO, pairs};
use std::f64::consts::{PI, TAU};

/// Functions modelled: m, d1, d2, c_rz, c_tz and c_zz of [`ArmCompliance`].
pub(super) const FUNCTIONS: usize = 6;
/// Remainders of them: of m, of the length of (d1, d2), of that of (c_rz, c_tz), and of c_zz.
pub(super) const REMAINDERS: usize = 4;

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

/// A value and its gradient.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slope<const V: usize = VARIABLES> {
    pub value: Lanes,
    pub gradient: [Lanes; V],
}

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

/// Intervals for the value, the gradient and the second derivatives over a region; and the value and the gradient in
/// its middle, which with the next derivatives give a second, often closer, interval for each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enclosure<const V: usize = VARIABLES, const P: usize = PAIRS> {
    pub value: Interval,
    pub gradient: [Interval; V],
    pub second: [Interval; P],
    middle: Slope<V>,
    /// Half the widths of the region.
    half: [f64; V],
}

impl<const V: usize, const P: usize> Enclosure<V, P> {
    /// The two variables of each second derivative.
    pub const PAIR: [(usize, usize); P] = pairs::<V, P>();

    /// The independent variable number `index`, over an interval of the region.
    #[inline(always)]
    pub fn variable(middle: Lanes, index: usize, half: [f64; V]) -> Self {
        let mut out = Self::fixed(0.0, half);
        out.value = Interval { middle, radius: Lanes::splat(half[index]) };
        out.gradient[index] = Interval::point(Lanes::splat(1.0));
        out.middle = Slope::variable(middle, index);
        out
    }

    /// Sine and cosine of four headings, the last variable, each within its half width. rad
    #[inline(always)]
    pub fn heading(angles: [f64; WIDTH], half: [f64; V]) -> (Self, Self) {
        let (sine, cosine) = sine_cosine(angles, half[V - 1]);
        let middle = angles.map(libm::sincos);
        let negative = |i: Interval| Interval { middle: -i.middle, radius: i.radius };
        let (mut s, mut c) = (Self::fixed(0.0, half), Self::fixed(0.0, half));
        (s.value, s.gradient[V - 1], s.second[V - 1]) = (sine, cosine, negative(sine));
        (c.value, c.gradient[V - 1], c.second[V - 1]) = (cosine, negative(sine), negative(cosine));
        (s.middle, c.middle) = Slope::heading(Lanes(middle.map(|m| m.0)), Lanes(middle.map(|m| m.1)));
        (s, c)
    }

    /// What the second derivatives of each pair of variables are multiplied by.
    pub fn pair_factors(half: [f64; V]) -> [f64; P] {
        Self::PAIR.map(|(i, j)| half[i] * half[j] * if i == j { 0.5 } else { 1.0 })
    }

    /// Value and gradient in the middle.
    pub fn middle(&self) -> &Slope<V> {
        &self.middle
    }

    #[inline(always)]
    fn fixed(value: f64, half: [f64; V]) -> Self {
        let zero = Interval::point(ZERO);
        let middle = Slope::constant(value);
        Self { value: Interval::point(middle.value), gradient: [zero; V], second: [zero; P], middle, half }
    }

    /// With each interval cut down to what the middle and the next derivatives leave of it, where there are any.
    #[inline]
    fn tightened(mut self) -> Self {
        if V == 0 {
            return self;
        }
        let h = self.half;
        let max_second = self.second.map(Interval::magnitude);
        for k in 0..V {
            let radius = (0..P).fold(ZERO, |sum, p| match Self::PAIR[p] {
                (i, j) if i == k => sum + max_second[p] * h[j],
                (i, j) if j == k => sum + max_second[p] * h[i],
                _ => sum,
            });
            self.gradient[k] = self.gradient[k].cut(Interval { middle: self.middle.gradient[k], radius });
        }
        let mut radius = ZERO;
        for k in 0..V {
            radius = radius + self.middle.gradient[k].abs() * h[k];
        }
        for (p, (i, j)) in Self::PAIR.iter().enumerate() {
            radius = radius + max_second[p] * (if i == j { 0.5 } else { 1.0 } * h[*i] * h[*j]);
        }
        self.value = self.value.cut(Interval { middle: self.middle.value, radius });
        self
    }

    /// A function of it, from intervals that hold its value and first two derivatives, and these in the middle.
    #[inline(never)]
    fn through(self, middle: Slope<V>, value: Interval, first: Interval, second: Interval) -> Self {
        Self {
            value,
            gradient: self.gradient.map(|g| g.mul(first)),
            second: std::array::from_fn(|p| {
                let (k, l) = Self::PAIR[p];
                let product = if k == l { self.gradient[k].square() } else { self.gradient[k].mul(self.gradient[l]) };
                self.second[p].mul(first).add(product.mul(second))
            }),
            middle,
            half: self.half,
        }
        .tightened()
    }
}

/// An interval for the value alone.
pub(super) type ValueRange = Enclosure<0, 0>;

impl ValueRange {
    /// All numbers of an interval.
    #[inline(always)]
    pub fn over(value: Interval) -> Self {
        Self { value, middle: Slope { value: value.middle, gradient: [] }, ..Self::fixed(0.0, []) }
    }

    /// Sine and cosine of four angles, each within its half width. rad
    pub fn turning(angles: [f64; WIDTH], half: f64) -> (Self, Self) {
        let (sine, cosine) = sine_cosine(angles, half);
        (Self::over(sine), Self::over(cosine))
    }
}

/// What an affine model of N things leaves out of each, in the region whose second derivatives it knows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Remainder<const N: usize> {
    /// Their largest second derivatives by pair of variables, in the order of [`pairs`].
    bends: [[f32; N]; PAIRS],
    /// What is lost by writing the model with fewer digits.
    digits: [f32; N],
}

impl<const N: usize> Remainder<N> {
    /// Rounded up; `None` where it is not finite.
    pub fn new(bends: [[f64; N]; PAIRS], digits: [f64; N]) -> Option<Self> {
        let up = |x: f64| (x * (1.0 + 1e-6)) as f32;
        let made = Self { bends: bends.map(|of| of.map(up)), digits: digits.map(up) };
        let is_fine = |x: &f32| *x < 1e30;
        (made.digits.iter().all(is_fine) && made.bends.iter().flatten().all(is_fine)).then_some(made)
    }

    /// Within those distances of the middle of the region in each variable, which are no more than its half widths: the
    /// second derivatives are not known beyond.
    #[inline(always)]
    pub fn within(&self, h: [f64; VARIABLES]) -> [f64; N] {
        let mut out = self.digits.map(f64::from);
        for (bends, factor) in self.bends.iter().zip(<Enclosure>::pair_factors(h)) {
            (0..N).for_each(|f| out[f] += factor * f64::from(bends[f]));
        }
        out
    }

    /// What says within some distances what this says within others.
    #[cfg(test)]
    pub fn in_place_of(self, h: [f64; VARIABLES], other: [f64; VARIABLES]) -> Self {
        let factors = [h, other].map(<Enclosure>::pair_factors);
        let of = |p: usize| self.bends[p].map(|bend| bend * (factors[1][p] / factors[0][p]) as f32);
        Self { bends: std::array::from_fn(of), ..self }
    }

    /// So many times as much of each.
    #[cfg(test)]
    pub fn times(self, factors: [f32; N]) -> Self {
        let times = |of: [f32; N]| std::array::from_fn(|f| factors[f] * of[f]);
        Self { bends: self.bends.map(times), digits: times(self.digits) }
    }
}

/// The largest second derivatives of functions by pair of variables: of m, of the length of (d1, d2), of that of (c_rz,
/// c_tz), and of c_zz.
pub(super) fn bends<const V: usize, const P: usize>(
    functions: &[&Enclosure<V, P>; FUNCTIONS],
    lane: usize,
) -> [[f64; REMAINDERS]; P] {
    std::array::from_fn(|p| {
        let of = |f: usize| functions[f].second[p].magnitude().0[lane];
        [of(0), libm::hypot(of(1), of(2)), libm::hypot(of(3), of(4)), of(5)]
    })
}

/// What is lost of the same by writing values and gradients with fewer digits.
pub(super) fn digits<const V: usize, const P: usize>(
    functions: &[&Enclosure<V, P>; FUNCTIONS],
    lane: usize,
    half: [f64; V],
) -> [f64; REMAINDERS] {
    let size = |f: usize| {
        let middle = functions[f].middle();
        middle.value.0[lane].abs() + (0..V).map(|k| middle.gradient[k].0[lane].abs() * half[k]).sum::<f64>()
    };
    [size(0), size(1) + size(2), size(3) + size(4), size(5)].map(|size| 1e-7 * size)
}

/// Sine and cosine of four angles, each within its half width. rad
fn sine_cosine(angles: [f64; WIDTH], half: f64) -> (Interval, Interval) {
    let ends = angles.map(|angle| sine_cosine_over(angle - half, angle + half));
    let between = |low: [f64; WIDTH], high: [f64; WIDTH]| Interval::between(Lanes(low), Lanes(high));
    (between(ends.map(|e| e.0.0), ends.map(|e| e.0.1)), between(ends.map(|e| e.1.0), ends.map(|e| e.1.1)))
}

/// Least and largest sine and cosine between two angles less than a turn apart. rad
fn sine_cosine_over(from: f64, to: f64) -> ((f64, f64), (f64, f64)) {
    let (s0, c0) = libm::sincos(from);
    let (s1, c1) = libm::sincos(to);
    // Whether an angle of that kind (plus whole turns) is between.
    let holds = |angle: f64| ((to - angle) / TAU).floor() > ((from - angle) / TAU).floor();
    let range = |a: f64, b: f64, top: f64| {
        let high = if holds(top) { 1.0 } else { a.max(b) };
        let low = if holds(top + PI) { -1.0 } else { a.min(b) };
        (low, high)
    };
    (range(s0, s1, PI / 2.0), range(c0, c1, 0.0))
}
