//! Where the robot stands in its cell: on the floor, on a pedestal, on a wall, under the ceiling.
//!
//! A mounted arm is an arm whose first row begins at another pose. All that is stated in the base frame (kinematics,
//! placements, forces, gravity along -z) is then in the cell frame, whose z axis points up; without a mount the two are
//! one.

use super::Robot;
use super::pose::Pose;
use nalgebra::Vector3;
use stead_numerics::scalar::Scalar;

impl Robot {
    /// The same arm with the frame in which it is given at a pose in the cell frame, in which it is given then. An arm
    /// that is mounted already is moved as a whole.
    pub fn mounted(mut self, cell_from_base: &Pose<f64>) -> Self {
        if *cell_from_base == Pose::identity() {
            return self;
        }
        self.geometry.base_from_root = cell_from_base.rotation * self.geometry.base_from_root;
        self.geometry.root_in_base = cell_from_base.point(&self.geometry.root_in_base);
        self.mount = Some(cell_from_base.then(&self.cell_from_base()));
        self
    }

    /// Pose of the base frame of the rows in the cell frame; the two are one where the arm is not mounted.
    pub fn cell_from_base<T: Scalar>(&self) -> Pose<T> {
        self.mount.map_or_else(Pose::identity, |mount| mount.cast())
    }

    /// Whether the base frame of the rows is not the cell frame.
    pub fn is_mounted(&self) -> bool {
        self.mount.is_some()
    }

    /// The same arm with its mounting flange so far (m) beyond the last frame along axis 6. What the tool frame of a
    /// spindle is stated in stays the last frame.
    pub fn with_flange(self, flange: f64) -> Self {
        Self { flange, ..self }
    }

    /// A frame that is given in the last frame, in that of the mounting flange, as a fitter measures it and a
    /// controller states a tool.
    pub fn on_flange(&self, of_last: &Pose<f64>) -> Pose<f64> {
        Pose { translation: of_last.translation - Vector3::z() * self.flange, ..*of_last }
    }

    /// Pose of the cell frame in the root of the controller (`$ROBROOT`, base), where that is known: what programs are
    /// stated in.
    pub fn controller_root_from_cell(&self) -> Option<Pose<f64>> {
        let root_from_base = self.controller()?.root_from_base?;
        Some(self.mount.map_or(root_from_base, |mount| root_from_base.then(&mount.inverse())))
    }

    /// The frame of every row at joint angle zero, in that before it; of the first row in the cell frame.
    pub fn mounted_rows(&self) -> [Pose<f64>; 6] {
        let mut rows = *self.rows();
        if let Some(mount) = self.mount {
            rows[0] = mount.then(&rows[0]);
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{kr270, odd_arms};
    use super::super::{Frames, Posture};
    use super::*;
    use nalgebra::vector;
    use stead_numerics::rotation::rotation_from_zyx;

    fn somewhere() -> Pose<f64> {
        Pose { rotation: rotation_from_zyx([0.4, -1.1, 2.0]), translation: vector![0.3, -0.7, 1.9] }
    }

    #[test]
    fn a_mounted_arm_is_the_arm_moved_as_a_whole() {
        let mount = somewhere();
        for arm in odd_arms().into_iter().chain([kr270()]) {
            let mounted = arm.clone().mounted(&mount);
            let theta = [0.3, 0.4, -1.2, 0.5, 0.7, 0.9];
            let expected = mount.then(&arm.forward(&theta));
            let found = mounted.forward(&theta);
            assert!((found.rotation - expected.rotation).norm() < 1e-12);
            assert!((found.translation - expected.translation).norm() < 1e-12);
            let posture = Posture::of(&mounted, &theta);
            assert_eq!(posture, Posture::of(&arm, &theta));
            let back = mounted.inverse(&found, posture).unwrap();
            let on_the_floor = arm.inverse(&arm.forward(&theta), posture).unwrap();
            assert!(back.iter().zip(on_the_floor).all(|(a, b)| (a - b).abs() < 1e-9), "{back:?}");
            // Axis 1 and its place.
            let frames = Frames::new(&mounted, &theta);
            let g = mounted.geometry();
            assert!((g.base_from_root.column(2) - frames.axes[0]).norm() < 1e-12);
            assert!((g.root_in_base - frames.origins[0]).cross(&frames.axes[0]).norm() < 1e-12);
        }
    }

    #[test]
    fn a_mount_at_the_origin_is_none_and_mounts_add_up() {
        assert_eq!(kr270().mounted(&Pose::identity()), kr270());
        let [a, b] = [somewhere(), Pose { translation: vector![1.0, 2.0, 3.0], ..somewhere() }];
        let (twice, once) = (kr270().mounted(&a).mounted(&b), kr270().mounted(&b.then(&a)));
        assert!((twice.geometry().base_from_root - once.geometry().base_from_root).norm() < 1e-14);
        assert!((twice.geometry().root_in_base - once.geometry().root_in_base).norm() < 1e-14);
        assert_eq!(twice.cell_from_base::<f64>(), once.cell_from_base());
        // Other compliances and limits leave it where it is.
        let margin = once.with_joint_margin(0.01).unwrap();
        let softer = once.with_compliances([1e-6; 6]).unwrap();
        assert!([margin, softer].iter().all(|arm| arm.geometry() == once.geometry() && arm.is_mounted()));
    }

    #[test]
    fn gravity_stays_down_in_the_cell() {
        use super::super::Inertial;
        use nalgebra::Matrix3;
        let body = Inertial::new(10.0, vector![0.1, 0.0, 0.2], Matrix3::identity()).unwrap();
        let theta = [0.3, 0.4, -1.2, 0.5, 0.7, 0.9];
        let tip = Pose::identity();
        let mount = somewhere();
        let mounted = kr270().mounted(&mount).chain(&[body; 6], tip);
        let turned = kr270().chain(&[body; 6], tip).with_gravity(mount.rotation.transpose() * vector![0.0, 0.0, -9.81]);
        let [a, b] = [&mounted, &turned].map(|chain| chain.at(&theta.into()).gravity(chain));
        assert!((a - b).norm() < 1e-9 * a.norm(), "{a} {b}");
        let floor = kr270().chain(&[body; 6], tip);
        assert!((a - floor.at(&theta.into()).gravity(&floor)).norm() > 1.0);
    }
}
