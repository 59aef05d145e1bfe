//! The moves of a program before it is put into the words of a controller: joint moves to a retracted point over each
//! segment, then linear moves through its points, and back; among surroundings the free way to the next segment in
//! place of these.

use super::ProgramError;
use super::transfer_paths::{Ends, Names, TransferPaths};
use stead_calibration::compensation::PathPoint;
use stead_model::external_axis::AxisKind;
use stead_model::robot::angles::{ANGLE_ROUNDING, nearest_turns};
use stead_model::robot::{Pose, Posture};
use stead_planning::transfer_path::TransferPath;
use stead_problem::problem::{Placement, Problem};
use stead_runs::plan::PlacedPlan;

/// Positions of the external axes that there are, in mm and deg.
pub(super) type External = [Option<f64>; 6];

/// Their units.
pub(super) fn external_units(problem: &Problem) -> [&'static str; 6] {
    std::array::from_fn(|number| match problem.external_axes.get(number).map(|axis| axis.kind) {
        Some(AxisKind::Turntable) => "deg",
        _ => "mm",
    })
}

/// Those of a problem at a path point.
pub(super) fn external_at(problem: &Problem, point: usize) -> External {
    let positions = problem.axis_positions(point);
    std::array::from_fn(|number| {
        let (axis, position) = (problem.external_axes.get(number)?, positions.get(number)?);
        Some(match axis.kind {
            AxisKind::Rail => position * 1e3,
            AxisKind::Turntable => position.to_degrees(),
        })
    })
}

/// Where the tool shall be at a path point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Target {
    /// Tool frame in the base frame. m
    pub base_from_tool: Pose<f64>,
    /// Posture of the arm.
    pub posture: Posture,
    /// Joint angles with their turns, as they are printed in the plan. rad
    pub joints: [f64; 6],
    /// Where the external axes stand.
    pub external: External,
}

/// The targets of a plan, point by point.
pub(super) fn targets(problem: &Problem, plan: &PlacedPlan) -> Vec<Target> {
    let target = |(number, point): (usize, &PathPoint)| Target {
        base_from_tool: point.base_from_tool,
        posture: point.posture,
        joints: point.joints,
        external: external_at(problem, number),
    };
    plan.points.iter().enumerate().map(target).collect()
}

/// How a move is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MoveKind {
    /// All joints at once, to angles.
    Joint,
    /// The tool centre point on a straight line, to a pose.
    Linear,
}

/// What begins with a move, for a comment before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Heading {
    /// The moves of a segment.
    Segment,
    /// The same, over a way that keeps free of all that stands around, with what is said of lines that are too short.
    FreeWay(Vec<String>),
    /// A move that is known to hit: the names of the two.
    Hits(Names),
    /// A line that the arm cannot follow: why.
    Unfollowed(String),
}

/// One move to a pose.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Move {
    pub kind: MoveKind,
    /// What begins with it, if anything does.
    pub heading: Option<Heading>,
    /// Number of the segment, from 1.
    pub segment: usize,
    /// The path point, from 0; none where the tool is retracted from it.
    pub point: Option<usize>,
    /// Tool frame in the workpiece frame. m
    pub workpiece_from_tool: Pose<f64>,
    /// Posture of the arm.
    pub posture: Posture,
    /// Exact joint angles of the rows, turns included. rad
    pub joints: [f64; 6],
    /// Angles of the controller, where it is known how it counts. rad
    pub angles: Option<[f64; 6]>,
    /// Where the external axes stand.
    pub external: External,
    /// Speed of the tool centre point. m/s
    pub feed: f64,
    /// Whether the next move may begin before this one has arrived.
    pub is_blended: bool,
}

impl Move {
    /// The same move to a place that is no path point.
    fn without_point(self) -> Self {
        Self { point: None, ..self }
    }
}

/// The frames that a program is in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frames {
    /// What linear poses are given in, in the controller's robot root: the workpiece with all external axes at zero, or
    /// where it stands still.
    pub root_from_workpiece: Pose<f64>,
    /// The tool on the flange.
    pub flange_from_tool: Pose<f64>,
    /// The table that carries the workpiece in the robot root, with all external axes at zero, where the program is
    /// coupled to it.
    pub root_from_table: Option<Pose<f64>>,
}

