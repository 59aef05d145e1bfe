//! What a fitter needs to set a placement up and to check it: where the part, the robot and the external axes stand, in
//! the frame that the pendant shows where that is known; points to drive to; and by how much the part may be off.

mod moves;
mod tolerance;

pub use tolerance::{Allowed, Blocked, OffDirection, RISES, Tolerance, Tolerances};

use crate::case::{Case, Plan, PlanPoint};
use moves::joint_moves;
use nalgebra::Vector3;
use serde::Serialize;
use std::sync::Arc;
use stead_cell::{Attachment, Solid};
use stead_model::external_axis::{AxisKind, Carried, ExternalAxis, carried};
use stead_model::robot::turns::Range;
use stead_model::robot::{ControllerKind, Pose, kuka_status_and_turn};
use stead_numerics::message::Warning;
use stead_numerics::monitor::Monitor;
use stead_planning::redundancy::SegmentPlan;
use stead_planning::transfer_path::{Space, transfer_path};
use stead_problem::problem::{Placement, Problem};
use tolerance::tolerances;

/// The frame in which a sheet states places.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SheetFrame {
    /// The root of the controller, which the pendant shows.
    Root,
    /// The base frame of the rows, where the robot file does not say where the controller's root is, or has it at a
    /// slant.
    Base,
    /// The cell frame, of a mounted robot, or of one that external axes carry: then the base frame with all axes at
    /// zero.
    Cell,
}

/// An external axis as it is set up.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisSetup {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: AxisKind,
    /// What stands on it.
    pub carries: Carried,
    /// The least and the largest position along the plan, which are one where it stands still. m or rad
    pub positions: [f64; 2],
    /// Its direction in the frame of the sheet, all axes at zero.
    pub direction: Vector3<f64>,
    /// A point on it there. m
    pub point: Vector3<f64>,
}

/// A point to which the tool is driven to check a setup.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckPoint {
    /// The path point, from 0.
    pub point: usize,
    /// The tool frame in the frame of the sheet. m
    pub tool: Pose<f64>,
    /// The same in the root of the controller as the robot stands, where that is known and another frame. m
    pub in_root: Option<Pose<f64>>,
    /// Joint angles of the rows. rad
    pub joints: [f64; 6],
    /// Joint angles as the controller counts them, where that is known. rad
    pub controller: Option<[f64; 6]>,
    /// Status and turn of a KUKA controller.
    pub status_and_turn: Option<[u8; 2]>,
    /// Positions of the external axes. m or rad
    pub axes: Vec<f64>,
}

/// What is known of the ways between check points, one after the other: out along the tool axis, a joint move, and in
/// again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ways {
    /// There is one point alone.
    None,
    /// Nothing is known: there are no shapes.
    NotChecked,
    /// They hit nothing.
    Free,
    /// In no order of the points do they hit nothing.
    Blocked,
}

/// The least room of something, and the pair of shapes that has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Room {
    /// How far they are apart. m
    pub distance: f64,
    /// Their names.
    pub names: Arc<[String; 2]>,
}

/// How near a plan comes to a limit of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestLimit {
    /// The joint, from 0; none for the sum of joints 2 and 3.
    pub joint: Option<usize>,
    /// Whether it is the upper one.
    pub is_upper: bool,
    /// The path point, from 0.
    pub point: usize,
    /// How far it stays from the limit of the arm. rad
    pub distance: f64,
}

/// What a fitter needs to set a placement up.
#[derive(Debug, Clone, PartialEq)]
pub struct SetupSheet {
    /// The frame of all places.
    pub frame: SheetFrame,
    /// The part, as its task file has it, in that frame: its origin is the datum. With all external axes at zero.
    pub part: Pose<f64>,
    /// The root of the controller, where it is known, else the base frame of the rows, in that frame; where the robot
    /// stands at the first point of the path.
    pub robot: Pose<f64>,
    /// Whether that is the root of the controller.
    pub is_root: bool,
    /// The tool frame on the mounting flange.
    pub flange_from_tool: Pose<f64>,
    /// Diameter of the cutter, where the run states it. m
    pub cutter_diameter: Option<f64>,
    /// Height of the top of the shape named `floor`, where there is one. m
    pub floor: Option<f64>,
    /// External axes.
    pub axes: Vec<AxisSetup>,
    /// Three points that are far from each other, two where the path is straight, one where it is a point: in an order
    /// whose ways are free, where there is one.
    pub check_points: Vec<CheckPoint>,
    /// What is known of the ways between them.
    pub ways: Ways,
    /// The least room on joint moves between segments, where there are shapes and such moves.
    pub room_on_moves: Option<Room>,
    /// Whether there are shapes, by which collisions are looked for.
    pub has_shapes: bool,
    /// How near the plan comes to a limit of a joint.
    pub nearest_limit: Option<NearestLimit>,
    /// By how much the part may be off, or why that is not known.
    pub tolerances: Result<Tolerances, String>,
    /// The cell frame in the frame of the sheet: what draws the cell goes through it.
    pub sheet_from_cell: Pose<f64>,
}

