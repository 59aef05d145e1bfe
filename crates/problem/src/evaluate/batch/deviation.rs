//! What the uncertainty of the compliances adds to a score, in lanes: the same as
//! [`State::margin`](super::super::evaluate::reference::State), several states at a time.

use super::limit::Limit;
use stead_model::robot::{Compensator, Compliance, Parameter, Robot, Uncertainty};
use stead_numerics::simd::{Lanes, Simd};

/// The uncertainty of an arm's compliances, ready for lanes.
#[derive(Debug, Clone)]
pub(super) struct Deviation {
    confidence: f64,
    /// For each parameter its spring ([`Parts`](super::whole::Parts)), beyond them where deflections do not count it,
    /// and how the compliance of that spring answers to it.
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

    /// At the sine and cosine of a joint angle that is the real one where the joint has only one, and with the
    /// compliance there.
    #[inline(always)]
    fn at<S: Simd>(&self, limit: &Limit, joint: [Lanes<S>; 2], compliance: Lanes<S>) -> Lanes<S> {
        let cos_psi = |(sin_alpha, cos_alpha): (f64, f64)| joint[1] * cos_alpha - joint[0] * sin_alpha;
        match *self {
            Self::One => compliance.all(1.0),
            Self::Linear { from, width } => {
                let share = (limit.angle(joint) - from) * (1.0 / width);
                share.max(share.all(0.0)).min(share.all(1.0))
            }
            Self::Alone { alone } => {
                let share = compliance * (1.0 / alone);
                share * share
            }
            Self::SpringStiffness { compensator, sin_cos_alpha } => {
                let slopes = cos_psi(sin_cos_alpha).map(|c| compensator.slope_by_spring_stiffness_at(c));
                -(compliance * compliance) * slopes
            }
            Self::FreeLength { compensator, sin_cos_alpha } => {
                let slopes = cos_psi(sin_cos_alpha).map(|c| compensator.slope_by_free_length_at(c));
                -(compliance * compliance) * slopes
            }
        }
    }
}

impl Deviation {
    /// Nothing where the score does not ask for it, or where nothing is known.
    pub fn new(robot: &Robot, confidence: f64) -> Option<Self> {
        let known = robot.uncertainty().filter(|_| confidence > 0.0)?;
        let counts_normal = robot.normal_springs().is_some();
        let slope = |parameter: &Parameter| match parameter.about() {
            Some(about) if counts_normal => (6 + 2 * parameter.joint() + about, Slope::One),
            Some(_) => (usize::MAX, Slope::One),
            None => (parameter.joint(), Slope::new(robot, *parameter)),
        };
        let slopes = known.parameters().iter().map(slope).collect();
        Some(Self { confidence, slopes, directions: known.directions().to_vec() })
    }

    /// The standard deviation of the deflection's normal part times the confidence, from what each joint adds to that
    /// part per compliance (m per rad/(N m)), the sines and cosines of the joint angles, and the compliances there. m
    #[inline(always)]
    pub fn margin<S: Simd>(
        &self,
        simd: S,
        limits: &[Limit; 6],
        parts: &[Lanes<S>],
        directions: &[[Lanes<S>; 2]; 6],
        compliances: &[Lanes<S>; 6],
    ) -> Lanes<S> {
        let mut gradient = [Lanes::splat(simd, 0.0); Uncertainty::MAX_PARAMETERS];
        for (entry, (spring, slope)) in gradient.iter_mut().zip(&self.slopes) {
            let j = *spring % 6;
            if let Some(part) = parts.get(*spring) {
                // The slope of a spring normal to an axis does not look at the joint.
                *entry = *part * slope.at(&limits[j], directions[j], compliances[j]);
            }
        }
        let mut variance = Lanes::splat(simd, 0.0);
        for direction in &self.directions {
            let mut seen = Lanes::splat(simd, 0.0);
            for (share, entry) in direction.iter().zip(gradient) {
                seen = seen + entry * *share;
            }
            variance = variance + seen * seen;
        }
        variance.sqrt() * self.confidence
    }
}
