//! The sum over everything that yields, against figures from elsewhere, closed forms, and the arm as a finite chain.

mod chain;
pub(in crate::stiffness) mod oracle;

use super::*;
use crate::robot::testing::{odd_arms, spindle};
use crate::robot::{BaseCompliance, NormalSprings, SpringModel};
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector6, vector};
use proptest::prelude::*;
use stead_numerics::rotation::rotation_from_zyx;
use stead_numerics::scalar::Dual;

/// A matrix that is symmetric and positive definite, of some numbers.
pub(in crate::stiffness) fn matrix(seed: u32, scale: f64) -> Matrix6<f64> {
    let root = Matrix6::from_fn(|row, column| {
        let k = f64::from(seed) + (6 * row + column) as f64;
        libm::sin(1.7 * k) + if row == column { 1.5 } else { 0.0 }
    });
    root * root.transpose() * scale
}

/// Springs normal to every axis, unlike each other, with bearings.
pub(in crate::stiffness) fn normal_springs() -> [NormalSprings; 6] {
    std::array::from_fn(|j| {
        let j = j as f64;
        NormalSprings { compliance: [3e-7 + 1e-7 * j, 8e-7 - 1e-7 * j], bearing: 0.05 * j - 0.12 }
    })
}

/// An arm with everything that can yield.
pub(in crate::stiffness) fn everything(arm: Robot) -> (Robot, Spindle) {
    let robot = arm.with_normal_springs(Some(normal_springs())).unwrap().with_spring_model(Some(SpringModel::Full));
    let base = BaseCompliance::new(vector![0.1, -0.05, -0.2], matrix(3, 1e-8)).unwrap();
    let spindle = spindle().with_mount(matrix(17, 2e-8)).unwrap();
    let tip = matrix(29, 1e-7).fixed_view::<3, 3>(0, 0).into_owned();
    (robot.with_base_compliance(Some(base)), spindle.with_tip(tip).unwrap())
}

/// The matrix that answers force and moment at the tool centre point by displacement and turn there.
fn compliance(robot: &Robot, spindle: &Spindle, theta: &[f64; 6]) -> Matrix6<f64> {
    let frames = Frames::new(robot, theta);
    let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
    let arm = WholeArm::new(robot, spindle, &frames, robot.compliances_at(theta), tip);
    let columns: [Vector6<f64>; 6] = std::array::from_fn(|k| {
        let unit = Vector6::ith(k, 1.0);
        let (force, moment) = (unit.fixed_rows::<3>(0).into_owned(), unit.fixed_rows::<3>(3).into_owned());
        let moved = arm.displacement(&force, &moment);
        Vector6::from_iterator(moved.linear.iter().chain(moved.angular.iter()).copied())
    });
    Matrix6::from_columns(&columns)
}

proptest! {
    #[test]
    fn the_compliance_is_symmetric_and_no_load_is_answered_against_it(
        theta in prop::array::uniform6(-3.0..3.0_f64), arm in 0..32_usize
    ) {
        let (robot, spindle) = everything(odd_arms()[arm].clone());
        let found = compliance(&robot, &spindle, &theta);
        prop_assert!((found - found.transpose()).norm() < 1e-13 * found.norm());
        let least = SymmetricEigen::new((found + found.transpose()) * 0.5).eigenvalues.min();
        prop_assert!(least > 0.0, "{}", least);
    }

    #[test]
    fn what_each_origin_adds_is_the_sum(theta in prop::array::uniform6(-3.0..3.0_f64), arm in 0..32_usize) {
        let (robot, spindle) = everything(odd_arms()[arm].clone());
        let frames = Frames::new(&robot, &theta);
        let tip = frames.base_from_flange.point(&spindle.flange_from_tool.translation);
        let arm = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&theta), tip);
        let (force, moment) = (vector![120.0, -80.0, 60.0], vector![4.0, -7.0, 12.0]);
        let parts = arm.by_origin(&force, &moment).map(|moved| moved.linear).into_array();
        prop_assert!(parts.iter().all(|part| part.norm() > 1e-9), "{:?}", parts);
        let sum: Vector3<f64> = parts.iter().sum();
        prop_assert!((sum - arm.displacement(&force, &moment).linear).norm() < 1e-15);
    }

    /// With the springs of the wrist in its centre, y4 and z5 turn about one line, y5 and z6 too, and x4, y4, z4
    /// against x5, y5, z5 about one point.
    #[test]
    fn springs_of_the_wrist_that_turn_about_one_line_can_be_exchanged(
        theta in prop::array::uniform6(-3.0..3.0_f64), arm in 0..32_usize,
        y4_to_z5 in -4e-7..4e-7_f64, y5_to_z6 in -3e-7..3e-7_f64, four_to_five in -2e-7..2e-7_f64
    ) {
        let (robot, spindle) = everything(odd_arms()[arm].clone());
        let mut normal = normal_springs();
        (normal[3].bearing, normal[4].bearing) = (0.0, 0.0);
        let mut axial = [2e-6; 6];
        let with = |normal, axial| {
            let robot = robot.with_compliances(axial).unwrap().with_normal_springs(Some(normal)).unwrap();
            compliance(&robot, &spindle, &theta)
        };
        let before = with(normal, axial);
        let [x4, y4] = &mut normal[3].compliance;
        (*x4, *y4, axial[3]) = (*x4 + four_to_five, *y4 + four_to_five - y4_to_z5, axial[3] + four_to_five);
        let [x5, y5] = &mut normal[4].compliance;
        (*x5, *y5) = (*x5 - four_to_five, *y5 - four_to_five - y5_to_z6);
        axial[4] += y4_to_z5 - four_to_five;
        axial[5] += y5_to_z6;
        prop_assume!(normal.iter().flat_map(|springs| springs.compliance).all(|compliance| compliance >= 0.0));
        let after = with(normal, axial);
        prop_assert!((after - before).norm() < 1e-12 * before.norm());
    }

    #[test]
    fn derivatives_are_those_of_differences(theta in prop::array::uniform6(-3.0..3.0_f64), arm in 0..32_usize) {
        let (robot, spindle) = everything(odd_arms()[arm].clone());
        let tool = spindle.flange_from_tool.translation;
        let (force, moment) = (vector![120.0, -80.0, 60.0], vector![4.0, -7.0, 12.0]);
        let at = |theta: &[f64; 6]| {
            let frames = Frames::new(&robot, theta);
            let tip = frames.base_from_flange.point(&tool);
            WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(theta), tip).displacement(&force, &moment)
        };
        let dual: [Dual<6>; 6] = std::array::from_fn(|j| Dual::variable(theta[j], j));
        let frames = Frames::new(&robot, &dual);
        let tip = frames.base_from_flange.point(&crate::robot::cast(&tool));
        let exact = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&dual), tip)
            .displacement(&crate::robot::cast(&force), &crate::robot::cast(&moment));
        let size = at(&theta).linear.norm();
        let h = 1e-6;
        for j in 0..6 {
            let (mut up, mut down) = (theta, theta);
            up[j] += h;
            down[j] -= h;
            let slope = (at(&up).linear - at(&down).linear) / (2.0 * h);
            let found = exact.linear.map(|entry| entry.gradient[j]);
            prop_assert!((found - slope).norm() < 1e-7 * size, "joint {} {} {}", j + 1, found, slope);
        }
    }
}