/// Places that differ by less are one. m
const SAME: f64 = 1e-3;

/// Why tolerances are not there after a stop.
const INTERRUPTED: &str = "interrupted";

impl SetupSheet {
    /// The warning that a stop left the tolerances out.
    pub fn left_out(&self) -> Option<Warning> {
        let is_interrupted = self.tolerances.as_ref().is_err_and(|why| why == INTERRUPTED);
        is_interrupted.then(|| Warning::left_out("the tolerances of the setup sheet are"))
    }

    /// The sheet of a case of a problem, whatever its setup.
    pub fn new(problem: &Problem, case: &Case, monitor: &Monitor) -> Self {
        let problem = &*problem.in_setup(&case.setup);
        let (placement, plan) = (&case.placement, &case.plan);
        let robot = &problem.robot;
        let root_from_base = robot.controller().and_then(|controller| controller.root_from_base);
        let (frame, sheet_from_cell) = frame(problem);
        let all_at_zero = placement.base_from_workpiece();
        let part = Pose {
            rotation: all_at_zero.rotation
                * problem.orientation().map_or(nalgebra::Matrix3::identity(), |of| of.rotation),
            ..all_at_zero
        };
        let base_from_root = root_from_base.map_or_else(Pose::identity, |root| root.inverse());
        let cell_from_base = carried(&problem.external_axes, problem.axis_positions(0), Carried::Robot);
        let stands = cell_from_base.then(&robot.cell_from_base()).then(&base_from_root);
        let tolerances = match monitor.should_stop() {
            true => Err(INTERRUPTED.to_owned()),
            false => tolerances(problem, case, sheet_from_cell.rotation.transpose(), monitor),
        };
        let (order, ways) = in_order(problem, placement, plan, spread(problem));
        Self {
            frame,
            part: sheet_from_cell.then(&part),
            robot: sheet_from_cell.then(&stands),
            is_root: root_from_base.is_some(),
            flange_from_tool: robot.on_flange(&problem.spindle.flange_from_tool),
            cutter_diameter: problem.segment_moves.cutter_diameter,
            floor: floor(problem).map(|height| sheet_from_cell.point(&Vector3::new(0.0, 0.0, height)).z),
            axes: axes(problem, plan, &sheet_from_cell),
            check_points: order
                .iter()
                .filter_map(|point| Some(check_point(problem, plan.points.get(*point)?, frame, &sheet_from_cell)))
                .collect(),
            ways,
            room_on_moves: room_on_moves(problem, case),
            has_shapes: problem.scene.is_some(),
            nearest_limit: nearest_limit(problem, plan),
            tolerances,
            sheet_from_cell,
        }
    }
}

/// The frame of a sheet, and its pose.
fn frame(problem: &Problem) -> (SheetFrame, Pose<f64>) {
    let robot = &problem.robot;
    let root_from_base = robot.controller().and_then(|controller| controller.root_from_base);
    let is_carried = problem.external_axes.iter().any(|axis| axis.carries == Carried::Robot);
    let upright = root_from_base.filter(|root| root.rotation[(2, 2)].abs() > 1.0 - 1e-9);
    match upright {
        _ if robot.is_mounted() || is_carried => (SheetFrame::Cell, Pose::identity()),
        Some(root) => (SheetFrame::Root, root),
        None => (SheetFrame::Base, Pose::identity()),
    }
}

/// A state of the plan as the controller shows it.
fn check_point(problem: &Problem, of: &PlanPoint, frame: SheetFrame, sheet_from_cell: &Pose<f64>) -> CheckPoint {
    let robot = &problem.robot;
    // With a mounted robot positions are in the cell frame, as it is with all axes at zero.
    let tool = robot.forward(&of.joints).then(&problem.spindle.flange_from_tool);
    let in_root = robot.controller_root_from_cell().filter(|_| frame != SheetFrame::Root);
    let counted = robot.controller().map(|controller| (controller, controller.angles(robot, &of.joints)));
    let kuka = counted.filter(|(controller, _)| controller.kind == ControllerKind::Kuka);
    let cell_from_base = carried(&problem.external_axes, problem.axis_positions(of.point), Carried::Robot);
    CheckPoint {
        point: of.point,
        tool: sheet_from_cell.then(&cell_from_base).then(&tool),
        in_root: in_root.map(|root| root.then(&tool)),
        joints: of.joints,
        controller: counted.map(|(_, angles)| angles),
        status_and_turn: kuka.map(|(controller, angles)| kuka_status_and_turn(of.posture, controller.sign[2], &angles)),
        axes: problem.axis_positions(of.point).to_vec(),
    }
}

