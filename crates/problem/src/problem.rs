//! The placement problem: what may vary, what must hold, and what a placement is.

mod at_feed;
mod in_setup;
mod parts;

pub use parts::{ProblemError, ProblemParts};

use super::postures::PostureRules;
use nalgebra::{Matrix3, Vector3};
use std::borrow::Cow;
use std::f64::consts::{PI, TAU};
use stead_cell::{Attachment, Shape};
use stead_model::external_axis::{AxisKind, ExternalAxis};
use stead_model::plausibility;
use stead_model::robot::{Pose, Posture, Robot, cast, point_from_tool};
use stead_model::task::{PathPoint, Task};
use stead_numerics::message::Note;
use stead_numerics::scalar::Scalar;

/// How every statement begins that collisions are not checked.
pub const UNCHECKED: &str = "collisions were not checked";

pub use super::cell::{Cell, Interval};
pub use super::placement::Placement;

/// A path point with its wrench, put by a placement into the robot base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedPoint<T: Scalar = f64> {
    /// Tool centre point. m
    pub tip: Vector3<T>,
    /// The point's axes as columns: the feed (made normal to the tool axis), the left of the feed, the tool axis.
    pub axes: Matrix3<T>,
    /// The axes along which the deflection is scored: the same, but for a tool that leans, where they are those of the
    /// path.
    pub scored_axes: Matrix3<T>,
    /// Force on the tool. N
    pub force: Vector3<T>,
    /// Moment on the tool. N m
    pub moment: Vector3<T>,
}

/// What every point of a plan must satisfy, joint limits apart.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Constraints {
    /// Smallest 1/kappa_F (Caro 2013, eq. 26).
    pub min_inverse_condition: f64,
    /// Characteristic length that makes the Jacobian's position rows comparable with its rotation rows. m
    pub characteristic_length: f64,
    /// Largest score of a point, c_max (Caro 2013, eq. 22), where one is set. m
    pub max_deflection: Option<f64>,
    /// Smallest distance of any path point from axis 1, so that no workpiece stands in the robot's column. m
    pub min_base_distance: f64,
    /// The margin that the limits of the robot's joints have in them already ([`Robot::with_joint_margin`]). rad
    pub joint_margin: f64,
}

/// Where the free angle beta may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BetaPlan {
    /// From point to point, within its limits.
    #[default]
    Free,
    /// From segment to segment alone.
    ConstantPerSegment,
    /// Nowhere: one beta for the whole path.
    Constant,
}

impl BetaPlan {
    /// As files state it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::ConstantPerSegment => "constant_per_segment",
            Self::Constant => "constant",
        }
    }
}

/// How the free angle beta about the tool axis is planned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Redundancy {
    /// Number of grid values of beta over a full turn.
    pub beta_count: usize,
    /// Feed speed where the task states none; with the joint speeds it bounds the joint step from point to point. m/s
    pub feed: f64,
    /// Largest change of beta along the path, where one is set. rad/m
    pub max_beta_rate: Option<f64>,
    /// Largest angle between the tool frames at neighbouring points along the path, where one is set. rad/m
    pub max_spindle_turn: Option<f64>,
    /// Largest angle between the tool frames at neighbouring points in time, at the feed, where one is set. rad/s
    pub max_spindle_speed: Option<f64>,
    /// Where beta may change; what is allowed of its changes must be within the limits above all the same.
    pub beta: BetaPlan,
}

impl Redundancy {
    /// So many values of beta over a turn, at this feed (m/s) where the task states none, and beta free without limits
    /// of its own.
    pub fn new(beta_count: usize, feed: f64) -> Self {
        let (max_beta_rate, max_spindle_turn, max_spindle_speed) = (None, None, None);
        Self { beta_count, feed, max_beta_rate, max_spindle_turn, max_spindle_speed, beta: BetaPlan::Free }
    }

    /// Step of the grid of beta. rad
    pub fn beta_step(&self) -> f64 {
        TAU / self.beta_count as f64
    }

    /// The same planning on the grid of beta divided by the smallest whole number that makes its step no wider than
    /// `max_step` (rad): every state of the old grid is one of the new.
    pub fn divided(&self, max_step: f64) -> Self {
        let parts = (self.beta_step() / max_step - 1e-9).ceil().max(1.0) as usize;
        Self { beta_count: self.beta_count * parts, ..*self }
    }

    /// Grid value of beta, from -pi upwards. rad
    pub fn beta(&self, index: usize) -> f64 {
        -PI + self.beta_step() * index as f64
    }
}

/// A joint step is never as large as half a turn. rad
pub const MAX_JOINT_STEP: f64 = PI - 1e-6;
/// The largest step of a joint while the tool turns in place, which no feed bounds: with a larger one the straight turn
/// of a controller can lead the joint round the other way, to an angle a turn away. rad
const MAX_STEP_IN_PLACE: f64 = 2.0 * PI / 3.0;

/// The placement problem: its [parts](ProblemParts), which agree.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    parts: ProblemParts,
}

