//! Every layer of the certificate against the reference evaluator, and with parts of it broken on purpose.
//!
//! Random placements against the bounds of boxes around them see nothing: slack hides what is missing. So each layer is
//! held against the truth by itself, over regions as small as that layer's slack asks for, at their corners and ends,
//! and each must see the mutations named in its test.

mod arms;
mod attack;
mod boxes;
mod cell;
mod cells;
mod certificate;
mod counts;
mod criteria;
mod minorants;
mod planner;

use super::arm::Arm;
use super::cell::whole;
use super::compliance_table::ComplianceTable;
use super::model::Model;
use super::region::{Point, Region};
use nalgebra::{Matrix6, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};
use stead_model::robot::testing::robot_from;
use stead_model::robot::{BaseCompliance, Compliance, Frames, PostureClass, Robot};
use stead_model::stiffness::whole::WholeArm;
use stead_model::task::{PathPoint, Task, ToolPath, Wrench};
use stead_planning::feasibility::explain;
use stead_problem::criterion::{Aggregate, Criterion, Weights};
use stead_problem::problem::{Interval, Placement, Problem};
use stead_problem::testing::{
    Beside, compensated, five_segments, hanging, slanted, with_axes_2_3, with_beside, with_laws,
};

/// What is broken on purpose, and how.
type Breaking<T> = (&'static str, fn(&mut T));

/// A problem, what its bounds are made of, and the reference evaluator in the terms of the certificate.
pub struct Setting {
    pub problem: Problem,
    pub model: Model,
    pub whole: Region,
    /// Whether the heading turns with beta or against it.
    rotation_sign: f64,
}

/// How the arm yields at an allowed state: by the ordinary inverse kinematics, limits, conditioning and displacement.
pub struct Truth {
    /// m, d1, d2, vertical to radial, to tangential and to itself, without joint 1. m/N
    pub values: [f64; 6],
    /// What the point adds to the figure that is minimised. m, for the root of the mean of squares m^2
    pub cost: f64,
    /// The score as bounds have it: of the load of the point, which has its weight in it. m
    pub score: f64,
    /// 1/kappa_F.
    pub inverse_condition: f64,
}

impl Setting {
    pub fn new(problem: Problem) -> Self {
        let (model, whole) = (Model::new(&problem), whole(&problem));
        let turned = |beta: f64| problem.at(&Placement::from([0.0; 4])).base_from_flange(0, beta).rotation;
        let turn = turned(0.1) * turned(0.0).transpose();
        let side = problem.robot.geometry().base_from_root[(2, 2)].signum();
        let rotation_sign = (libm::atan2(turn[(1, 0)], turn[(0, 0)]) * side).signum();
        Self { problem, model, whole, rotation_sign }
    }

    /// Takes the tables of another setting, which are what takes long to make, where they are of the same arm.
    pub fn take_table(&mut self, other: Option<Self>) {
        let Some(other) = other else { return };
        let of = |arm: &Arm, table: &ComplianceTable| format!("{arm:?} {:?}", table.grid());
        let all = |model: &Model| {
            let others = model.others.iter().map(|set| of(&set.arm, &set.table));
            std::iter::once(of(&model.arm, &model.table)).chain(others).collect::<Vec<_>>()
        };
        if all(&self.model) == all(&other.model) {
            (self.model.table, self.model.others) = (other.model.table, other.model.others);
        }
    }

    /// An upright tool, one from below, forces with a vertical part, an arm upside down, and one with every offset.
    pub fn all() -> Vec<(&'static str, Self)> {
        [
            ("five segments", five_segments()),
            ("slanted forces", slanted()),
            ("hanging workpiece", hanging()),
            ("hanging arm", hanging_arm()),
            ("odd arm", odd_arm()),
            ("compliances that change", changing()),
            ("compensator", with_laws(slanted(), &[(1, compensated(0.2, 1e-6 / 3.32))])),
            ("linkage", with_axes_2_3(slanted(), true, [-150.0, -20.0])),
            // Of some sums beyond the range another turn is within it.
            ("sum of the odd arm", with_axes_2_3(odd_arm(), false, [-110.0, 230.0])),
        ]
        .map(|(name, problem)| (name, Self::new(problem)))
        .into()
    }

    /// Criteria of every kind, with forces in every direction.
    pub fn criteria() -> Vec<(&'static str, Self)> {
        let weighed = Weights { feed: 0.3, wall: 1.0, axis: 0.5, surface: 0.7 };
        let plain = Weights { feed: 0.4, axis: 0.9, ..Weights::NONE };
        type Of = (&'static str, fn() -> Problem, Weights, Aggregate, f64);
        let all: [Of; 16] = [
            ("wall, force errors", slanted, Weights::WALL, Aggregate::Mean, 0.1),
            ("total", hanging_arm, Weights::TOTAL, Aggregate::Mean, 0.0),
            ("total, force errors", odd_arm, Weights::TOTAL, Aggregate::Mean, 0.1),
            ("axis", odd_arm, Weights::AXIS, Aggregate::Mean, 0.0),
            ("surface", with_normals, Weights::SURFACE, Aggregate::Mean, 0.0),
            ("surface, force errors", with_normals, Weights::SURFACE, Aggregate::Rms, 0.2),
            ("weights", with_normals, weighed, Aggregate::Mean, 0.0),
            ("weights, force errors", slanted, plain, Aggregate::Mean, 0.15),
            ("root of the mean of squares", hanging, Weights::TOTAL, Aggregate::Rms, 0.1),
            ("total, moments", with_moments, Weights::TOTAL, Aggregate::Mean, 0.0),
            ("total, moments, force errors", with_moments, Weights::TOTAL, Aggregate::Mean, 0.1),
            ("wall, moments, force errors", with_moments, Weights::WALL, Aggregate::Mean, 0.1),
            ("weights, moments", with_moments, plain, Aggregate::Rms, 0.0),
            ("largest", slanted, Weights::TOTAL, Aggregate::Max, 0.1),
            ("total, whole arm", || whole_arm(odd_arm(), Beside::Everything), Weights::TOTAL, Aggregate::Mean, 0.0),
            ("total, whole hanging arm", whole_hanging, Weights::TOTAL, Aggregate::Mean, 0.1),
        ];
        let setting = |(name, of, weights, aggregate, force_uncertainty): Of| {
            let mut problem = of();
            let segment_weights = vec![1.0, 0.5, 2.0, 1.0, 0.7];
            problem.criterion =
                Criterion { weights, aggregate, force_uncertainty, segment_weights, ..Criterion::default() };
            (name, Self::new(problem))
        };
        let linear = [
            ("wall, moments", with_moments()),
            ("moments on a linkage", with_axes_2_3(with_moments(), true, [-150.0, 0.0])),
            (
                "whole arm with a linkage",
                whole_arm(with_axes_2_3(odd_arm(), true, [-200.0, 150.0]), Beside::Everything),
            ),
            ("normal springs", whole_arm(slanted(), Beside::Alike)),
            ("normal springs in pairs, hanging arm", whole_arm(hanging_arm(), Beside::Pairs)),
            ("whole arm", whole_arm(odd_arm(), Beside::Everything)),
        ];
        let linear = linear.map(|(name, problem)| (name, Self::new(problem)));
        all.map(setting).into_iter().chain(linear).collect()
    }

    fn side(&self) -> f64 {
        self.problem.robot.geometry().base_from_root[(2, 2)].signum()
    }

    /// Pose (x, y, z, yaw) that has the workpiece origin at an azimuth, and its radius, height and turn from the
    /// certificate.
    pub fn pose(&self, placement: [f64; 3], azimuth: f64) -> Placement {
        let (side, root) = (self.side(), self.problem.robot.geometry().root_in_base);
        let (sine, cosine) = libm::sincos(azimuth);
        let [radius, height, turn] = placement;
        let position = [radius * cosine + root.x, side * radius * sine + root.y, side * height + root.z];
        Placement { x: position[0], y: position[1], z: position[2], yaw: side * (turn + azimuth) }
    }

    /// Radius, height and direction of the feed of a point at a placement, by the task's own transforms.
    pub fn place(&self, placement: [f64; 3], point: usize) -> [f64; 3] {
        let (side, root) = (self.side(), self.problem.robot.geometry().root_in_base);
        let workpiece = self.pose(placement, 0.0).base_from_workpiece();
        let p = &self.problem.task.points()[point];
        let (at, feed) = (workpiece.point(&p.position) - root, workpiece.rotation * p.feed);
        let direction = libm::atan2(side * feed.y, feed.x);
        [libm::hypot(at.x, at.y), side * at.z, direction - libm::atan2(side * at.y, at.x)]
    }

    /// A pose that has a point at a radius and height, with its feed in a direction against its azimuth.
    fn pose_at(&self, point: usize, [r, z, chi]: [f64; 3], azimuth: f64) -> Placement {
        let (side, root) = (self.side(), self.problem.robot.geometry().root_in_base);
        let p = &self.problem.task.points()[point];
        let yaw = side * (chi + azimuth) - libm::atan2(p.feed.y, p.feed.x);
        let turned = Placement { x: 0.0, y: 0.0, z: 0.0, yaw }.base_from_workpiece().point(&p.position);
        let (sine, cosine) = libm::sincos(azimuth);
        let tip = Vector3::new(r * cosine, side * r * sine, side * z) + root;
        let origin = tip - turned;
        Placement { x: origin.x, y: origin.y, z: origin.z, yaw }
    }

    /// Beta at a heading. rad
    pub fn beta(&self, heading: f64, chi: f64) -> f64 {
        self.rotation_sign * (heading - chi)
    }

    /// The state of a point, where some posture of the class is allowed there.
    pub fn truth(&self, point: usize, at: [f64; 3], heading: f64, class: PostureClass) -> Option<Truth> {
        let azimuth = -PI / 2.0;
        let pose = self.pose_at(point, at, azimuth);
        let all = explain(&self.problem, &pose, point, self.beta(heading, at[2]));
        let found = class.postures().into_iter().map(|p| &all[usize::from(p.number()) - 1]).find(|e| e.is_allowed())?;
        let state = found.state.as_ref()?;
        let frames = Frames::new(&self.problem.robot, &state.joints);
        let (side, root) = (self.side(), self.problem.robot.geometry().root_in_base);
        let (sine, cosine) = libm::sincos(azimuth);
        let tip = Vector3::new(at[0] * cosine, side * at[0] * sine, side * at[1]) + root;
        let mut compliances = self.problem.robot.compliances_at(&state.joints);
        compliances[0] = 0.0;
        let radial = Vector3::new(cosine, side * sine, 0.0);
        let tangential = Vector3::new(-sine, side * cosine, 0.0);
        let arm = WholeArm::new(&self.problem.robot, &self.problem.spindle, &frames, compliances, tip);
        let moved = |force: &Vector3<f64>| arm.displacement(force, &Vector3::zeros()).linear;
        let (by_radial, by_tangential) = (moved(&radial), moved(&tangential));
        let (rr, tt) = (by_radial.dot(&radial), by_tangential.dot(&tangential));
        let up = Vector3::new(0.0, 0.0, side);
        let (crossed, turned) = (by_radial.dot(&tangential), [by_radial.dot(&up), by_tangential.dot(&up)]);
        let values = [(rr + tt) / 2.0, (rr - tt) / 2.0, crossed, turned[0], turned[1], moved(&up).dot(&up)];
        let cost = self.problem.point_cost(point, state.score());
        let is_squared = self.problem.criterion.aggregate == Aggregate::Rms;
        let score = if is_squared { cost.sqrt() } else { cost };
        Some(Truth { values, cost, score, inverse_condition: state.inverse_condition })
    }

    /// The class, and a heading of a random allowed state at a placement.
    pub fn random_state(&self, random: &mut ChaCha8Rng, point: usize, at: [f64; 3]) -> Option<(PostureClass, f64)> {
        (0..30).find_map(|_| {
            let class = PostureClass::ALL[random.random_range(0..4)];
            let heading = TAU * random.random::<f64>();
            self.truth(point, at, heading, class).map(|_| (class, heading))
        })
    }
}

pub fn seeded(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// One of the ends of [-1, 1], its middle, or anything between.
pub fn share(random: &mut ChaCha8Rng) -> f64 {
    match random.random_range(0..8) {
        0..3 => 1.0,
        3..6 => -1.0,
        6 => 0.0,
        _ => random.random_range(-1.0..1.0),
    }
}

pub fn shares(random: &mut ChaCha8Rng) -> [f64; 3] {
    [share(random), share(random), share(random)]
}

/// A random path point somewhere in the cell: radius, height, direction of its feed.
pub fn anywhere(setting: &Setting, random: &mut ChaCha8Rng) -> (usize, [f64; 3]) {
    let point = random.random_range(0..setting.model.points.len());
    let middle = setting.whole.middle;
    let placement = std::array::from_fn(|k| middle[k] + setting.whole.half[k] * random.random_range(-0.95..0.95));
    (point, setting.place(placement, point))
}

/// Forces in every direction, and a surface that lies anyhow.
fn with_normals() -> Problem {
    let mut problem = slanted();
    let normal = |k: usize| Vector3::new(libm::sin(k as f64), libm::cos(2.0 * k as f64), 0.6).normalize();
    let path = problem.task.path().clone().with_surface_normals((0..105).map(normal).collect()).unwrap();
    problem.task = Task::new(path, problem.task.wrenches().copied().collect()).unwrap();
    problem
}

/// Forces and moments in every direction, on an arm with every offset.
fn with_moments() -> Problem {
    let mut problem = odd_arm();
    let moment = |k: usize| {
        let at = k as f64;
        Vector3::new(60.0 * libm::cos(at), 90.0 * libm::sin(0.7 * at), 120.0 * libm::sin(1.3 * at))
    };
    let wrenches = problem.task.wrenches().enumerate();
    let wrenches = wrenches.map(|(k, wrench)| Wrench { moment: moment(k), ..*wrench }).collect();
    problem.task = Task::new(problem.task.path().clone(), wrenches).unwrap();
    problem
}

/// The arm hangs, the tool is upright.
pub fn hanging_arm() -> Problem {
    let mut problem = slanted();
    let mut joints = problem.robot.joints().clone();
    joints[0].alpha = PI;
    problem.robot = Robot::new("hanging", joints).unwrap();
    problem.cell.position[2] = Interval { min: -1.4, max: -1.0 };
    problem
}

/// A base that is alike in every direction about axis 1 of an arm, on that axis.
fn alike_base(robot: &Robot) -> BaseCompliance {
    let (e, g) = (3e-8, -2e-8);
    let mut matrix = Matrix6::from_diagonal(&Vector6::new(6e-8, 6e-8, 3e-8, 2e-7, 2e-7, 4e-7));
    for (row, column, value) in [(0, 3, e), (1, 4, e), (0, 4, g), (1, 3, -g), (2, 5, 5e-8)] {
        (matrix[(row, column)], matrix[(column, row)]) = (value, value);
    }
    let root = robot.geometry().root_in_base;
    BaseCompliance::new(root + Vector3::new(0.0, 0.0, -0.3), matrix).unwrap()
}

/// The same problem with more that yields than the joints about their axes, as far as bounds cover it.
pub fn whole_arm(problem: Problem, beside: Beside) -> Problem {
    let mut problem = with_beside(problem, beside);
    let mut springs = *problem.robot.normal_springs().unwrap();
    springs[4].bearing = 0.0;
    problem.robot = problem.robot.clone().with_normal_springs(Some(springs)).unwrap();
    if beside == Beside::Everything {
        let base = alike_base(&problem.robot);
        problem.robot = problem.robot.clone().with_base_compliance(Some(base));
    }
    problem
}

/// The same, upside down.
fn whole_hanging() -> Problem {
    whole_arm(hanging_arm(), Beside::Everything)
}

/// Joints 2 and 3 yield by their angles, far more than those of any arm do.
fn changing() -> Problem {
    let range = |at_min, at_max| Compliance::Range { at_min, at_max };
    with_laws(slanted(), &[(1, range(6e-7, 1e-7)), (2, range(1e-7, 9e-7))])
}

/// An arm with offsets at shoulder, elbow and side, and joints 2 and 3 that turn by more than half a turn.
pub fn odd_arm() -> Problem {
    let mut problem = slanted();
    problem.robot = robot_from([
        (0.0, 0.1, 0.4, -350.0, 350.0, 1.0),
        (-90.0, 0.3, 0.07, -150.0, 100.0, 2.0),
        (0.0, 0.9, -0.02, -170.0, 160.0, 3.0),
        (90.0, -0.05, 0.8, -350.0, 350.0, 4.0),
        (-90.0, 0.0, 0.0, -350.0, 350.0, 5.0),
        (90.0, 0.0, 0.15, -350.0, 350.0, 6.0),
    ]);
    problem.cell.position = [(-0.3, 0.3), (-1.5, -1.0), (-0.5, 0.0)].map(|(min, max)| Interval { min, max });
    problem
}

/// An arm of two links of the same length that folds until they meet, near its shoulder.
fn equal_links() -> Problem {
    let mut problem = slanted();
    problem.robot = robot_from([
        (0.0, 0.0, 0.5, -350.0, 350.0, 1.0),
        (-90.0, 0.2, 0.0, -200.0, 160.0, 2.0),
        (0.0, 0.6, 0.0, -350.0, 350.0, 3.0),
        (90.0, 0.0, 0.6, -350.0, 350.0, 4.0),
        (-90.0, 0.0, 0.0, -350.0, 350.0, 5.0),
        (90.0, 0.0, 0.1, -350.0, 350.0, 6.0),
    ]);
    problem.cell.position = [(-0.3, 0.3), (-0.9, -0.4), (-0.6, 0.2)].map(|(min, max)| Interval { min, max });
    problem
}

/// The same problem with a tool that leans by some degrees, the same way at every point.
pub fn leaning(mut problem: Problem, degrees: f64) -> Problem {
    let (sine, cosine) = libm::sincos(degrees.to_radians());
    let axis = Vector3::new(0.28 * sine, -0.96 * sine, cosine);
    let path = problem.task.path();
    let points = path.points().iter().enumerate().map(|(k, p)| {
        let feed = (p.feed - axis * axis.dot(&p.feed)).normalize();
        (path.segment_of(k) as u32 + 1, PathPoint { axis, feed, ..*p })
    });
    let leaning = ToolPath::new(points.collect::<Vec<_>>()).unwrap();
    problem.task = Task::new(leaning, problem.task.wrenches().copied().collect()).unwrap();
    problem
}

#[test]
fn placements_are_seen_along_axis_1() {
    for (name, setting) in Setting::all() {
        let mut random = seeded(1);
        for _ in 0..200 {
            let (point, at) = anywhere(&setting, &mut random);
            let pose = setting.pose_at(point, at, 0.7);
            let workpiece = pose.base_from_workpiece();
            let root = setting.problem.robot.geometry().root_in_base;
            let tip = workpiece.point(&setting.problem.task.points()[point].position) - root;
            assert!((libm::hypot(tip.x, tip.y) - at[0]).abs() < 1e-12, "{name}");
            let one: &Point = &setting.model.points[point];
            assert!(one.distance >= 0.0);
        }
    }
}
