//! What a run states, in figures to compare with what was meant: before any search.

use super::problem::{Interval, Placement, Problem};
use super::symmetry::is_axis_1_vertical;
use nalgebra::Vector3;
use serde::Serialize;
use std::f64::consts::TAU;
use stead_model::robot::Robot;
use stead_model::robot::turns::Range;
use stead_numerics::mean_max::MeanAndMax;

/// What a run states of its spindle, tool path, forces and cell.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Overview {
    /// Angle between the tool axis and the axis of the flange. rad
    pub tool_tilt: f64,
    /// Smallest and largest x, y and z of the path in the workpiece frame. m
    pub extents: [[f64; 2]; 3],
    /// Length of each segment. m
    pub segment_lengths: Vec<f64>,
    /// Smallest and largest angle between the tool axis and z of the workpiece. rad
    pub tilts: [f64; 2],
    /// Size of the forces. N
    pub force: MeanAndMax,
    /// Size of the moments about the tool centre point. N m
    pub moment: MeanAndMax,
    /// The farthest that the wrist centre gets from axis 1. m
    pub reach: f64,
    /// Smallest and largest distance of places of the cell from axis 1. m
    pub cell_distances: [f64; 2],
    /// The workpiece in the middle of its cell.
    pub middle: Stance,
}

/// What the arm reaches of the path at one placement, each point by itself: within the joint limits, at some free angle and in some
/// allowed posture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stance {
    /// The placement.
    pub placement: Placement,
    /// How many points were tried.
    pub tried: usize,
    /// How many of them are reached.
    pub reached: usize,
    /// Joint angles at the first point that is reached. rad
    pub joints: Option<[f64; 6]>,
}

/// Most points of a path that are tried.
const TRIED: usize = 200;
/// Free angles that are tried at each.
const ANGLES: usize = 36;

impl Overview {
    /// That of a problem.
    pub fn of(problem: &Problem) -> Self {
        let points = problem.task.points();
        let extents = std::array::from_fn(|axis| range(points.iter().map(|point| point.position[axis])));
        let path = problem.task.path();
        let sizes = |of: fn(&stead_model::task::Wrench) -> f64| MeanAndMax::of(problem.task.wrenches().iter().map(of));
        let tool = &problem.spindle.flange_from_tool.rotation;
        Self {
            tool_tilt: libm::acos(tool.m33.clamp(-1.0, 1.0)),
            extents,
            segment_lengths: (0..path.segments().len()).map(|segment| path.segment_length(segment)).collect(),
            tilts: range(points.iter().map(|point| libm::acos(point.axis.z.clamp(-1.0, 1.0)))),
            force: sizes(|wrench| wrench.force.norm()),
            moment: sizes(|wrench| wrench.moment.norm()),
            reach: problem.robot.geometry().reach(),
            cell_distances: cell_distances(problem),
            middle: stance(problem, middle(problem)),
        }
    }

    /// What looks wrong beyond [`Problem::notes`], in sentences.
    pub fn notes(&self) -> Vec<String> {
        let Stance { tried, reached, .. } = self.middle;
        let unreached = (reached < tried).then(|| {
            format!(
                "with the workpiece in the middle of its cell the arm reaches {reached} of {tried} path points within its joint \
                 limits, at any angle about the tool: `stead explain` says why at a placement"
            )
        });
        unreached.into_iter().collect()
    }
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)])
}

/// The middle of the cell.
fn middle(problem: &Problem) -> Placement {
    let [x, y, z] = problem.cell.position.map(|bounds| (bounds.min + bounds.max) / 2.0);
    let yaw = problem.cell.yaw;
    Placement { x, y, z, yaw: (yaw.min + yaw.max) / 2.0 }
}

/// Projections between cell and axis 1 until the nearest place is found.
const PROJECTIONS: usize = 500;

