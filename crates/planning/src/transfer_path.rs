//! Moves between segments that keep free: out of the cut along the tool axis, over to the next segment in joint space,
//! and in again.
//!
//! Where the straight joint move hits, higher lifts are tried, then a tree search from both ends (RRT-connect: Kuffner
//! and LaValle 2000) with random numbers of its own, so that the same plan always gets the same moves.

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::Arc;
use stead_cell::tool_scene::ToolScene;
use stead_cell::{PairKind, Scene};
use stead_model::robot::angles::ANGLE_ROUNDING;
use stead_model::robot::{Pose, Posture};
use stead_model::task::PathPoint;
use stead_problem::problem::{Placement, Problem};
use stead_problem::segment_plan::SegmentPlan;
pub use stead_problem::straight_move::LineEnd;
use stead_problem::straight_move::{MAX_SWING, limit_end};

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
/// Between two poses at which the room on a move is measured. rad
pub const ROOM_STEP: f64 = 0.02;
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

/// What moves are found in: an arm at a placement, among shapes where there are some.
#[derive(Debug, Clone, Copy)]
pub struct Space<'a> {
    problem: &'a Problem,
    /// The shapes of the cell, for lines along the tool axis.
    scene: Option<&'a Scene>,
    /// The same with cutter, holder and part, for joint moves.
    with_tool: Option<&'a Scene>,
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
    let space = Space::among_shapes(problem, placement)?;
    let [from, to] = plans;
    let (end, start) = (AtPoint::last(from)?, AtPoint::first(to)?);
    let are_axes_moved = problem.axis_positions(end.point) != problem.axis_positions(start.point);
    // External axes that stand elsewhere for the next segment move with the joints on the direct move, and before them
    // on any other.
    let lowest = [end, start].map(|at| space.line(at, problem.segment_moves.retract));
    let short_lines = lowest.each_ref().map(|line| line.short.clone());
    let lifts = space.lifted([end, start], lowest);
    if let Some([out, into]) = &lifts.free {
        return Some(TransferPath { short_lines, ..joined(&out.joints, &[], &into.joints, are_axes_moved) });
    }
    let mut random = ChaCha8Rng::seed_from_u64(number as u64);
    // Trees grow from the lowest lift at which nothing hits at either end.
    let points = (end.point, start.point);
    let is_free = |joints: &[f64; 6]| space.hit((joints, points.0), (joints, points.1)).is_none();
    let free_ends = lifts.blocked.iter().find(|[out, into]| {
        let (Some(high), Some(low)) = (out.joints.last(), into.joints.last()) else { return false };
        is_free(high) && is_free(low)
    });
    let around = free_ends.and_then(|[out, into]| {
        let over = space.around(*out.joints.last()?, *into.joints.last()?, points.1, &mut random)?;
        Some(joined(&out.joints, &over, &into.joints, are_axes_moved))
    });
    Some(match around {
        Some(way) => TransferPath { short_lines, ..way },
        None => TransferPath {
            joints: vec![end.joints, start.joints],
            axes_from: 1,
            along_axis: [false; 2],
            short_lines,
            blocked_by: lifts.blocked_by,
        },
    })
}

/// Lines along the tool axis out of one segment and into the next, from low to high.
#[derive(Debug, Default)]
struct Lifts {
    /// The lowest between whose ends the arm can move directly.
    free: Option<[Line; 2]>,
    /// Those between whose ends it cannot.
    blocked: Vec<[Line; 2]>,
    /// The first shapes that hit.
    blocked_by: Option<Arc<[String; 2]>>,
}

/// Whether the lines into and out of a segment have their whole length, in this order.
pub fn whole_lines(problem: &Problem, placement: &Placement, plan: &SegmentPlan) -> [bool; 2] {
    let space = Space::new(problem, placement);
    let is_whole = |at: AtPoint| space.line_end(at, problem.segment_moves.retract).is_none();
    line_ends(problem, plan).map(|end| end.is_none_or(is_whole))
}

/// The ends of a segment's plan at which a line leads into the cut and out of it; none on a path of which only some
/// points are left.
pub fn line_ends(problem: &Problem, plan: &SegmentPlan) -> [Option<AtPoint>; 2] {
    if problem.task.path().is_thinned() {
        return [None, None];
    }
    [AtPoint::first(plan), AtPoint::last(plan)]
}

/// A line of a program into a segment (from 0), or out of it, that ends before its length.
#[derive(Debug, Clone, PartialEq)]
pub struct ShortEnd {
    /// The segment.
    pub segment: usize,
    /// Whether the line leads out of it.
    pub is_out: bool,
    /// What ends it.
    pub line: ShortLine,
}

