//! By how much a part may be off its place before the program of its plan no longer runs, or deflects more: the base is
//! measured anew, so that the program moves with the part, every point with its free angle and its posture. Joint moves
//! between segments stay, as their joint angles do.

use super::moves::{JointMove, joint_moves};
use crate::case::{Case, PlanPoint};
use crate::path_subset::PathSubset;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::atomic::{AtomicUsize, Ordering};
use stead_numerics::monitor::{Monitor, Progress};
use stead_planning::transfer_path::{AtPoint, LineEnd, Space};
use stead_problem::constraints::{ConstraintKind, Measured, describe, joint_steps_hold, on_joints, on_state};
use stead_problem::criterion::CANCELLATION;
use stead_problem::problem::{Placement, Problem};

/// Shares by which the objective may grow, the smaller first.
pub const RISES: [f64; 2] = [0.01, 0.05];
/// The first trial along an axis and about one; the farthest; and how near to each other two trials may be. m, rad
const TRIALS: [[f64; 3]; 2] = [[5e-3, 0.1, 5e-5], [PI / 360.0, PI / 18.0, PI / 36000.0]];
/// The next trial is so many times as far.
const GROWTH: f64 = 5.0;
/// An offset is found to this share of itself, on the safe side.
const FINENESS: f64 = 0.2;
/// A controller slows the path down where a joint is at its speed. Where one would be so many times as fast as it can
/// be, the pose is nearly singular, and a line is not followed.
const FASTER: f64 = 2.0;
/// Most trials for a direction.
const MOST: usize = 14;
/// Path points that stand for a long path, beside one for every segment; of paths of fewer than twice as many all are
/// looked at.
const POINTS: usize = 1000;

/// A way in which a part can stand off its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OffDirection {
    /// 0 to 2: along x, y, z of the frame of the sheet; 3: turned about its z axis, in the datum.
    pub axis: usize,
    /// Whether it is against the axis.
    pub is_negative: bool,
}

impl OffDirection {
    /// All eight.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..4).flat_map(|axis| [false, true].map(|is_negative| Self { axis, is_negative }))
    }

    /// Whether it is a turn.
    pub fn is_turn(self) -> bool {
        self.axis == 3
    }
}

impl std::fmt::Display for OffDirection {
    /// `+x`, `-rz`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", if self.is_negative { '-' } else { '+' }, ["x", "y", "z", "rz"][self.axis])
    }
}

/// How far a part may be off in a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowed {
    /// The farthest trial up to which every one kept below the rise; the next one that did not is at most a fifth of it
    /// farther. m or rad
    pub offset: f64,
    /// Whether it is the farthest tried, so that the part may be off by more.
    pub is_more: bool,
}

/// What the program cannot keep on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocked {
    /// The nearest trial at which it cannot. m or rad
    pub offset: f64,
    /// The limit that it breaks, or the two shapes that come too near, in words.
    pub by: String,
}

/// How far a part may be off in one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerance {
    /// The direction.
    pub direction: OffDirection,
    /// Until the objective has grown by each of [`RISES`].
    pub rises: [Allowed; 2],
    /// What the program cannot keep, where it is met before the larger rise.
    pub blocked: Option<Blocked>,
}

/// How far a part may be off.
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances {
    /// The objective where the part is as stated, by which rises are measured: on the points below, and without the
    /// travel of the joints. m
    pub nominal: f64,
    /// Points of the path that are looked at, of all; fewer for a long path.
    pub points: [usize; 2],
    /// By direction.
    pub directions: Vec<Tolerance>,
}

/// A program with the part off its place.
struct Trials<'a> {
    /// The problem with the arm's own limits, and on the points that are looked at.
    problem: Problem,
    sampled: Problem,
    placement: Placement,
    /// The plan at these points.
    points: Vec<&'a PlanPoint>,
    moves: Vec<JointMove<'a>>,
    /// Ends of segments whose lines along the tool axis have their whole length.
    lines: Vec<&'a PlanPoint>,
    /// From the frame of the sheet to that of placements.
    rotation: Matrix3<f64>,
}

