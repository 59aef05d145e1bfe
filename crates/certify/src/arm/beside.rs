//! What yields beside the joints about their axes: springs normal to the axes, base, mount of the spindle, tip.
//!
//! A spring that turns what is behind it about the direction e, at a point r before the tool centre point, yields by
//! `c (e x r) (e x r)^T`. In the frame of joint 1 (x along the arm, y normal to its plane):
//!
//! ```text
//! x_1 = x,  y_1 = y      x_2 along the upper arm, y_2 normal to it in the plane     y_3 along z_4, x_3 normal to it
//! y_4 along z_5,  x_4 along z_5 x z_4,  y_5 along z_6,  x_5 along z_5 x z_6,  with z_5 = (z_4 x z_6) / s
//! ```
//!
//! up to signs, which do not count. Springs of joint 6, mount and tip are fixed to the tool: one matrix, which turns
//! with the heading. The matrix of the base is a sum of such springs that move their point too, fixed to the radial
//! frame if turning it about axis 1 changes nothing, as bounds require.

use super::super::number::Number;
use super::posed::Posed;
use super::vector::Vector;
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector3};
use stead_model::robot::{Geometry, Joint, NormalSprings, Pose, Robot, Spindle};
use stead_model::stiffness::whole::{of_matrix, yields_elsewhere};

/// What yields beside the joints about their axes.
#[derive(Debug, Clone)]
pub(super) struct Beside {
    normal: Option<[NormalSprings; 6]>,
    /// Where the bearings of joints 2 and 3 are, along the normal of the arm's plane. m
    bearings: [f64; 2],
    /// Joint 6, mount and tip, with heading zero, in the radial frame. m/N
    tool: Matrix3<f64>,
    base: Vec<BaseSpring>,
    /// Height of the point of the base's matrix above the root. m
    base_height: f64,
}

/// A part of the base's matrix: it moves by `shift + turn x r` and the force does as much work on it. In the root
/// frame.
#[derive(Debug, Clone, Copy)]
struct BaseSpring {
    compliance: f64,
    shift: Vector3<f64>,
    turn: Vector3<f64>,
}

/// A symmetric matrix.
#[derive(Clone, Copy)]
pub(super) struct Symmetric<T> {
    pub xx: T,
    pub yy: T,
    pub zz: T,
    pub xy: T,
    pub xz: T,
    pub yz: T,
}

impl<T: Number> Symmetric<T> {
    fn zero() -> Self {
        let zero = T::constant(0.0);
        Self { xx: zero, yy: zero, zz: zero, xy: zero, xz: zero, yz: zero }
    }

    fn add(&mut self, compliance: f64, v: Vector<T>) {
        let by = |entry: &mut T, product: T| *entry = *entry + product.scale(compliance);
        by(&mut self.xx, v.x.square());
        by(&mut self.yy, v.y.square());
        by(&mut self.zz, v.z.square());
        by(&mut self.xy, v.x * v.y);
        by(&mut self.xz, v.x * v.z);
        by(&mut self.yz, v.y * v.z);
    }

    fn map(self, f: impl Fn(T) -> T) -> Self {
        let Self { xx, yy, zz, xy, xz, yz } = self;
        Self { xx: f(xx), yy: f(yy), zz: f(zz), xy: f(xy), xz: f(xz), yz: f(yz) }
    }

    fn plus(self, o: Self) -> Self {
        Self {
            xx: self.xx + o.xx,
            yy: self.yy + o.yy,
            zz: self.zz + o.zz,
            xy: self.xy + o.xy,
            xz: self.xz + o.xz,
            yz: self.yz + o.yz,
        }
    }

    /// In a frame against which its own is turned about z.
    fn turned(self, sine: T, cosine: T) -> Self {
        let mean = (self.xx + self.yy).scale(0.5);
        let half = (self.xx - self.yy).scale(0.5);
        let (sine2, cosine2) = ((sine * cosine).scale(2.0), sine.square().scale(-2.0).plus(1.0));
        let along = half * cosine2 - self.xy * sine2;
        Self {
            xx: mean + along,
            yy: mean - along,
            zz: self.zz,
            xy: half * sine2 + self.xy * cosine2,
            xz: self.xz * cosine - self.yz * sine,
            yz: self.xz * sine + self.yz * cosine,
        }
    }
}

