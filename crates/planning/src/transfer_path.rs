//! Moves between segments that keep free: out of the cut along the tool axis, over to the next segment in joint space,
//! and in again.
//!
//! Where the straight joint move hits, higher lifts are tried, then a tree search from both ends (RRT-connect: Kuffner
//! and LaValle 2000) with random numbers of its own, so that the same plan always gets the same moves.

use crate::problem::{Placement, Problem};
use crate::segment_plan::SegmentPlan;
pub use crate::straight_move::LineEnd;
use crate::straight_move::MAX_SWING;
use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;
use stead_cell::tool_scene::ToolScene;
use stead_cell::{PairKind, Scene};
use stead_model::robot::angles::ANGLE_ROUNDING;
use stead_model::robot::{Pose, Posture};
use stead_model::task::PathPoint;

/// How a move between two segments goes.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferPath {
    /// Joint angles one after the other, from the end of one segment to the start of the next, at least these two. rad
    pub joints: Vec<[f64; 6]>,
    /// From which of them on the external axes stand where the next segment has them; before it, where the last one
    /// has.
    pub axes_from: usize,
    /// Whether the first and the last move follow the tool axis; all others are straight in joint space.
    pub along_axis: [bool; 2],
    /// What ends the line out of the cut, and that into it, before its length.
    pub short_lines: [Option<ShortLine>; 2],
    /// The pair that hits, where no free way was found: `joints` is then the straight move.
    pub blocked_by: Option<Arc<[String; 2]>>,
}

/// A line along the tool axis that is not as long as it should be.
#[derive(Debug, Clone, PartialEq)]
pub struct ShortLine {
    /// How long it is. m
    pub length: f64,
    /// How long it should be. m
    pub wanted: f64,
    /// What ends it.
    pub end: LineEnd,
}

/// Lifts beyond the retraction that are tried. m
const LIFTS: [f64; 5] = [0.0, 0.1, 0.2, 0.4, 0.8];
/// A straight move along the tool axis is followed in steps of this length. m
pub(crate) const STRAIGHT_STEP: f64 = 0.01;
/// Positions of external axes between which all is taken to turn about one axis. m or rad
const AXIS_STEP: f64 = 0.1;
/// States that both trees together have at the most.
const MAX_STATES: usize = 1500;
/// The longest edge of a tree. rad
const EDGE: f64 = 0.35;
/// Tries to shorten a way by going straight between two places of it.
const SHORTCUTS: usize = 60;

/// The arm at a path point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtPoint {
    /// The path point, from 0.
    pub point: usize,
    /// The free angle about the tool axis. rad
    pub beta: f64,
    /// The posture of the arm.
    pub posture: Posture,
    /// Its joint angles. rad
    pub joints: [f64; 6],
}

/// What moves are found in: an arm among shapes, at a placement.
#[derive(Debug, Clone, Copy)]
pub struct Space<'a> {
    problem: &'a Problem,
    /// The shapes of the cell, for lines along the tool axis.
    scene: &'a Scene,
    /// The same with cutter, holder and part, for joint moves.
    with_tool: &'a Scene,
    placement: &'a Placement,
}

/// A line along the tool axis away from a path point.
#[derive(Debug, Clone, PartialEq)]
struct Line {
    /// Joint angles in steps, from the point on. rad
    joints: Vec<[f64; 6]>,
    short: Option<ShortLine>,
}

