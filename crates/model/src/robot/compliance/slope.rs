//! Exact derivatives of the compliance of a joint with respect to the parameters of its law.

use super::{Compensator, Compliance, Joint};
use crate::robot::Parameter;
use stead_numerics::scalar::Scalar;

impl Compensator {
    /// Derivative of the stiffness K_eq by the spring stiffness, over cos(psi): K_eq is in proportion to it. m^2
    #[inline]
    pub fn slope_by_spring_stiffness_at<T: Scalar>(&self, cosine: T) -> T {
        self.stiffness_at(cosine).scale(1.0 / self.spring_stiffness)
    }

    /// Derivative of the stiffness K_eq by the free length, over cos(psi): K_eq is linear in it. N/rad
    #[inline]
    pub fn slope_by_free_length_at<T: Scalar>(&self, cosine: T) -> T {
        let length = self.length_at(cosine);
        let product = (cosine.scale(self.l) + T::constant(self.a)) * (cosine.scale(self.a) + T::constant(self.l));
        (product / (length * length * length)).scale(self.spring_stiffness * self.a * self.l)
    }
}

impl Compliance {
    /// Whether the law has a parameter of this kind, whatever the joint it names.
    pub fn has(&self, parameter: Parameter) -> bool {
        matches!(
            (self, parameter),
            (Self::Constant(_), Parameter::Compliance(_))
                | (Self::Range { .. }, Parameter::ComplianceAtMin(_) | Parameter::ComplianceAtMax(_))
                | (
                    Self::Compensated { .. },
                    Parameter::Compliance(_) | Parameter::SpringStiffness(_) | Parameter::FreeLength(_)
                )
        )
    }
}

impl Joint {
    /// Derivative of [`Joint::compliance_at`] by a parameter of its law, in rad/(N m) per SI unit of the parameter;
    /// zero for a parameter that the law does not have.
    ///
    /// Beside a compensator, `c = 1 / (K_theta + K_eq)`: `dc = (c / c_alone)^2 d c_alone - c^2 d K_eq`.
    pub fn compliance_slope_at<T: Scalar>(&self, parameter: Parameter, angle: T) -> T {
        match self.compliance {
            Compliance::Constant(_) => match parameter {
                Parameter::Compliance(_) => T::one(),
                _ => T::zero(),
            },
            Compliance::Range { .. } => {
                let share = || (self.inside(angle) - T::constant(self.min)).scale(1.0 / (self.max - self.min));
                match parameter {
                    Parameter::ComplianceAtMin(_) => T::one() - share(),
                    Parameter::ComplianceAtMax(_) => share(),
                    _ => T::zero(),
                }
            }
            Compliance::Compensated { alone, compensator } => {
                let cosine = compensator.cosine(self.inside(angle));
                let share = T::one() / (compensator.stiffness_at(cosine).scale(alone) + T::one());
                let per_stiffness = -(share * share).scale(alone * alone);
                match parameter {
                    Parameter::Compliance(_) => share * share,
                    Parameter::SpringStiffness(_) => per_stiffness * compensator.slope_by_spring_stiffness_at(cosine),
                    Parameter::FreeLength(_) => per_stiffness * compensator.slope_by_free_length_at(cosine),
                    _ => T::zero(),
                }
            }
        }
    }
}
