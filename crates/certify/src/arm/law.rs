//! Compliances of joints 2 and 3 that change with the joint angle, from its sine and cosine.

use super::super::interval_simd::Mask;
use super::super::number::Number;
use stead_model::robot::{Compensator, Compliance, Joint};

/// Half the angle from the middle of the limits is told by its tangent, which needs one plus its cosine above this.
const MIN_OPEN: f64 = 1e-2;
/// Squared length of a spring and share of the stiffness left, below which too little is known.
const MIN_SPRING2: f64 = 1e-6;
const MIN_SHARE: f64 = 1e-3;

/// How a joint yields.
#[derive(Debug, Clone, Copy)]
pub(super) enum Law {
    /// The same at every angle. rad/(N m)
    Constant(f64),
    /// Linear in the angle: its value in the middle of the limits (rad/(N m)), slope, and sine and cosine of the
    /// middle.
    Range { middle: f64, slope: f64, at: (f64, f64) },
    /// Beside a spring: [`Compliance::Compensated`], and sine and cosine of its alpha.
    Compensated { alone: f64, compensator: Compensator, at: (f64, f64) },
}

impl Law {
    pub fn of(joint: &Joint) -> Self {
        match joint.compliance {
            Compliance::Constant(value) => Self::Constant(value),
            Compliance::Range { at_min, at_max } => Self::Range {
                middle: 0.5 * (at_min + at_max),
                slope: (at_max - at_min) / (joint.max - joint.min),
                at: libm::sincos(0.5 * (joint.min + joint.max)),
            },
            Compliance::Compensated { alone, compensator } => {
                Self::Compensated { alone, compensator, at: libm::sincos(compensator.alpha) }
            }
        }
    }

    /// A number times the compliance at the angle of this sine and cosine: true within the limits of the joint.
    /// `regular` loses the lanes in which too little is known. rad/(N m)
    #[inline(always)]
    pub fn times<T: Number>(&self, number: T, angle: [T; 2], regular: &mut Mask) -> T {
        let [sine, cosine] = angle;
        match *self {
            Self::Constant(value) => number.scale(value),
            Self::Range { middle, slope, at: (s, c) } => {
                // tan(x / 2) = sin x / (1 + cos x), with x the angle from the middle of the limits.
                let off = sine.scale(c) - cosine.scale(s);
                let open = (cosine.scale(c) + sine.scale(s)).plus(1.0).assume_above(MIN_OPEN, regular);
                number * (off * open.reciprocal()).arctangent().scale(2.0 * slope).plus(middle)
            }
            Self::Compensated { alone, compensator, at: (s, c) } => {
                let Compensator { spring_stiffness, a, l, free_length, .. } = compensator;
                let straight = cosine.scale(c) - sine.scale(s);
                let length2 = straight.scale(2.0 * a * l).plus(a * a + l * l).assume_above(MIN_SPRING2, regular);
                let inverse = length2.inverse_sqrt();
                let product = straight.scale(l).plus(a) * straight.scale(a).plus(l);
                let pull = (product * inverse.square() * inverse).scale(free_length);
                let share = (pull - straight).scale(spring_stiffness * a * l * alone).plus(1.0);
                (number * share.assume_above(MIN_SHARE, regular).reciprocal()).scale(alone)
            }
        }
    }
}
