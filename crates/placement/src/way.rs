//! Moves between segments that keep free: out of the cut along the tool axis, over to the next segment in joint space, and in again.
//!
//! Where the straight joint move hits, higher lifts are tried, then a tree search from both ends (RRT-connect: Kuffner and LaValle
//! 2000) with random numbers of its own, so that the same plan always gets the same moves.

use crate::problem::{Placement, Problem};
use crate::redundancy::SegmentPlan;
use crate::settings::TransferSettings;
use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use stead_cell::Scene;
use stead_model::robot::angles::wrap;
use stead_model::robot::{Pose, Posture};

/// How a move between two segments goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Way {
    /// Joint angles one after the other, from the end of one segment to the start of the next, at least these two. rad
    pub joints: Vec<[f64; 6]>,
    /// From which of them on the external axes stand where the next segment has them; before it, where the last one has.
    pub axes_from: usize,
    /// Whether the first and the last move follow the tool axis; all others are straight in joint space.
    pub along_axis: [bool; 2],
    /// Number of the pair of the scene that hits on the straight move, where no free way was found: `joints` is then that move.
    pub blocked_by: Option<usize>,
}

/// Lifts beyond the retraction that are tried. m
const LIFTS: [f64; 4] = [0.1, 0.2, 0.4, 0.8];
/// A straight move along the tool axis is followed in steps of this length. m
const STRAIGHT_STEP: f64 = 0.01;
/// A joint that turns farther in one such step swings round a singularity, which no controller follows at a useful speed. rad
const MAX_SWING: f64 = 0.5;
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
    scene: &'a Scene,
    placement: &'a Placement,
}

/// The move from the end of one segment's plan to the start of the next; `None` where there is no scene.
pub fn way(
    problem: &Problem,
    settings: &TransferSettings,
    placement: &Placement,
    plans: [&SegmentPlan; 2],
    number: usize,
) -> Option<Way> {
    let space = Space::new(problem, placement)?;
    let [from, to] = plans;
    let end = AtPoint {
        point: from.points.end.checked_sub(1)?,
        beta: *from.betas.last()?,
        posture: from.posture,
        joints: *from.joints.last()?,
    };
    let (point, posture) = (to.points.start, to.posture);
    let start = AtPoint { point, beta: *to.betas.first()?, posture, joints: *to.joints.first()? };
    let are_axes_moved = problem.axis_positions(end.point) != problem.axis_positions(start.point);
    let out = space.retracted(end, settings.retract);
    let into = space.retracted(start, settings.retract);
    let (a, b) = (*out.last()?, *into.last()?);
    // External axes that stand elsewhere for the next segment move with the joints on the direct move, and before them on any other.
    let points = (end.point, start.point);
    let Some(blocked) = space.hit((&a, points.0), (&b, points.1)) else {
        return Some(joined(&out, &[], &into, are_axes_moved));
    };
    for lift in LIFTS {
        let [up, down] = [end, start].map(|end| space.retracted(end, settings.retract + lift));
        if let (Some(high), Some(low)) = (up.last(), down.last())
            && space.hit((high, points.0), (low, points.1)).is_none()
        {
            return Some(joined(&up, &[], &down, are_axes_moved));
        }
    }
    let mut random = ChaCha8Rng::seed_from_u64(number as u64);
    let over = match space.hit((&a, points.0), (&a, points.1)) {
        Some(_) => None,
        None => space.around((a, b), points.1, &mut random),
    };
    Some(match over {
        Some(over) => joined(&out, &over, &into, are_axes_moved),
        None => Way {
            joints: vec![end.joints, start.joints],
            axes_from: 1,
            along_axis: [false; 2],
            blocked_by: Some(blocked),
        },
    })
}

/// A retraction, joint moves, and an approach (given backwards). Joint moves begin where the external axes, which they then leave alone,
/// have moved already.
fn joined(out: &[[f64; 6]], over: &[[f64; 6]], into: &[[f64; 6]], are_axes_moved: bool) -> Way {
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
    Way { joints, axes_from, along_axis: [out.len() > 1, into.len() > 1], blocked_by: None }
}

impl Way {
    /// Whether the move to one of its places (from 1) follows the tool axis.
    pub fn is_along_axis(&self, place: usize) -> bool {
        let [out, into] = self.along_axis;
        (out && place == 1) || (into && place + 1 == self.joints.len())
    }
}

