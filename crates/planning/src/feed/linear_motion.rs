//! Linear moves of the tool as the arm drives them: joint angles and their rates along the way.

use nalgebra::{Matrix3, Vector3};
use stead_model::external_axis::robot_from_workpiece;
use stead_model::robot::{Pose, Posture, angles::nearest_turns};
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};
use stead_numerics::scalar::Dual;
use stead_problem::problem::Problem;

/// The largest turn of a joint between poses at which its speed is evaluated. rad
const MAX_TURN: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// The largest change of the speed of a joint between these poses, by its limit, beside the largest speed of any joint
/// by its own.
const MAX_CHANGE: f64 = 0.2;
/// A step is halved this often at the most.
const MAX_HALVINGS: usize = 10;
/// A pose of a step.
#[derive(Clone, Copy)]
pub(super) struct Node {
    /// The part of the step that is done.
    pub part: f64,
    /// Real joint angles. rad
    pub joints: [f64; 6],
    /// Their derivatives by the part, where the pose is reached. rad
    pub rates: Option<[f64; 6]>,
}

/// The largest rates of the joints between two poses in a row: their averages, or at the vertex of the parabola that
/// has the rates at both ends and the average between, where the vertex is between the two. rad
pub(super) fn rates_between(pair: &[Node]) -> [f64; 6] {
    let (from, to) = (&pair[0], &pair[1]);
    std::array::from_fn(|j| {
        let average = (to.joints[j] - from.joints[j]) / (to.part - from.part);
        let (Some(first), Some(last)) = (from.rates, to.rates) else { return average };
        // first + linear t + square t^2 for t from 0 to 1.
        let linear = 6.0 * average - 4.0 * first[j] - 2.0 * last[j];
        let square = 3.0 * (first[j] + last[j] - 2.0 * average);
        let vertex = -linear / (2.0 * square);
        let at_vertex = first[j] + linear * vertex / 2.0;
        if vertex > 0.0 && vertex < 1.0 && at_vertex.abs() > average.abs() { at_vertex } else { average }
    })
}

/// A linear move of the tool to a path point: its point along a straight line, the tool about a fixed axis, in the
/// frame of the part, which external axes may turn.
pub(super) struct LinearMotion<'a> {
    problem: &'a Problem,
    posture: Posture,
    /// The path point at its end where external axes move on the way.
    carried_to: Option<usize>,
    /// What the speed of each joint counts in comparisons: the inverse of its limit, zero where that is not known.
    /// s/rad
    weights: [f64; 6],
    /// Tool centre point in the flange frame. m
    tool: Vector3<f64>,
    /// Flange frame at the start to the frame in which the move is straight: that of the robot base, or that of the
    /// part at axes at zero.
    rotation: Matrix3<f64>,
    /// Tool centre point at the start. m
    start: Vector3<f64>,
    /// From there to the end. m
    travel: Vector3<f64>,
    /// Rotation vector of the whole turn in the flange frame. rad
    turn: Vector3<f64>,
}

/// Half of the share of a move over which the motion of the part is differentiated: an error of 1e-9.
const DIFFERENCE: f64 = 1e-4;

impl<'a> LinearMotion<'a> {
    pub(super) fn new(
        problem: &'a Problem,
        point: usize,
        posture: Posture,
        weights: [f64; 6],
        ends: [&[f64; 6]; 2],
    ) -> Self {
        let tool = problem.spindle.flange_from_tool.translation;
        let carried_to = Some(point).filter(|point| problem.axes_moved_to(*point));
        let straight = |share: f64, joints: &[f64; 6]| {
            let base_from_flange = problem.robot.forward(joints);
            carried_to
                .map_or(base_from_flange, |point| carried(problem, point, share).inverse().then(&base_from_flange))
        };
        let (from, to) = (straight(0.0, ends[0]), straight(1.0, ends[1]));
        let start = from.point(&tool);
        Self {
            problem,
            posture,
            carried_to,
            weights,
            tool,
            rotation: from.rotation,
            start,
            travel: to.point(&tool) - start,
            turn: rotation_vector(&from.rotation.tr_mul(&to.rotation)),
        }
    }

