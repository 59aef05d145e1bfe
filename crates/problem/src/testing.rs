//! The problem of Caro 2013 for the tests of this crate and of those above.
#![allow(clippy::unwrap_used, reason = "for tests alone")]

use crate::criterion::Criterion;
use crate::postures::PostureRules;
use crate::problem::*;
use crate::segment_plan::SegmentPlan;
use crate::setup::Setup;
use nalgebra::{DMatrix, SMatrix, Vector3};
use std::f64::consts::PI;
use stead_cell::tool_scene::SegmentMoves;
use stead_model::robot::Axes23;
use stead_model::robot::angles::wrap;
use stead_model::robot::testing::{kr270, spindle};
use stead_model::robot::turns::Range;
use stead_model::robot::{BaseCompliance, NormalSprings, SpringModel};
use stead_model::robot::{Compensator, Compliance, Joint, Parameter, Robot, Uncertainty};
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};

/// The five-segment task in the paper's cell, with no joint speeds.
pub fn five_segments() -> Problem {
    let interval = |min, max| Interval { min, max };
    let parts = ProblemParts {
        robot: kr270(),
        spindle: spindle(),
        task: stead_model::task::testing::five_segments(),
        cell: Cell {
            position: [interval(-0.3, 0.3), interval(-2.24, -1.64), interval(-0.602, -0.214)],
            yaw: interval(-PI, PI),
        },
        constraints: Constraints { min_inverse_condition: 0.2, characteristic_length: 0.682, ..Constraints::default() },
        criterion: Criterion::default(),
        redundancy: Redundancy {
            beta_count: 120,
            feed: 0.066667,
            max_beta_rate: Some(0.9_f64.to_radians() * 1e3),
            max_spindle_turn: None,
            max_spindle_speed: None,
            beta: BetaPlan::Free,
        },
        postures: PostureRules::NONE,
        scene: None,
        segment_moves: SegmentMoves::default(),
        orientations: [].into(),
        external_axes: Vec::new(),
        lean: None,
        setup: Setup::default(),
    };
    parts.build().unwrap()
}

/// The same problem with so many times the rate of beta.
pub fn with_beta_rate(mut problem: Problem, times: f64) -> Problem {
    problem.redundancy.max_beta_rate = problem.redundancy.max_beta_rate.map(|rate| rate * times);
    problem
}

/// The five segments with forces in every direction.
pub fn slanted() -> Problem {
    let mut problem = five_segments();
    let force = |point: usize| {
        let (sine, cosine) = libm::sincos(point as f64);
        Vector3::new(90.0 * sine, 40.0 * cosine, 60.0 * libm::sin(0.3 * point as f64))
    };
    let wrenches = (0..105).map(|point| Wrench { force: force(point), moment: Vector3::zeros() }).collect();
    problem.task = Task::new(problem.task.path().clone(), wrenches).unwrap();
    problem
}

/// The five segments on a workpiece that hangs, the tool from below: the other sense of the heading.
pub fn hanging() -> Problem {
    let mut problem = five_segments();
    let turned = |v: Vector3<f64>| Vector3::new(v.x, -v.y, -v.z);
    let path = problem.task.path();
    let points = path.points().iter().enumerate().map(|(k, point)| {
        let point = PathPoint { position: turned(point.position), feed: turned(point.feed), axis: turned(point.axis) };
        (path.segment_of(k) as u32 + 1, point)
    });
    let turned_path = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
    let wrenches = problem.task.wrenches().map(|w| Wrench { force: turned(w.force), ..*w }).collect();
    problem.cell.position[2] = Interval { min: 1.0, max: 1.4 };
    problem.task = Task::new(turned_path, wrenches).unwrap();
    problem
}

/// The same problem with other laws of compliance at some joints (from 0).
pub fn with_laws(mut problem: Problem, laws: &[(usize, Compliance)]) -> Problem {
    let mut joints = problem.robot.joints().clone();
    for (joint, law) in laws {
        joints[*joint].compliance = *law;
    }
    problem.robot = Robot::new("laws", joints).unwrap();
    problem
}

/// The same problem with every parameter of the robot's laws known to about `share` of its value, in correlated errors.
pub fn with_uncertainty(mut problem: Problem, share: f64) -> Problem {
    let mut values = Vec::new();
    for (j, joint) in problem.robot.joints().iter().enumerate() {
        match joint.compliance {
            Compliance::Constant(value) => values.push((Parameter::Compliance(j), value)),
            Compliance::Range { at_min, at_max } => {
                values.extend([(Parameter::ComplianceAtMin(j), at_min), (Parameter::ComplianceAtMax(j), at_max)]);
            }
            Compliance::Compensated { alone, compensator } => values.extend([
                (Parameter::Compliance(j), alone),
                (Parameter::SpringStiffness(j), compensator.spring_stiffness),
                (Parameter::FreeLength(j), compensator.free_length),
            ]),
        }
    }
    let (parameters, values): (Vec<_>, Vec<f64>) = values.into_iter().unzip();
    let count = values.len();
    // Rows of unit size that point in different directions.
    let factor = DMatrix::from_fn(count, count, |k, r| libm::sin((7 * k + 3 * r + k * r) as f64));
    let factor = DMatrix::from_fn(count, count, |k, r| share * values[k] * factor[(k, r)] / factor.row(k).norm());
    let uncertainty = Uncertainty::new(parameters, &factor * factor.transpose()).unwrap();
    problem.robot = problem.robot.clone().with_uncertainty(uncertainty).unwrap();
    problem
}

