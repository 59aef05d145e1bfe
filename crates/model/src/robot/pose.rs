//! Rigid transforms.

use nalgebra::{Matrix3, Vector3};
use serde::Serialize;
use stead_numerics::scalar::Scalar;

/// A rigid transform `a_from_b`: takes coordinates in b to coordinates in a.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pose<T: Scalar> {
    /// Rotation from b to a.
    pub rotation: Matrix3<T>,
    /// Origin of b in a. m
    pub translation: Vector3<T>,
}

impl<T: Scalar> Pose<T> {
    /// The transform that leaves everything where it is.
    pub fn identity() -> Self {
        Self { rotation: Matrix3::identity(), translation: Vector3::zeros() }
    }

    /// `a_from_b.then(b_from_c)` is `a_from_c`.
    pub fn then(&self, other: &Self) -> Self {
        Self {
            rotation: self.rotation * other.rotation,
            translation: self.rotation * other.translation + self.translation,
        }
    }

    /// The inverse transform, `b_from_a`.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation) }
    }

    /// Coordinates in a of a point given in b. m
    pub fn point(&self, point: &Vector3<T>) -> Vector3<T> {
        self.rotation * point + self.translation
    }

    /// Coordinates in b of a point given in a. m
    pub fn inverse_point(&self, point: &Vector3<T>) -> Vector3<T> {
        self.rotation.tr_mul(&(point - self.translation))
    }
}

impl Pose<f64> {
    /// The same transform in another number type, with derivatives of zero.
    pub fn cast<T: Scalar>(&self) -> Pose<T> {
        Pose { rotation: self.rotation.map(T::constant), translation: cast(&self.translation) }
    }
}

/// A vector in another number type, with derivatives of zero.
pub fn cast<T: Scalar>(vector: &Vector3<f64>) -> Vector3<T> {
    vector.map(T::constant)
}
