//! Corrections of an arm that yields beside the joints about their axes, and of its weight.

use super::*;
use nalgebra::{Matrix3, Matrix6};
use stead_model::robot::{BaseCompliance, NormalSprings, PointMass, SpringModel};
use stead_model::stiffness::elastic::ElasticArm;
use stead_model::task::Wrench;

/// Yields alike in all directions, with turns that couple with shifts.
fn matrix(scale: f64) -> Matrix6<f64> {
    let root = Matrix6::from_fn(|row, column| if row == column { 1.0 } else { 0.2 / (1.0 + (row + column) as f64) });
    root * root.transpose() * scale
}

fn full(arm: Robot) -> Robot {
    let springs =
        std::array::from_fn(|j| NormalSprings { compliance: [3e-7, 1e-7 * j as f64], bearing: 0.1 - 0.05 * j as f64 });
    arm.with_normal_springs(Some(springs)).unwrap().with_spring_model(Some(SpringModel::Full))
}

/// The job of the full arm on a base that yields, with a mount, a tip and a part that yield, and a weight.
fn everything(theta: &[f64; 6]) -> CompensationProblem {
    let base = BaseCompliance::new(vector![0.1, 0.0, -0.3], matrix(2e-8)).unwrap();
    let robot = full(kr270()).with_base_compliance(Some(base));
    let mass = PointMass { mass: 61.0, centre: vector![0.02, -0.05, 0.25] };
    let spindle = Spindle { point_mass: Some(mass), ..spindle() };
    let spindle = spindle.with_mount(matrix(1e-8)).unwrap().with_tip(Matrix3::from_diagonal_element(5e-8)).unwrap();
    let point = PathPoint { of_part: vector![2e-5, -3e-5, 1e-5], ..path_point(&robot, theta, CUT) };
    CompensationProblem { spindle, ..job(&robot, &robot, vec![point]) }
}

#[test]
fn the_tool_comes_to_rest_at_the_target_on_the_part_with_all_that_yields() {
    for gravity in [false, true] {
        let mut job = everything(&MIDDLE);
        job.settings.gravity = gravity;
        let done = compensate(&job).complete().unwrap();
        let (point, target) = (&done.points[0], &job.points[0]);
        let arm = ElasticArm::new(&job.robot, &job.spindle);
        let arm = if gravity { arm.in_gravity(target.free_fall) } else { arm };
        let rest = arm.at_rest(&point.joints, &Wrench { force: target.force, moment: target.moment }).unwrap();
        assert!((rest.translation + target.of_part - target.base_from_tool.translation).norm() <= 1e-9);
        let turn = rotation_vector(&(rest.rotation * target.base_from_tool.rotation.transpose()));
        assert!(turn.norm() <= 1e-9 && point.iterations >= 1 && point.iterations <= 4, "{turn} {}", point.iterations);
        // The correction is the deflection the other way, the part's share among it.
        let before = point.before.unwrap().linear;
        assert!((before + point.correction.linear).norm() < 0.01 * before.norm());
        let alone = arm.at_rest(&MIDDLE, &Wrench { force: target.force, moment: target.moment }).unwrap();
        assert!((alone.translation + target.of_part - target.base_from_tool.translation - before).norm() < 1e-9);
    }
}

#[test]
fn weight_bends_the_arm_only_where_it_counts() {
    let mut job = everything(&MIDDLE);
    let of = |job: &CompensationProblem| compensate(job).points[0].before.unwrap().linear;
    let without = of(&job);
    job.settings.gravity = true;
    let with = of(&job);
    let sag = ElasticArm::new(&job.robot, &job.spindle).in_gravity(vector![0.0, 0.0, -9.81]).sag(&MIDDLE).linear;
    assert!(sag.norm() > 2e-4 && (with - without - sag).norm() < 5e-3 * sag.norm(), "{sag} {}", with - without);
    // Under the ceiling of a cell that hangs upside down it is pulled the other way.
    job.points[0].free_fall *= -1.0;
    assert!((of(&job) - without + sag).norm() < 5e-3 * sag.norm());
    // Where nothing has a mass, gravity changes nothing.
    job.spindle.point_mass = None;
    assert!((of(&job) - without).norm() < 1e-12);
}

#[test]
fn a_linear_correction_counts_all_of_it_to_first_order() {
    let mut job = everything(&MIDDLE);
    (job.settings.gravity, job.settings.model) = (true, DeflectionModel::Linear);
    let point = compensate(&job).complete().unwrap().points[0];
    let [before, after] = [point.before, point.after].map(|deflection| deflection.unwrap().linear.norm());
    assert!(after > 1e-8 && after < 0.01 * before, "{after} {before}");
}

#[test]
fn an_arm_without_springs_beside_its_axes_is_corrected_to_the_same_bits() {
    let arm = kr270();
    let point = path_point(&arm, &MIDDLE, CUT);
    let stated = arm.clone().with_normal_springs(full(arm.clone()).stated_normal_springs().copied()).unwrap();
    let [a, b] = [&arm, &stated].map(|robot| compensate(&job(robot, robot, vec![point])));
    assert_eq!(a.points, b.points);
}

/// What a fit of springs about the axes does not know of a full arm is left.
#[test]
fn a_full_arm_shows_what_a_correction_about_the_axes_leaves() {
    let arm = kr270();
    let points = vec![path_point(&arm, &MIDDLE, CUT)];
    let done = compensate(&job(&arm, &full(arm.clone()), points.clone())).complete().unwrap();
    let same = compensate(&job(&arm, &arm, points.clone())).complete().unwrap();
    let all = compensate(&job(&full(arm.clone()), &full(arm.clone()), points)).complete().unwrap();
    let [before, after] = [done.points[0].before, done.points[0].after].map(|deflection| deflection.unwrap().linear);
    let [axes, whole] = [&same, &all].map(|path| path.points[0].before.unwrap().linear);
    assert!((before - whole).norm() < 1e-9 && (before - axes - after).norm() < 5e-3 * after.norm());
    assert!(after.norm() > 0.05 * before.norm());
}
