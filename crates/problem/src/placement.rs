//! A placement of the workpiece.

use nalgebra::{Matrix3, Vector3};
use std::ops::{Index, IndexMut};
use stead_model::robot::Pose;
use stead_model::robot::angles::{q4_from_yaw, wrap, yaw_from_q4};
use stead_numerics::scalar::Scalar;

/// Where the workpiece stands, with all external axes at zero: its origin in the robot base frame, and its rotation
/// about the vertical.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Placement<T = f64> {
    /// x of the workpiece origin. m
    pub x: T,
    /// y of the workpiece origin. m
    pub y: T,
    /// z of the workpiece origin. m
    pub z: T,
    /// Yaw gamma about the vertical, with Q4 = sin(gamma / 2). rad
    pub yaw: T,
}

impl<T> From<[T; 4]> for Placement<T> {
    /// From x, y, z and yaw.
    fn from(coordinates: [T; 4]) -> Self {
        let [x, y, z, yaw] = coordinates;
        Self { x, y, z, yaw }
    }
}

impl<T> From<Placement<T>> for [T; 4] {
    /// To x, y, z and yaw.
    fn from(placement: Placement<T>) -> Self {
        [placement.x, placement.y, placement.z, placement.yaw]
    }
}

/// Coordinates by number: x, y, z, and yaw for every other number.
impl<T> Index<usize> for Placement<T> {
    type Output = T;

    fn index(&self, number: usize) -> &T {
        match number {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => &self.yaw,
        }
    }
}

impl<T> IndexMut<usize> for Placement<T> {
    fn index_mut(&mut self, number: usize) -> &mut T {
        match number {
            0 => &mut self.x,
            1 => &mut self.y,
            2 => &mut self.z,
            _ => &mut self.yaw,
        }
    }
}

impl<T: Scalar> Placement<T> {
    /// The transform from workpiece to robot base (Caro 2013, eq. 8 as corrected: a plain rotation about z).
    pub fn base_from_workpiece(&self) -> Pose<T> {
        let (sine, cosine) = self.yaw.sin_cos();
        let (zero, one) = (T::zero(), T::one());
        Pose {
            rotation: Matrix3::new(cosine, -sine, zero, sine, cosine, zero, zero, zero, one),
            translation: Vector3::new(self.x, self.y, self.z),
        }
    }
}

impl Placement {
    /// From a place in mm and a yaw in degrees, as files and users state it.
    pub fn from_mm_deg(xyz_mm: [f64; 3], yaw_deg: f64) -> Self {
        let [x, y, z] = xyz_mm.map(|mm| mm / 1e3);
        Self { x, y, z, yaw: wrap(yaw_deg.to_radians()) }
    }

    /// From a place in mm and the quaternion component Q4 = sin(yaw / 2), from -1 to 1.
    pub fn from_mm_q4(xyz_mm: [f64; 3], q4: f64) -> Self {
        Self { yaw: yaw_from_q4(q4), ..Self::from_mm_deg(xyz_mm, 0.0) }
    }

    /// The quaternion component by which the paper states the yaw (Caro 2013, eq. 4).
    pub fn q4(&self) -> f64 {
        q4_from_yaw(self.yaw)
    }
}
