//! The deflection of a whole arm: springs about the axes of the joints, springs normal to them, what carries the robot,
//! how the spindle is fixed to the flange, and holder and tool.
//!
//! All of it is small displacements that add up. Springs of a joint turn the arm behind them by `C tau` about the
//! bearing b, with `tau = m + (p - b) x f` for force f and moment m at p; a 6x6 at a point answers force and moment
//! there by displacement and turn there; a 3x3 at the tip answers the force alone. The sum is symmetric and positive
//! semidefinite, as each term is. [`super::displacement`] has the springs about the axes alone.

use super::{Displacement, displacement};
use crate::robot::{Frames, Pose, Robot, Spindle};
use nalgebra::{Matrix3, Matrix6, Vector3};
use stead_numerics::scalar::Scalar;

/// What yields, by where it is; the same things of each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ByOrigin<V> {
    /// Springs of the joints about their axes.
    pub axes: V,
    /// Springs of the joints normal to their axes.
    pub normal: V,
    /// What carries the robot.
    pub base: V,
    /// How the spindle is fixed to the flange.
    pub mount: V,
    /// Holder and tool.
    pub tip: V,
}

impl<V> ByOrigin<V> {
    /// Something of each.
    pub fn map<W>(self, mut of: impl FnMut(V) -> W) -> ByOrigin<W> {
        let Self { axes, normal, base, mount, tip } = self;
        ByOrigin { axes: of(axes), normal: of(normal), base: of(base), mount: of(mount), tip: of(tip) }
    }

    /// All of them, springs about the axes first.
    pub fn into_array(self) -> [V; 5] {
        let Self { axes, normal, base, mount, tip } = self;
        [axes, normal, base, mount, tip]
    }
}

/// Whether anything but springs about the axes of an arm with a spindle yields.
pub fn yields_elsewhere(robot: &Robot, spindle: &Spindle) -> bool {
    robot.normal_springs().is_some()
        || robot.base_compliance().is_some()
        || spindle.mount.is_some()
        || spindle.tip.is_some()
}

/// An arm with its spindle in one configuration, and a point of the tool.
#[derive(Debug, Clone, Copy)]
pub struct WholeArm<'a, T: Scalar> {
    robot: &'a Robot,
    spindle: &'a Spindle,
    frames: &'a Frames<T>,
    /// Of the springs about the axes at the pose. rad/(N m)
    compliances: [T; 6],
    /// In the base frame. m
    point: Vector3<T>,
    yields_elsewhere: bool,
}

impl<'a, T: Scalar> WholeArm<'a, T> {
    /// With compliances about the axes at the pose in rad/(N m) ([`Robot::compliances_at`]), and a point of the tool in
    /// the base frame (m).
    pub fn new(
        robot: &'a Robot,
        spindle: &'a Spindle,
        frames: &'a Frames<T>,
        compliances: [T; 6],
        point: Vector3<T>,
    ) -> Self {
        Self { robot, spindle, frames, compliances, point, yields_elsewhere: yields_elsewhere(robot, spindle) }
    }

    /// The displacement at the point under a force (N) and a moment (N m) there, in the base frame.
    pub fn displacement(&self, force: &Vector3<T>, moment: &Vector3<T>) -> Displacement<T> {
        let mut moved = displacement(self.frames, &self.point, &self.compliances, force, moment);
        if self.yields_elsewhere {
            for other in &self.by_origin(force, moment).into_array()[1..] {
                moved.linear += other.linear;
                moved.angular += other.angular;
            }
        }
        moved
    }