/// From the nearest to the farthest place of the cell, from axis 1.
fn cell_distances(problem: &Problem) -> [f64; 2] {
    let root = problem.robot.geometry().root_in_base;
    let [x, y, z] = problem.cell.position;
    if !is_axis_1_vertical(problem) {
        // The nearest place of a box to a line, by projections onto one and the other; the farthest is a corner.
        let axis = problem.robot.geometry().base_from_root.column(2).into_owned();
        let inside = |p: &Vector3<f64>| Vector3::new(x.clamp(p.x), y.clamp(p.y), z.clamp(p.z));
        let on_axis = |p: &Vector3<f64>| root + axis * axis.dot(&(p - root));
        let nearest = (0..PROJECTIONS).fold(inside(&root), |place, _| inside(&on_axis(&place)));
        let corners = (0..8).map(|corner: u32| {
            let end = |bounds: Interval, bit: u32| if corner >> bit & 1 == 1 { bounds.max } else { bounds.min };
            problem.base_distance(&Vector3::new(end(x, 0), end(y, 1), end(z, 2)))
        });
        return [problem.base_distance(&nearest), corners.fold(0.0, f64::max)];
    }
    let nearest = [x.clamp(root.x) - root.x, y.clamp(root.y) - root.y];
    let farthest = [(x, root.x), (y, root.y)].map(|(bounds, at)| (bounds.min - at).abs().max((bounds.max - at).abs()));
    [nearest, farthest].map(|[x, y]| libm::hypot(x, y))
}

fn stance(problem: &Problem, placement: Placement) -> Stance {
    let count = problem.task.points().len();
    let tried = count.min(TRIED);
    let found = (0..tried).map(|k| reached(problem, &placement, k * count / tried));
    let mut stance = Stance { placement, tried, reached: 0, joints: None };
    for joints in found.flatten() {
        stance.reached += 1;
        stance.joints = stance.joints.or(Some(joints));
    }
    stance
}

/// The joint angles within the limits that reach a point, those of the largest distance from a limit.
fn reached(problem: &Problem, placement: &Placement, point: usize) -> Option<[f64; 6]> {
    let betas = (0..ANGLES).map(|k| TAU * k as f64 / ANGLES as f64);
    let flanges = betas.map(|beta| problem.base_from_flange(point, placement, beta));
    let allowed = || problem.postures.allowed();
    flanges
        .flat_map(|flange| allowed().filter_map(move |posture| problem.robot.inverse(&flange, posture).ok()))
        .filter_map(|wrapped| within(&problem.robot, &wrapped))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(joints, _)| joints)
}

/// The real angles of wrapped ones, and their smallest distance from a limit; none beyond the limits. rad
fn within(robot: &Robot, wrapped: &[f64; 6]) -> Option<([f64; 6], f64)> {
    let (mut joints, mut margin) = (*wrapped, f64::INFINITY);
    for (angle, joint) in joints.iter_mut().zip(robot.joints()) {
        let middle = (joint.min + joint.max) / 2.0;
        let off = |real: &f64| (real - middle).abs();
        *angle = Range::of(joint).real_angles(*angle).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        margin = margin.min((*angle - joint.min).min(joint.max - *angle));
    }
    Some((joints, margin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::five_segments;

    #[test]
    fn the_published_run_is_understood() {
        let problem = five_segments();
        let overview = Overview::of(&problem);
        assert!((overview.tool_tilt.to_degrees() - 45.0).abs() < 1e-4);
        assert_eq!(overview.segment_lengths.len(), 5);
        assert_eq!(overview.tilts, [0.0, 0.0]);
        assert!((overview.force.max - problem.task.wrenches()[0].force.norm()).abs() < 1e3);
        assert!(overview.reach > 2.6 && overview.cell_distances[0] < overview.cell_distances[1]);
        assert_eq!(overview.middle.tried, 105);
        // What is said to be reached is: the flange is where the first point wants it.
        let joints = overview.middle.joints.unwrap();
        let tool = problem.robot.forward(&joints).then(&problem.spindle.flange_from_tool);
        let place = overview.middle.placement.base_from_workpiece().point(&problem.task.points()[0].position);
        assert!((tool.translation - place).norm() < 1e-9);
    }

    #[test]
    fn a_cell_out_of_reach_is_noted() {
        let mut problem = five_segments();
        problem.cell.position[0] = crate::problem::Interval { min: 9.0, max: 9.5 };
        let overview = Overview::of(&problem);
        assert_eq!((overview.middle.reached, overview.middle.joints), (0, None));
        assert!(overview.notes()[0].contains("reaches 0 of 105 path points"));
    }
}
