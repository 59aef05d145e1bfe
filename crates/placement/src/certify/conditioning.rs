//! The constraint on conditioning, written so that nothing is divided by what may vanish.

use super::arm::{Arm, Vector};
use super::number::Number;

/// The plane arm, as conditioning needs it.
pub(super) struct PlaneArm<T> {
    pub forward: T,
    pub inverse_forward: T,
    pub u: T,
    pub u3: T,
    pub height: T,
    pub height3: T,
    pub p2: (T, T),
    pub p3: (T, T),
    /// Sign of the determinant over the lengths of the links.
    pub sign: f64,
    pub sin_delta: T,
}

/// The wrist, as conditioning needs it.
pub(super) struct Wrist<T> {
    pub t: Vector<T>,
    pub z4: Vector<T>,
    pub z6: Vector<T>,
    pub dot46: T,
    pub sine5_squared: T,
    /// Squared part of the lever along axis 5.
    pub across: T,
}

impl Arm {
    /// 36 / min^2 - |N|^2 |N^-1|^2 (see the kernel's and [`stead_model::robot::conditioning`]), times the squared sine of the elbow
    /// and the fourth power of the wrist's: so nothing is divided by either, and the sign is plain where they vanish.
    pub fn condition<T: Number>(&self, a: &PlaneArm<T>, w: &Wrist<T>) -> T {
        let (lateral, length) = (self.geometry.lateral, self.characteristic_length);
        let t = w.t;
        // The lever's length is known.
        let lever2 = self.lever.norm_squared();
        let (px, py) = (a.forward + t.x, t.y.plus(lateral));
        let along4 = w.z4.dot(t);
        let along6 = self.lever.dot(&self.axis6);
        let linear2 = px.square() + py.square() + a.p2.0.square() + a.p2.1.square() + a.p3.0.square() + a.p3.1.square()
            - along4.square()
            - w.across;
        let norm2 = linear2.plus(3.0 * lever2 - along6 * along6).scale(1.0 / (length * length)).plus(6.0);
        // All rows times the sine of the elbow.
        let slope = a.inverse_forward.scale(lateral);
        let row = |x: T, z: T| {
            let x = x.scale(a.sign);
            Vector { x, y: x * slope, z: z.scale(a.sign) }
        };
        let zero = T::constant(0.0);
        let q1 = Vector { x: zero, y: a.inverse_forward * a.sin_delta, z: zero };
        let (q2, q3) = (row(a.u3, a.height3), row(-a.u, -a.height));
        let wy = Vector { x: -(q2.x + q3.x), y: -(q2.y + q3.y), z: -(q2.z + q3.z) };
        let arm2 = q1.square() + q2.square() + q3.square();
        let crossed = |q: Vector<T>| q.square().scale(lever2) - q.dot(t).square();
        let arm_crossed2 = crossed(q1) + crossed(q2) + crossed(q3);
        // The inverse wrist as a quadratic form, from the dual basis of z4, z5, z6, times the fourth power of its sine;
        // z5 = (z4 x z6) / sin(theta_5).
        let same = w.dot46.square().plus(1.0);
        let mixed = w.dot46.scale(-2.0);
        let (z4, c, z6) = (w.z4, w.z4.cross(w.z6), w.z6);
        let form = |a4: T, b4: T, a5: T, b5: T, a6: T, b6: T| {
            a5 * b5 * w.sine5_squared + same * (a4 * b4 + a6 * b6) + mixed * (a4 * b6 + a6 * b4)
        };
        let qxx = form(z4.x, z4.x, c.x, c.x, z6.x, z6.x);
        let qyy = form(z4.y, z4.y, c.y, c.y, z6.y, z6.y);
        let qzz = form(z4.z, z4.z, c.z, c.z, z6.z, z6.z);
        let qxy = form(z4.x, z4.y, c.x, c.y, z6.x, z6.y);
        let qxz = form(z4.x, z4.z, c.x, c.z, z6.x, z6.z);
        let qyz = form(z4.y, z4.z, c.y, c.z, z6.y, z6.z);
        let spin2 = qyy * wy.square() + (qyz * wy.dot(q1)).scale(2.0) + qzz * q1.square();
        let (cy, cz) = (wy.cross(t), q1.cross(t));
        let d = a.sin_delta;
        let my = Vector { x: -cy.x, y: d - cy.y, z: -cy.z };
        let mz = Vector { x: -cz.x, y: -cz.y, z: d - cz.z };
        let rest2 = qxx * d.square()
            + qyy * my.square()
            + qzz * mz.square()
            + (d * (qxy * my.x + qxz * mz.x) + qyz * my.dot(mz)).scale(2.0);
        let s4 = w.sine5_squared.square();
        let product = norm2 * ((arm2 * s4 + spin2).scale(length * length) + arm_crossed2 * s4 + rest2);
        s4 * d.square() - product.scale(self.min_inverse_condition * self.min_inverse_condition / 36.0)
    }
}