impl Frames {
    /// The workpiece on the table, where the program is coupled to one.
    pub fn table_from_workpiece(&self) -> Option<Pose<f64>> {
        self.root_from_table.map(|table| table.inverse().then(&self.root_from_workpiece))
    }
}

/// A retracted point is gone to in this many steps, each of which the arm must reach.
const APPROACH_STEPS: i32 = 10;
/// A joint that turns farther in one of these steps passes a singularity. rad
const MAX_APPROACH_STEP: f64 = 0.5;

/// Joint angles from the rounded beta and pose of a plan's row differ from its own by no more than this. rad
const PLAN_ROUNDING: f64 = 1e-5;

/// The frames of a program with its poses given in this frame of the cell, where the robot's root is known.
pub(super) fn frames(
    problem: &Problem,
    cell_from_workpiece: &Pose<f64>,
    root_from_table: Option<Pose<f64>>,
) -> Option<Frames> {
    let root_from_cell = problem.robot.controller_root_from_cell()?;
    Some(Frames {
        root_from_workpiece: root_from_cell.then(cell_from_workpiece),
        flange_from_tool: problem.robot.on_flange(&problem.spindle.flange_from_tool),
        root_from_table,
    })
}

/// The workpiece of the task file in the cell with all external axes at zero.
pub(super) fn at_zero(problem: &Problem, placement: &Placement) -> Pose<f64> {
    let mut pose = placement.base_from_workpiece();
    if let Some(orientation) = problem.orientation() {
        pose.rotation *= orientation.rotation;
    }
    pose
}

/// All moves, segment by segment, with the free ways between them where there are any.
///
/// # Errors
/// [`ProgramError::Unreached`] where the arm cannot be at a point, or cannot retract from it, in the posture of the
/// plan.
pub(super) fn moves(
    problem: &Problem,
    placement: &Placement,
    targets: &[Target],
    ends: Ends,
    transfer_paths: &TransferPaths,
) -> Result<Vec<Move>, ProgramError> {
    let maker = Maker { problem, placement };
    let mut moves = Vec::with_capacity(targets.len() + 2 * problem.task.segments().len());
    let has_approach = ends.approach > 0.0;
    let retracted = |point: usize, at: &At, when| {
        maker.retracted(point, &targets[point], at, ends.approach, when).map_err(|error| match error {
            ProgramError::Unreached { point, way, reason, .. } => ProgramError::Unreached {
                point,
                way,
                reason,
                most: Some(maker.farthest(targets, ends, transfer_paths)),
            },
            other => other,
        })
    };
    for (segment, range) in problem.task.segments().iter().enumerate() {
        let (first, last) = (range.start, range.end - 1);
        let start = maker.exact(first, &targets[first])?;
        let way_here = transfer_paths.free_to(segment);
        let is_at_first = match way_here {
            Some(way) => {
                moves.extend(maker.way_to(segment, way, transfer_paths.short_lines(segment), targets, &start));
                true
            }
            None => {
                let entry = retracted(first, &start, "before")?;
                let joint = maker.to(segment, first, MoveKind::Joint, &targets[first], &entry);
                let heading =
                    Some(transfer_paths.hit_before(segment).map_or(Heading::Segment, |hit| Heading::Hits(hit.clone())));
                // Without an approach the joint move goes to the first point.
                moves.push(Move { heading, ..if has_approach { joint.without_point() } else { joint } });
                !has_approach
            }
        };
        for point in range.clone().skip(usize::from(is_at_first)) {
            let at = maker.exact(point, &targets[point])?;
            let linear = maker.to(segment, point, MoveKind::Linear, &targets[point], &at);
            let is_blended = ends.has_blending && point != first && point != last;
            let heading = transfer_paths.unfollowed_to(point).map(|end| Heading::Unfollowed(end.to_string()));
            moves.push(Move { is_blended, heading, ..linear });
        }
        if let Some(way) = transfer_paths.free_from(segment) {
            moves.extend(maker.way_out(segment, way, &targets[last]));
        } else if has_approach {
            let end = maker.exact(last, &targets[last])?;
            let exit = retracted(last, &end, "after")?;
            let linear = maker.to(segment, last, MoveKind::Linear, &targets[last], &exit).without_point();
            let is_end = range.end == targets.len();
            let heading = transfer_paths.ends_hit[1].clone().filter(|_| is_end).map(Heading::Hits);
            moves.push(Move { heading, ..linear });
        }
    }
    Ok(moves)
}

