//! Straight moves as a controller drives them: the tool moves straight and turns evenly, and the joints follow in their
//! posture.
//!
//! Between two places that the arm reaches it may not reach all others: where a spindle at an angle to the flange turns
//! about its tool, the wrist centre swings out on an arc; and past a singularity of the wrist joints 4 and 6 may go on
//! by the other way round.

use crate::problem::{Placement, Problem};
use crate::segment_plan::SegmentPlan;
use nalgebra::Vector3;
use std::f64::consts::PI;
use std::sync::Arc;
use stead_model::robot::angles::nearest_turns;
use stead_model::robot::{Pose, Posture, Robot};
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};

/// Why the arm cannot go on along a straight line of the tool.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LineEnd {
    /// The arm does not reach farther in its posture.
    OutOfReach,
    /// A joint (from 1) is at its limit.
    JointLimit(usize),
    /// The sum of joints 2 and 3 is at its limit.
    AxesSum,
    /// A joint (from 1) would swing round a singularity.
    Swing(usize),
    /// A joint (from 1) would go the other way round than planned, and end a whole turn off.
    WholeTurn(usize),
    /// Two shapes are too near.
    Hit(Arc<[String; 2]>),
}

impl std::fmt::Display for LineEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::OutOfReach => write!(f, "the arm does not reach farther in its posture"),
            Self::JointLimit(joint) => write!(f, "joint {joint} is at its limit"),
            Self::AxesSum => write!(f, "the sum of joints 2 and 3 is at its limit"),
            Self::Swing(joint) => write!(f, "joint {joint} would swing round a singularity"),
            Self::WholeTurn(joint) => {
                write!(f, "joint {joint} would go the other way round than planned, and end a whole turn off")
            }
            Self::Hit(names) => write!(f, "{} and {} come too near", names[0], names[1]),
        }
    }
}

/// Steps of joints 1 to 3, and of joints 4 to 6, over which a straight move of the joints leaves that of the tool by
/// about a tenth of a millimetre. rad
const STEPS: [f64; 2] = [0.03, 0.06];
/// The same of the tool and the workpiece, which may turn. rad
const TURN_STEP: f64 = 0.04;
/// A step in which a joint turns by more than so many times these is halved.
const MOST_STEPS: f64 = 1.25;
/// How often a step is halved at the most, where a joint turns far, and where the arm may leave its reach: a joint that
/// turns by [`MAX_SWING`] in a hundredth of a move keeps no feed.
const HALVINGS: [i32; 2] = [3, 12];
/// A joint that turns farther in such a step of a move, or in one of a line along the tool axis, swings round a
/// singularity, which no controller follows at a useful speed. rad
pub const MAX_SWING: f64 = 0.5;
/// A joint that is by no more than this beyond its limit between two points, both inside, is not reported. rad
const BULGE: f64 = 2e-3;
/// A way of the wrist centre is as long as the chord but for this factor, where the tool turns by little.
const ARC: f64 = 1.05;
/// The wrist centre may come so near to the end of its reach without a closer look. m
const REACH_ROUNDING: f64 = 1e-5;

/// Which limit of an arm joint angles (rad), real ones, are beyond by more than a margin (rad), a joint's first.
pub fn limit_end(robot: &Robot, joints: &[f64; 6], margin: f64) -> Option<LineEnd> {
    let joint = (0..6).find(|j| robot.joints()[*j].is_beyond(joints[*j], margin));
    let sum = || (robot.beyond_sum(joints) > margin).then_some(LineEnd::AxesSum);
    joint.map(|joint| LineEnd::JointLimit(joint + 1)).or_else(sum)
}