/// The move from the end of one segment's plan to the start of the next; `None` where there is no scene.
pub fn transfer_path(
    problem: &Problem,
    placement: &Placement,
    plans: [&SegmentPlan; 2],
    number: usize,
) -> Option<TransferPath> {
    let space = Space::new(problem, placement)?;
    let [from, to] = plans;
    let (end, start) = (AtPoint::last(from)?, AtPoint::first(to)?);
    let retract = problem.segment_moves.retract;
    let are_axes_moved = problem.axis_positions(end.point) != problem.axis_positions(start.point);
    // External axes that stand elsewhere for the next segment move with the joints on the direct move, and before them
    // on any other.
    let points = (end.point, start.point);
    let lowest = [end, start].map(|at| space.line(at, retract));
    let short_lines = lowest.each_ref().map(|line| line.short.clone());
    let is_too_short = |line: &Line| line.joints.len() < 2;
    let mut blocked = None;
    let mut lines: Vec<[Line; 2]> = Vec::new();
    for lift in LIFTS {
        // A higher line is looked at in other steps, and may so end a little before the lowest one, where that is
        // whole: then that is taken.
        let raised = |k: usize| {
            let line = space.line([end, start][k], retract + lift);
            let is_short = line.short.as_ref().is_some_and(|short| short.length < retract);
            if is_short && lowest[k].short.is_none() { lowest[k].clone() } else { line }
        };
        let pair = [raised(0), raised(1)];
        // A line that a shorter one has ended already leads no farther.
        if lines.last().is_some_and(|known| *known == pair || (lift > 0.0 && pair.iter().all(is_too_short))) {
            break;
        }
        if let Some(names) = [end, start].iter().find_map(|at| space.tool_hit(at.point, retract + lift)) {
            blocked = blocked.or(Some(names));
            break;
        }
        let [out, into] = &pair;
        let (Some(high), Some(low)) = (out.joints.last(), into.joints.last()) else { break };
        match space.hit((high, points.0), (low, points.1)) {
            None => {
                return Some(TransferPath { short_lines, ..joined(&out.joints, &[], &into.joints, are_axes_moved) });
            }
            Some(names) => blocked = blocked.or(Some(names)),
        }
        lines.push(pair);
    }
    let mut random = ChaCha8Rng::seed_from_u64(number as u64);
    // Trees grow from the lowest lift at which nothing hits at either end.
    let free_ends = lines.iter().find(|[out, into]| {
        let (Some(high), Some(low)) = (out.joints.last(), into.joints.last()) else { return false };
        space.hit((high, points.0), (high, points.1)).is_none() && space.hit((low, points.1), (low, points.1)).is_none()
    });
    let around = free_ends.and_then(|[out, into]| {
        let over = space.around((*out.joints.last()?, *into.joints.last()?), points.1, &mut random)?;
        Some(joined(&out.joints, &over, &into.joints, are_axes_moved))
    });
    Some(match around {
        Some(way) => TransferPath { short_lines, ..way },
        None => TransferPath {
            joints: vec![end.joints, start.joints],
            axes_from: 1,
            along_axis: [false; 2],
            short_lines,
            blocked_by: blocked,
        },
    })
}

/// Whether the lines into and out of a segment have their whole length, in this order; also where no segment comes
/// before or after it, and where there is no scene.
pub fn whole_lines(problem: &Problem, placement: &Placement, plan: &SegmentPlan) -> [bool; 2] {
    let ends = line_ends(problem, plan);
    let Some(space) = Space::new(problem, placement) else { return [true; 2] };
    let is_whole = |at: AtPoint| space.line_end(at, problem.segment_moves.retract).is_none();
    ends.map(|end| end.is_none_or(is_whole))
}

/// The ends of a segment's plan at which a line leads into the cut and out of it: neither before the first segment nor
/// after the last, nor on a path of which only some points are left.
pub fn line_ends(problem: &Problem, plan: &SegmentPlan) -> [Option<AtPoint>; 2] {
    if problem.scene.is_none() || problem.task.path().is_thinned() {
        return [None, None];
    }
    let count = problem.task.points().len();
    let into = (plan.points.start > 0).then(|| AtPoint::first(plan)).flatten();
    let out = (plan.points.end < count).then(|| AtPoint::last(plan)).flatten();
    [into, out]
}

impl AtPoint {
    /// The end of a segment's plan.
    fn last(plan: &SegmentPlan) -> Option<Self> {
        let point = plan.points.end.checked_sub(1)?;
        Some(Self { point, beta: *plan.betas.last()?, posture: plan.posture, joints: *plan.joints.last()? })
    }

    /// Its start.
    fn first(plan: &SegmentPlan) -> Option<Self> {
        let point = plan.points.start;
        Some(Self { point, beta: *plan.betas.first()?, posture: plan.posture, joints: *plan.joints.first()? })
    }
}