/// The same problem with the sum of joints 2 and 3 in a range (deg), and a linkage that drives axis 3 or none.
pub fn with_axes_2_3(mut problem: Problem, linkage: bool, [min, max]: [f64; 2]) -> Problem {
    let sum = Range { min: min.to_radians(), max: max.to_radians() };
    problem.robot = problem.robot.clone().with_axes_2_3(Some(Axes23 { linkage, sum })).unwrap();
    problem
}

/// A joint beside a compensator of the size of a KR270's, strong enough to be seen; `alpha` in rad, `alone` in
/// rad/(N m).
pub fn compensated(alpha: f64, alone: f64) -> Compliance {
    let compensator = Compensator { spring_stiffness: 3e6, a: 0.7, l: 0.18, alpha, free_length: 0.46 };
    Compliance::Compensated { alone, compensator }
}

/// The five-segment task with a compensator at joint 2.
pub fn five_segments_compensated() -> Problem {
    with_laws(five_segments(), &[(1, compensated(0.2, 1e-6 / 3.32))])
}

/// Every joint may step by 10 deg in 10 mm, as in the prototype.
pub fn with_prototype_steps(mut problem: Problem) -> Problem {
    let speed = 10.0_f64.to_radians() * problem.redundancy.feed / 0.010;
    let joints: [Joint; 6] = problem.robot.joints().clone().map(|j| Joint { max_speed: Some(speed), ..j });
    problem.robot = Robot::new("stepped", joints).unwrap();
    problem
}

/// A path of one segment whose feed turns by the given angles (rad) from point to point, each step as long (m); the
/// tool upright or leaning about.
pub fn winding(steps: &[(f64, f64)], lean: f64) -> Problem {
    let mut problem = with_prototype_steps(five_segments());
    let first = problem.task.points()[0];
    let (mut position, mut heading) = (first.position, 0.3_f64);
    let mut points = Vec::new();
    for (k, (turn, length)) in std::iter::once(&(0.0, 0.0)).chain(steps).enumerate() {
        let chord = heading + turn / 2.0;
        position += Vector3::new(libm::cos(chord), libm::sin(chord), 0.0) * *length;
        heading += turn;
        let axis = Vector3::new(lean * libm::sin(0.2 * k as f64), lean * libm::cos(0.3 * k as f64), 1.0).normalize();
        let feed = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0);
        points.push((1, PathPoint { position, feed: (feed - axis * axis.dot(&feed)).normalize(), axis }));
    }
    let wrenches = vec![problem.task.loads()[0].wrench; points.len()];
    problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
    problem
}

/// Straight on, and around corners both ways.
pub fn corners(lean: f64) -> Problem {
    let turns = [0.0, 0.0, 0.35, 0.35, 0.35, 0.0, 0.0, -0.6, -0.6, 0.0, 1.2, 0.0, -2.2, 0.0, 0.1, 0.1, 0.1];
    winding(&turns.map(|turn| (turn, 0.008)), lean)
}

/// The limits are given in steps of a grid over a step of the path.
pub fn with_turn_limits(mut problem: Problem, beta_count: usize, rate: Option<f64>, turn: f64) -> Problem {
    problem.redundancy.beta_count = beta_count;
    let unit = problem.redundancy.beta_step() / problem.step_length(1);
    problem.redundancy.max_beta_rate = rate.map(|rate| rate * unit);
    problem.redundancy.max_spindle_turn = Some(turn * unit);
    problem
}

/// Holds a change of beta against its limits: the turn of the spindle by the rotation matrices of the tool.
pub fn assert_steps_of_beta(problem: &Problem, point: usize, from: f64, to: f64) {
    if let Some(rate) = problem.redundancy.max_beta_rate {
        let turned = wrap(to - from).abs();
        assert!(turned <= rate * problem.step_length(point) + 1e-8, "beta steps {turned}");
    }
    if let Some(limit) = problem.spindle_turn_limit(point) {
        let still = Placement::from([0.0; 4]);
        let [a, b] =
            [(point - 1, from), (point, to)].map(|(k, beta)| problem.at(&still).base_from_flange(k, beta).rotation);
        let turned = stead_numerics::rotation::rotation_vector(&(a.transpose() * b)).norm();
        assert!(turned <= limit + 1e-7, "the spindle turns {turned} at {point}, limit {limit}");
    }
}

