//! A task on a workpiece that is turned before it is placed.

use super::{Task, ToolPath};
use nalgebra::Matrix3;
use std::sync::Arc;

impl Task {
    /// The same task on the workpiece turned by a rotation about its origin: positions, directions and wrenches in the
    /// directions of the frame in which the rotation is given.
    pub fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        Self {
            path: Arc::new(self.path.turned(rotation)),
            loads: self.loads.iter().map(|load| load.turned(rotation)).collect(),
            lean_forces: self.lean_forces.as_ref().map(|forces| Arc::new(forces.turned(rotation))),
            upright: self.upright.as_ref().map(|task| Arc::new(task.turned(rotation))),
        }
    }
}

impl ToolPath {
    pub(super) fn turned(&self, rotation: &Matrix3<f64>) -> Self {
        let mut path = self.clone();
        for point in &mut path.points {
            point.position = rotation * point.position;
            point.feed = (rotation * point.feed).normalize();
            point.axis = (rotation * point.axis).normalize();
        }
        path.leaned.iter_mut().for_each(|leaned| *leaned = leaned.turned(rotation));
        path.surface_normals.iter_mut().flatten().for_each(|normal| *normal = (rotation * *normal).normalize());
        path
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::five_segments;
    use nalgebra::Vector3;
    use stead_numerics::rotation::rotation_from_zyx;

    #[test]
    fn a_turned_task_is_the_task_in_other_directions() {
        let task = five_segments();
        let rotation = rotation_from_zyx([0.3, -0.7, 1.2]);
        let turned = task.turned(&rotation);
        assert_eq!(turned.segments(), task.segments());
        for (a, b) in task.points().iter().zip(turned.points()) {
            assert!((rotation * a.workpiece_from_point() - b.workpiece_from_point()).norm() < 1e-12);
            assert!((rotation * a.position - b.position).norm() < 1e-12);
        }
        let force: f64 =
            task.wrenches().zip(turned.wrenches()).map(|(a, b)| (rotation * a.force - b.force).norm()).sum();
        assert!(force < 1e-9 && turned.loads()[0].wrench.force != task.loads()[0].wrench.force);
        assert!((turned.points()[0].axis - rotation * Vector3::z()).norm() < 1e-12);
    }
}