/// How far a part may be off the placement of a case; a part that external axes carry with all of them at zero.
/// `rotation` turns the frame of the sheet, in which directions are, into that of placements; their z axes are
/// parallel.
///
/// # Errors
/// A sentence: why it is not known.
pub(super) fn tolerances(
    problem: &Problem,
    case: &Case,
    rotation: Matrix3<f64>,
    monitor: &Monitor,
) -> Result<Tolerances, String> {
    let trials = Trials::new(problem, case, rotation);
    let nominal = trials.at(&trials.placement).map_err(|by| format!("the plan itself does not keep {by}"))?;
    if nominal <= CANCELLATION {
        return Err("the best plan cancels the deflection: any offset is many times as much".to_owned());
    }
    let (done, directions) = (AtomicUsize::new(0), OffDirection::all().collect::<Vec<_>>());
    let report = |done| monitor.report(Progress::Steps { stage: "tolerances", done, total: directions.len() });
    report(0);
    let one = |direction: &OffDirection| {
        let found = trials.along(*direction, nominal, monitor);
        report(done.fetch_add(1, Ordering::Relaxed) + 1);
        found
    };
    let found: Option<Vec<Tolerance>> = directions.par_iter().map(one).collect();
    let points = [trials.points.len(), problem.task.points().len()];
    Ok(Tolerances { nominal, points, directions: found.ok_or(super::INTERRUPTED)? })
}

/// A trial: how far off, and the objective there or what is not kept.
type Trial = (f64, Result<f64, String>);

/// How many of the first trials keep a limit.
fn kept(trials: &[Trial], limit: f64) -> usize {
    trials.iter().take_while(|trial| trial.1.as_ref().is_ok_and(|objective| *objective <= limit)).count()
}

/// The last of them, and the next, where there is one.
fn bracket(trials: &[Trial], limit: f64) -> Option<(&Trial, &Trial)> {
    let count = kept(trials, limit);
    Some((trials.get(count.checked_sub(1)?)?, trials.get(count)?))
}

/// Where the limit may be met between two trials.
fn between(low: &Trial, high: &Trial, limit: f64, bisects: bool) -> f64 {
    let share = match (&low.1, &high.1) {
        (Ok(below), Ok(above)) if !bisects && above > below => {
            // Between what a kink and what a smooth minimum would have.
            libm::pow(((limit - below) / (above - below)).max(0.0), 0.75)
        }
        _ => 0.5,
    };
    low.0 + (high.0 - low.0) * share.clamp(0.1, 0.9)
}

impl<'a> Trials<'a> {
    fn new(problem: &Problem, case: &'a Case, rotation: Matrix3<f64>) -> Self {
        let problem = problem.to_its_limits();
        let (task, plan) = (&problem.task, &case.plan);
        let subset = PathSubset::new(
            task,
            match task.points().len() {
                all if all < 2 * POINTS => all,
                _ => POINTS + task.segments().len(),
            },
        );
        let points: Vec<&PlanPoint> = subset.points().iter().filter_map(|point| plan.points.get(*point)).collect();
        let sampled = if points.len() < task.points().len() { subset.of(&problem) } else { problem.clone() };
        let moves = joint_moves(&problem, case);
        let space = Space::new(&problem, &case.placement);
        let ends = task.segments().iter().flat_map(|span| [span.start, span.end - 1]);
        let ends = ends.filter_map(|point| plan.points.get(point));
        let is_whole =
            |of: &&PlanPoint| space.line_end(at_point(of, of.joints), problem.segment_moves.retract).is_none();
        let lines = ends.filter(is_whole).collect();
        Self { placement: case.placement, sampled, points, moves, lines, rotation, problem }
    }

    /// The placement with the part off by so much. m or rad
    fn off(&self, direction: OffDirection, offset: f64) -> Placement {
        let offset = if direction.is_negative { -offset } else { offset };
        let mut placement = self.placement;
        if direction.is_turn() {
            placement.yaw += offset * self.rotation[(2, 2)];
            return placement;
        }
        let shift: Vector3<f64> = self.rotation.column(direction.axis) * offset;
        (0..3).for_each(|k| placement[k] += shift[k]);
        placement
    }