/// The feed of the tip on the way to a path point, with which the point that the tool touches has that of the task, on
/// the way to the first point of a segment that to the next; of the run where the task has none. m/s
fn feed_at(problem: &Problem, point: usize) -> f64 {
    let path = problem.task.path();
    let segment = &path.segments()[path.segment_of(point)];
    let of = if point == segment.start && segment.len() > 1 { point + 1 } else { point };
    let share = if of == segment.start { 1.0 } else { path.tip_share(of) };
    path.feed(of).unwrap_or(problem.redundancy.feed) * share
}

/// The arm in one place.
#[derive(Debug, Clone, Copy)]
struct At {
    base_from_tool: Pose<f64>,
    joints: [f64; 6],
}

struct Maker<'a> {
    problem: &'a Problem,
    placement: &'a Placement,
}

impl Maker<'_> {
    fn to(&self, segment: usize, point: usize, kind: MoveKind, target: &Target, at: &At) -> Move {
        Move {
            kind,
            heading: None,
            segment: segment + 1,
            point: Some(point),
            workpiece_from_tool: self.problem.base_from_part(point, self.placement).inverse().then(&at.base_from_tool),
            posture: target.posture,
            joints: at.joints,
            angles: self
                .problem
                .robot
                .controller()
                .map(|controller| controller.angles(&self.problem.robot, &at.joints)),
            external: target.external,
            feed: feed_at(self.problem, point),
            is_blended: false,
        }
    }

    /// The move of a free way that still belongs to the segment (from 0) that it leaves: out of the cut along the tool
    /// axis.
    fn way_out(&self, segment: usize, way: &TransferPath, target: &Target) -> Option<Move> {
        let last = self.problem.task.segments()[segment].end - 1;
        let joints = way.joints.get(1).filter(|_| way.along_axis[0])?;
        Some(self.to(segment, last, MoveKind::Linear, target, &self.at(joints)).without_point())
    }

    /// The other moves of a free way, to the first point of the segment (from 0) that it leads to. External axes are
    /// where the last segment ends, or where this one begins.
    fn way_to(
        &self,
        segment: usize,
        way: &TransferPath,
        short_lines: Vec<String>,
        targets: &[Target],
        start: &At,
    ) -> Vec<Move> {
        let first = self.problem.task.segments()[segment].start;
        let end = way.joints.len() - 1;
        let places = (1 + usize::from(way.along_axis[0])..=end).map(|place| {
            let point = if place < way.axes_from { first - 1 } else { first };
            let kind = if way.is_along_axis(place) { MoveKind::Linear } else { MoveKind::Joint };
            if place == end {
                return self.to(segment, first, kind, &targets[first], start);
            }
            let joints = &way.joints[place];
            let target = Target { posture: Posture::of(&self.problem.robot, joints), ..targets[point] };
            self.to(segment, point, kind, &target, &self.at(joints)).without_point()
        });
        let mut moves: Vec<Move> = places.collect();
        if let Some(step) = moves.first_mut() {
            step.heading = Some(Heading::FreeWay(short_lines));
        }
        moves
    }

    /// The arm with these joint angles.
    fn at(&self, joints: &[f64; 6]) -> At {
        let base_from_tool = self.problem.robot.forward(joints).then(&self.problem.spindle.flange_from_tool);
        At { base_from_tool, joints: *joints }
    }

    /// The joint angles of a target to the last digit: those of its posture, in the turns of the plan.
    fn exact(&self, point: usize, target: &Target) -> Result<At, ProgramError> {
        let unreached = |reason| ProgramError::Unreached { point, way: String::new(), reason, most: None };
        let joints = self.joints(&target.base_from_tool, target.posture, &target.joints).map_err(unreached)?;
        Ok(At { base_from_tool: target.base_from_tool, joints: self.in_limits(joints) })
    }

    /// The same joint angles (rad), but at a limit where they are beyond it by no more than the rounding of the plan's
    /// digits.
    fn in_limits(&self, joints: [f64; 6]) -> [f64; 6] {
        let margin = self.problem.constraints.joint_margin;
        std::array::from_fn(|j| {
            let joint = &self.problem.robot.joints()[j];
            match joint.is_beyond(joints[j], margin + PLAN_ROUNDING) {
                true => joints[j],
                false => joints[j].clamp(joint.min - margin, joint.max + margin),
            }
        })
    }

    /// The farthest in whole mm, up to that requested, that the tool can be retracted before and after every segment,
    /// but for those with a free way. mm
    fn farthest(&self, targets: &[Target], ends: Ends, transfer_paths: &TransferPaths) -> u32 {
        let points = self.problem.task.segments().iter().enumerate().flat_map(|(segment, range)| {
            let before = transfer_paths.free_to(segment).is_none().then_some((range.start, "before"));
            let after = transfer_paths.free_from(segment).is_none().then_some((range.end - 1, "after"));
            [before, after].into_iter().flatten()
        });
        points.fold((ends.approach * 1e3).floor() as u32, |most, (point, when)| {
            let target = &targets[point];
            let Ok(at) = self.exact(point, target) else { return 0 };
            let is_reached = |mm: &u32| self.retracted(point, target, &at, f64::from(*mm) / 1e3, when).is_ok();
            (1..=most).rev().find(is_reached).unwrap_or(0)
        })
    }

    /// The tool drawn back along its axis, away from the workpiece.
    fn retracted(
        &self,
        point: usize,
        target: &Target,
        from: &At,
        approach: f64,
        when: &str,
    ) -> Result<At, ProgramError> {
        if approach == 0.0 {
            return Ok(*from);
        }
        // The tool's z axis points to the workpiece.
        let back = -target.base_from_tool.rotation.column(2);
        let mut at = *from;
        for step in 1..=APPROACH_STEPS {
            let by = approach * f64::from(step) / f64::from(APPROACH_STEPS);
            let unreached = |reason| {
                let way = format!(", {:.1} mm back along the tool axis {when} its segment", by * 1e3);
                ProgramError::Unreached { point, way, reason, most: None }
            };
            at.base_from_tool.translation = from.base_from_tool.translation + back * by;
            let joints = self.joints(&at.base_from_tool, target.posture, &at.joints).map_err(unreached)?;
            let swung = (0..6).find(|j| (joints[*j] - at.joints[*j]).abs() > MAX_APPROACH_STEP);
            if let Some(j) = swung {
                return Err(unreached(format!("joint {} would have to swing round a singularity", j + 1)));
            }
            if let Some(reason) = beyond_limit(self.problem, &joints) {
                return Err(unreached(reason));
            }
            at.joints = joints;
        }
        Ok(at)
    }

    /// The joint angles of a pose in a posture, each in the turn nearest to an angle.
    fn joints(&self, base_from_tool: &Pose<f64>, posture: Posture, near: &[f64; 6]) -> Result<[f64; 6], String> {
        let base_from_flange = base_from_tool.then(&self.problem.spindle.flange_from_tool.inverse());
        let angles = self.problem.robot.inverse(&base_from_flange, posture).map_err(|error| error.to_string())?;
        Ok(nearest_turns(&angles, near))
    }
}

/// Which joint, or the sum of joints 2 and 3, is beyond its limit; the margin that plans keep from limits is for the
/// cut, and not for the way to it.
fn beyond_limit(problem: &Problem, joints: &[f64; 6]) -> Option<String> {
    let margin = problem.constraints.joint_margin;
    let joint = problem.robot.joints().iter().zip(joints).zip(1..).find_map(|((joint, angle), number)| {
        let is_beyond = joint.is_beyond(*angle, margin + ANGLE_ROUNDING);
        let [angle, min, max] = [*angle, joint.min - margin, joint.max + margin].map(f64::to_degrees);
        is_beyond.then(|| format!("joint {number} would stand at {angle:.3} deg, and goes from {min:.3} to {max:.3}"))
    });
    let is_beyond = problem.robot.beyond_sum(joints) > margin + ANGLE_ROUNDING;
    let sum = problem.robot.sum_range().filter(|_| is_beyond).map(|range| {
        let sum = problem.robot.sum_of(joints);
        let [sum, min, max] = [sum, range.min - margin, range.max + margin].map(f64::to_degrees);
        format!("the sum of joints 2 and 3 would stand at {sum:.3} deg, and goes from {min:.3} to {max:.3}")
    });
    joint.or(sum)
}