impl Problem {
    /// Follows a path of the flange in the base frame, given over a share from 0 to 1, from joint angles (rad) in a
    /// posture, in so many steps or, where a joint turns far or the arm is nearly stretched or folded, in finer ones;
    /// up to the first state of which `visit` gives an answer. Returns where the joints are then. Limits of the joints
    /// are not checked.
    ///
    /// # Errors
    /// What ends the path before.
    pub fn follow<H>(
        &self,
        posture: Posture,
        from: &[f64; 6],
        steps: usize,
        flange_at: impl Fn(f64) -> Pose<f64>,
        mut visit: impl FnMut(f64, &[f64; 6]) -> Option<H>,
    ) -> Result<([f64; 6], Option<H>), LineEnd> {
        let robot = &self.robot;
        let first = flange_at(0.0);
        // Joint angles, wrist centre, and how far that may move.
        let mut last = (*from, robot.wrist_centre(&first), robot.reach_margin(&first, posture));
        for step in 0..steps {
            let (mut done, mut width) = (0.0, 1.0);
            while done < 1.0 {
                let share = (step as f64 + done + width) / steps as f64;
                let flange = flange_at(share);
                let found = robot.inverse(&flange, posture).map_err(|_| LineEnd::OutOfReach)?;
                let joints = nearest_turns(&found, &last.0);
                let turned = |j: usize| (joints[j] - last.0[j]).abs();
                let room = robot.reach_margin(&flange, posture);
                let wrist = robot.wrist_centre(&flange);
                let way = ARC * wrist.metric_distance(&last.1);
                let is_far = (0..6).any(|j| turned(j) > MOST_STEPS * STEPS[j / 3]);
                let may_leave = way > REACH_ROUNDING && last.2 + room < way;
                let can_halve = |times: i32| width > 0.5_f64.powi(times);
                if (is_far && can_halve(HALVINGS[0])) || (may_leave && can_halve(HALVINGS[1])) {
                    width /= 2.0;
                    continue;
                }
                if let Some(joint) = (0..6).find(|j| turned(*j) > MAX_SWING) {
                    return Err(LineEnd::Swing(joint + 1));
                }
                last = (joints, wrist, room);
                if let Some(found) = visit(share, &joints) {
                    return Ok((joints, Some(found)));
                }
                done += width;
                // Dyadic, so that steps meet again at whole ones.
                if (done / width) % 2.0 == 0.0 {
                    width = (2.0 * width).min(1.0);
                }
            }
        }
        Ok((last.0, None))
    }
}

/// A straight move of the tool in the frame of the part to a path point from the one before, while the external axes
/// move evenly.
#[derive(Debug)]
pub struct StraightMove<'a> {
    problem: &'a Problem,
    placement: &'a Placement,
    /// The path point at its end.
    point: usize,
    posture: Posture,
    /// Joint angles at both ends. rad
    joints: [[f64; 6]; 2],
    /// The tool at the start, in the frame of the part.
    start: Pose<f64>,
    /// What it moves and turns by. m, rad
    way: Vector3<f64>,
    turn: Vector3<f64>,
}

impl<'a> StraightMove<'a> {
    /// The move to a path point in a posture between joint angles (rad).
    pub fn new(
        problem: &'a Problem,
        placement: &'a Placement,
        point: usize,
        posture: Posture,
        joints: [[f64; 6]; 2],
    ) -> Self {
        let tool = |point: usize, joints: &[f64; 6]| {
            let base_from_tool = problem.robot.forward(joints).then(&problem.spindle.flange_from_tool);
            problem.base_from_part(point, placement).inverse().then(&base_from_tool)
        };
        let [start, end] = [tool(point - 1, &joints[0]), tool(point, &joints[1])];
        let turn = rotation_vector(&(end.rotation * start.rotation.transpose()));
        Self { problem, placement, point, posture, joints, start, way: end.translation - start.translation, turn }
    }

    /// The flange in the base frame at a share of the move.
    pub fn flange_at(&self, share: f64) -> Pose<f64> {
        let tool = Pose {
            rotation: rotation_from_vector(&(self.turn * share)) * self.start.rotation,
            translation: self.start.translation + self.way * share,
        };
        let positions = self.problem.positions_between([self.point - 1, self.point], share);
        let part = self.problem.turned(self.problem.base_from_workpiece_at(&positions, self.placement));
        part.then(&tool).then(&self.problem.spindle.flange_from_tool.inverse())
    }

    /// Follows it up to the first state, given by its share and joint angles (rad), of which `visit` gives an answer.
    ///
    /// # Errors
    /// What keeps the arm from following it.
    pub fn follow<H>(&self, visit: impl FnMut(f64, &[f64; 6]) -> Option<H>) -> Result<Option<H>, LineEnd> {
        let [from, to] = &self.joints;
        let [before, after] =
            [self.point - 1, self.point].map(|point| self.problem.base_from_part(point, self.placement).rotation);
        let of_part = rotation_vector(&(after * before.transpose()));
        let turned = (self.turn.norm() + of_part.norm()) / TURN_STEP;
        let steps = (0..6).map(|j| (to[j] - from[j]).abs() / STEPS[j / 3]).fold(turned, f64::max).ceil().max(1.0);
        let flange_at = |share: f64| self.flange_at(share);
        let (end, found) = self.problem.follow(self.posture, from, steps as usize, flange_at, visit)?;
        let is_off = |j: &usize| (end[*j] - to[*j]).abs() > PI;
        match (0..6).find(is_off) {
            Some(joint) if found.is_none() => Err(LineEnd::WholeTurn(joint + 1)),
            _ => Ok(found),
        }
    }

