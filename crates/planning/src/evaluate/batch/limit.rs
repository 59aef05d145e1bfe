//! One joint's limits, ready for lanes.

use pulp::Simd;
use std::f64::consts::{PI, TAU};
use stead_model::robot::{angles::ANGLE_ROUNDING, turns::Range};
use stead_numerics::simd::{Lanes, Mask};

/// One joint's limits, ready for lanes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limit {
    min: f64,
    max: f64,
    has_turns: bool,
    /// Sine and cosine of both limits.
    ends: [(f64, f64); 2],
}

impl Limit {
    pub fn new(range: Range) -> Self {
        let (min, max) = (range.min - ANGLE_ROUNDING, range.max + ANGLE_ROUNDING);
        Self { min, max, has_turns: range.has_turns(), ends: [libm::sincos(min), libm::sincos(max)] }
    }

    /// Where the angle of a vector (sine, cosine), of any length, is allowed: found without the angle.
    #[inline(always)]
    pub fn allows<S: Simd>(self, simd: S, [sine, cosine]: [Lanes<S>; 2]) -> Mask<S> {
        if self.has_turns {
            return Mask::splat(simd, true);
        }
        let [(s0, c0), (s1, c1)] = self.ends;
        let zero = Lanes::splat(simd, 0.0);
        let after_min = zero.at_most(sine * c0 - cosine * s0);
        let before_max = zero.at_most(cosine * s1 - sine * c1);
        if self.max - self.min <= PI { after_min & before_max } else { after_min | before_max }
    }

    /// The real angle of a vector (sine, cosine), or any one where the joint has several; rad
    #[inline(always)]
    pub fn angle<S: Simd>(self, [sine, cosine]: [Lanes<S>; 2]) -> Lanes<S> {
        let angle = sine.atan2(cosine);
        if self.has_turns {
            return angle;
        }
        angle + ((angle.all(self.min) - angle) * (1.0 / TAU)).ceil() * TAU
    }
}
