//! Joint compliances in lanes: the same as [`Robot::compliances_at`], four states at a time.

use super::lanes::Lanes;
use crate::robot::{Compensator, Compliance, Robot};

/// The compliance laws of an arm, ready for lanes.
#[derive(Debug, Clone)]
pub(super) struct Laws {
    laws: [Law; 6],
    /// All six, where none changes with the joint angle. rad/(N m)
    constants: Option<[Lanes; 6]>,
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
        Self { laws, constants: robot.constant_compliances().map(|constants| constants.map(Lanes::splat)) }
    }

    /// All six compliances, where none changes with the joint angle. rad/(N m)
    #[inline(always)]
    pub fn constants(&self) -> Option<[Lanes; 6]> {
        self.constants
    }

    /// All six compliances at joint angles (rad) that are the real ones where a joint has only one, given with their sines
    /// and cosines. rad/(N m)
    pub fn at(&self, angles: &[Lanes; 6], directions: &[[Lanes; 2]; 6]) -> [Lanes; 6] {
        std::array::from_fn(|j| self.laws[j].at(angles[j], directions[j]))
    }
}

impl Law {
    #[inline(always)]
    fn at(&self, angle: Lanes, [sine, cosine]: [Lanes; 2]) -> Lanes {
        match *self {
            Self::Constant(value) => Lanes::splat(value),
            Self::Linear { min, width, at_min, rise } => {
                let share = ((angle - min) * (1.0 / width)).max(Lanes::splat(0.0)).min(Lanes::splat(1.0));
                share * rise + at_min
            }
            Self::Spring { alone, compensator, sin_cos_alpha: (sin_alpha, cos_alpha) } => {
                let cos_psi = cosine * cos_alpha - sine * sin_alpha;
                let stiffness = Lanes(cos_psi.0.map(|cosine| compensator.stiffness_at(cosine)));
                Lanes::splat(alone) / (stiffness * alone + 1.0)
            }
        }
    }
}