impl Problem {
    /// The same problem where the best plan of a segment is taken whatever the moves: what placements are compared by.
    pub fn without_tie_rule(&self) -> Cow<'_, Self> {
        if self.postures.tie == 0.0 {
            return Cow::Borrowed(self);
        }
        let postures = PostureRules { tie: 0.0, ..self.postures };
        Cow::Owned(Self { parts: ProblemParts { postures, ..self.parts.clone() } })
    }

    /// The same problem with the arm's own joint limits.
    #[must_use]
    pub fn to_its_limits(&self) -> Self {
        let constraints = Constraints { joint_margin: 0.0, ..self.constraints };
        Self { parts: ProblemParts { robot: self.robot_to_its_limits(), constraints, ..self.parts.clone() } }
    }

    /// The arm with its own joint limits, without the margin that plans keep from them.
    pub fn robot_to_its_limits(&self) -> Robot {
        // An arm that could be narrowed can be widened again.
        self.robot.with_joint_margin(-self.constraints.joint_margin).unwrap_or_else(|_| self.robot.clone())
    }

    /// What looks like a wrong unit or sign though it is possible, in sentences.
    pub fn notes(&self) -> Vec<Note> {
        let parts = [
            plausibility::spindle(&self.spindle),
            plausibility::path(self.task.path()),
            plausibility::force(self.largest_force()),
            plausibility::feed((0..self.task.segments().len()).map(|k| self.programmed_feed(k)).fold(0.0, f64::max)),
            plausibility::characteristic_length(self.constraints.characteristic_length),
            self.tool_axes_from_below(),
            self.cell.note(),
        ];
        let has_moves = self.task.segments().len() > 1;
        let of_tool = self.segment_moves.tool.iter().filter(|_| has_moves).flat_map(|tool| tool.notes());
        let turns = [
            ("redundancy.max_beta_rate_deg_per_mm", self.redundancy.max_beta_rate.map(|rate| rate * 1e-3)),
            ("redundancy.max_spindle_turn_deg_per_mm", self.redundancy.max_spindle_turn.map(|rate| rate * 1e-3)),
            ("redundancy.max_spindle_turn_deg_per_s", self.redundancy.max_spindle_speed),
        ];
        let stated = turns.into_iter().filter_map(|(key, limit)| Some((key, limit?.to_degrees())));
        let turns = plausibility::run(&stated.collect::<Vec<_>>());
        let matrices = plausibility::matrices(&self.robot, &self.spindle, &self.task)
            .into_iter()
            .chain(plausibility::softer_than_the_arm(&self.robot, &self.spindle, &self.task))
            .chain(plausibility::carried(&self.spindle))
            .chain(turns);
        let parts = parts.into_iter().flatten().chain(matrices).map(Note::may_be_wrong);
        let of_tool = of_tool.map(|text| Note::not_checked("tool on moves", text));
        let of_arm = plausibility::arm(&self.robot).into_iter();
        of_arm.chain(parts).chain(plausibility::scored_arm(&self.robot)).chain(of_tool).collect()
    }

    /// The largest force along the path. N
    pub fn largest_force(&self) -> f64 {
        self.task.wrenches().map(|wrench| wrench.force.norm()).fold(0.0, f64::max)
    }

    /// That most tool axes point downwards in the cell however the part lies; not where a turntable may tilt it.
    fn tool_axes_from_below(&self) -> Option<String> {
        let tilts = |axis: &ExternalAxis| axis.kind == AxisKind::Turntable && axis.direction.z.abs() < 1.0 - 1e-9;
        if self.external_axes.iter().any(tilts) {
            return None;
        }
        let note = |task: &Task| plausibility::tool_axes(task.points().iter().map(|point| &point.axis), "in the cell");
        let mut notes = self.orientations.iter().map(|orientation| note(&orientation.task));
        match notes.next() {
            None => note(&self.task),
            // Any orientation that is right will do.
            Some(first) => notes.fold(first, |last, next| last.and(next)),
        }
    }

    /// That collisions are not checked, where nothing stands around the robot, or nothing but shapes of the arm itself.
    pub fn unchecked_collisions(&self) -> Option<Note> {
        let note = |text: String| Note::not_checked("collisions", text);
        let Some(scene) = self.scene.as_deref() else {
            return Some(note(format!(
                "{UNCHECKED}: nothing stands around the robot (surroundings, [[shape]] or [[keep_out]] of the run file)"
            )));
        };
        let around = scene.surroundings();
        let is_own = |shape: &Shape| matches!(shape.attached, Attachment::Link(_) | Attachment::Flange);
        (around.zones().is_empty() && around.shapes().iter().all(is_own)).then(|| {
            note(format!("{UNCHECKED} but between parts of the arm: nothing else is among the shapes, and nothing stands around the robot"))
        })
    }

    /// The flange frame in the base frame at a free angle (rad) for a point whose frame stands in the base frame as
    /// given.
    pub fn flange_at<T: Scalar>(&self, base_from_point: &Pose<T>, beta: T) -> Pose<T> {
        let point_from_tool = Pose { rotation: point_from_tool(beta), translation: Vector3::zeros() };
        base_from_point.then(&point_from_tool).then(&self.spindle.flange_from_tool.inverse().cast())
    }

    /// The frame of path point `point` in the base frame: its axes are the feed, the left of the feed and the tool
    /// axis.
    pub fn base_from_point<T: Scalar>(&self, point: usize, placement: &Placement<T>) -> Pose<T> {
        let path_point = &self.task.points()[point];
        let workpiece_from_point = Pose {
            rotation: path_point.workpiece_from_point().map(T::constant),
            translation: cast(&path_point.position),
        };
        self.base_from_workpiece(point, placement).then(&workpiece_from_point)
    }

    /// Path point `point` and its wrench in the robot base frame, the workpiece at a placement.
    pub fn placed<T: Scalar>(&self, point: usize, placement: &Placement<T>) -> PlacedPoint<T> {
        let workpiece = self.base_from_workpiece(point, placement);
        let (path_point, wrench) = (&self.task.points()[point], &self.task.loads()[point].wrench);
        PlacedPoint {
            tip: workpiece.point(&cast(&path_point.position)),
            axes: workpiece.rotation * path_point.workpiece_from_point().map(T::constant),
            scored_axes: workpiece.rotation * self.task.path().scored_axes(point).map(T::constant),
            force: workpiece.rotation * cast(&wrench.force),
            moment: workpiece.rotation * cast(&wrench.moment),
        }
    }

    /// Distance of a point given in the base frame from axis 1. m
    pub fn base_distance<T: Scalar>(&self, position: &Vector3<T>) -> T {
        let g = self.robot.geometry();
        let from_root = position - cast(&g.root_in_base);
        let axis = cast(&g.base_from_root.column(2).into_owned());
        let across = from_root - axis * from_root.dot(&axis);
        across.dot(&across).sqrt()
    }

    /// The normal of the surface at a path point in the base frame, with the workpiece placed, where the task states
    /// it.
    pub fn surface_normal<T: Scalar>(&self, point: usize, placement: &Placement<T>) -> Option<Vector3<T>> {
        let normals = self.task.path().surface_normals()?;
        Some(self.base_from_workpiece(point, placement).rotation * cast(&normals[point]))
    }

    /// The feed at every path point in the base frame, with the workpiece placed.
    pub fn feeds(&self, placement: &Placement) -> Vec<Vector3<f64>> {
        let feed =
            |(number, point): (usize, &PathPoint)| self.base_from_workpiece(number, placement).rotation * point.feed;
        self.task.points().iter().enumerate().map(feed).collect()
    }

    /// Time from path point `point - 1` to `point`, both in one segment: at the feed of the task, or at the given one
    /// where it states none; infinite for a turn of the tool in place, which the controller takes its own time for. s
    pub fn step_time(&self, point: usize) -> f64 {
        self.task.path().step_time(point, self.redundancy.feed)
    }

    /// The highest feed that is programmed for a segment (from 0). m/s
    pub fn programmed_feed(&self, segment: usize) -> f64 {
        self.task.path().highest_feed(segment).unwrap_or(self.redundancy.feed)
    }

    /// Distance along the path from point `point - 1` to `point`. m
    pub fn step_length(&self, point: usize) -> f64 {
        self.task.path().step_length(point)
    }

    /// Largest step of each joint from path point `point - 1` to `point`: what its speed allows at the feed, and in any
    /// case less than half a turn, since a joint that turns farther between two neighbours does not follow the path; a
    /// third of a turn where the tool turns in place. rad
    pub fn joint_steps(&self, point: usize) -> [f64; 6] {
        let time = self.step_time(point);
        let most = if self.task.path().turns_in_place(point) { MAX_STEP_IN_PLACE } else { MAX_JOINT_STEP };
        std::array::from_fn(|j| self.robot.joints()[j].max_speed.map_or(most, |speed| most.min(speed * time)))
    }

    /// The schemes to choose from where the posture may not change: each allowed posture, for every segment; nothing
    /// where each segment has its own, or a scheme is given.
    pub fn unchanging_schemes(&self, scheme: Option<&[Posture]>) -> Vec<Vec<Posture>> {
        let segments = self.task.segments().len();
        match scheme {
            None if !self.postures.may_change => self.postures.allowed().map(|one| vec![one; segments]).collect(),
            _ => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::five_segments;

    #[test]
    fn a_divided_grid_has_the_old_values_in_it() {
        let coarse = Redundancy { beta_count: 30, ..five_segments().redundancy };
        let fine = coarse.divided(1.0_f64.to_radians());
        assert_eq!(fine.beta_count, 360);
        assert!((0..30).all(|k| (coarse.beta(k) - fine.beta(12 * k)).abs() < 1e-12));
        assert_eq!(fine.divided(1.0_f64.to_radians()), fine);
    }
}
