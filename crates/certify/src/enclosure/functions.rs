//! Functions of values with their gradients, and of enclosures.

use super::super::continuation::{Bend, Links};
use super::super::interval_simd::{Lanes, Mask};
use super::super::number::{Number, ZERO};
use super::{Enclosure, Interval, Slope};
use std::ops::{Add, Mul, Neg, Sub};

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

/// The half widths of whichever is not a constant.
#[inline(always)]
fn widths<const V: usize, const P: usize>(a: &Enclosure<V, P>, b: &Enclosure<V, P>) -> [f64; V] {
    std::array::from_fn(|k| a.half[k].max(b.half[k]))
}

impl<const V: usize, const P: usize> Add for Enclosure<V, P> {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value.add(other.value),
            gradient: std::array::from_fn(|k| self.gradient[k].add(other.gradient[k])),
            second: std::array::from_fn(|p| self.second[p].add(other.second[p])),
            middle: self.middle + other.middle,
            half: widths(&self, &other),
        }
        .tightened()
    }
}

impl<const V: usize, const P: usize> Sub for Enclosure<V, P> {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value.sub(other.value),
            gradient: std::array::from_fn(|k| self.gradient[k].sub(other.gradient[k])),
            second: std::array::from_fn(|p| self.second[p].sub(other.second[p])),
            middle: self.middle - other.middle,
            half: widths(&self, &other),
        }
        .tightened()
    }
}

impl<const V: usize, const P: usize> Mul for Enclosure<V, P> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (&self, &other);
        Self {
            value: a.value.mul(b.value),
            gradient: std::array::from_fn(|k| a.gradient[k].mul(b.value).add(b.gradient[k].mul(a.value))),
            second: std::array::from_fn(|p| {
                let (k, l) = Self::PAIR[p];
                let outer = a.second[p].mul(b.value).add(b.second[p].mul(a.value));
                let cross = a.gradient[k].mul(b.gradient[l]);
                let cross = if k == l { cross.scale(2.0) } else { cross.add(a.gradient[l].mul(b.gradient[k])) };
                outer.add(cross)
            }),
            middle: self.middle * other.middle,
            half: widths(a, b),
        }
        .tightened()
    }
}

impl<const V: usize, const P: usize> Neg for Enclosure<V, P> {
    type Output = Self;
    #[inline(never)]
    fn neg(self) -> Self {
        self.scale(-1.0)
    }
}

