//! The closed form of an upright tool: how the arm yields, and what its joints allow, as functions of the radius and
//! height of the tool centre point and of the spindle's heading against its azimuth.
//!
//! Everything is in the radial frame of the tool centre point: x away from axis 1, z along it. Joint 1 is left to
//! [`super::cost`], and so are joints 4 and 6, whose limits are relaxed.
//!
//! A joint j moves the tool centre point at v_j per joint velocity, so joints 2 to 6 yield by `C = sum k_j v_j v_j^T`.
//! With phi the angle theta_1 of the arm's plane, h_2 and h_3 the heights of the tool centre point above axes 2 and 3,
//! and t the lever, where a linkage puts v_2 - v_3 in the place of v_2:
//!
//! ```text
//! v_2, v_3: h_j (cos phi, sin phi) in plan        v_4 = z_4 x t,  v_5 = (z_4 x z_6) x t / s,  v_6 = z_6 x t
//! [[m + d1, d2], [d2, m - d1]] = C in plan        c_rz, c_tz = C between the vertical and the plan
//! ```
//!
//! What else yields is in `beside`; the part, which turns with the load, in [`super::load`].

mod beside;
mod conditioning;
mod constants;
mod inverse;
mod posed;
mod singularity;
mod vector;

use super::interval_simd::Mask;
use super::moment::MOMENTS;
use super::number::Number;
pub(super) use beside::is_base_alike;
pub(super) use constants::Arm;
use posed::{Place, Posed, Signs, Tool};
pub(super) use singularity::needed_condition;
use stead_model::robot::PostureClass;
use vector::{InPlane, Vector};

/// How the arm yields and what it allows, in one posture class.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArmCompliance<T> {
    /// In-plane compliance without joint 1 about its axis: [[m + d1, d2], [d2, m - d1]]. m/N
    pub m: T,
    /// See `m`.
    pub d1: T,
    /// See `m`.
    pub d2: T,
    /// Compliance between the vertical and the radial, and the vertical and the tangential direction. m/N
    pub vertical: [T; 2],
    /// Compliance along the vertical. m/N
    pub axial: T,
    /// The functions of [`super::moment::MomentModel`], where some moment acts. 1/N
    pub moments: Option<[T; MOMENTS]>,
    /// What is left to each constraint.
    pub margins: Margins<T>,
    /// Where all but the conditioning was sure to be regular.
    pub regular: Mask,
    /// Where the conditioning was.
    pub conditioned: Mask,
    /// Where some constraint is sure to be violated.
    pub violated: Mask,
}

/// Signed margins, each not negative where its constraint holds; without unit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Margins<T> {
    /// What the bound on conditioning asks of the elbow.
    pub elbow: T,
    /// Of joints 2 and 3, above the lower and below the upper limit: see [`Arm::limit_span`].
    pub joints: [[T; 2]; 2],
    /// The same of the sum of joints 2 and 3, where it has limits.
    pub sum: Option<[T; 2]>,
    /// Joint 5, in the better of the two flips.
    pub joint5: T,
    /// What the bound on conditioning asks of the wrist.
    pub wrist: T,
    /// Conditioning.
    pub conditioning: T,
}

/// One of the components of a vector.
type Component<T> = fn(&Vector<T>) -> T;

/// m, d1, d2, c_rz and c_tz, and c_zz of [`ArmCompliance`]. m/N
type Compliance<T> = (T, T, T, [T; 2], T);

impl Arm {
    /// Evaluates one posture class for a tool centre point at a radius and height (m) and a heading; `None` where none
    /// of the lanes is allowed.
    pub fn evaluate<T: Number>(
        &self,
        radius: T,
        height: T,
        sine: T,
        cosine: T,
        class: PostureClass,
    ) -> Option<ArmCompliance<T>> {
        let tool = self.tool(sine, cosine);
        let wrist = [radius - tool.lever.x, -tool.lever.y];
        let place =
            Place { tip: Vector { x: radius, y: T::constant(0.0), z: height }, wrist, radius2: radius.square() };
        self.evaluate_at(&place, &tool, class)
    }

    /// The same of a tool that leans, in the frame of the workpiece about axis 1, with a turn about the tool axis; and
    /// with joint 1.
    pub fn evaluate_leaning<T: Number>(
        &self,
        at: [T; 3],
        sine: T,
        cosine: T,
        class: PostureClass,
    ) -> Option<ArmCompliance<T>> {
        let [x, y, z] = at;
        let tool = self.tool(sine, cosine);
        let wrist = [x - tool.lever.x, y - tool.lever.y];
        let (x2, y2) = (x.square(), y.square());
        let place = Place { tip: Vector { x, y, z }, wrist, radius2: x2 + y2 };
        let mut all = self.evaluate_at(&place, &tool, class)?;
        // Joint 1 moves the tool centre point by (-y, x).
        all.m = all.m + place.radius2.scale(0.5 * self.joint1);
        all.d1 = all.d1 + (y2 - x2).scale(0.5 * self.joint1);
        all.d2 = all.d2 - (x * y).scale(self.joint1);
        Some(all)
    }