/// Holds a plan against every rule, through the reference evaluator.
pub fn assert_sound(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) {
    assert_eq!(plans.len(), problem.task.segments().len());
    for plan in plans {
        let mut sum = 0.0;
        for (place, point) in plan.points.clone().enumerate() {
            let found = problem.at(placement).state(point, plan.betas[place], plan.posture).unwrap();
            sum = problem.criterion.aggregate.join(sum, problem.point_cost(point, found.score()));
            assert!(found.inverse_condition >= problem.constraints.min_inverse_condition);
            for (j, joint) in problem.robot.joints().iter().enumerate() {
                let real = plan.joints[place][j];
                assert!(real >= joint.min - 1e-8 && real <= joint.max + 1e-8, "joint {}", j + 1);
                assert!(wrap(real - found.joints[j]).abs() < 1e-9);
                if place > 0 {
                    let step = (real - plan.joints[place - 1][j]).abs();
                    let is_alone = j != 2 || !problem.robot.has_linkage();
                    assert!(!is_alone || step <= problem.joint_steps(point)[j] + 1e-8, "joint {} steps {step}", j + 1);
                    assert!(step < std::f64::consts::PI, "joint {} steps {step}", j + 1);
                }
            }
            let sum = |place: usize| plan.joints[place][1] + plan.joints[place][2] * problem.robot.geometry().fold;
            if let Some(range) = problem.robot.sum_range() {
                assert!((range.min - 1e-8..=range.max + 1e-8).contains(&sum(place)), "the sum is {}", sum(place));
            }
            if place > 0 && problem.robot.has_linkage() {
                let step = (sum(place) - sum(place - 1)).abs();
                assert!(step <= problem.joint_steps(point)[2] + 1e-8, "the sum steps {step}");
            }
            if place > 0 {
                assert_steps_of_beta(problem, point, plan.betas[place - 1], plan.betas[place]);
            }
        }
        assert!((sum - plan.cost).abs() < 1e-12 * sum, "{sum} {}", plan.cost);
    }
}

/// A symmetric positive definite matrix of some numbers, of about this size.
fn some_matrix<const N: usize>(seed: u32, size: f64) -> SMatrix<f64, N, N> {
    let entry = |row: usize, column: usize| libm::sin(1.7 * (f64::from(seed) + (N * row + column) as f64));
    let root = SMatrix::<f64, N, N>::from_fn(|row, column| entry(row, column) + if row == column { 1.5 } else { 0.0 });
    root * root.transpose() * size
}

/// What yields beside the joints about their axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beside {
    /// Springs normal to the axes, alike about x and y, those of the wrist in its centre.
    Alike,
    /// Springs normal to the axes that differ about x and y, and sit anywhere on them.
    Pairs,
    /// The base, the mount of the spindle, holder and tool, and the part.
    Matrices,
    /// All of it.
    Everything,
}

impl Beside {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Alike, Self::Pairs, Self::Matrices, Self::Everything];
}

/// The arm with springs normal to its axes.
pub fn with_normal_springs(robot: Robot, are_pairs: bool) -> Robot {
    let springs = std::array::from_fn(|j| {
        let k = j as f64;
        match are_pairs {
            true => NormalSprings { compliance: [3e-7 + 1e-7 * k, 9e-7 - 1e-7 * k], bearing: 0.05 * k - 0.13 },
            false => NormalSprings { compliance: [4e-7 + 1e-7 * k; 2], bearing: if j < 3 { -0.3 } else { 0.0 } },
        }
    });
    robot.with_normal_springs(Some(springs)).unwrap().with_spring_model(Some(SpringModel::Full))
}

/// The same problem with more than the joints about their axes that yields.
pub fn with_beside(mut problem: Problem, beside: Beside) -> Problem {
    if beside != Beside::Matrices {
        problem.robot = with_normal_springs(problem.robot.clone(), beside != Beside::Alike);
    }
    if matches!(beside, Beside::Matrices | Beside::Everything) {
        let base = BaseCompliance::new(Vector3::new(0.1, -0.05, -0.2), some_matrix(3, 1e-8)).unwrap();
        problem.robot = problem.robot.clone().with_base_compliance(Some(base));
        problem.spindle =
            problem.spindle.with_mount(some_matrix(17, 2e-8)).unwrap().with_tip(some_matrix(29, 1e-7)).unwrap();
        let part = (0..problem.task.points().len() as u32).map(|point| some_matrix(point, 1e-7)).collect();
        problem.task = problem.task.clone().with_part_compliances(part).unwrap();
    }
    problem
}