impl<const V: usize, const P: usize> Number for Enclosure<V, P> {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::fixed(value, [0.0; V])
    }
    #[inline(never)]
    fn scale(self, factor: f64) -> Self {
        Self {
            value: self.value.scale(factor),
            gradient: self.gradient.map(|g| g.scale(factor)),
            second: self.second.map(|s| s.scale(factor)),
            middle: self.middle.scale(factor),
            half: self.half,
        }
    }
    #[inline(always)]
    fn plus(self, term: f64) -> Self {
        let value = Interval { middle: self.value.middle + term, radius: self.value.radius };
        Self { value, middle: self.middle.plus(term), ..self }
    }
    #[inline(never)]
    fn square(self) -> Self {
        Self {
            value: self.value.square(),
            gradient: self.gradient.map(|g| g.mul(self.value).scale(2.0)),
            second: std::array::from_fn(|p| {
                let (k, l) = Self::PAIR[p];
                let product = if k == l { self.gradient[k].square() } else { self.gradient[k].mul(self.gradient[l]) };
                self.second[p].mul(self.value).add(product).scale(2.0)
            }),
            middle: self.middle.square(),
            half: self.half,
        }
        .tightened()
    }
    #[inline(never)]
    fn sqrt(self) -> Self {
        let (low, high) = (self.value.low().sqrt(), self.value.high().sqrt());
        let (a, b) = (Lanes::splat(1.0) / high, Lanes::splat(1.0) / low);
        let first = Interval::between(a * 0.5, b * 0.5);
        let second = Interval::between(b * b * b * -0.25, a * a * a * -0.25);
        self.through(self.middle.sqrt(), Interval::between(low, high), first, second)
    }
    #[inline(never)]
    fn inverse_sqrt(self) -> Self {
        let one = Lanes::splat(1.0);
        let (a, b) = (one / self.value.high(), one / self.value.low());
        let (p, q) = (a.sqrt(), b.sqrt());
        let first = Interval::between(q * b * -0.5, p * a * -0.5);
        let second = Interval::between(p * a * a * 0.75, q * b * b * 0.75);
        self.through(self.middle.inverse_sqrt(), Interval::between(p, q), first, second)
    }
    #[inline(never)]
    fn reciprocal(self) -> Self {
        let (a, b) = (Lanes::splat(1.0) / self.value.high(), Lanes::splat(1.0) / self.value.low());
        let (a2, b2) = (a * a, b * b);
        let (a3, b3) = (a2 * a, b2 * b);
        let first = Interval::between(-(a2.max(b2)), -(a2.min(b2)));
        let second = Interval::between(a3.min(b3) * 2.0, a3.max(b3) * 2.0);
        self.through(self.middle.reciprocal(), Interval::between(a.min(b), a.max(b)), first, second)
    }
    #[inline(never)]
    fn arctangent(self) -> Self {
        let (low, high) = (self.value.low(), self.value.high());
        let value = Interval::between(Lanes(low.0.map(libm::atan)), Lanes(high.0.map(libm::atan)));
        let first = |t: Lanes| Lanes::splat(1.0) / (t * t + 1.0);
        let (a, b) = (first(low), first(high));
        let holds = |t: f64| low.at_most(Lanes::splat(t)) & Lanes::splat(t).at_most(high);
        let steepest = holds(0.0).select(Lanes::splat(1.0), a.max(b));
        // -2 t / (1 + t^2)^2 is least and largest at 1 / sqrt 3 and at -1 / sqrt 3.
        let bend = |t: Lanes, first: Lanes| t * first * first * -2.0;
        let (p, q) = (bend(low, a), bend(high, b));
        let (turn, most) = (1.0 / 3.0_f64.sqrt(), 0.375 * 3.0_f64.sqrt());
        let least = holds(turn).select(Lanes::splat(-most), p.min(q));
        let largest = holds(-turn).select(Lanes::splat(most), p.max(q));
        let second = Interval::between(least, largest);
        self.through(self.middle.arctangent(), value, Interval::between(a.min(b), steepest), second)
    }
    #[inline(never)]
    fn elbow(self, links: &Links) -> [Self; 3] {
        let [s, alpha, beta] = self.middle.elbow(links);
        let (low, high) = (self.value.low(), self.value.high());
        let ([s0, d0, c0], [s1, d1, c1]) = (links.sine(low), links.sine(high));
        // The sine is concave in q, and largest at the right angle.
        let one = Lanes::splat(1.0);
        let holds_top = low.at_most(Lanes::splat(links.square())) & Lanes::splat(links.square()).at_most(high);
        let top = holds_top.select(one, s0.max(s1));
        let sine = Interval::between(s0.min(s1), top);
        let first = Interval::between(d1, d0);
        // The second derivative is largest in magnitude at the ends, least at the right angle, and zero where
        // continued.
        let bend = 1.0 / (2.0 * links.upper_arm * links.forearm);
        let beyond = low.less(Lanes::splat(links.limits[0])) | Lanes::splat(links.limits[1]).less(high);
        let flattest = beyond.select(Lanes::splat(0.0), holds_top.select(Lanes::splat(-bend * bend), c0.max(c1)));
        let second = Interval::between(c0.min(c1), flattest);
        let inverse = Interval::between(one / high, one / low);
        let inverse2 = Interval::between(one / (high * high), one / (low * low));
        let inverse3 = Interval::between(one / (high * high * high), one / (low * low * low));
        let half = 0.5 * (links.upper_arm * links.upper_arm - links.forearm * links.forearm);
        let area = links.upper_arm * links.forearm;
        let along = inverse.scale(half);
        let along = Interval { middle: along.middle + 0.5, radius: along.radius };
        let across = [
            sine.mul(inverse),
            first.mul(inverse).sub(sine.mul(inverse2)),
            second.mul(inverse).sub(first.mul(inverse2).scale(2.0)).add(sine.mul(inverse3).scale(2.0)),
        ]
        .map(|i| i.scale(area));
        [
            self.through(s, sine, first, second),
            self.through(alpha, along, inverse2.scale(-half), inverse3.scale(2.0 * half)),
            self.through(beta, across[0], across[1], across[2]),
        ]
    }
    #[inline(never)]
    fn wrist(self, bend: &Bend) -> Self {
        let (low, high) = (self.value.low(), self.value.high());
        let ([v0, d0, c0], [v1, d1, c1]) = (bend.inverse(low), bend.inverse(high));
        // Convex, least at zero, and so is the second derivative where it is not continued; there it is zero.
        let zero = Lanes::splat(0.0);
        let holds_zero = low.at_most(zero) & zero.at_most(high);
        let min_value = holds_zero.select(Lanes::splat(1.0), v0.min(v1));
        let limit = Lanes::splat(bend.limit);
        let beyond = limit.less(high) | low.less(-limit);
        let min_second = beyond.select(zero, holds_zero.select(Lanes::splat(2.0), c0.min(c1)));
        let second = Interval::between(min_second, c0.max(c1));
        self.through(
            self.middle.wrist(bend),
            Interval::between(min_value, v0.max(v1)),
            Interval::between(d0, d1),
            second,
        )
    }
    #[inline(always)]
    fn is_negative(self) -> Mask {
        self.value.high().less(ZERO)
    }
    #[inline(always)]
    fn low(self) -> Lanes {
        self.value.low()
    }
    #[inline(always)]
    fn high(self) -> Lanes {
        self.value.high()
    }
    #[inline(always)]
    fn assume_above(self, floor: f64, sure: &mut Mask) -> Self {
        let floor = Lanes::splat(floor);
        let fine = floor.less(self.value.low());
        *sure = *sure & fine;
        // Elsewhere some number that does no harm.
        let one = Lanes::splat(1.0);
        let value =
            Interval { middle: fine.select(self.value.middle, one), radius: fine.select(self.value.radius, ZERO) };
        let middle = Slope { value: fine.select(self.middle.value, one), ..self.middle };
        Self { value, middle, ..self }
    }
}