    /// The way of the tool centre point over the part. m
    pub(super) fn length(&self) -> f64 {
        self.travel.norm()
    }

    /// The joint angles, turns left out, where this part of the way is done, and their derivatives by the part; `None`
    /// where the arm does not reach. rad
    fn at(&self, part: f64) -> Option<([f64; 6], [f64; 6])> {
        let rotation = self.rotation * rotation_from_vector(&(self.turn * part));
        let rotation_rate = rotation * self.turn.cross_matrix();
        let flange = self.start + self.travel * part - rotation * self.tool;
        let flange_rate = self.travel - rotation_rate * self.tool;
        let dual = |value: f64, rate: f64| Dual::<1> { value, gradient: [rate] };
        let straight =
            Pose { rotation: rotation.zip_map(&rotation_rate, dual), translation: flange.zip_map(&flange_rate, dual) };
        let pose = self.carried_to.map_or(straight, |point| {
            let [before, here, after] =
                [part - DIFFERENCE, part, part + DIFFERENCE].map(|share| carried(self.problem, point, share));
            let rate = |after: f64, before: f64| (after - before) / (2.0 * DIFFERENCE);
            let carried = Pose {
                rotation: here.rotation.zip_map(&after.rotation.zip_map(&before.rotation, rate), dual),
                translation: here.translation.zip_map(&after.translation.zip_map(&before.translation, rate), dual),
            };
            carried.then(&straight)
        });
        let joints = self.problem.robot.inverse(&pose, self.posture).ok()?;
        Some((joints.map(|joint| joint.value), joints.map(|joint| joint.gradient[0])))
    }

    /// Both ends, the middle, and as many poses between that from one to the next no joint turns by more than
    /// [`MAX_TURN`], speeds are much the same, and no more than `max_part` of the way is done.
    pub(super) fn nodes(&self, ends: [&[f64; 6]; 2], max_part: f64) -> Vec<Node> {
        let end =
            |part: f64, joints: &[f64; 6]| Node { part, joints: *joints, rates: self.at(part).map(|(_, rates)| rates) };
        let (from, to) = (end(0.0, ends[0]), end(1.0, ends[1]));
        let mut nodes = vec![from];
        self.halve(&from, &to, max_part, 0, &mut nodes);
        nodes.push(to);
        nodes
    }

    /// Whether the speeds of all joints are much the same at two poses.
    fn is_even(&self, from: &Node, to: &Node) -> bool {
        let (Some(first), Some(last)) = (from.rates, to.rates) else { return true };
        let weighed = |rate: f64, j: usize| self.weights[j] * rate.abs();
        let largest = (0..6).map(|j| weighed(first[j], j).max(weighed(last[j], j))).fold(0.0, f64::max);
        (0..6).all(|j| weighed(last[j] - first[j], j) <= MAX_CHANGE * largest)
    }

    fn halve(&self, from: &Node, to: &Node, max_part: f64, halvings: usize, nodes: &mut Vec<Node>) {
        let widest = (0..6).map(|j| (to.joints[j] - from.joints[j]).abs()).fold(0.0, f64::max);
        let is_fine = halvings > 0 && widest <= MAX_TURN && to.part - from.part <= max_part && self.is_even(from, to);
        if is_fine || halvings == MAX_HALVINGS {
            return;
        }
        let part = (from.part + to.part) / 2.0;
        let Some((wrapped, rates)) = self.at(part) else { return };
        let middle = std::array::from_fn(|j| (from.joints[j] + to.joints[j]) / 2.0);
        let joints = nearest_turns(&wrapped, &middle);
        let node = Node { part, joints, rates: Some(rates) };
        self.halve(from, &node, max_part, halvings + 1, nodes);
        nodes.push(node);
        self.halve(&node, to, max_part, halvings + 1, nodes);
    }
}

/// Where the external axes have the part as the robot sees it, a share of the way to a path point: the frame of the
/// part with all axes at zero to the base frame.
fn carried(problem: &Problem, point: usize, share: f64) -> Pose<f64> {
    robot_from_workpiece(&problem.external_axes, &problem.positions_between([point - 1, point], share))
}