impl Beside {
    /// Of a robot and a spindle, with the rotation of the flange with heading zero in the radial frame and the lever in
    /// it (m); `None` where nothing yields beside the joints about their axes.
    pub fn of(robot: &Robot, spindle: &Spindle, root_from_flange: &Matrix3<f64>, lever: &Vector3<f64>) -> Option<Self> {
        if !yields_elsewhere(robot, spindle) {
            return None;
        }
        let (g, joints, normal) = (robot.geometry(), robot.joints(), robot.normal_springs().copied());
        let (base, base_height) = base_springs(robot, g);
        Some(Self {
            normal,
            bearings: bearings(g, joints, normal.as_ref()),
            tool: of_tool(g, spindle, normal.as_ref(), root_from_flange, lever),
            base,
            base_height,
        })
    }

    /// How it all yields in the radial frame, with the tool centre point at a radius and height. m/N
    #[inline(never)]
    pub fn compliance<T: Number>(&self, posed: &Posed<'_, T>, g: &Geometry, radius: T, height: T) -> Symmetric<T> {
        let mut sum = Symmetric {
            xx: T::constant(self.tool[(0, 0)]),
            yy: T::constant(self.tool[(1, 1)]),
            zz: T::constant(self.tool[(2, 2)]),
            xy: T::constant(self.tool[(0, 1)]),
            xz: T::constant(self.tool[(0, 2)]),
            yz: T::constant(self.tool[(1, 2)]),
        };
        sum = sum.turned(posed.tool.sine, posed.tool.cosine);
        for BaseSpring { compliance, shift, turn } in &self.base {
            let up = height.plus(-self.base_height);
            let v = Vector {
                x: up.scale(turn.y).plus(shift.x),
                y: radius.scale(turn.z) - up.scale(turn.x) + T::constant(shift.y),
                z: radius.scale(-turn.y).plus(shift.z),
            };
            sum.add(*compliance, v);
        }
        let Some(normal) = &self.normal else { return sum };
        sum = sum.plus(self.of_upper_joints(posed, g, normal, height).turned(posed.first.sine, posed.first.cosine));
        let (axis4, axis6, lever) = (posed.wrist.axis4, posed.tool.axis6, posed.tool.lever);
        let axis5 = axis4.cross(axis6);
        let mut wrist = Symmetric::zero();
        let along4 = |h: f64| Vector {
            x: lever.x - axis4.x.scale(h),
            y: lever.y - axis4.y.scale(h),
            z: lever.z - axis4.z.scale(h),
        };
        for (compliance, e, r) in [
            (normal[3].compliance[0], axis5.cross(axis4), along4(normal[3].bearing)),
            (normal[3].compliance[1], axis5, along4(normal[3].bearing)),
            (normal[4].compliance[0], axis5.cross(axis6), lever),
        ] {
            if compliance != 0.0 {
                wrist.add(compliance, e.cross(r));
            }
        }
        sum = sum.plus(wrist.map(|entry| entry * posed.wrist.inverse5));
        if normal[4].compliance[1] != 0.0 {
            sum.add(normal[4].compliance[1], axis6.cross(lever));
        }
        debug_assert!(normal[4].bearing == 0.0 || normal[4].compliance == [0.0; 2], "flips that differ are refused");
        sum
    }

    /// Springs of joints 1 to 3 in the frame of joint 1.
    fn of_upper_joints<T: Number>(
        &self,
        posed: &Posed<'_, T>,
        g: &Geometry,
        normal: &[NormalSprings; 6],
        height: T,
    ) -> Symmetric<T> {
        let (first, lever) = (posed.first, posed.tool.lever);
        let along = lever.x * first.cosine + lever.y * first.sine;
        let aside = (lever.y * first.cosine - lever.x * first.sine).plus(g.lateral);
        let mut sum = Symmetric::zero();
        // x and y of the first joint.
        let (x, up) = (first.forward + along, height.plus(-g.shoulder_height - normal[0].bearing));
        let zero = T::constant(0.0);
        sum.add(normal[0].compliance[0], Vector { x: zero, y: -up, z: aside });
        sum.add(normal[0].compliance[1], Vector { x: up, y: zero, z: -x });
        let [sin2, cos2] = posed.elbow.angles[0];
        let (ax, az) = (posed.wrist.axis4_along, posed.wrist.axis4.z);
        // Directions in the plane of the arm: along it, and up.
        let frames = [[(cos2, sin2.scale(g.lift)), (-sin2, cos2.scale(g.lift))], [(-az, ax), (ax, az)]];
        for (k, frame) in frames.into_iter().enumerate() {
            let (tip, y) = (posed.tips[k], aside.plus(-self.bearings[k]));
            for (compliance, (e, f)) in normal[k + 1].compliance.into_iter().zip(frame) {
                if compliance != 0.0 {
                    // (e, 0, f) x (along, y, up)
                    sum.add(compliance, Vector { x: -(f * y), y: f * tip.along - e * tip.up, z: e * y });
                }
            }
        }
        sum
    }
}

