//! Joint compliances in lanes: the same as [`Robot::compliances_at`], several states at a time.

use super::limit::Limit;
use stead_model::robot::{Compensator, Compliance, Robot};
use stead_numerics::simd::{Lanes, Simd};

/// The compliance laws of an arm, ready for lanes.
#[derive(Debug, Clone)]
pub(super) struct Laws {
    laws: [Law; 6],
    /// All six, where none changes with the joint angle. rad/(N m)
    constants: Option<[f64; 6]>,
}

#[derive(Debug, Clone, Copy)]
enum Law {
    Constant(f64),
    /// From the lower limit on, per width of the range.
    Linear {
        min: f64,
        width: f64,
        at_min: f64,
        rise: f64,
    },
    Spring {
        alone: f64,
        compensator: Compensator,
        sin_cos_alpha: (f64, f64),
    },
}

impl Laws {
    pub fn new(robot: &Robot) -> Self {
        let laws = robot.joints().each_ref().map(|joint| match joint.compliance {
            Compliance::Constant(value) => Law::Constant(value),
            Compliance::Range { at_min, at_max } => {
                Law::Linear { min: joint.min, width: joint.max - joint.min, at_min, rise: at_max - at_min }
            }
            Compliance::Compensated { alone, compensator } => {
                Law::Spring { alone, compensator, sin_cos_alpha: libm::sincos(compensator.alpha) }
            }
        });
        Self { laws, constants: robot.constant_compliances() }
    }

    /// All six compliances at the sines and cosines of the joint angles, which are the real ones where a joint has only
    /// one. rad/(N m)
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, limits: &[Limit; 6], directions: &[[Lanes<S>; 2]; 6]) -> [Lanes<S>; 6] {
        let mut compliances = [Lanes::splat(simd, 0.0); 6];
        for j in 0..6 {
            compliances[j] = match &self.constants {
                Some(constants) => Lanes::splat(simd, constants[j]),
                None => self.laws[j].at(simd, &limits[j], directions[j]),
            };
        }
        compliances
    }
}

impl Law {
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, limit: &Limit, direction: [Lanes<S>; 2]) -> Lanes<S> {
        match *self {
            Self::Constant(value) => Lanes::splat(simd, value),
            Self::Linear { min, width, at_min, rise } => {
                let share = (limit.angle(direction) - min) * (1.0 / width);
                share.max(share.all(0.0)).min(share.all(1.0)) * rise + at_min
            }
            Self::Spring { alone, compensator, sin_cos_alpha: (sin_alpha, cos_alpha) } => {
                let cos_psi = direction[1] * cos_alpha - direction[0] * sin_alpha;
                let stiffness = cos_psi.map(|cosine| compensator.stiffness_at(cosine));
                cos_psi.all(alone) / (stiffness * alone + 1.0)
            }
        }
    }
}
