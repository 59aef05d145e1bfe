//! From the tool centre point back along the arm: joint 1, the elbow, the wrist.
//!
//! In the radial frame the tool centre point is at (r, 0, z) and the tool is turned by the heading eta about axis 1,
//! with t_0 the tool lever and a_0 axis 6 at heading zero, and s, l, f_a the shoulder radius, the lateral offset and
//! the forearm angle:
//!
//! ```text
//! t = R(eta) t_0,  a6 = R(eta) a_0,  w = (r - t_x, -t_y)                    lever, axis 6, wrist centre in plan
//! rho = +-sqrt(|w|^2 - l^2)                                                 its distance along the arm
//! cos theta_1 = (w_x rho + w_y l) / |w|^2,  sin theta_1 = (w_y rho - w_x l) / |w|^2
//! S = (rho - s, lift (z - t_z - shoulder height)),  q = |S|^2               wrist centre from the shoulder
//! cos delta = (q - L_2^2 - L_3^2) / (2 L_2 L_3),  sin^2 delta = 1 - cos^2 delta        elbow, zero when stretched
//! e = alpha(q) S + beta(q) S',  S' normal to S                                         elbow from the shoulder
//! theta_2: e / L_2,   theta_3 = +-delta - f_a
//! z_4 in the plane of the arm, normal to the forearm's x axis,  cos theta_5 ~ z_4 . a_6
//! ```
//!
//! See [`stead_model::robot::Robot::inverse`] for the same with angles.

use super::super::interval_simd::Mask;
use super::super::number::Number;
use super::constants::{Arm, LimitSpan};
use super::posed::{Elbow, FirstJoint, Signs, Tool, Wrist, turned};
use super::vector::{InPlane, Vector};

/// Squared lengths must be above this to be divided by. m^2
const MIN_LENGTH2: f64 = 1e-6;

impl Arm {
    /// What turns with the spindle, at a heading given by its sine and cosine.
    #[inline(always)]
    pub(super) fn tool<T: Number>(&self, sine: T, cosine: T) -> Tool<T> {
        let of = |v| turned(sine, cosine, self.leaning.as_ref(), v);
        Tool { sine, cosine, leaning: self.leaning, lever: of(&self.lever), axis6: of(&self.axis6) }
    }

    /// Joint 1, from the wrist centre in plan; `regular` loses the lanes in which that may be too near to axis 1.
    #[inline(always)]
    pub(super) fn first_joint<T: Number>(&self, wrist: [T; 2], signs: Signs, regular: &mut Mask) -> FirstJoint<T> {
        let [wx, wy] = wrist;
        let lateral = self.geometry.lateral;
        let radius2 = wx.square() + wy.square();
        let forward2 = radius2.plus(-lateral * lateral);
        let forward_squared_high = forward2.high();
        let forward = forward2.assume_above(MIN_LENGTH2, regular).sqrt().scale(signs.side);
        let (cosine, sine) = if lateral == 0.0 {
            let inverse = radius2.assume_above(MIN_LENGTH2, regular).inverse_sqrt().scale(signs.side);
            (wx * inverse, wy * inverse)
        } else {
            let inverse = radius2.assume_above(MIN_LENGTH2, regular).reciprocal();
            ((wx * forward + wy.scale(lateral)) * inverse, (wy * forward - wx.scale(lateral)) * inverse)
        };
        FirstJoint { forward, forward_squared_high, cosine, sine }
    }

