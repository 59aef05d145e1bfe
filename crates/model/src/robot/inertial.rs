//! Rigid bodies: mass, centre of mass, inertia tensor.

use super::pose::Pose;
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// What of a body its weight depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointMass {
    /// Mass, above zero. kg
    pub mass: f64,
    /// Centre of mass in the frame that the body is given in. m
    pub centre: Vector3<f64>,
}

/// Mass, centre of mass and inertia tensor of a rigid body, in a frame fixed to it; checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    mass: f64,
    centre: Vector3<f64>,
    inertia: Matrix3<f64>,
}

/// Why numbers are not those of a rigid body.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum InertialError {
    /// The mass is not a finite number above zero. kg
    #[error("the mass is {0} kg, but must be above zero")]
    Mass(f64),
    /// The centre of mass has a coordinate that is NaN or infinite.
    #[error("the centre of mass is not finite")]
    Centre,
    /// The tensor has an entry that is NaN or infinite.
    #[error("the inertia tensor is not finite")]
    NotFinite,
    /// A principal moment of inertia is not above zero: the smallest. kg m^2
    #[error("the inertia tensor is not positive definite: its smallest principal moment is {0} kg m^2")]
    NotPositiveDefinite(f64),
    /// A principal moment is larger than the sum of the two others: no distribution of mass has that.
    #[error(
        "the inertia tensor breaks the triangle inequality: its largest principal moment, {largest} kg m^2, is above the sum \
         of the two others, {others} kg m^2"
    )]
    Triangle {
        /// The largest principal moment. kg m^2
        largest: f64,
        /// The sum of the two others. kg m^2
        others: f64,
    },
}

/// What the largest principal moment may be above the sum of the others, by rounding: relative.
const ROUNDING: f64 = 1e-9;

impl Inertial {
    /// A body of a mass (kg) with its centre of mass at `centre` (m) and the tensor `inertia` (kg m^2) about the centre
    /// of mass along the axes of the frame: off-diagonal numbers are entries of the tensor, `-integral x y dm`. Only
    /// the upper triangle is read.
    ///
    /// # Errors
    /// [`InertialError`] when no rigid body has these numbers.
    pub fn new(mass: f64, centre: Vector3<f64>, inertia: Matrix3<f64>) -> Result<Self, InertialError> {
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(InertialError::Mass(mass));
        }
        if !centre.iter().all(|value| value.is_finite()) {
            return Err(InertialError::Centre);
        }
        let inertia = Matrix3::from_fn(|row, column| inertia[(row.min(column), row.max(column))]);
        if !inertia.iter().all(|value| value.is_finite()) {
            return Err(InertialError::NotFinite);
        }
        let moments = SymmetricEigen::new(inertia).eigenvalues;
        let (smallest, largest) = (moments.min(), moments.max());
        if smallest.is_nan() || smallest <= 0.0 {
            return Err(InertialError::NotPositiveDefinite(smallest));
        }
        let others = moments.sum() - largest;
        if largest > others * (1.0 + ROUNDING) {
            return Err(InertialError::Triangle { largest, others });
        }
        Ok(Self { mass, centre, inertia })
    }

    /// Mass. kg
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Centre of mass in the frame. m
    pub fn centre(&self) -> &Vector3<f64> {
        &self.centre
    }

    /// Inertia tensor about the centre of mass, along the axes of the frame. kg m^2
    pub fn inertia(&self) -> &Matrix3<f64> {
        &self.inertia
    }

    /// Mass and centre alone.
    pub fn point_mass(&self) -> PointMass {
        PointMass { mass: self.mass, centre: self.centre }
    }

    /// The same body in another frame a, where `a_from_body` places its own.
    pub fn placed(&self, a_from_body: &Pose<f64>) -> Self {
        let rotation = &a_from_body.rotation;
        Self {
            mass: self.mass,
            centre: a_from_body.point(&self.centre),
            inertia: rotation * self.inertia * rotation.transpose(),
        }
    }

    /// Both bodies as one, in the frame that they share.
    pub fn joined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let centre = (self.centre * self.mass + other.centre * other.mass) / mass;
        let about = |body: &Self| {
            let arm = body.centre - centre;
            body.inertia + (Matrix3::identity() * arm.norm_squared() - arm * arm.transpose()) * body.mass
        };
        Self { mass, centre, inertia: about(self) + about(other) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{matrix, vector};
    use proptest::prelude::*;

    #[test]
    fn what_no_rigid_body_has_is_refused() {
        let (here, unit) = (vector![0.0, 0.0, 0.0], Matrix3::identity());
        for mass in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(Inertial::new(mass, here, unit), Err(InertialError::Mass(_))));
        }
        assert_eq!(Inertial::new(1.0, vector![f64::NAN, 0.0, 0.0], unit), Err(InertialError::Centre));
        assert_eq!(Inertial::new(1.0, here, unit * f64::INFINITY), Err(InertialError::NotFinite));
        // Positive on the diagonal, but a product of inertia too large.
        let tilted = matrix![1.0, 1.5, 0.0; 1.5, 1.0, 0.0; 0.0, 0.0, 1.0];
        let error = Inertial::new(1.0, here, tilted);
        assert!(matches!(error, Err(InertialError::NotPositiveDefinite(smallest)) if (smallest + 0.5).abs() < 1e-12));
        let rod = Matrix3::from_diagonal(&vector![1.0, 1.0, 2.1]);
        let error = Inertial::new(1.0, here, rod);
        assert!(matches!(error, Err(InertialError::Triangle { others, .. }) if (others - 2.0).abs() < 1e-12));
        // A flat plate has just the sum.
        assert!(Inertial::new(1.0, here, Matrix3::from_diagonal(&vector![1.0, 1.0, 2.0])).is_ok());
    }

    proptest! {
        /// Point masses on three axes: the tensor about their centre of mass, whichever way they are put together.
        #[test]
        fn bodies_joined_are_the_masses_together(
            masses in prop::array::uniform4(0.1..5.0_f64), at in prop::array::uniform12(-1.0..1.0_f64)
        ) {
            let small = Matrix3::identity() * 1e-3;
            let points: [Vector3<f64>; 4] = std::array::from_fn(|k| vector![at[3 * k], at[3 * k + 1], at[3 * k + 2]]);
            let body = |k: usize| Inertial::new(masses[k], points[k], small).unwrap();
            let all = body(0).joined(&body(1)).joined(&body(2).joined(&body(3)));
            let mass: f64 = masses.iter().sum();
            let centre = (0..4).map(|k| points[k] * masses[k]).sum::<Vector3<f64>>() / mass;
            prop_assert!((all.mass() - mass).abs() < 1e-12 && (all.centre() - centre).norm() < 1e-12);
            let tensor: Matrix3<f64> = (0..4)
                .map(|k| {
                    let cross = (points[k] - centre).cross_matrix();
                    small - cross * cross * masses[k]
                })
                .sum();
            prop_assert!((all.inertia() - tensor).abs().max() < 1e-12);
            let checked = Inertial::new(mass, centre, tensor);
            prop_assert!(checked.is_ok(), "{checked:?}");
        }
    }
}
