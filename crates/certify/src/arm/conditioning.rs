//! The constraint on conditioning, written so that nothing is divided by what may vanish.
//!
//! With N the normalised Jacobian (see [`stead_model::robot::conditioning`]), `1/kappa_F = 6 / (|N| |N^-1|) >= min`
//! where
//!
//! ```text
//! D^2 s^4  -  |N|^2 (D^2 s^4 |N^-1|^2) min^2 / 36  >=  0
//! ```
//!
//! with D the sine of the elbow and s that of the wrist (theta_5). In the frame of joint 1, p is the tool centre point
//! from axis 1, 2 and 3, t the lever, q_1..3 the rows of the inverse of the position block at the wrist centre, w the
//! rotations of the arm per velocity of the wrist centre, and Q the inverse wrist as a quadratic form:
//!
//! ```text
//! |N|^2    = (sum |z_j x p_j|^2) / L^2 + 6
//! |N^-1|^2 = L^2 (sum |q|^2 + Q(w)) + sum |q x t|^2 + Q(1 - w x t)
//! ```

use super::super::interval_simd::Mask;
use super::super::number::Number;
use super::constants::Arm;
use super::inverse::Posed;
use super::vector::Vector;

/// The wrist centre must be this far from axis 1 to divide by its distance. m
const MIN_DISTANCE: f64 = 1e-3;

/// Lever and axes in the frame of joint 1.
struct ArmFrame<T> {
    lever: Vector<T>,
    axis4: Vector<T>,
    axis6: Vector<T>,
    /// Squared part of the lever along axis 5.
    along5_squared: T,
}

/// The inverse of the position block at the wrist centre, all rows times the sine of the elbow.
struct InversePosition<T> {
    rows: [Vector<T>; 3],
    /// w_y; w_x is zero, and w_z is the first row.
    spin_y: Vector<T>,
}

/// The inverse wrist as a quadratic form, times the fourth power of its sine.
struct WristForm<T> {
    xx: T,
    yy: T,
    zz: T,
    xy: T,
    xz: T,
    yz: T,
}

impl Arm {
    /// `D^2 s^4 - |N|^2 (D^2 s^4 |N^-1|^2) min^2 / 36`: not negative where the constraint holds. `regular` loses the
    /// lanes in which the wrist centre may be too near to axis 1.
    #[inline(always)]
    pub(super) fn conditioning<T: Number>(&self, posed: &Posed<'_, T>, regular: &mut Mask) -> T {
        let frame = self.arm_frame(posed);
        let norm2 = self.jacobian_norm2(posed, &frame);
        let inverse = self.inverse_position(posed, regular);
        let scaled_inverse_norm2 = self.inverse_norm2(posed, &frame, &inverse);
        let sine5_fourth = posed.wrist.sine5_squared.square();
        let product = norm2 * scaled_inverse_norm2;
        sine5_fourth * posed.elbow.sin_delta.square()
            - product.scale(self.min_inverse_condition * self.min_inverse_condition / 36.0)
    }

    #[inline(always)]
    fn arm_frame<T: Number>(&self, posed: &Posed<'_, T>) -> ArmFrame<T> {
        let (cosine, sine) = (posed.first.cosine, posed.first.sine);
        let into = |v: Vector<T>| Vector { x: v.x * cosine + v.y * sine, y: v.y * cosine - v.x * sine, z: v.z };
        let axis4 = Vector { x: posed.wrist.axis4_along, y: T::constant(0.0), z: posed.wrist.axis4.z };
        let normal = into(posed.tool.turned(&self.axis6.cross(&self.lever)));
        let along5_squared = axis4.dot(normal).square() * posed.wrist.inverse5;
        ArmFrame { lever: into(posed.tool.lever), axis4, axis6: into(posed.tool.axis6), along5_squared }
    }

    /// |N|^2.
    #[inline(always)]
    fn jacobian_norm2<T: Number>(&self, posed: &Posed<'_, T>, frame: &ArmFrame<T>) -> T {
        let (lever, length) = (frame.lever, self.characteristic_length);
        let (px, py) = (posed.first.forward + lever.x, lever.y.plus(self.geometry.lateral));
        let [p2, p3] = posed.tips;
        // The lever's length, and its part along axis 6, are known.
        let (lever2, along6) = (self.lever.norm_squared(), self.lever.dot(&self.axis6));
        let along4 = frame.axis4.dot(lever);
        let linear2 =
            px.square() + py.square() + p2.along.square() + p2.up.square() + p3.along.square() + p3.up.square()
                - along4.square()
                - frame.along5_squared;
        linear2.plus(3.0 * lever2 - along6 * along6).scale(1.0 / (length * length)).plus(6.0)
    }