/// A retraction, joint moves, and an approach (given backwards). Joint moves begin where the external axes, which they
/// then leave alone, have moved already.
fn joined(out: &[[f64; 6]], over: &[[f64; 6]], into: &[[f64; 6]], are_axes_moved: bool) -> TransferPath {
    let ends = |followed: &[[f64; 6]]| match followed {
        [first, .., last] => vec![*first, *last],
        all => all.to_vec(),
    };
    let mut joints = ends(out);
    let axes_from = joints.len();
    let mut rest = over.to_vec();
    rest.extend(ends(into).into_iter().rev());
    rest.dedup();
    // The same place again is a move where the external axes move there, or where there is no other move.
    let stays = !are_axes_moved && joints.len() + rest.len() > 2 && rest.first() == joints.last();
    joints.extend(rest.into_iter().skip(usize::from(stays)));
    let along_axis = [out.len() > 1, into.len() > 1];
    TransferPath { joints, axes_from, along_axis, short_lines: [None, None], blocked_by: None }
}

impl TransferPath {
    /// Whether the move to one of its places (from 1) follows the tool axis.
    pub fn is_along_axis(&self, place: usize) -> bool {
        let [out, into] = self.along_axis;
        (out && place == 1) || (into && place + 1 == self.joints.len())
    }
}

impl<'a> Space<'a> {
    /// Among the shapes of a problem; `None` where there are none.
    pub fn new(problem: &'a Problem, placement: &'a Placement) -> Option<Self> {
        let scene = problem.scene.as_deref()?;
        let with_tool = problem.segment_moves.tool.as_deref().map_or(scene, ToolScene::scene);
        Some(Self { problem, scene, with_tool, placement })
    }

    /// What ends the line of a length (m) along the tool axis out of the cut at a path point, or into it, before its
    /// length.
    pub fn line_end(&self, at: AtPoint, length: f64) -> Option<ShortLine> {
        self.line(at, length).short
    }

    /// What cutter or holder hit on such a line, deeper than they are in the part at the path point.
    pub fn tool_hit(&self, point: usize, length: f64) -> Option<Arc<[String; 2]>> {
        let problem = self.problem;
        let point = &problem.task.points()[point];
        let lies = problem.orientation().map_or_else(Matrix3::identity, |orientation| orientation.rotation);
        let [position, feed, axis] = [point.position, point.feed, point.axis].map(|v| lies.tr_mul(&v));
        problem.segment_moves.tool.as_deref()?.line_hit(&PathPoint { position, feed, axis }, length)
    }

    /// The pair that hits on a straight joint move (rad) with the tool out of the cut, the external axes moving evenly
    /// from where they stand at one path point to where they stand at another.
    pub fn hit(&self, from: (&[f64; 6], usize), to: (&[f64; 6], usize)) -> Option<Arc<[String; 2]>> {
        self.hit_in(self.with_tool, from, to)
    }

    fn hit_in(&self, scene: &Scene, from: (&[f64; 6], usize), to: (&[f64; 6], usize)) -> Option<Arc<[String; 2]>> {
        let [start, end] = [from, to].map(|(_, point)| self.problem.axis_positions(point));
        // Several axes that turn together move nothing about one axis: over such a step it is as good as that.
        let most = start.iter().zip(end).map(|(a, b)| (b - a).abs()).fold(0.0, f64::max);
        let steps = (most / AXIS_STEP).ceil().max(1.0);
        let at = |step: usize| self.problem.by_joints(scene, self.placement, [from, to], step as f64 / steps);
        let pair = (0..steps as usize).find_map(|step| {
            let [(a, start), (b, end)] = [at(step), at(step + 1)];
            match a == b && start == end {
                true => scene.first_hit(&start, &PairKind::ALL),
                false => scene.motion((&a, &start), (&b, &end)).map(|hit| hit.pair),
            }
        })?;
        scene.pair(pair).map(|pair| pair.names.clone())
    }