    fn evaluate_at<T: Number>(
        &self,
        place: &Place<T>,
        tool: &Tool<T>,
        class: PostureClass,
    ) -> Option<ArmCompliance<T>> {
        let signs = Signs::of(class);
        let mut regular = Mask::splat(true);
        let first = self.first_joint(place.wrist, signs, &mut regular);
        let needed = self.needs.at(place.radius2);
        // Where the wrist centre is that near to axis 1 the closed form is not regular, and nothing else would tell.
        let is_above_axis = self.is_too_near(first.forward_squared_high, needed.low());
        if is_above_axis.all() {
            return None;
        }
        let up = place.tip.z - tool.lever.z;
        let elbow = self.elbow(first.forward, up, needed, signs, &mut regular);
        let mut violated = is_above_axis | elbow.violated;
        if violated.all() {
            return None;
        }
        let wrist = self.wrist(tool.axis6, &first, &elbow, needed);
        violated = violated | (wrist.margin.is_negative() | wrist.joint5_margin.is_negative()) & regular;
        if violated.all() {
            return None;
        }
        let lever_along = tool.lever.x * first.cosine + tool.lever.y * first.sine;
        let tips = [elbow.from_shoulder, wrist.from_elbow]
            .map(|p| InPlane { along: p.along + lever_along, up: p.up + tool.lever.z });
        let posed = Posed { signs, tool, first: &first, elbow: &elbow, wrist: &wrist, tips: &tips };
        let mut conditioned = regular;
        let (conditioning, is_singular) = if self.min_inverse_condition > 0.0 {
            self.conditioning(&posed, &mut conditioned)
        } else {
            (T::constant(1.0), Mask::splat(false))
        };
        violated = violated | is_singular | conditioning.is_negative() & conditioned;
        if violated.all() {
            return None;
        }
        let (m, d1, d2, vertical, axial) = self.compliance(&posed, place, &mut regular);
        let moments = self.has_moments.then(|| self.under_moments(&posed, &mut regular));
        let margins = Margins {
            elbow: elbow.margin,
            joints: elbow.joint_margins,
            sum: elbow.sum_margins,
            joint5: wrist.joint5_margin,
            wrist: wrist.margin,
            conditioning,
        };
        Some(ArmCompliance { m, d1, d2, vertical, axial, moments, margins, regular, conditioned, violated })
    }

    /// m, d1, d2, and c_rz, c_tz and c_zz where some force or scored direction is along axis 1.
    #[inline(always)]
    fn compliance<T: Number>(&self, posed: &Posed<'_, T>, place: &Place<T>, regular: &mut Mask) -> Compliance<T> {
        let (mut m, mut d1, mut d2, mut vertical, mut axial) = self.of_joints(posed, regular);
        if let Some(beside) = &self.beside {
            let more = beside.compliance(posed, &self.geometry, place.tip.x, place.tip.z);
            (m, d1, d2) = (m + (more.xx + more.yy).scale(0.5), d1 + (more.xx - more.yy).scale(0.5), d2 + more.xy);
            if self.is_vertical {
                vertical = [vertical[0] + more.xz, vertical[1] + more.yz];
            }
            if self.is_axial {
                axial = axial + more.zz;
            }
        }
        (m, d1, d2, vertical, axial)
    }

