//! `page-data.json`: what a page shows beyond the tables beside it.

use super::body::BodyData;
use super::clearance::{ClearanceData, changing};
use super::map_data::MapData;
use super::moves::{MoveData, moves};
use super::packed::singles;
use super::pose::PoseData;
use super::removal::RemovalData;
use super::setup::{AxisData, external_axes, part_turns};
use super::shapes::bodies;
use super::surroundings::surroundings;
use crate::figure::{AngleDeg, DeflectionMm, PlaceMm, each, some};
use crate::placement::context::{CaseOfStudy, Context};
use nalgebra::Vector3;
use serde_json::Value;
use stead_model::robot::{Axes23, Compliance, Controller, Joint, Robot};
use stead_numerics::message::NoteGroup;
use stead_placement::outcome::Case;
use stead_planning::feasibility::DeflectionMap;
use stead_problem::criterion::Direction;
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::Setup;

/// A deflection map with the placement and the setup that it is of and the name of its table.
pub(crate) type MapOf<'a> = (Placed<'a>, &'a DeflectionMap, &'static str);

/// A placement with the setup of the cell.
pub(crate) type Placed<'a> = (&'a Placement, &'a Setup);

records! {
    /// The content of `page-data.json`. Lists of numbers are in single precision, little endian, as Base64.
    pub struct PageData of (
        command: &str, problem: &Problem, run: &Context, plans: &[&Case], maps: &[MapOf<'_>]
    ) {
        let map =
            |((placement, setup), map, table): &MapOf<'_>| MapData::of(&problem.in_setup(setup), placement, map, table);
        let computed = run.notes.iter().filter(|note| note.group() == NoteGroup::Computed);
        let computed: Vec<String> = computed.map(ToString::to_string).collect();
    } with {
        /// The command that left it.
        command: String = command.to_owned(),
        /// Which case of a study it is, where it is one.
        study_case?: CaseOfStudy = run.study_case.clone(),
        /// Those of the notes that are on how it was computed, where there are any: paper leaves these to `notes.txt`.
        computed_notes?: Vec<String> = (!computed.is_empty()).then_some(computed),
        /// The arm.
        robot: RobotData = RobotData::of(problem),
        /// The tool frame in the frame of the flange.
        spindle: PoseData = (&problem.spindle.flange_from_tool).into(),
        /// Where the workpiece may be.
        cell: CellData = CellData::of(problem),
        /// Limits of a state.
        limits: LimitData = LimitData::of(problem),
        /// What is scored.
        criterion: CriterionData = CriterionData::of(problem),
        /// The path.
        task: TaskData = TaskData::of(problem),
        /// Joint angles of the deflection maps.
        maps: Vec<MapData> = maps.iter().map(map).collect(),
        /// What moves with the arm, the tool and the workpiece.
        bodies: Vec<BodyData> = bodies(problem).iter().map(Into::into).collect(),
        /// What stands in the cell.
        surroundings: Vec<BodyData> = surroundings(problem).iter().map(Into::into).collect(),
        /// External axes.
        external_axes: Vec<AxisData> = external_axes(problem),
        /// For each plan the rotation from the workpiece frame that the page has the task in to the frame that is
        /// placed; null where there is one orientation.
        part_turns: Option<Vec<[[f64; 3]; 3]>> = part_turns(problem, plans),
        /// For each plan its moves between segments, null where a move is straight in joint space; left out where no
        /// plan has a path round shapes.
        moves?: Vec<Vec<Option<MoveData>>> = moves(problem, &run.transfer, plans),
        /// For each plan its least room without the pairs whose distance does not change along it, null where no such
        /// pair has the least room; left out where that is so of all plans.
        clearances?: Vec<Option<ClearanceData>> = changing(problem, plans),
        /// What the path removes of its stock, where the run has one.
        removal?: RemovalData = run.removal.as_ref().map(|removal| RemovalData::of(problem, removal)),
    }

    /// An arm by its Denavit-Hartenberg rows.
    pub struct RobotData of (problem: &Problem) {
        let robot = &problem.robot;
    } with {
        /// Its name.
        name: String = robot.name().to_owned(),
        /// The rows.
        rows: Vec<RowData> = robot.joints().iter().map(RowData::of).collect(),
        /// What joins axes 2 and 3, where anything does.
        axes_2_3?: AxesData = robot.axes_2_3().map(AxesData::of),
        /// How its controller counts the joints, where it is known.
        controller?: ControllerData = robot.controller().map(|controller| ControllerData::of(robot, controller)),
        /// Its base in the cell, where it is mounted.
        mount: Option<PoseData> = robot.is_mounted().then(|| (&robot.cell_from_base()).into()),
    }

    /// The angles of a controller: that of each joint is at_zero_deg + sign theta, and to that of axis 3 comes a3_by_a2
    /// times what joint 2 gives to that of axis 2.
    pub struct ControllerData of (robot: &Robot, controller: &Controller) {
        /// What it shows where the angles of the rows are zero. deg
        at_zero_deg: [f64; 6] = controller.angles(robot, &[0.0; 6]).map(|angle| angle.to_degrees() + 0.0),
        /// 1 where it counts in the direction of the row, else -1.
        sign: [f64; 6] = controller.sign,
        /// How the angle of axis 2 counts in that of axis 3: 0 but where this is against the horizontal.
        a3_by_a2: f64 = controller.a3_by_a2(robot),
    }

    /// What joins axes 2 and 3.
    pub struct AxesData of (axes: &Axes23) {
        /// Whether a parallelogram drives axis 3.
        linkage: bool = axes.linkage,
        /// Lower limit of the sum of joints 2 and 3.
        sum_min_deg: AngleDeg = axes.sum.min.into(),
        /// Upper limit of the sum of joints 2 and 3.
        sum_max_deg: AngleDeg = axes.sum.max.into(),
    }

    /// A Denavit-Hartenberg row with the limits of its joint.
    pub struct RowData of (joint: &Joint) {
        /// Twist. deg
        alpha_deg: f64 = joint.alpha.to_degrees(),
        /// Length. mm
        a_mm: f64 = joint.a * 1e3,
        /// Offset. mm
        d_mm: f64 = joint.d * 1e3,
        /// Lower limit.
        min_deg: AngleDeg = joint.min.into(),
        /// Upper limit.
        max_deg: AngleDeg = joint.max.into(),
        /// Compliance of the joint about its axis, at angles that go evenly from the lower limit to the upper one; one
        /// number where it is the same at all. urad/(N m)
        compliance_urad_per_nm: Vec<f64> = compliances(joint),
    }

    /// Where the workpiece origin may be: ends of intervals.
    pub struct CellData of (problem: &Problem) {
        let [x_mm, y_mm, z_mm] = problem.cell.position.map(|interval| each([interval.min, interval.max]));
    } with {
        /// Along x.
        x_mm: [PlaceMm; 2] = x_mm,
        /// Along y.
        y_mm: [PlaceMm; 2] = y_mm,
        /// Along z.
        z_mm: [PlaceMm; 2] = z_mm,
    }

    /// Limits of a state.
    pub struct LimitData of (problem: &Problem) {
        /// Least inverse condition number of the Jacobian.
        min_inverse_condition: f64 = problem.constraints.min_inverse_condition,
        /// Largest deflection.
        max_deflection_mm: Option<DeflectionMm> = some(problem.constraints.max_deflection),
    }

    /// What is scored.
    pub struct CriterionData of (problem: &Problem) {
        /// The direction; null where the weights name no single one.
        direction: Option<&'static str> = problem.criterion.direction().map(Direction::name),
        /// How the scores of the points make one.
        aggregate: &'static str = problem.criterion.aggregate.name(),
    }

    /// A path in the workpiece frame.
    pub struct TaskData of (problem: &Problem) {
        let points = problem.task.points();
        let all = |of: fn(&stead_model::task::PathPoint) -> Vector3<f64>, factor: f64| {
            singles(points.iter().flat_map(|point| <[f64; 3]>::from(of(point) * factor)))
        };
        let directions = |point: usize| problem.scored_directions(point, &points[point].workpiece_from_point());
        let scored = |k: usize| {
            singles((0..points.len()).flat_map(|point| <[f64; 3]>::from(directions(point).padded()[k])))
        };
        let most = (0..points.len()).map(|point| directions(point).vectors().len()).max().unwrap_or(0);
        let moments = || problem.task.wrenches().map(|wrench| wrench.moment);
        let starts: Vec<usize> = problem.task.segments().iter().map(|segment| segment.start).collect();
        let step = |point: usize| {
            let time = if starts.contains(&point) { 0.0 } else { problem.step_time(point) };
            if time.is_finite() { time } else { 0.0 }
        };
    } with {
        /// Points.
        points: usize = points.len(),
        /// Segments.
        segments: usize = starts.len(),
        /// Their places.
        position_mm: String = all(|point| point.position, 1e3),
        /// Directions of the feed.
        feed: String = all(|point| point.feed, 1.0),
        /// Tool axes.
        axis: String = all(|point| point.axis, 1.0),
        /// The directions that are scored, each with the root of its weight: one to three lists, zero at points that
        /// have fewer.
        scored: Vec<String> = (0..most).map(scored).collect(),
        /// Moments on the tool about the tool centre point, where there are any. N m
        moment_nm?: String = moments()
            .any(|moment| moment != Vector3::zeros())
            .then(|| singles(moments().flat_map(<[f64; 3]>::from))),
        /// Time from each point to the next at the programmed feed.
        step_s: String = singles((0..points.len()).map(step)),
    }
}

/// The content of `page-data.json` of a problem, its maps and its plans.
pub(crate) fn page_data(run: &Context, command: &str, problem: &Problem, plans: &[&Case], maps: &[MapOf<'_>]) -> Value {
    run.document().with(PageData::of(command, problem, run, plans, maps))
}

/// Compliances along the range of a joint that follow a curve.
const CURVED: usize = 65;

/// The compliance of a joint at angles that go evenly from its lower limit to its upper one. urad/(N m)
fn compliances(joint: &Joint) -> Vec<f64> {
    let count = match joint.compliance {
        Compliance::Constant(_) => 1,
        Compliance::Range { .. } => 2,
        Compliance::Compensated { .. } => CURVED,
    };
    let angle = |k: usize| joint.min + (joint.max - joint.min) * k as f64 / (count - 1).max(1) as f64;
    (0..count).map(|k| joint.compliance_at(angle(k)) * 1e6).collect()
}