    /// Joints 2 and 3, for the wrist centre at a distance along the arm and a height (m) and what
    /// [`super::singularity::Needs`] says there.
    #[inline(always)]
    pub(super) fn elbow<T: Number>(
        &self,
        forward: T,
        height: T,
        needed: T,
        signs: Signs,
        regular: &mut Mask,
    ) -> Elbow<T> {
        let g = &self.geometry;
        let up = height.plus(-g.shoulder_height);
        let u = forward.plus(-g.shoulder_radius);
        let v = up.scale(g.lift);
        let distance2 = u.square() + v.square();
        let per_product = 0.5 / (g.upper_arm * g.forearm);
        let cos_delta = distance2.plus(-g.upper_arm * g.upper_arm - g.forearm * g.forearm).scale(per_product);
        let sin_delta_squared = -cos_delta.square().plus(-1.0);
        let defined = *regular;
        let margin = sin_delta_squared - needed * distance2.scale(self.needs.elbow);
        let [sin_delta, along, across] = distance2.assume_above(MIN_LENGTH2, regular).elbow(&self.links);
        let across = across.scale(g.fold * signs.elbow);
        let elbow = [u * along + v * across, v * along - u * across];
        let (cos2, sin2) = (elbow[0].scale(1.0 / g.upper_arm), elbow[1].scale(1.0 / g.upper_arm));
        let (sin_bar, cos_bar) = libm::sincos(g.forearm_angle);
        let sin3 = sin_delta.scale(signs.elbow * cos_bar) - cos_delta.scale(sin_bar);
        let cos3 = cos_delta.scale(cos_bar) + sin_delta.scale(signs.elbow * sin_bar);
        let joint_margins = [limit_margins(self.limits(0), sin2, cos2), limit_margins(self.limits(1), sin3, cos3)];
        let [span2, span3] = [0, 1].map(|joint| self.limit_span(joint));
        let mut outside = is_outside(span2, joint_margins[0]) | is_outside(span3, joint_margins[1]);
        let mut sum_margins = None;
        if let Some(sum) = &self.sum {
            let sin3 = sin3.scale(sum.fold);
            let margins = limit_margins(sum.limits, sin2 * cos3 + cos2 * sin3, cos2 * cos3 - sin2 * sin3);
            outside = outside | is_outside(LimitSpan::of(sum.limits), margins);
            sum_margins = Some(margins);
        }
        let is_folded = self.is_too_near(distance2.high(), needed.low());
        let violated = (margin.is_negative() | is_folded) & defined | outside & *regular;
        let angles = [[sin2, cos2], [sin3, cos3]];
        let from_shoulder = InPlane { along: u, up };
        Elbow {
            from_shoulder,
            elbow,
            sin_delta,
            sin_delta_squared,
            distance2,
            angles,
            margin,
            joint_margins,
            sum_margins,
            violated,
        }
    }

    /// Joints 4 to 6: axis 4 follows from the forearm, axis 6 from the spindle.
    #[inline(always)]
    pub(super) fn wrist<T: Number>(
        &self,
        axis6: Vector<T>,
        first: &FirstJoint<T>,
        elbow: &Elbow<T>,
        needed: T,
    ) -> Wrist<T> {
        let g = &self.geometry;
        let along = elbow.from_shoulder.along - elbow.elbow[0];
        let up = elbow.from_shoulder.up - elbow.elbow[1].scale(g.lift);
        // psi: elevation of the forearm's x axis.
        let (sin_bar, cos_bar) = libm::sincos(g.forearm_angle);
        let folded = sin_bar * g.fold;
        let (bar, lift) = (1.0 / g.forearm, g.lift / g.forearm);
        let cos_psi = along.scale(bar * cos_bar) + up.scale(lift * folded);
        let sin_psi = up.scale(lift * cos_bar) - along.scale(bar * folded);
        let twist4 = g.fold * g.twist[0];
        let axis4_along = sin_psi.scale(twist4);
        let axis4 =
            Vector { x: axis4_along * first.cosine, y: axis4_along * first.sine, z: cos_psi.scale(-twist4 * g.lift) };
        let dot46 = axis4.dot(axis6);
        let sine5_squared = -dot46.square().plus(-1.0);
        let inverse5 = dot46.wrist(&self.bend);
        let margin = sine5_squared.scale(self.needs.wrist) - needed * dot46.square().plus(1.0);
        let joint5_margin = dot46.scale(-g.twist[1] * g.twist[2]).plus(-self.min_cosine5);
        let from_elbow = InPlane { along, up };
        Wrist { from_elbow, axis4, axis4_along, dot46, sine5_squared, inverse5, margin, joint5_margin }
    }
}

/// sin(theta - min) and sin(max - theta) of an angle with limits (rad).
#[inline(always)]
fn limit_margins<T: Number>(limits: (f64, f64), sine: T, cosine: T) -> [T; 2] {
    let ((s0, c0), (s1, c1)) = (libm::sincos(limits.0), libm::sincos(limits.1));
    [sine.scale(c0) - cosine.scale(s0), cosine.scale(s1) - sine.scale(c1)]
}

/// Where an angle is sure to be outside its limits.
#[inline(always)]
fn is_outside<T: Number>(span: LimitSpan, margins: [T; 2]) -> Mask {
    let [min, max] = margins.map(|margin| margin.is_negative());
    match span {
        LimitSpan::Full => Mask::splat(false),
        LimitSpan::Wide => min & max,
        LimitSpan::Narrow => min | max,
    }
}
