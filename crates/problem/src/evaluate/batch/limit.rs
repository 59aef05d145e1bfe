//! One joint's limits, ready for lanes.

use std::f64::consts::{PI, TAU};
use stead_model::robot::{Robot, angles::ANGLE_ROUNDING, turns::Range};
use stead_numerics::simd::{LaneNumber, Lanes, Mask, Simd};

/// One joint's limits, ready for lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit<E = f64> {
    min: f64,
    max: f64,
    has_turns: bool,
    /// Sine and cosine of both limits.
    ends: [(E, E); 2],
}

impl Limit {
    pub fn new(range: Range) -> Self {
        let (min, max) = (range.min - ANGLE_ROUNDING, range.max + ANGLE_ROUNDING);
        Self { min, max, has_turns: range.has_turns(), ends: [libm::sincos(min), libm::sincos(max)] }
    }

    /// The same in numbers of some kind.
    #[inline(always)]
    pub fn with<E: LaneNumber>(self) -> Limit<E> {
        let ends = self.ends.map(|(sine, cosine)| (E::of(sine), E::of(cosine)));
        Limit { min: self.min, max: self.max, has_turns: self.has_turns, ends }
    }
}

impl<E: LaneNumber> Limit<E> {
    /// Where the angle of a vector (sine, cosine), of any length, is allowed: found without the angle.
    #[inline(always)]
    pub fn allows<S: Simd<Number = E>>(self, simd: S, [sine, cosine]: [Lanes<S>; 2]) -> Mask<S> {
        if self.has_turns {
            return Mask::splat(simd, true);
        }
        let [(s0, c0), (s1, c1)] = self.ends;
        let zero = Lanes::splat(simd, 0.0);
        let after_min = zero.at_most(sine.times(c0) - cosine.times(s0));
        let before_max = zero.at_most(cosine.times(s1) - sine.times(c1));
        if self.max - self.min <= PI { after_min & before_max } else { after_min | before_max }
    }
}

impl<E> Limit<E> {
    /// The real angle of a vector (sine, cosine), or any one where the joint has several; rad
    #[inline(always)]
    pub fn angle<S: Simd>(self, direction: [Lanes<S>; 2]) -> Lanes<S> {
        let angle = direction[0].atan2(direction[1]);
        if self.has_turns {
            return angle;
        }
        angle + ((angle.all(self.min) - angle) * (1.0 / TAU)).ceil() * TAU
    }
}

/// The range of the sum of joint angles 2 and 3, ready for lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct SumLimit {
    min: f64,
    max: f64,
    fold: f64,
    joints: [Limit; 2],
}

impl SumLimit {
    /// Nothing where the ranges of the joints allow no more.
    pub fn new(robot: &Robot) -> Option<Self> {
        let Range { min, max } = robot.sum_range()?;
        let [least, largest] = robot.sums();
        let joints = [1, 2].map(|j| Limit::new(Range::of(&robot.joints()[j])));
        let fold = robot.geometry().fold;
        let says_more = least < min - ANGLE_ROUNDING || largest > max + ANGLE_ROUNDING;
        says_more.then_some(Self { min: min - ANGLE_ROUNDING, max: max + ANGLE_ROUNDING, fold, joints })
    }

    /// Where the sum is allowed, of vectors (sine, cosine) of any length that the limits of their joints allow: those
    /// have one real angle each.
    #[inline(always)]
    pub fn allows<S: Simd>(self, second: [Lanes<S>; 2], third: [Lanes<S>; 2]) -> Mask<S> {
        let sum = self.joints[0].angle(second) + self.joints[1].angle(third) * self.fold;
        sum.all(self.min).at_most(sum) & sum.at_most(sum.all(self.max))
    }
}
