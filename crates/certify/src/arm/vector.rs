//! Three components in any of the number types of a certificate.

use super::super::number::Number;

/// Three components: radial, tangential and along axis 1, or those of the frame of joint 1.
#[derive(Clone, Copy)]
pub(in super::super) struct Vector<T> {
    pub x: T,
    pub y: T,
    pub z: T,
}

impl<T: Number> Vector<T> {
    #[inline(always)]
    pub fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    #[inline(always)]
    pub fn square(self) -> T {
        self.x.square() + self.y.square() + self.z.square()
    }
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self { x: self.y * o.z - self.z * o.y, y: self.z * o.x - self.x * o.z, z: self.x * o.y - self.y * o.x }
    }
}

/// A vector in the plane of the arm, which contains axis 1.
#[derive(Clone, Copy)]
pub(super) struct InPlane<T> {
    /// Along the arm, normal to axis 1. m
    pub along: T,
    /// Along axis 1. m
    pub up: T,
}