    /// The same displacement, as the sum of what each origin adds.
    pub fn by_origin(&self, force: &Vector3<T>, moment: &Vector3<T>) -> ByOrigin<Displacement<T>> {
        let none = Displacement { linear: Vector3::zeros(), angular: Vector3::zeros() };
        let base = self.robot.yielding_base();
        let mount = self.spindle.mount.as_ref().map(|matrix| (self.frames.base_from_flange, matrix));
        ByOrigin {
            axes: displacement(self.frames, &self.point, &self.compliances, force, moment),
            normal: self.of_normal_springs(force, moment),
            base: base.map_or(none, |(frame, matrix)| of_matrix(matrix, &frame.cast(), &self.point, [force, moment])),
            mount: mount.map_or(none, |(frame, matrix)| of_matrix(matrix, &frame, &self.point, [force, moment])),
            tip: Displacement { linear: self.of_tip(force), ..none },
        }
    }

    /// What the springs normal to the axis of each joint add to [`ByOrigin::normal`]; nothing where there are none.
    pub fn normal_by_joint(&self, force: &Vector3<T>, moment: &Vector3<T>) -> [Displacement<T>; 6] {
        std::array::from_fn(|j| {
            let mut moved = Displacement { linear: Vector3::zeros(), angular: Vector3::zeros() };
            self.add_normal_springs(j, force, moment, &mut moved);
            moved
        })
    }

    fn of_normal_springs(&self, force: &Vector3<T>, moment: &Vector3<T>) -> Displacement<T> {
        let mut moved = Displacement { linear: Vector3::zeros(), angular: Vector3::zeros() };
        (0..6).for_each(|j| self.add_normal_springs(j, force, moment, &mut moved));
        moved
    }

    fn add_normal_springs(&self, j: usize, force: &Vector3<T>, moment: &Vector3<T>, moved: &mut Displacement<T>) {
        let Some(springs) = self.robot.normal_springs().map(|all| all[j]) else { return };
        for (about, compliance) in springs.compliance.into_iter().enumerate() {
            let (velocity, axis) = self.frames.twist_normal(j, about, springs.bearing, &self.point);
            let yielding = (velocity.dot(force) + axis.dot(moment)).scale(compliance);
            moved.linear += velocity * yielding;
            moved.angular += axis * yielding;
        }
    }

    fn of_tip(&self, force: &Vector3<T>) -> Vector3<T> {
        let Some(tip) = &self.spindle.tip else { return Vector3::zeros() };
        let base_from_tool =
            self.frames.base_from_flange.rotation * self.spindle.flange_from_tool.rotation.map(T::constant);
        base_from_tool * (tip.map(T::constant) * base_from_tool.tr_mul(force))
    }
}

/// The displacement at a point (m) by a matrix in a frame, which holds at its origin, under a force (N) and a moment
/// (N m) at the point.
pub fn of_matrix<T: Scalar>(
    matrix: &Matrix6<f64>,
    frame: &Pose<T>,
    point: &Vector3<T>,
    wrench: [&Vector3<T>; 2],
) -> Displacement<T> {
    let reach = point - frame.translation;
    let turning = wrench[1] + reach.cross(wrench[0]);
    let [force, turning] = [wrench[0], &turning].map(|vector| frame.rotation.tr_mul(vector));
    let row = |row: usize| {
        (0..3).fold(T::zero(), |sum, k| sum + force[k].scale(matrix[(row, k)]) + turning[k].scale(matrix[(row, 3 + k)]))
    };
    let shift = frame.rotation * Vector3::new(row(0), row(1), row(2));
    let turn = frame.rotation * Vector3::new(row(3), row(4), row(5));
    Displacement { linear: shift + turn.cross(&reach), angular: turn }
}

/// The displacement of the tool against a part that yields, beside that of the tool: the part moves against the force
/// on the tool. In the frame in which force (N) and workpiece rotation are given, for a matrix in the workpiece frame.
/// m
pub fn of_part<T: Scalar>(matrix: &Matrix3<f64>, rotation: &Matrix3<T>, force: &Vector3<T>) -> Vector3<T> {
    rotation * (matrix.map(T::constant) * rotation.tr_mul(force))
}

#[cfg(test)]
pub(super) mod tests;