    /// The same of joints 2 to 6 about their axes.
    #[inline(always)]
    fn of_joints<T: Number>(&self, posed: &Posed<'_, T>, regular: &mut Mask) -> Compliance<T> {
        let (axis4, axis6, lever) = (posed.wrist.axis4, posed.tool.axis6, posed.tool.lever);
        let v4 = axis4.cross(lever);
        // s v_5 = (z_4 x z_6) x t = z_6 (z_4 . t) - z_4 (z_6 . t).
        let (along4, along6) = (axis4.dot(lever), self.lever.dot(&self.axis6));
        let five = |z6: T, z4: T| z6 * along4 - z4.scale(along6);
        let v5 = Vector { x: five(axis6.x, axis4.x), y: five(axis6.y, axis4.y), z: five(axis6.z, axis4.z) };
        let v6 = posed.tool.turned(&self.axis6.cross(&self.lever));
        let [k4, k5, k6] = self.compliances;
        let ([second, third], [angles2, angles3]) = (&self.laws, posed.elbow.angles);
        let k5 = posed.wrist.inverse5.scale(k5);
        // The sum over joints 4 to 6 of k_j f(v_j).
        let wrist = |f: &dyn Fn(&Vector<T>) -> T| f(&v4).scale(k4) + f(&v5) * k5 + f(&v6).scale(k6);
        let [mut p2, p3] = *posed.tips;
        if self.linkage {
            p2 = InPlane { along: p2.along - p3.along, up: p2.up - p3.up };
        }
        let (cos1, sin1) = (posed.first.cosine, posed.first.sine);
        let (cos_twice, sin_twice) = (sin1.square().scale(-2.0).plus(1.0), (cos1 * sin1).scale(2.0));
        // Of joints 2 and 3 the sum of k_j f(v_j).
        let mut upper = |of2: T, of3: T| second.times(of2, angles2, regular) + third.times(of3, angles3, regular);
        let bending = upper(p2.up.square(), p3.up.square()).scale(0.5);
        let m = bending + wrist(&|v| v.x.square() + v.y.square()).scale(0.5);
        let d1 = bending * cos_twice + wrist(&|v| v.x.square() - v.y.square()).scale(0.5);
        let d2 = bending * sin_twice + wrist(&|v| v.x * v.y);
        let zero = T::constant(0.0);
        if !self.is_vertical {
            return (m, d1, d2, [zero; 2], zero);
        }
        let tilting = -upper(p2.along * p2.up, p3.along * p3.up);
        let vertical = [tilting * cos1 + wrist(&|v| v.x * v.z), tilting * sin1 + wrist(&|v| v.y * v.z)];
        let axial =
            if self.is_axial { upper(p2.along.square(), p3.along.square()) + wrist(&|v| v.z.square()) } else { zero };
        (m, d1, d2, vertical, axial)
    }

    /// The functions of D = sum k_j v_j z_j^T without joint 1. In the frame of the arm's plane, axes 2 and 3 are
    /// (sin phi, -cos phi, 0).
    #[inline(never)]
    fn under_moments<T: Number>(&self, posed: &Posed<'_, T>, regular: &mut Mask) -> [T; MOMENTS] {
        let (axis4, axis6, lever) = (posed.wrist.axis4, posed.tool.axis6, posed.tool.lever);
        let crossed = axis4.cross(axis6);
        let [k4, k5, k6] = self.compliances;
        let k5 = posed.wrist.inverse5.scale(k5);
        let [v4, v5, v6] = [axis4.cross(lever), crossed.cross(lever), axis6.cross(lever)];
        // The sum over joints 4 to 6 of k_j f(v_j) g(z_j).
        let wrist = |f: fn(&Vector<T>) -> T, g: fn(&Vector<T>) -> T| {
            (f(&v4) * g(&axis4)).scale(k4) + f(&v5) * g(&crossed) * k5 + (f(&v6) * g(&axis6)).scale(k6)
        };
        let [x, y, z]: [Component<T>; 3] = [|v| v.x, |v| v.y, |v| v.z];
        let [rr, rt, tr, tt] = [wrist(x, x), wrist(x, y), wrist(y, x), wrist(y, y)];
        let ([second, third], [angles2, angles3]) = (&self.laws, posed.elbow.angles);
        let mut upper = |of2: T, of3: T| second.times(of2, angles2, regular) + third.times(of3, angles3, regular);
        let [p2, p3] = posed.tips;
        let [mut up2, mut along2] = [p2.up, p2.along];
        if self.linkage {
            // The forearm keeps its direction: no moment turns the spring of joint 2.
            (up2, along2) = (T::constant(0.0), T::constant(0.0));
        }
        let (bending, lifting) = (upper(up2, p3.up).scale(0.5), upper(along2, p3.along));
        let (cos1, sin1) = (posed.first.cosine, posed.first.sine);
        let (cos_twice, sin_twice) = (sin1.square().scale(-2.0).plus(1.0), (cos1 * sin1).scale(2.0));
        [
            (rr + tt).scale(0.5),
            (tr - rt).scale(0.5) - bending,
            (rr - tt).scale(0.5) - bending * sin_twice,
            (rt + tr).scale(0.5) + bending * cos_twice,
            wrist(x, z),
            wrist(y, z),
            wrist(z, x) + lifting * sin1,
            wrist(z, y) - lifting * cos1,
            wrist(z, z),
        ]
    }
}
