//! The closed form of an upright tool: how the arm yields, and what its joints allow, as functions of the radius and height
//! of the tool centre point and of the spindle's heading against its azimuth.
//!
//! Everything is in the radial frame of the tool centre point: x away from axis 1, z along it. Joint 1 is left to
//! [`super::cost`], and so are joints 4 and 6, whose limits are relaxed.

use super::conditioning::{PlaneArm, Wrist};
use super::elbow::{Bend, Links};
use super::interval_simd::Mask;
use super::limits::{Limits, Needs, lever};
use super::number::Number;
use crate::problem::Problem;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use stead_model::robot::{Geometry, PostureClass, angles::ANGLE_ROUNDING};

/// Number of constraints: elbow, both limits of joints 2 and 3, joint 5, wrist, conditioning.
pub(super) const CONSTRAINTS: usize = 8;

/// What does not change from state to state.
#[derive(Debug, Clone)]
pub(super) struct Arm {
    pub(super) geometry: Geometry,
    /// Tool centre point from the wrist centre, with heading zero. m
    pub(super) lever: Vector3<f64>,
    /// Axis 6 with heading zero.
    pub(super) axis6: Vector3<f64>,
    /// Compliances of joints 2 to 6. rad/(N m)
    compliances: [f64; 5],
    /// Limits of joints 2 and 3, rounding included. rad
    limits: [(f64, f64); 2],
    /// Smallest cosine of theta_5.
    least_cosine5: f64,
    pub(super) min_inverse_condition: f64,
    pub(super) characteristic_length: f64,
    needs: Needs,
    links: Links,
    bend: Bend,
    /// Whether any force is along axis 1.
    is_vertical: bool,
}

/// How the arm yields and what it allows, in one posture class.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArmCompliance<T> {
    /// In-plane compliance without joint 1: [[m + d1, d2], [d2, m - d1]]. m/N
    pub m: T,
    /// See `m`.
    pub d1: T,
    /// See `m`.
    pub d2: T,
    /// Compliance between the vertical and the radial, and the vertical and the tangential direction. m/N
    pub vertical: [T; 2],
    /// Each of them not negative where the constraint holds: see [`Arm::is_wide`] for limits wider than half a turn.
    pub constraints: [T; CONSTRAINTS],
    /// Where the calculation was sure to be regular: up to the elbow constraint, up to the wrist constraint, all of it.
    pub regular: [Mask; 3],
    /// Where that of the conditioning was.
    pub conditioned: Mask,
    /// Where some constraint is sure to fail.
    pub lost: Mask,
}