    /// From a path point straight along the tool axis, away from the work, as far as the arm reaches and nothing hits.
    /// The margin that plans keep from the limits of the joints is for the cut, and not for the way to it.
    fn line(&self, at: AtPoint, wanted: f64) -> Line {
        let AtPoint { point, beta, posture, joints } = at;
        let flange = self.problem.at(self.placement).base_from_flange(point, beta);
        let axis: Vector3<f64> = self.problem.placed(point, self.placement).axes.column(2).into_owned();
        let steps = (wanted / STRAIGHT_STEP).ceil().max(0.0) as usize;
        let margin = self.problem.constraints.joint_margin + ANGLE_ROUNDING;
        let mut all = vec![joints];
        let mut last = joints;
        for step in 1..=steps {
            let share = |step: usize| wanted * step as f64 / steps as f64;
            let flange_at = |part: f64| {
                let along = share(step - 1) + part * (share(step) - share(step - 1));
                Pose { translation: flange.translation + axis * along, ..flange }
            };
            let next = self.problem.follow(posture, &last, 1, flange_at, |_, _| None::<()>).and_then(|(next, _)| {
                let swings = |j: &usize| (next[*j] - last[*j]).abs() > MAX_SWING;
                let is_beyond = |j: &usize| self.problem.robot.joints()[*j].is_beyond(next[*j], margin);
                match ((0..6).find(swings), (0..6).find(is_beyond)) {
                    (Some(joint), _) => Err(LineEnd::Swing(joint + 1)),
                    (None, Some(joint)) => Err(LineEnd::JointLimit(joint + 1)),
                    (None, None) => match self.hit_in(self.scene, (&last, point), (&next, point)) {
                        Some(names) => Err(LineEnd::Hit(names)),
                        None => Ok(next),
                    },
                }
            });
            match next {
                Ok(next) => {
                    last = next;
                    all.push(next);
                }
                Err(end) => {
                    let short = ShortLine { length: share(step - 1), wanted, end };
                    return Line { joints: all, short: Some(short) };
                }
            }
        }
        Line { joints: all, short: None }
    }

    /// A free way from one configuration to another, by trees from both, the external axes where they stand at a path
    /// point: the configurations on it, shortened.
    fn around(&self, (from, to): ([f64; 6], [f64; 6]), point: usize, random: &mut ChaCha8Rng) -> Option<Vec<[f64; 6]>> {
        let mut trees = [vec![(from, 0)], vec![(to, 0)]];
        let mut grown = 0;
        while trees[0].len() + trees[1].len() < MAX_STATES {
            let sample: [f64; 6] = std::array::from_fn(|j| {
                let joint = &self.problem.robot.joints()[j];
                joint.min + (joint.max - joint.min) * random.random::<f64>()
            });
            let (mine, theirs) = (grown, 1 - grown);
            grown = theirs;
            let Some(new) = self.extend(&mut trees[mine], &sample, point) else { continue };
            // The other tree grows towards the new state for as long as it can.
            while let Some(near) = self.extend(&mut trees[theirs], &new, point) {
                if near == new {
                    let mut joints = branch(&trees[0]);
                    joints.reverse();
                    joints.extend(branch(&trees[1]).into_iter().skip(1));
                    return Some(self.shortened(joints, point, random));
                }
                if trees[0].len() + trees[1].len() >= MAX_STATES {
                    break;
                }
            }
        }
        None
    }

    /// Lets a tree grow by one edge towards a configuration; `None` where that hits, or the tree ends there already.
    fn extend(&self, tree: &mut Vec<([f64; 6], usize)>, towards: &[f64; 6], point: usize) -> Option<[f64; 6]> {
        let apart = |joints: &[f64; 6]| joints.iter().zip(towards).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let (nearest, distance) =
            tree.iter().enumerate().map(|(k, (joints, _))| (k, apart(joints))).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let start = tree[nearest].0;
        let share = (EDGE / distance).min(1.0);
        let new = if distance <= EDGE {
            *towards
        } else {
            std::array::from_fn(|j| start[j] + share * (towards[j] - start[j]))
        };
        if distance == 0.0 || self.hit((&start, point), (&new, point)).is_some() {
            return None;
        }
        tree.push((new, nearest));
        Some(new)
    }

    /// The same way with straight moves in place of detours, where these are free.
    fn shortened(&self, mut joints: Vec<[f64; 6]>, point: usize, random: &mut ChaCha8Rng) -> Vec<[f64; 6]> {
        for _ in 0..SHORTCUTS {
            if joints.len() < 3 {
                break;
            }
            let first = random.random_range(0..joints.len() - 2);
            let last = random.random_range(first + 2..joints.len());
            if self.hit((&joints[first], point), (&joints[last], point)).is_none() {
                joints.drain(first + 1..last);
            }
        }
        joints
    }
}