#[test]
fn springs_that_hardly_yield_leave_the_arm_as_it_was() {
    for arm in odd_arms() {
        let stiff = [NormalSprings { compliance: [1e-30; 2], bearing: 0.2 }; 6];
        let with = arm.clone().with_normal_springs(Some(stiff)).unwrap().with_spring_model(Some(SpringModel::Full));
        let theta = [0.3, -0.4, 0.7, 1.1, -0.9, 2.0];
        let [a, b] = [&arm, &with].map(|robot| compliance(robot, &spindle(), &theta));
        assert!((a - b).norm() < 1e-12 * a.norm());
    }
}

/// A robot as good as rigid on a steel tube 1.2 m high: the beam's own closed form, `integral of (s + h)^2 / EI`.
#[test]
fn a_pedestal_bends_as_a_cantilever() {
    let (length, modulus, shear) = (1.2, 210e9, 81e9);
    let (outer, inner): (f64, f64) = (0.5, 0.48);
    let second = std::f64::consts::PI / 64.0 * (outer.powi(4) - inner.powi(4));
    let area = std::f64::consts::PI / 4.0 * (outer * outer - inner * inner);
    let bending = modulus * second;
    let mut tube = Matrix6::zeros();
    for axis in 0..2 {
        tube[(axis, axis)] = length * length * length / (3.0 * bending);
        tube[(3 + axis, 3 + axis)] = length / bending;
    }
    (tube[(2, 2)], tube[(5, 5)]) = (length / (modulus * area), length / (shear * 2.0 * second));
    // A force along x turns the top about +y, along y about -x.
    let coupling = length * length / (2.0 * bending);
    (tube[(0, 4)], tube[(4, 0)], tube[(1, 3)], tube[(3, 1)]) = (coupling, coupling, -coupling, -coupling);
    let mount = Pose { rotation: rotation_from_zyx([0.7, 0.0, 0.0]), translation: vector![0.4, 0.2, length] };
    let rigid = crate::robot::testing::kr270().with_compliances([1e-30; 6]).unwrap();
    let robot = rigid.with_base_compliance(Some(BaseCompliance::new(Vector3::zeros(), tube).unwrap())).mounted(&mount);
    let theta = [0.2, 1.2, -2.0, 0.3, 1.0, 0.0];
    let frames = Frames::new(&robot, &theta);
    let spindle = spindle();
    let at = |point: Vector3<f64>, force: Vector3<f64>| {
        let arm = WholeArm::new(&robot, &spindle, &frames, robot.compliances_at(&theta), point);
        arm.displacement(&force, &Vector3::zeros()).linear
    };
    let (force, height) = (1000.0, 0.8);
    let above = at(mount.translation + vector![0.0, 0.0, height], vector![force, 0.0, 0.0]);
    let beam = ((length + height).powi(3) - height.powi(3)) / (3.0 * bending) * force;
    assert!((above - vector![beam, 0.0, 0.0]).norm() < 1e-12 * beam, "{above} {beam}");
    // Out at the side: the tube twists as well.
    let side = at(mount.translation + vector![1.5, 0.0, 0.0], vector![0.0, force, 0.0]);
    let twisted = (length.powi(3) / (3.0 * bending) + 1.5 * 1.5 * length / (shear * 2.0 * second)) * force;
    assert!((side.y - twisted).abs() < 1e-12 * twisted, "{side} {twisted}");
}

#[test]
fn a_part_yields_in_its_own_directions() {
    let matrix = Matrix3::from_diagonal(&vector![1e-7, 0.0, 0.0]);
    let quarter = rotation_from_zyx([std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
    let moved = of_part(&matrix, &quarter, &vector![100.0, 50.0, 30.0]);
    assert!((moved - vector![0.0, 5e-6, 0.0]).norm() < 1e-20, "{moved}");
}
