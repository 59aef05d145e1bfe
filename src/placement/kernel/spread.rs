//! What the uncertainty of the compliances adds to a score, in lanes: the same as
//! [`State::margin`](super::super::criterion::State), four states at a time.

use super::lanes::Lanes;
use crate::placement::problem::Problem;
use crate::robot::{Compensator, Compliance, Parameter, Robot, Uncertainty};

/// The uncertainty of an arm's compliances, ready for lanes.
#[derive(Debug, Clone)]
pub(super) struct Spread {
    confidence: f64,
    /// For each parameter its joint, and how the compliance of that joint answers to it.
    slopes: Vec<(usize, Slope)>,
    /// See [`Uncertainty::directions`].
    directions: Vec<Vec<f64>>,
}

/// Derivative of a joint's compliance by a parameter of its law.
#[derive(Debug, Clone, Copy)]
enum Slope {
    One,
    /// Per width of the range, from the limit at which it is zero.
    Linear {
        from: f64,
        width: f64,
    },
    Alone {
        alone: f64,
    },
    SpringStiffness {
        compensator: Compensator,
        sin_cos_alpha: (f64, f64),
    },
    FreeLength {
        compensator: Compensator,
        sin_cos_alpha: (f64, f64),
    },
}

impl Slope {
    fn new(robot: &Robot, parameter: Parameter) -> Self {
        let joint = &robot.joints()[parameter.joint()];
        let width = joint.max - joint.min;
        match (joint.compliance, parameter) {
            (Compliance::Range { .. }, Parameter::ComplianceAtMin(_)) => {
                Self::Linear { from: joint.max, width: -width }
            }
            (Compliance::Range { .. }, _) => Self::Linear { from: joint.min, width },
            (Compliance::Compensated { compensator, .. }, Parameter::SpringStiffness(_)) => {
                Self::SpringStiffness { compensator, sin_cos_alpha: libm::sincos(compensator.alpha) }
            }
            (Compliance::Compensated { compensator, .. }, Parameter::FreeLength(_)) => {
                Self::FreeLength { compensator, sin_cos_alpha: libm::sincos(compensator.alpha) }
            }
            (Compliance::Compensated { alone, .. }, _) => Self::Alone { alone },
            (Compliance::Constant(_), _) => Self::One,
        }
    }

    /// At a joint angle (rad) that is the real one where the joint has only one, given with its sine and cosine, and with
    /// the compliance there.
    #[inline(always)]
    fn at(&self, angle: Lanes, [sine, cosine]: [Lanes; 2], compliance: Lanes) -> Lanes {
        let cos_psi = |(sin_alpha, cos_alpha): (f64, f64)| cosine * cos_alpha - sine * sin_alpha;
        match *self {
            Self::One => Lanes::splat(1.0),
            Self::Linear { from, width } => {
                ((angle - from) * (1.0 / width)).max(Lanes::splat(0.0)).min(Lanes::splat(1.0))
            }
            Self::Alone { alone } => {
                let share = compliance * (1.0 / alone);
                share * share
            }
            Self::SpringStiffness { compensator, sin_cos_alpha } => {
                let slopes = cos_psi(sin_cos_alpha).0.map(|c| compensator.slope_by_spring_stiffness_at(c));
                -(compliance * compliance) * Lanes(slopes)
            }
            Self::FreeLength { compensator, sin_cos_alpha } => {
                let slopes = cos_psi(sin_cos_alpha).0.map(|c| compensator.slope_by_free_length_at(c));
                -(compliance * compliance) * Lanes(slopes)
            }
        }
    }
}

impl Spread {
    /// Nothing where the score does not ask for it, or where nothing is known.
    pub fn new(problem: &Problem) -> Option<Self> {
        let confidence = problem.criterion.confidence;
        let known = problem.robot.uncertainty().filter(|_| confidence > 0.0)?;
        let slope = |parameter: &Parameter| (parameter.joint(), Slope::new(&problem.robot, *parameter));
        let slopes = known.parameters().iter().map(slope).collect();
        Some(Self { confidence, slopes, directions: known.directions().to_vec() })
    }

    /// The standard deviation of the deflection's normal part times the confidence, from what each joint adds to that part
    /// per compliance (m per rad/(N m)), the joint angles (rad) with their sines and cosines, and the compliances there. m
    pub fn margin(
        &self,
        parts: &[Lanes; 6],
        angles: &[Lanes; 6],
        turned: &[[Lanes; 2]; 6],
        compliances: &[Lanes; 6],
    ) -> Lanes {
        let mut gradient = [Lanes::splat(0.0); Uncertainty::MOST_PARAMETERS];
        for (entry, (j, slope)) in gradient.iter_mut().zip(&self.slopes) {
            *entry = parts[*j] * slope.at(angles[*j], turned[*j], compliances[*j]);
        }
        let mut variance = Lanes::splat(0.0);
        for direction in &self.directions {
            let mut seen = Lanes::splat(0.0);
            for (share, entry) in direction.iter().zip(gradient) {
                seen = seen + entry * *share;
            }
            variance = variance + seen * seen;
        }
        variance.sqrt() * self.confidence
    }
}