    #[inline(always)]
    fn inverse_position<T: Number>(&self, posed: &Posed<'_, T>, regular: &mut Mask) -> InversePosition<T> {
        let (g, signs, forward) = (&self.geometry, posed.signs, posed.first.forward);
        let inverse_forward =
            forward.scale(signs.side).assume_above(MIN_DISTANCE, regular).reciprocal().scale(signs.side);
        let slope = inverse_forward.scale(g.lateral);
        // Sign of the determinant over the lengths of the links.
        let per_links = signs.elbow * g.fold * g.lift / (g.upper_arm * g.forearm);
        let row = |x: T, z: T| {
            let x = x.scale(per_links);
            Vector { x, y: x * slope, z: z.scale(per_links) }
        };
        let (shoulder, elbow) = (posed.elbow.from_shoulder, posed.wrist.from_elbow);
        let zero = T::constant(0.0);
        let q1 = Vector { x: zero, y: inverse_forward * posed.elbow.sin_delta, z: zero };
        let (q2, q3) = (row(elbow.along, elbow.up), row(-shoulder.along, -shoulder.up));
        let spin_y = Vector { x: -(q2.x + q3.x), y: -(q2.y + q3.y), z: -(q2.z + q3.z) };
        InversePosition { rows: [q1, q2, q3], spin_y }
    }

    /// D^2 s^4 |N^-1|^2.
    #[inline(always)]
    fn inverse_norm2<T: Number>(&self, posed: &Posed<'_, T>, frame: &ArmFrame<T>, inverse: &InversePosition<T>) -> T {
        let (t, length, lever2) = (frame.lever, self.characteristic_length, self.lever.norm_squared());
        let InversePosition { rows: [q1, q2, q3], spin_y: wy } = *inverse;
        let arm2 = q1.square() + q2.square() + q3.square();
        let crossed2 = |q: Vector<T>| q.square().scale(lever2) - q.dot(t).square();
        let arm_crossed2 = crossed2(q1) + crossed2(q2) + crossed2(q3);
        let form = wrist_form(frame, posed.wrist.dot46, posed.wrist.sine5_squared);
        let spin2 = form.yy * wy.square() + (form.yz * wy.dot(q1)).scale(2.0) + form.zz * q1.square();
        // Columns of 1 - w x t, times the sine of the elbow.
        let (cy, cz) = (wy.cross(t), q1.cross(t));
        let d = posed.elbow.sin_delta;
        let my = Vector { x: -cy.x, y: d - cy.y, z: -cy.z };
        let mz = Vector { x: -cz.x, y: -cz.y, z: d - cz.z };
        let turned2 = form.xx * d.square()
            + form.yy * my.square()
            + form.zz * mz.square()
            + (d * (form.xy * my.x + form.xz * mz.x) + form.yz * my.dot(mz)).scale(2.0);
        let s4 = posed.wrist.sine5_squared.square();
        (arm2 * s4 + spin2).scale(length * length) + arm_crossed2 * s4 + turned2
    }
}

/// From the dual basis of z_4, z_5 = (z_4 x z_6) / s and z_6.
#[inline(always)]
fn wrist_form<T: Number>(frame: &ArmFrame<T>, dot46: T, sine5_squared: T) -> WristForm<T> {
    let same = dot46.square().plus(1.0);
    let mixed = dot46.scale(-2.0);
    let (z4, c, z6) = (frame.axis4, frame.axis4.cross(frame.axis6), frame.axis6);
    let form = |[a4, a5, a6]: [T; 3], [b4, b5, b6]: [T; 3]| {
        a5 * b5 * sine5_squared + same * (a4 * b4 + a6 * b6) + mixed * (a4 * b6 + a6 * b4)
    };
    let (x, y, z) = ([z4.x, c.x, z6.x], [z4.y, c.y, z6.y], [z4.z, c.z, z6.z]);
    WristForm { xx: form(x, x), yy: form(y, y), zz: form(z, z), xy: form(x, y), xz: form(x, z), yz: form(y, z) }
}