    /// The same, where every joint is within its own limits: the margin is for the points.
    ///
    /// # Errors
    /// What keeps the arm from following it.
    fn follow_within_limits(&self) -> Result<(), LineEnd> {
        let margin = self.problem.constraints.joint_margin + BULGE;
        let beyond = |_, joints: &[f64; 6]| limit_end(&self.problem.robot, joints, margin);
        self.follow(beyond)?.map_or(Ok(()), Err)
    }
}

impl Problem {
    /// Path points of a plan to which the arm cannot follow the straight move of the tool, and why; none on a subset of
    /// a path.
    pub fn unfollowed_moves(&self, placement: &Placement, plan: &SegmentPlan) -> Vec<(usize, LineEnd)> {
        let moves = (1..plan.joints.len()).filter(|_| !self.task.path().is_thinned());
        let fault = |place: usize| {
            let point = plan.points.start + place;
            let joints = [plan.joints[place - 1], plan.joints[place]];
            let straight = StraightMove::new(self, placement, point, plan.posture, joints);
            Some((point, straight.follow_within_limits().err()?))
        };
        moves.filter_map(fault).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::five_segments;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use std::sync::Arc;
    use stead_cell::testing::kr270_shapes;
    use stead_cell::{KeepOut, Proximity, Scene, Surroundings, TrackedPoint, Zone};

    /// The published task on an arm whose joints turn without limits.
    fn unlimited() -> Problem {
        let mut problem = five_segments();
        problem.constraints.joint_margin = 10.0;
        problem
    }

    /// Moves of up to 60 mm and a radian between states of a posture, near a stretched arm and singularities of the
    /// wrist: path point 1, posture, joint angles.
    fn random_moves(problem: &Problem, count: usize) -> Vec<(Posture, [[f64; 6]; 2])> {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let robot = &problem.robot;
        let tool = problem.spindle.flange_from_tool;
        let mut moves = Vec::new();
        while moves.len() < count {
            let mut from: [f64; 6] = std::array::from_fn(|_| random.random_range(-2.0..2.0));
            match moves.len() % 3 {
                0 => from[2] = -robot.geometry().forearm_angle + random.random_range(-0.2..0.2),
                1 => from[4] = random.random_range(-0.3..0.3),
                _ => {}
            }
            let posture = Posture::of(robot, &from);
            let mut vector = |most: f64| Vector3::from_fn(|_, _| random.random_range(-1.0..1.0)).normalize() * most;
            let (way, turn) = (vector(0.06), vector(1.0));
            let start = robot.forward(&from).then(&tool);
            let end =
                Pose { rotation: rotation_from_vector(&turn) * start.rotation, translation: start.translation + way };
            let Ok(found) = robot.inverse(&end.then(&tool.inverse()), posture) else { continue };
            moves.push((posture, [from, nearest_turns(&found, &from)]));
        }
        moves
    }

    /// The same move in many even steps: the joint angles, as far as the arm reaches.
    fn in_even_steps(straight: &StraightMove<'_>) -> Vec<[f64; 6]> {
        let mut last = straight.joints[0];
        let states = (1..=20_000).map_while(|step| {
            let found =
                straight.problem.robot.inverse(&straight.flange_at(f64::from(step) / 20_000.0), straight.posture);
            last = nearest_turns(&found.ok()?, &last);
            Some(last)
        });
        states.collect()
    }

    #[test]
    fn moves_are_followed_as_in_many_even_steps() {
        let (problem, limited) = (unlimited(), five_segments());
        let placement = Placement::from([0.0; 4]);
        let (mut counts, mut at_limits, mut within) = ([0; 3], 0, 0);
        for (posture, joints) in random_moves(&problem, 400) {
            let straight = StraightMove::new(&problem, &placement, 1, posture, joints);
            let states = in_even_steps(&straight);
            let largest = states.windows(2).flat_map(|pair| (0..6).map(|j| (pair[1][j] - pair[0][j]).abs()));
            let largest = largest.fold(0.0, f64::max);
            let followed = straight.follow(|_, _| None::<()>);
            let is_whole = states.len() == 20_000;
            let arrives = is_whole && (0..6).all(|j| (states[19_999][j] - joints[1][j]).abs() < 1e-6);
            match &followed {
                Ok(_) => assert!(arrives, "{joints:?} is not followed in even steps"),
                Err(LineEnd::OutOfReach) => assert!(!is_whole, "{joints:?} is in reach"),
                Err(LineEnd::WholeTurn(_)) => assert!(is_whole && !arrives, "{joints:?} arrives"),
                // A hundredth of the move in which a joint turns by half a radian.
                Err(end) => assert!(!arrives || largest > 0.5 / 200.0, "{joints:?}: {end}, {largest}"),
            }
            // A limit counts at the point itself, where the move begins.
            let starts_within = (0..6).all(|j| !limited.robot.joints()[j].is_beyond(joints[0][j], 0.0));
            if followed.is_ok() && starts_within {
                let found = StraightMove::new(&limited, &placement, 1, posture, joints).follow_within_limits();
                let beyond = |j: usize, margin: f64| {
                    states.iter().any(|state| limited.robot.joints()[j].is_beyond(state[j], margin))
                };
                match &found {
                    Err(LineEnd::JointLimit(joint)) => assert!(beyond(*joint - 1, BULGE), "{joints:?}: {joint}"),
                    other => assert!(other.is_ok() && (0..6).all(|j| !beyond(j, 1.5 * BULGE)), "{joints:?}: {other:?}"),
                }
                at_limits += usize::from(found.is_err());
                within += usize::from(found.is_ok());
            }
            counts[followed.map_or_else(|end| 1 + usize::from(end != LineEnd::OutOfReach), |_| 0)] += 1;
        }
        assert!(counts[0] > 200 && counts[1] > 10 && counts[2] > 5, "{counts:?}");
        assert!(at_limits > 5 && within > 5, "{at_limits} at limits, {within} within them");
    }

    #[test]
    fn a_zone_that_the_wrist_brushes_between_two_points_is_found() {
        let problem = unlimited();
        let placement = Placement::from([0.0; 4]);
        let mut found = 0;
        for (posture, joints) in random_moves(&problem, 200) {
            let straight = StraightMove::new(&problem, &placement, 1, posture, joints);
            let centre = |joints: &[f64; 6]| problem.robot.wrist_centre(&problem.robot.forward(joints));
            if straight.follow(|_, _| None::<()>).is_err() {
                continue;
            }
            // The zone begins where the wrist centre is farthest out across the chord, but for 0.3 mm.
            let [start, end] = [0, 1].map(|side| centre(&joints[side]));
            let chord = (end - start).normalize();
            let out = |joints: &[f64; 6]| {
                let apart = centre(joints) - start;
                apart - chord * apart.dot(&chord)
            };
            let states = in_even_steps(&straight);
            let Some(farthest) = states.iter().max_by(|a, b| out(a).norm().total_cmp(&out(b).norm())) else { continue };
            let far = out(farthest);
            if far.norm() < 1e-3 {
                continue;
            }
            let normal = far.normalize();
            let zone = Zone::HalfSpace { point: start + normal * (far.norm() - 3e-4), normal };
            let keep_out = KeepOut { name: "light curtain".to_owned(), zone, points: vec![TrackedPoint::Wrist] };
            let shapes = kr270_shapes().into_iter().filter(|shape| shape.name == "spindle").collect();
            let around = Surroundings::new(shapes, vec![keep_out], 0.01, Vec::new()).unwrap();
            let scene = Scene::new(&problem.robot, &problem.spindle.flange_from_tool, around).unwrap();
            let among = problem.clone().with(|parts| parts.scene = Some(Arc::new(scene)));
            let scene = among.scene.as_deref().unwrap();
            let stands = [0, 1].map(|side| among.poses(scene, side, &placement, &joints[side]));
            let ends = Some((scene, [&stands[0], &stands[1]]));
            let fault = among.at(&placement).move_fault(1, posture, joints, ends, &mut Proximity::default());
            assert!(fault.is_some(), "{joints:?}: {} mm out", far.norm() * 1e3);
            found += 1;
        }
        assert!(found > 50, "{found}");
    }
}