/// The lines of a program at which [`transfer_path`] does not look and that end before the length of the run: into the
/// first segment and out of the last, and without shapes into and out of each of them.
pub fn short_ends(problem: &Problem, placement: &Placement, plans: &[SegmentPlan]) -> Vec<ShortEnd> {
    let space = Space::new(problem, placement);
    let is_asked =
        |segment: usize, is_out: bool| problem.scene.is_none() || segment == if is_out { plans.len() - 1 } else { 0 };
    let ends = plans
        .iter()
        .enumerate()
        .flat_map(|(segment, plan)| [(segment, false, AtPoint::first(plan)), (segment, true, AtPoint::last(plan))]);
    ends.filter(|(segment, is_out, _)| is_asked(*segment, *is_out))
        .filter_map(|(segment, is_out, at)| {
            let line = space.line_end(at?, problem.segment_moves.retract)?;
            Some(ShortEnd { segment, is_out, line })
        })
        .collect()
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
    pub fn among_shapes(problem: &'a Problem, placement: &'a Placement) -> Option<Self> {
        Some(Self::new(problem, placement)).filter(|space| space.scene.is_some())
    }

    /// That of a problem at a placement; without shapes nothing hits, and limits and singular poses count alone.
    pub fn new(problem: &'a Problem, placement: &'a Placement) -> Self {
        let scene = problem.scene.as_deref();
        let with_tool = scene.map(|scene| problem.segment_moves.tool.as_deref().map_or(scene, ToolScene::scene));
        Self { problem, scene, with_tool, placement }
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

    /// The least room on such a move (m) and the pair that has it, at poses that no joint changes more between than by
    /// [`ROOM_STEP`].
    pub fn least_room(&self, from: (&[f64; 6], usize), to: (&[f64; 6], usize)) -> Option<(f64, Arc<[String; 2]>)> {
        let scene = self.with_tool?;
        let most = (0..6).map(|j| (to.0[j] - from.0[j]).abs()).fold(0.0, f64::max);
        let steps = (most / ROOM_STEP).ceil().max(1.0);
        let at = |step: usize| {
            let (_, poses) = self.problem.at(self.placement).by_joints(scene, [from, to], step as f64 / steps);
            scene.clearance(&poses, &PairKind::ALL)
        };
        let least = (0..=steps as usize).filter_map(at).min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        Some((least.distance, scene.pair(least.pair)?.names.clone()))
    }

    fn hit_in(
        &self,
        scene: Option<&Scene>,
        from: (&[f64; 6], usize),
        to: (&[f64; 6], usize),
    ) -> Option<Arc<[String; 2]>> {
        let scene = scene?;
        let [start, end] = [from, to].map(|(_, point)| self.problem.axis_positions(point));
        // Several axes that turn together move nothing about one axis: over such a step it is as good as that.
        let most = start.iter().zip(end).map(|(a, b)| (b - a).abs()).fold(0.0, f64::max);
        let steps = (most / AXIS_STEP).ceil().max(1.0);
        let at = |step: usize| self.problem.at(self.placement).by_joints(scene, [from, to], step as f64 / steps);
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
                match ((0..6).find(swings), limit_end(&self.problem.robot, &next, margin)) {
                    (Some(joint), _) => Err(LineEnd::Swing(joint + 1)),
                    (None, Some(end)) => Err(end),
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

    /// Lines of growing length away from the end of a segment and the start of the next, of which the `lowest` are
    /// known, until there is a direct move between two.
    fn lifted(&self, ends: [AtPoint; 2], lowest: [Line; 2]) -> Lifts {
        let retract = self.problem.segment_moves.retract;
        let is_too_short = |line: &Line| line.joints.len() < 2;
        let mut lifts = Lifts::default();
        for lift in LIFTS {
            // A higher line is looked at in other steps, and may so end a little before the lowest one, where that is
            // whole: then that is taken.
            let raised = |k: usize| {
                let line = self.line(ends[k], retract + lift);
                let is_short = line.short.as_ref().is_some_and(|short| short.length < retract);
                if is_short && lowest[k].short.is_none() { lowest[k].clone() } else { line }
            };
            let pair = [raised(0), raised(1)];
            // A line that a shorter one has ended already leads no farther.
            let is_known = |known: &[Line; 2]| *known == pair || (lift > 0.0 && pair.iter().all(is_too_short));
            if lifts.blocked.last().is_some_and(is_known) {
                break;
            }
            if let Some(names) = ends.iter().find_map(|at| self.tool_hit(at.point, retract + lift)) {
                lifts.blocked_by = lifts.blocked_by.or(Some(names));
                break;
            }
            let [out, into] = &pair;
            let (Some(high), Some(low)) = (out.joints.last(), into.joints.last()) else { break };
            let Some(names) = self.hit((high, ends[0].point), (low, ends[1].point)) else {
                lifts.free = Some(pair);
                break;
            };
            lifts.blocked_by = lifts.blocked_by.or(Some(names));
            lifts.blocked.push(pair);
        }
        lifts
    }

    /// A free way from one configuration to another, by trees from both, the external axes where they stand at a path
    /// point: the configurations on it, shortened.
    fn around(&self, from: [f64; 6], to: [f64; 6], point: usize, random: &mut ChaCha8Rng) -> Option<Vec<[f64; 6]>> {
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
        let is_beyond = self.problem.robot.beyond_sum(&new) > self.problem.constraints.joint_margin + ANGLE_ROUNDING;
        if distance == 0.0 || is_beyond || self.hit((&start, point), (&new, point)).is_some() {
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
mod tests;