/// The external axes with the ends of their positions.
fn axes(problem: &Problem, plan: &Plan, sheet_from_cell: &Pose<f64>) -> Vec<AxisSetup> {
    let one = |(axis, path): (&ExternalAxis, &stead_problem::setup::AxisPath)| {
        let end = |of: fn(f64, f64) -> f64| path.positions.iter().copied().reduce(of).unwrap_or(0.0);
        AxisSetup {
            name: axis.name.clone(),
            kind: axis.kind,
            carries: axis.carries,
            positions: [end(f64::min), end(f64::max)],
            direction: sheet_from_cell.rotation * axis.direction,
            point: sheet_from_cell.point(&axis.point),
        }
    };
    problem.external_axes.iter().zip(&plan.axes).map(one).collect()
}

/// The height in the cell of the top of a box named `floor` that stands level. m
fn floor(problem: &Problem) -> Option<f64> {
    let shapes = problem.scene.as_deref()?.surroundings().shapes();
    let floor = shapes.iter().find(|shape| shape.name == "floor" && shape.attached == Attachment::Base)?;
    match &floor.solid {
        Solid::Box(edges) if floor.pose.rotation[(2, 2)].abs() > 1.0 - 1e-9 => {
            Some(floor.pose.translation.z + edges.z / 2.0)
        }
        _ => None,
    }
}

/// Up to three points of the path that are far from each other, ascending: the farthest from its middle, the farthest
/// from that, and the farthest from the line through both.
fn spread(problem: &Problem) -> Vec<usize> {
    let points = problem.task.points();
    let middle = points.iter().map(|point| point.position).sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let farthest = |distance: &dyn Fn(&Vector3<f64>) -> f64| {
        let all = points.iter().enumerate().map(|(number, point)| (number, distance(&point.position)));
        all.reduce(|most, next| if next.1 > most.1 { next } else { most })
    };
    let mut chosen = Vec::new();
    let Some((first, _)) = farthest(&|place| (place - middle).norm()) else { return chosen };
    chosen.push(first);
    let from = points[first].position;
    if let Some((second, apart)) = farthest(&|place| (place - from).norm())
        && apart > SAME
    {
        chosen.push(second);
        let along = (points[second].position - from) / apart;
        if let Some((third, aside)) = farthest(&|place| (place - from).cross(&along).norm())
            && aside > SAME
        {
            chosen.push(third);
        }
    }
    chosen.sort_unstable();
    chosen
}

/// Points of a plan in an order in which the tool can be driven from one to the next: out along its axis, by a joint
/// move, and in again.
fn in_order(problem: &Problem, placement: &Placement, plan: &Plan, points: Vec<usize>) -> (Vec<usize>, Ways) {
    if points.len() < 2 {
        return (points, Ways::None);
    }
    let at = |point: usize| {
        let of = plan.points.get(point)?;
        let (betas, joints) = (vec![of.beta], vec![of.joints]);
        Some(SegmentPlan { points: point..point + 1, posture: of.posture, betas, joints, cost: 0.0 })
    };
    let is_free = |pair: &[usize]| {
        let way = transfer_path(problem, placement, [&at(pair[0])?, &at(pair[1])?], 0)?;
        let joint_moves = (1..way.joints.len()).filter(|place| !way.is_along_axis(*place)).count();
        Some(way.blocked_by.is_none() && joint_moves == 1)
    };
    if problem.scene.is_none() {
        return (points, Ways::NotChecked);
    }
    // The same way back is as free, so that of three points the one in the middle decides.
    let orders = (0..points.len()).map(|middle| {
        let mut order = points.clone();
        let of_middle = order.remove(middle);
        order.insert(1, of_middle);
        order
    });
    let free = orders.into_iter().find(|order| order.windows(2).all(|pair| is_free(pair) == Some(true)));
    free.map_or((points, Ways::Blocked), |order| (order, Ways::Free))
}

/// The least room on the joint moves between segments.
fn room_on_moves(problem: &Problem, case: &Case) -> Option<Room> {
    let space = Space::among_shapes(problem, &case.placement)?;
    let rooms = joint_moves(problem, case).into_iter().filter_map(|[from, to]| space.least_room(from, to));
    let (distance, names) = rooms.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Room { distance, names })
}

/// The state of a plan that is nearest to a limit of a joint, of the arm itself without the margin of the run.
fn nearest_limit(problem: &Problem, plan: &Plan) -> Option<NearestLimit> {
    let robot = problem.robot_to_its_limits();
    let all = plan.points.iter().flat_map(|of| {
        let joints = robot.joints().iter().zip(of.joints).enumerate();
        let joints = joints.map(|(joint, (row, angle))| (Some(joint), Range::of(row), angle));
        let sum = robot.sum_range().map(|range| (None, range, robot.sum_of(&of.joints)));
        joints.chain(sum).flat_map(move |(joint, range, angle)| {
            [(angle - range.min, false), (range.max - angle, true)].map(|(distance, is_upper)| NearestLimit {
                joint,
                is_upper,
                point: of.point,
                distance,
            })
        })
    });
    all.collect::<Vec<_>>().into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance))
}

#[cfg(test)]
mod tests;