/// Where the bearings of joints 2 and 3 are, along the normal of the arm's plane. m
fn bearings(g: &Geometry, joints: &[Joint; 6], normal: Option<&[NormalSprings; 6]>) -> [f64; 2] {
    let bearing = |j: usize| normal.map_or(0.0, |springs| springs[j].bearing);
    let second = -g.lift * joints[1].d;
    [second - g.lift * bearing(1), second - g.lift * g.fold * (joints[2].d + bearing(2))]
}

/// Joint 6, mount and tip, with heading zero in the radial frame. m/N
fn of_tool(
    g: &Geometry,
    spindle: &Spindle,
    normal: Option<&[NormalSprings; 6]>,
    root_from_flange: &Matrix3<f64>,
    lever: &Vector3<f64>,
) -> Matrix3<f64> {
    let axis6 = root_from_flange.column(2).into_owned();
    let from_flange = lever - axis6 * g.flange;
    let mut sum = Matrix3::zeros();
    if let Some(normal) = normal {
        let NormalSprings { compliance, bearing } = normal[5];
        for (about, compliance) in compliance.into_iter().enumerate() {
            let v = root_from_flange.column(about).cross(&(from_flange - axis6 * bearing));
            sum += v * v.transpose() * compliance;
        }
    }
    if let Some(mount) = &spindle.mount {
        let frame = Pose { rotation: *root_from_flange, translation: Vector3::zeros() };
        let column =
            |k: usize| of_matrix(mount, &frame, &from_flange, [&Vector3::ith(k, 1.0), &Vector3::zeros()]).linear;
        sum += Matrix3::from_columns(&[column(0), column(1), column(2)]);
    }
    if let Some(tip) = &spindle.tip {
        let rotation = root_from_flange * spindle.flange_from_tool.rotation;
        sum += rotation * tip * rotation.transpose();
    }
    sum
}

/// The parts of the base's matrix in the root frame, and the height of its point there (m).
fn base_springs(robot: &Robot, g: &Geometry) -> (Vec<BaseSpring>, f64) {
    let Some((pose, matrix)) = robot.yielding_base() else { return (Vec::new(), 0.0) };
    let root_from_point = g.base_from_root.transpose() * pose.rotation;
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(*matrix);
    let part = |k: usize| {
        let half = |from: usize| root_from_point * eigenvectors.fixed_view::<3, 1>(from, k);
        BaseSpring { compliance: eigenvalues[k], shift: half(0), turn: half(3) }
    };
    let at = g.base_from_root.transpose() * (pose.translation - g.root_in_base);
    ((0..6).map(part).filter(|part| part.compliance != 0.0).collect(), at.z)
}

/// Entries of a matrix that is the same in every direction about axis 1 may differ by this much, relative to its size.
const ALIKE: f64 = 1e-9;

/// Whether turning what carries the robot about axis 1 changes nothing.
pub(in super::super) fn is_base_alike(robot: &Robot) -> bool {
    let Some((pose, matrix)) = robot.yielding_base() else { return true };
    let g = robot.geometry();
    let at = g.base_from_root.transpose() * (pose.translation - g.root_in_base);
    let rotation = g.base_from_root.transpose() * pose.rotation;
    let mut turned = Matrix6::zeros();
    for block in [0, 3] {
        turned.fixed_view_mut::<3, 3>(block, block).copy_from(&rotation);
    }
    let own = turned * matrix * turned.transpose();
    let (sine, cosine) = libm::sincos(1.0);
    let about = Matrix3::new(cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0);
    for block in [0, 3] {
        turned.fixed_view_mut::<3, 3>(block, block).copy_from(&about);
    }
    let off = turned * own * turned.transpose() - own;
    let is_on_axis = libm::hypot(at.x, at.y) <= ALIKE;
    // Moved to axis 1 the matrix is another one; only a base that yields without turning is the same everywhere.
    let does_turn = own.fixed_view::<3, 3>(3, 3).amax() > 0.0;
    off.amax() <= ALIKE * own.amax() && (is_on_axis || !does_turn)
}
