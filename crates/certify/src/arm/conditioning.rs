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
//!
//! Over a region near a singularity that difference is between terms that are nearly alike, and its sign is lost. There
//! two tests need no difference: every sum in `|N^-1|^2` is above zero, so that each may be enclosed by itself and left
//! out where it is loose; and for any joint velocity x, `|N^-1| >= |x| / |N x|`, so that
//! `|N x|^2 / |x|^2 >= min^2 |N|^2 / 36`. See [`super::singularity`] for the velocities of elbow, wrist and joint 2. Of
//! the shoulder it is that which turns joint 1 and moves the wrist centre only normal to the plane of the arm, by rho,
//! with a wrist that undoes the turn: `|N x| = |rho| / L` and `|x|^2 >= 1 + 1 / 2`, since the norm of (z_4, z_5, z_6)
//! is at most the root of 2.

use super::super::interval_simd::{Lanes, Mask};
use super::super::number::{Number, ZERO};
use super::constants::Arm;
use super::posed::Posed;
use super::singularity::UNDONE;
use super::vector::Vector;

/// The wrist centre must be this far from axis 1 to divide by its distance. m
const MIN_DISTANCE: f64 = 1e-3;
/// A quotient above this is above 1 whatever the rounding.
const BEYOND_ROUNDING: f64 = 1.0 + 1e-9;
/// Divisors are no smaller: above zero, and far below any that counts.
const TINY: Lanes = Lanes([1e-30; 4]);

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

/// The parts of |N^-1|^2, both sums of squares.
struct InverseNorm<T> {
    /// L^2 sum |q|^2 + sum |q x t|^2, times D^2.
    arm: T,
    /// L^2 Q(w) + Q(1 - w x t), times D^2 s^4.
    turned: T,
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
    /// `D^2 s^4 - |N|^2 (D^2 s^4 |N^-1|^2) min^2 / 36`: not negative where the constraint holds; and where it is sure
    /// to be violated otherwise. `regular` loses the lanes in which the wrist centre may be too near to axis 1.
    #[inline(always)]
    pub(super) fn conditioning<T: Number>(&self, posed: &Posed<'_, T>, regular: &mut Mask) -> (T, Mask) {
        let frame = self.arm_frame(posed);
        let [norm2, norm2_at_least] = self.jacobian_norm2(posed, &frame);
        let share = self.min_inverse_condition * self.min_inverse_condition / 36.0;
        let needed = norm2.low().max(norm2_at_least.low()) * share;
        let is_near = self.is_near_singularity(posed, needed) & *regular;
        let inverse = self.inverse_position(posed, regular);
        let parts = self.inverse_norm2(posed, &frame, &inverse);
        let (by_elbow, by_both) = (posed.elbow.sin_delta_squared.high(), posed.wrist.sine5_squared.high());
        let least = |sum: T| sum.low().max(ZERO);
        let inverse_norm2 =
            (least(parts.arm) + least(parts.turned) / (by_both * by_both).max(TINY)) / by_elbow.max(TINY);
        let is_above = Lanes::splat(BEYOND_ROUNDING).less(needed * inverse_norm2) & *regular;
        let sine5_fourth = posed.wrist.sine5_squared.square();
        let product = norm2 * (parts.arm * sine5_fourth + parts.turned);
        let margin = sine5_fourth * posed.elbow.sin_delta.square() - product.scale(share);
        (margin, is_near | is_above)
    }

    /// Where elbow, wrist or shoulder is sure to be nearer to its singularity than `min^2 |N|^2 / 36`, which is at
    /// least `needed`, allows.
    #[inline(always)]
    fn is_near_singularity<T: Number>(&self, posed: &Posed<'_, T>, needed: Lanes) -> Mask {
        let is_short = |of: Lanes, by: Lanes| (of * BEYOND_ROUNDING).less(needed * by);
        let elbow = is_short(posed.elbow.sin_delta_squared.high(), posed.elbow.distance2.low() * self.needs.elbow);
        let same = posed.wrist.dot46.square().plus(1.0);
        let wrist = is_short(posed.wrist.sine5_squared.high() * self.needs.wrist, same.low());
        let shoulder = self.is_too_near(posed.first.forward_squared_high, needed);
        let reach = self.is_too_near(posed.elbow.distance2.high(), needed);
        elbow | wrist | shoulder | reach
    }

    /// Where the square of the wrist centre's distance from axis 1 along the arm, or from axis 2, is at most so large
    /// (m^2), and `min^2 |N|^2 / 36`, which is at least `needed`, does not allow that.
    #[inline(always)]
    pub(super) fn is_too_near(&self, distance2: Lanes, needed: Lanes) -> Mask {
        let length2 = self.characteristic_length * self.characteristic_length;
        (distance2 * BEYOND_ROUNDING).less(needed * (UNDONE * length2))
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

    /// |N|^2; and what it is at least, with the lever's part along axis 5 as large as it can be.
    #[inline(always)]
    fn jacobian_norm2<T: Number>(&self, posed: &Posed<'_, T>, frame: &ArmFrame<T>) -> [T; 2] {
        let (lever, length) = (frame.lever, self.characteristic_length);
        let (px, py) = (posed.first.forward + lever.x, lever.y.plus(self.geometry.lateral));
        let [p2, p3] = posed.tips;
        // The lever's length, and its part along axis 6, are known.
        let (lever2, along6) = (self.lever.norm_squared(), self.lever.dot(&self.axis6));
        let along4 = frame.axis4.dot(lever);
        let linear2 =
            px.square() + py.square() + p2.along.square() + p2.up.square() + p3.along.square() + p3.up.square()
                - along4.square();
        let normalised = |sum: T| sum.scale(1.0 / (length * length)).plus(6.0);
        let exact = (linear2 - frame.along5_squared).plus(3.0 * lever2 - along6 * along6);
        [normalised(exact), normalised(linear2.plus(2.0 * lever2))]
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

    /// |N^-1|^2.
    #[inline(always)]
    fn inverse_norm2<T: Number>(
        &self,
        posed: &Posed<'_, T>,
        frame: &ArmFrame<T>,
        inverse: &InversePosition<T>,
    ) -> InverseNorm<T> {
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
        let length2 = length * length;
        InverseNorm { arm: arm2.scale(length2) + arm_crossed2, turned: spin2.scale(length2) + turned2 }
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