/// The states from the last one of a tree back to its root.
fn branch(tree: &[([f64; 6], usize)]) -> Vec<[f64; 6]> {
    let mut place = tree.len() - 1;
    let mut joints = vec![tree[place].0];
    while place > 0 {
        place = tree[place].1;
        joints.push(tree[place].0);
    }
    joints
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::redundancy::Planner;
    use crate::sense::Sense;
    use crate::testing::five_segments;
    use stead_cell::testing::{kr270_shapes, scene_of, shape};
    use stead_cell::tool_scene::{Cylinder, SegmentMoves, ToolBody};
    use stead_cell::{Attachment, Solid};
    use stead_model::task::{Task, ToolPath, Wrench};

    fn plans(problem: &Problem, placement: &Placement) -> Vec<SegmentPlan> {
        let free = problem.clone().with(|parts| parts.scene = None);
        let planner = Planner::new(&free);
        planner.plan(placement, Sense::Min, None, &mut planner.workspace()).unwrap()
    }

    #[test]
    fn a_way_around_a_wall_between_two_segments_is_found_and_free() {
        let placement = Placement::from([0.1, -1.9, -0.4, 1.0]);
        let mut problem = five_segments();
        let free = plans(&problem, &placement);
        // A plate upright between the ends of the tool, wherever these are.
        let [a, b] = [&free[0], &free[2]].map(|plan| problem.placed(plan.points.start, &placement).tip);
        let middle = (a + b) / 2.0;
        let mut plate = shape("plate", Attachment::Base, Solid::Box(Vector3::new(0.01, 0.5, 0.5)), middle.into());
        let across = (b - a).cross(&Vector3::z()).normalize();
        let along = (b - a).normalize();
        plate.pose.rotation = nalgebra::Matrix3::from_columns(&[along, across, along.cross(&across)]);
        let shapes = kr270_shapes().into_iter().filter(|s| s.name == "spindle").chain([plate]).collect();
        problem.scene = Some(Arc::new(scene_of(shapes, 0.005)));
        let found = transfer_path(&problem, &placement, [&free[0], &free[2]], 1).unwrap();
        let scene = problem.scene.as_deref().unwrap();
        let workpiece = placement.base_from_workpiece();
        if found.blocked_by.is_none() {
            assert!(found.joints.len() > 2);
            for pair in found.joints.windows(2).skip(1).take(found.joints.len() - 3) {
                let [a, b] = [0, 1].map(|end| scene.poses(&pair[end], &workpiece));
                assert!(scene.motion((&pair[0], &a), (&pair[1], &b)).is_none());
                for share in [0.25, 0.5, 0.75] {
                    let joints: [f64; 6] = std::array::from_fn(|j| pair[0][j] + share * (pair[1][j] - pair[0][j]));
                    let near = scene.clearance(&scene.poses(&joints, &workpiece), &PairKind::ALL);
                    assert!(near.is_none_or(|near| near.distance > 0.0));
                }
            }
        }
        assert_eq!(found.blocked_by, None);
        assert_eq!(transfer_path(&problem, &placement, [&free[0], &free[2]], 1), Some(found));
    }

    #[test]
    fn external_axes_move_before_the_joints_on_a_way_and_with_them_on_the_direct_move() {
        let [end, a, via, b, start] = [0.0, 1.0, 2.0, 3.0, 4.0].map(|angle| [angle; 6]);
        let (out, into, over) = ([end, a], [start, b], [a, via, b]);
        let found = |over: &[[f64; 6]], are_moved| {
            let way = joined(&out, over, &into, are_moved);
            (way.joints.clone(), way.axes_from, [1, 2, way.joints.len() - 1].map(|place| way.is_along_axis(place)))
        };
        let along = [true, false, true];
        assert_eq!(found(&[], true), (vec![end, a, b, start], 2, along));
        assert_eq!(found(&[], false), (vec![end, a, b, start], 2, along));
        assert_eq!(found(&over, true), (vec![end, a, a, via, b, start], 2, along));
        assert_eq!(found(&over, false), (vec![end, a, via, b, start], 2, along));
        // Nothing moves but the axes, or nothing at all.
        assert_eq!(joined(&[end], &[], &[end], true).joints, [end, end]);
        assert_eq!(joined(&[end], &[], &[end], false).joints, [end, end]);
    }

    #[test]
    fn without_obstacles_the_move_is_retraction_joint_move_approach() {
        let placement = Placement::from([0.1, -1.9, -0.4, 1.0]);
        let mut problem = five_segments();
        let free = plans(&problem, &placement);
        assert_eq!(transfer_path(&problem, &placement, [&free[0], &free[1]], 1), None);
        let spindle = kr270_shapes().into_iter().filter(|s| s.name == "spindle").collect();
        problem.scene = Some(Arc::new(scene_of(spindle, 0.005)));
        let found = transfer_path(&problem, &placement, [&free[0], &free[1]], 1).unwrap();
        assert_eq!((found.joints.len(), found.along_axis, found.blocked_by), (4, [true; 2], None));
        let tip =
            |joints: &[f64; 6]| problem.robot.forward(joints).point(&problem.spindle.flange_from_tool.translation);
        let end = problem.placed(free[0].points.end - 1, &placement);
        assert!((tip(&found.joints[1]) - end.tip - end.axes.column(2) * problem.segment_moves.retract).norm() < 1e-9);
    }

    /// A cut on the floor of each of two pockets beside each other, 90 mm deep with a wall from x = -30 to 30 mm, and
    /// one on top.
    fn two_pockets() -> Problem {
        let mut problem = five_segments();
        let row = |x: f64, z: f64, step: usize| PathPoint {
            position: Vector3::new(x, 0.01 * step as f64, z),
            feed: Vector3::y(),
            axis: Vector3::z(),
        };
        let starts = [(1, -0.08, -0.09), (2, 0.08, -0.09), (3, 0.08, 0.0)];
        let points = starts.into_iter().flat_map(|(segment, x, z)| (0..5).map(move |k| (segment, row(x, z, k))));
        let wrenches = vec![Wrench { force: Vector3::new(10.0, 50.0, 20.0), moment: Vector3::zeros() }; 15];
        problem.task = Task::new(ToolPath::new(points).unwrap(), wrenches).unwrap();
        problem
    }

    /// The wall and the floor of the pockets.
    fn pocketed_part() -> [stead_cell::Shape; 2] {
        let part = |name: &str, edges: [f64; 3], z: f64| {
            shape(name, Attachment::Workpiece, Solid::Box(edges.into()), [0.0, 0.0, z])
        };
        [part("wall", [0.06, 0.3, 0.09], -0.045), part("floor plate", [0.4, 0.3, 0.02], -0.101)]
    }

    /// With its spindle above a cutter of 20 mm by 40 mm, and a shank.
    fn with_tool(mut problem: Problem, part: &[stead_cell::Shape], tool: ToolBody) -> Problem {
        let spindle =
            shape("spindle", Attachment::Flange, Solid::Cylinder { radius: 0.06, length: 0.3 }, [0.0, 0.0, 0.2]);
        problem.scene = Some(Arc::new(scene_of([&[spindle], part].concat(), 0.002)));
        let flange_from_tool = problem.spindle.flange_from_tool;
        let scene = problem.scene.as_deref().unwrap();
        let tool = ToolScene::new(&problem.robot, &flange_from_tool, scene, problem.task.path(), tool).unwrap();
        problem.segment_moves.tool = Some(Arc::new(tool));
        problem
    }

    fn end_mill() -> ToolBody {
        let [cutter, shank] =
            [(0.01, 0.0, 0.04), (0.008, 0.04, 0.15)].map(|(radius, from, to)| Cylinder { radius, from, to });
        ToolBody { cutter: Some(cutter), holder: vec![shank], ..ToolBody::default() }
    }

    /// The least height of the tool centre point above the top of the part, in the workpiece frame, while it is over
    /// the wall. m
    fn least_height_over_the_wall(problem: &Problem, placement: &Placement, joints: &[[f64; 6]]) -> f64 {
        let workpiece = placement.base_from_workpiece().inverse();
        let tool = problem.spindle.flange_from_tool.translation;
        let heights = joints.windows(2).flat_map(|pair| {
            (0..=400).filter_map(|step| {
                let share = f64::from(step) / 400.0;
                let at: [f64; 6] = std::array::from_fn(|j| pair[0][j] + share * (pair[1][j] - pair[0][j]));
                let tip = workpiece.point(&problem.robot.forward(&at).point(&tool));
                (tip.x.abs() < 0.03).then_some(tip.z)
            })
        });
        heights.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn between_deep_pockets_the_tool_goes_over_the_wall() {
        let placement = Placement::from([0.0, -1.9, -0.4, 0.3]);
        let bare = two_pockets();
        let made = plans(&bare, &placement);
        let tools = [ToolBody::default(), end_mill()];
        for part in [&pocketed_part()[..], &[]] {
            for tool in &tools {
                let problem = with_tool(two_pockets(), part, tool.clone());
                let found = transfer_path(&problem, &placement, [&made[0], &made[1]], 0).unwrap();
                assert_eq!(found.blocked_by, None);
                assert_eq!(found.short_lines, [None, None]);
                let height = least_height_over_the_wall(&problem, &placement, &found.joints);
                assert!(height > 0.0015, "{} mm, {} shapes, {tool:?}", height * 1e3, part.len());
                assert_eq!(
                    problem.segment_moves.tool.as_deref().unwrap().notes().len(),
                    usize::from(part.is_empty()) + usize::from(tool.cutter.is_none())
                );
            }
        }
        // Without the part that is a move through the wall.
        let problem = with_tool(two_pockets(), &[], ToolBody::default());
        let unaware = problem.with(|parts| parts.segment_moves = SegmentMoves::default());
        let found = transfer_path(&unaware, &placement, [&made[0], &made[1]], 0).unwrap();
        assert!(least_height_over_the_wall(&unaware, &placement, &found.joints) < -0.02);
    }

    #[test]
    fn a_line_out_counts_only_what_is_deeper_than_at_the_path_point() {
        let problem = two_pockets();
        let point = problem.task.points()[0];
        let hit = |part: &[stead_cell::Shape], tool: ToolBody, length: f64| {
            let problem = with_tool(problem.clone(), part, tool);
            let names = problem.segment_moves.tool.as_deref().unwrap().line_hit(&point, length)?;
            Some(names[1].clone())
        };
        let cutter =
            |radius: f64, to: f64| ToolBody { cutter: Some(Cylinder { radius, from: 0.0, to }), ..ToolBody::default() };
        let block = |name: &str, edges: [f64; 3], at: [f64; 3]| {
            shape(name, Attachment::Workpiece, Solid::Box(edges.into()), at)
        };
        // Against a wall, 0.3 mm inside of it, and 0.1 mm inside of the floor.
        let wall = block("wall", [0.06, 0.3, 0.2], [-0.08 + 0.0097 + 0.03, 0.0, 0.0]);
        let floor = block("base plate", [0.4, 0.3, 0.02], [0.0, 0.0, -0.0999]);
        assert_eq!(hit(&[wall.clone(), floor.clone()], cutter(0.01, 0.04), 0.2), None);
        // A ledge above the cutter, as over a slot that it cuts below.
        let ledge = block("ledge", [0.06, 0.3, 0.01], [-0.08 + 0.009 + 0.03, 0.0, -0.02]);
        assert_eq!(hit(&[floor.clone(), ledge.clone()], cutter(0.01, 0.04), 0.2).as_deref(), Some("ledge"));
        assert_eq!(hit(&[floor, ledge], cutter(0.01, 0.04), 0.02), None);
        // Stock that the whole cutter is in.
        assert_eq!(hit(&[block("stock", [0.4, 0.3, 0.2], [0.0, 0.0, -0.1])], cutter(0.01, 0.04), 0.2), None);
    }

    #[test]
    fn a_short_line_is_told_with_what_ends_it() {
        let placement = Placement::from([0.0, -1.9, -0.4, 0.3]);
        let bare = two_pockets();
        let made = plans(&bare, &placement);
        // A lid above the spindle at the first pocket.
        let tip = bare.placed(4, &placement).tip;
        let lid = shape("lid", Attachment::Base, Solid::Box(Vector3::new(0.1, 0.1, 0.01)), [tip.x, tip.y, tip.z + 1.0]);
        let flange = made[0].joints.last().map(|joints| bare.robot.forward(joints).translation).unwrap();
        let lid =
            stead_cell::Shape { pose: Pose { translation: flange + Vector3::new(0.0, 0.0, 0.12), ..lid.pose }, ..lid };
        let ball = shape("ball", Attachment::Flange, Solid::Capsule { radius: 0.08, length: 0.0 }, [0.0; 3]);
        let problem = with_tool(bare.clone(), &[lid, ball], end_mill());
        let found = transfer_path(&problem, &placement, [&made[0], &made[1]], 0).unwrap();
        let [Some(out), None] = &found.short_lines else { panic!("{:?}", found.short_lines) };
        assert!((0.02..0.05).contains(&out.length) && out.wanted == 0.05, "{out:?}");
        assert_eq!(out.end.to_string(), "ball and lid come too near");
        assert_eq!(whole_lines(&problem, &placement, &made[0]), [true, false]);
        assert_eq!(whole_lines(&problem, &placement, &made[1]), [true, true]);
    }
}