impl<'a> Space<'a> {
    /// Among the shapes of a problem; `None` where there are none.
    pub fn new(problem: &'a Problem, placement: &'a Placement) -> Option<Self> {
        Some(Self { problem, scene: problem.scene.as_deref()?, placement })
    }

    /// The number of the pair that hits where the tool is drawn back along its axis from a path point, or goes in there again.
    pub fn retraction_hit(&self, at: AtPoint, by: f64) -> Option<usize> {
        self.retraction(at, by).1
    }

    /// The number of the pair that hits on a straight joint move (rad), the external axes moving evenly from where they stand at one path
    /// point to where they stand at another.
    pub fn hit(&self, from: (&[f64; 6], usize), to: (&[f64; 6], usize)) -> Option<usize> {
        let [start, end] = [from, to].map(|(_, point)| self.problem.axis_positions(point));
        // Several axes that turn together move nothing about one axis: over such a step it is as good as that.
        let most = start.iter().zip(end).map(|(a, b)| (b - a).abs()).fold(0.0, f64::max);
        let steps = (most / AXIS_STEP).ceil().max(1.0);
        let at = |step: usize| self.problem.by_joints(self.scene, self.placement, [from, to], step as f64 / steps);
        (0..steps as usize).find_map(|step| {
            let [(a, start), (b, end)] = [at(step), at(step + 1)];
            self.scene.motion((&a, &start), (&b, &end)).map(|hit| hit.pair)
        })
    }

    /// From a path point straight along the tool axis, away from the work, as far as the arm reaches and nothing hits: joint angles
    /// from the point on. rad
    fn retracted(&self, at: AtPoint, by: f64) -> Vec<[f64; 6]> {
        self.retraction(at, by).0
    }

    /// The same with the pair that ends it.
    fn retraction(&self, at: AtPoint, by: f64) -> (Vec<[f64; 6]>, Option<usize>) {
        let AtPoint { point, beta, posture, joints } = at;
        let flange = self.problem.base_from_flange(point, self.placement, beta);
        let axis: Vector3<f64> = self.problem.placed(point, self.placement).axes.column(2).into_owned();
        let steps = (by / STRAIGHT_STEP).ceil().max(0.0) as usize;
        let mut all = vec![joints];
        let mut last = joints;
        for step in 1..=steps {
            let lift = axis * (by * step as f64 / steps as f64);
            let target = Pose { translation: flange.translation + lift, ..flange };
            let Ok(found) = self.problem.robot.inverse(&target, posture) else { break };
            let next: [f64; 6] = std::array::from_fn(|j| last[j] + wrap(found[j] - last[j]));
            let is_inside = (0..6).all(|j| {
                let joint = &self.problem.robot.joints()[j];
                (joint.min..=joint.max).contains(&next[j]) && (next[j] - last[j]).abs() <= MAX_SWING
            });
            if !is_inside {
                break;
            }
            if let Some(pair) = self.hit((&last, point), (&next, point)) {
                return (all, Some(pair));
            }
            last = next;
            all.push(next);
        }
        (all, None)
    }

    /// A free way from one configuration to another, by trees from both, the external axes where they stand at a path point: the
    /// configurations on it, shortened.
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
    use std::sync::Arc;
    use stead_cell::testing::{kr270_shapes, scene_of, shape};
    use stead_cell::{Attachment, PairKind, Solid};

    fn plans(problem: &Problem, placement: &Placement) -> Vec<SegmentPlan> {
        let free = Problem { scene: None, ..problem.clone() };
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
        let settings = TransferSettings::default();
        let found = way(&problem, &settings, &placement, [&free[0], &free[2]], 1).unwrap();
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
        assert_eq!(way(&problem, &settings, &placement, [&free[0], &free[2]], 1), Some(found));
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
        let settings = TransferSettings::default();
        assert_eq!(way(&problem, &settings, &placement, [&free[0], &free[1]], 1), None);
        let spindle = kr270_shapes().into_iter().filter(|s| s.name == "spindle").collect();
        problem.scene = Some(Arc::new(scene_of(spindle, 0.005)));
        let found = way(&problem, &settings, &placement, [&free[0], &free[1]], 1).unwrap();
        assert_eq!((found.joints.len(), found.along_axis, found.blocked_by), (4, [true; 2], None));
        let tip =
            |joints: &[f64; 6]| problem.robot.forward(joints).point(&problem.spindle.flange_from_tool.translation);
        let end = problem.placed(free[0].points.end - 1, &placement);
        assert!((tip(&found.joints[1]) - end.tip - end.axes.column(2) * settings.retract).norm() < 1e-9);
    }
}