/// Three components in the frame of joint 1.
#[derive(Clone, Copy)]
pub(super) struct Vector<T> {
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

impl Arm {
    /// For radii of the tool centre point from `nearest` (m) on.
    pub fn new(problem: &Problem, compliances: &[f64; 6], nearest: f64) -> Self {
        let robot = &problem.robot;
        let geometry = robot.geometry().clone();
        let side = geometry.base_from_root[(2, 2)];
        let axis = problem.task.points().first().map_or(1.0, |p| p.axis.z) * side;
        // With heading zero: feed along x, axis up or down, then eq. 10 with beta zero.
        let root_from_flange = Matrix3::from_diagonal(&Vector3::new(1.0, axis, axis))
            * Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0))
            * problem.spindle.flange_from_tool.inverse().rotation;
        let lever = lever(problem);
        let joint = |j: usize| &robot.joints()[j];
        let widest5 = joint(4).min.abs().max(joint(4).max.abs()) + ANGLE_ROUNDING;
        let least = problem.constraints.min_inverse_condition;
        let limits = Limits::new(problem, least, nearest);
        let (upper, fore) = (geometry.upper_arm, geometry.forearm);
        let (square, twice) = (upper * upper + fore * fore, 2.0 * upper * fore);
        let links = Links {
            upper_arm: upper,
            forearm: fore,
            limits: [square - twice * limits.folded, square + twice * limits.stretched],
        };
        Self {
            geometry,
            needs: limits.needs,
            links,
            bend: Bend { limit: limits.in_line },
            is_vertical: problem.task.wrenches().iter().any(|w| w.force.z != 0.0),
            lever: root_from_flange * lever,
            axis6: root_from_flange.column(2).into_owned(),
            compliances: std::array::from_fn(|k| compliances[k + 1]),
            limits: [1, 2].map(|j| (joint(j).min - ANGLE_ROUNDING, joint(j).max + ANGLE_ROUNDING)),
            least_cosine5: if widest5 >= PI { -1.0 } else { libm::cos(widest5) },
            min_inverse_condition: problem.constraints.min_inverse_condition,
            characteristic_length: problem.constraints.characteristic_length,
        }
    }

    /// How large a compliance of the arm is: that of its upper joints at a lever of a metre. m/N
    pub fn typical(&self) -> f64 {
        self.compliances[0].max(self.compliances[1]) / 3.0
    }

    /// For joint 2 (0) or 3 (1): whether its limits are wider than half a turn, so that a state is lost only where both of
    /// its constraints (2k + 1 and 2k + 2) fail, or so wide that nothing is lost (`None`).
    pub fn is_wide(&self, joint: usize) -> Option<bool> {
        let (min, max) = self.limits[joint];
        if max - min >= 2.0 * PI { None } else { Some(max - min > PI) }
    }

    /// Evaluates one posture class; `None` where none of the lanes is allowed.
    pub fn evaluate<T: Number>(&self, r: T, z: T, sine: T, cosine: T, class: PostureClass) -> Option<ArmCompliance<T>> {
        let g = &self.geometry;
        let back = if class.postures()[0].is_back() { -1.0 } else { 1.0 };
        let e = if class.postures()[0].is_delta_negative() { -1.0 } else { 1.0 };
        let mut regular = Mask::splat(true);
        let (at_elbow, at_wrist);
        let turn = |v: &Vector3<f64>| Vector {
            x: cosine.scale(v.x) - sine.scale(v.y),
            y: sine.scale(v.x) + cosine.scale(v.y),
            z: T::constant(v.z),
        };
        let lever = turn(&self.lever);
        let axis6 = turn(&self.axis6);
        // Wrist centre, and joint 1 against the azimuth.
        let (wx, wy) = (r - lever.x, -lever.y);
        let radius2 = wx.square() + wy.square();
        let forward = radius2.plus(-g.lateral * g.lateral).assume_above(1e-6, &mut regular).sqrt().scale(back);
        let (cos1, sin1) = if g.lateral == 0.0 {
            let inverse = radius2.assume_above(1e-6, &mut regular).inverse_sqrt().scale(back);
            (wx * inverse, wy * inverse)
        } else {
            let inverse = radius2.assume_above(1e-6, &mut regular).reciprocal();
            ((wx * forward + wy.scale(g.lateral)) * inverse, (wy * forward - wx.scale(g.lateral)) * inverse)
        };
        let height = z.plus(-self.lever.z - g.shoulder_height);
        // The plane arm.
        let u = forward.plus(-g.shoulder_radius);
        let v = height.scale(g.lift);
        let distance2 = u.square() + v.square();
        let bend = 0.5 / (g.upper_arm * g.forearm);
        let cos_delta = distance2.plus(-g.upper_arm * g.upper_arm - g.forearm * g.forearm).scale(bend);
        let sin_delta_squared = -cos_delta.square().plus(-1.0);
        at_elbow = regular;
        // What the least inverse condition asks of the elbow and of the wrist: see `needs`.
        let needed = r.square().scale(self.needs.per_radius2).plus(self.needs.constant);
        let elbow = sin_delta_squared - needed * distance2.scale(self.needs.elbow);
        let [sin_delta, along, across] = distance2.assume_above(1e-6, &mut regular).elbow(&self.links);
        let across = across.scale(g.fold * e);
        let (elbow_u, elbow_v) = (u * along + v * across, v * along - u * across);
        let (cos2, sin2) = (elbow_u.scale(1.0 / g.upper_arm), elbow_v.scale(1.0 / g.upper_arm));
        let (sin_bar, cos_bar) = libm::sincos(g.forearm_angle);
        let sin3 = sin_delta.scale(e * cos_bar) - cos_delta.scale(sin_bar);
        let cos3 = cos_delta.scale(cos_bar) + sin_delta.scale(e * sin_bar);
        let limit = |joint: usize, sine: T, cosine: T| {
            let (min, max) = self.limits[joint];
            let ((s0, c0), (s1, c1)) = (libm::sincos(min), libm::sincos(max));
            [sine.scale(c0) - cosine.scale(s0), cosine.scale(s1) - sine.scale(c1)]
        };
        let ([min2, max2], [min3, max3]) = (limit(0, sin2, cos2), limit(1, sin3, cos3));
        let fails = |joint: usize, pair: [T; 2]| match self.is_wide(joint) {
            None => Mask::splat(false),
            Some(true) => pair[0].is_negative() & pair[1].is_negative(),
            Some(false) => pair[0].is_negative() | pair[1].is_negative(),
        };
        let everywhere = Mask::splat(true);
        let mut lost = elbow.is_negative() & at_elbow | (fails(0, [min2, max2]) | fails(1, [min3, max3])) & regular;
        if lost.covers(everywhere) {
            return None;
        }
        let u3 = u - elbow_u;
        let height3 = height - elbow_v.scale(g.lift);
        // The wrist, in the radial frame: axis 4 along the forearm, axis 6 along with the spindle.
        let folded = sin_bar * g.fold;
        let (bar, lift) = (1.0 / g.forearm, g.lift / g.forearm);
        let cos_psi = u3.scale(bar * cos_bar) + height3.scale(lift * folded);
        let sin_psi = height3.scale(lift * cos_bar) - u3.scale(bar * folded);
        let twist4 = g.fold * g.twist[0];
        let zero = T::constant(0.0);
        let forearm = sin_psi.scale(twist4);
        let z4 = Vector { x: forearm * cos1, y: forearm * sin1, z: cos_psi.scale(-twist4 * g.lift) };
        let dot46 = z4.dot(axis6);
        let sine5_squared = -dot46.square().plus(-1.0);
        at_wrist = regular;
        let inverse5 = dot46.wrist(&self.bend);
        let wrist = sine5_squared.scale(self.needs.wrist) - needed * dot46.square().plus(1.0);
        let cosine5 = dot46.scale(-g.twist[1] * g.twist[2]);
        let cosine5 = cosine5.plus(-self.least_cosine5);
        lost = lost | (wrist.is_negative() | cosine5.is_negative()) & at_wrist;
        if lost.covers(everywhere) {
            return None;
        }
        let (z2, z3) = (height.plus(self.lever.z), height3.plus(self.lever.z));
        let forward_t = lever.x * cos1 + lever.y * sin1;
        let (p2, p3) = ((u + forward_t, z2), (u3 + forward_t, z3));
        let yields = regular;
        let conditioning = if self.min_inverse_condition > 0.0 {
            let into = |v: Vector<T>| Vector { x: v.x * cos1 + v.y * sin1, y: v.y * cos1 - v.x * sin1, z: v.z };
            let (z6, t) = (into(axis6), into(lever));
            let z4 = Vector { x: forearm, y: zero, z: z4.z };
            let sign = e * g.fold * g.lift / (g.upper_arm * g.forearm);
            let inverse_forward = forward.scale(back).assume_above(1e-3, &mut regular).reciprocal().scale(back);
            let plane = PlaneArm { forward, inverse_forward, u, u3, height, height3, p2, p3, sign, sin_delta };
            let across = z4.dot(into(turn(&self.axis6.cross(&self.lever)))).square() * inverse5;
            self.condition(&plane, &Wrist { t, z4, z6, dot46, sine5_squared, across })
        } else {
            T::constant(1.0)
        };
        lost = lost | conditioning.is_negative() & regular;
        if lost.covers(everywhere) {
            return None;
        }
        // Velocity of the tool centre point per joint velocity, joint 5 times sin(theta_5). Those of joints 2 and 3 lie in the
        // plane of the arm; (z4 x z6) x t = z6 (z4 . t) - z4 (z6 . t).
        let v4 = z4.cross(lever);
        let (along4, along6) = (z4.dot(lever), self.lever.dot(&self.axis6));
        let five = |z6: T, z4: T| z6 * along4 - z4.scale(along6);
        let v5 = Vector { x: five(axis6.x, z4.x), y: five(axis6.y, z4.y), z: five(axis6.z, z4.z) };
        let v6 = turn(&self.axis6.cross(&self.lever));
        let [k2, k3, k4, k5, k6] = self.compliances;
        let inverse5k = inverse5.scale(k5);
        let bending = (z2.square().scale(k2) + z3.square().scale(k3)).scale(0.5);
        let wrists = |f: &dyn Fn(&Vector<T>) -> T| f(&v4).scale(k4) + f(&v5) * inverse5k + f(&v6).scale(k6);
        let (cc, ss) = (sin1.square().scale(-2.0).plus(1.0), (cos1 * sin1).scale(2.0));
        let m = bending + wrists(&|v| v.x.square() + v.y.square()).scale(0.5);
        let d1 = bending * cc + wrists(&|v| v.x.square() - v.y.square()).scale(0.5);
        let d2 = bending * ss + wrists(&|v| v.x * v.y);
        let vertical = if self.is_vertical {
            let shaking = -((p2.0 * z2).scale(k2) + (p3.0 * z3).scale(k3));
            [shaking * cos1 + wrists(&|v| v.x * v.z), shaking * sin1 + wrists(&|v| v.y * v.z)]
        } else {
            [zero; 2]
        };
        Some(ArmCompliance {
            m,
            d1,
            d2,
            vertical,
            constraints: [elbow, min2, max2, min3, max3, cosine5, wrist, conditioning],
            regular: [at_elbow, at_wrist, yields],
            conditioned: regular,
            lost,
        })
    }
}