    /// How far the part may be off in a direction; `None` once the caller asks to stop.
    fn along(&self, direction: OffDirection, nominal: f64, monitor: &Monitor) -> Option<Tolerance> {
        let [first, farthest, nearest] = TRIALS[usize::from(direction.is_turn())];
        let mut trials: Vec<Trial> = vec![(0.0, Ok(nominal))];
        let attempt = |trials: &mut Vec<Trial>, offset: f64| {
            let trial = (offset, self.at(&self.off(direction, offset)));
            trials.insert(trials.partition_point(|known| known.0 < offset), trial);
        };
        let limits = RISES.map(|rise| nominal * (1.0 + rise));
        let mut offset = first;
        loop {
            if monitor.should_stop() {
                return None;
            }
            attempt(&mut trials, offset);
            if kept(&trials, limits[1]) < trials.len() || offset >= farthest {
                break;
            }
            offset = (offset * GROWTH).min(farthest);
        }
        for limit in limits.into_iter().rev() {
            let mut bisects = false;
            while let Some((low, high)) = bracket(&trials, limit) {
                if high.0 - low.0 <= nearest.max(FINENESS * low.0) || trials.len() > MOST {
                    break;
                }
                if monitor.should_stop() {
                    return None;
                }
                let next = between(low, high, limit, bisects);
                attempt(&mut trials, next);
                bisects = !bisects;
            }
        }
        let rises = limits.map(|limit| {
            let count = kept(&trials, limit);
            Allowed { offset: trials[count - 1].0, is_more: count == trials.len() }
        });
        let blocked = trials.into_iter().find_map(|(offset, found)| Some(Blocked { offset, by: found.err()? }));
        Some(Tolerance { direction, rises, blocked })
    }

    /// The objective of the program with the part at a placement (m).
    ///
    /// # Errors
    /// What it cannot keep there, in words.
    fn at(&self, placement: &Placement) -> Result<f64, String> {
        let problem = &self.sampled;
        let mut before: Option<(usize, [f64; 6])> = None;
        let mut costs = vec![0.0; self.problem.task.segments().len()];
        for (point, of) in self.points.iter().enumerate() {
            let kept = |kind: ConstraintKind| format!("{} at point {}", describe(&[kind]).join(", "), of.point);
            let state = problem.at(placement).state(point, of.beta, of.posture);
            let mut state = state.map_err(|_| kept(ConstraintKind::Reach))?;
            state.joints = turned_to(&state.joints, &of.joints);
            // The conditioning decides where a plan is looked for, and not what an arm can do: what follows of it is
            // in the deflection and in the steps of the joints.
            let on_state = on_state(problem, &state).filter(|of| of.kind() != ConstraintKind::Conditioning);
            let from = before.replace((of.segment, state.joints)).filter(|(segment, _)| *segment == of.segment);
            let is_singular = from.is_some_and(|(_, from)| {
                let limits = problem.joint_steps(point).map(|limit| FASTER * limit);
                !joint_steps_hold(&problem.robot, &from, &state.joints, &limits)
            });
            if is_singular {
                return Err(format!("a nearly singular pose at point {}", of.point));
            }
            let mut measured = on_joints(problem, &state.joints).chain(on_state);
            if let Some(broken) = measured.find(|measured| !measured.holds()) {
                return Err(kept(broken.kind()));
            }
            if let Some(Measured::Clearance { names, .. }) =
                problem.clearance_constraint(point, placement, &state.joints).filter(|measured| !measured.holds())
            {
                return Err(format!("{} and {} at point {}", names[0], names[1], of.point));
            }
            let cost = &mut costs[of.segment - 1];
            *cost = problem.criterion.aggregate.join(*cost, problem.point_cost(point, state.score()));
        }
        let space = Space::new(&self.problem, placement);
        for [from, to] in &self.moves {
            if let Some(names) = space.hit(*from, *to) {
                return Err(format!("{} and {} on a joint move", names[0], names[1]));
            }
        }
        for of in &self.lines {
            let state = self.problem.at(placement).state(of.point, of.beta, of.posture);
            let joints = state.map(|state| turned_to(&state.joints, &of.joints)).unwrap_or(of.joints);
            if let Some(short) = space.line_end(at_point(of, joints), self.problem.segment_moves.retract) {
                return Err(match short.end {
                    LineEnd::Hit(names) => format!("{} and {} on the line to point {}", names[0], names[1], of.point),
                    _ => format!("limits of the joints on the line to point {}", of.point),
                });
            }
        }
        Ok(problem.objective(costs))
    }
}

/// A point of a plan with other joint angles.
fn at_point(of: &PlanPoint, joints: [f64; 6]) -> AtPoint {
    AtPoint { point: of.point, beta: of.beta, posture: of.posture, joints }
}

/// Joint angles in the turns of others.
fn turned_to(joints: &[f64; 6], near: &[f64; 6]) -> [f64; 6] {
    std::array::from_fn(|j| joints[j] + TAU * ((near[j] - joints[j]) / TAU).round())
}
