//! Requirements of bounds on a problem that is bounded as a whole, and external axes at one position as a larger cell.

use super::arm::{is_base_alike, needed_condition};
use super::cell::{axes_of, extent, points_of};
use super::coarse_bounds::CoarseBounds;
use super::compliance_table::ComplianceTable;
use super::leaning;
use super::model::STEPS;
use nalgebra::Vector3;
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_model::robot::Robot;
use stead_model::stiffness::whole::yields_elsewhere;
use stead_problem::problem::{Cell, Interval, Problem};
use stead_problem::setup::Setup;
use stead_problem::symmetry::{Unsupported, Upright, is_vertical, require_constant};

/// A problem that is bounded as a whole: bounds cover it.
#[derive(Debug)]
pub(super) struct Leaf {
    /// With external axes as a larger cell.
    pub problem: Problem,
    /// What that cell is made of: of arcs that turntables bring the part along.
    pub pieces: Vec<Cell>,
    /// Whether the tool leans at some point of the path.
    pub leans: bool,
}

impl Leaf {
    /// Of a problem, with tables of at most `memory` bytes when they are empty.
    ///
    /// # Errors
    /// All reasons why bounds do not cover it.
    pub fn of(problem: &Problem, memory: u64) -> Result<Self, Vec<Unsupported>> {
        let alone = without_axes(problem);
        let rest = alone.as_deref().unwrap_or(problem);
        let axes = tool_axes(rest);
        let mut reasons: Vec<_> = problem.lean.is_some().then_some(Unsupported::Lean).into_iter().collect();
        reasons.extend(alone.as_ref().err().cloned());
        // That there are external axes was said.
        let of_tool = axes.as_ref().err().filter(|reason| alone.is_ok() || **reason != Unsupported::ExternalAxes);
        reasons.extend(of_tool.cloned());
        reasons.extend([0, 3, 4, 5].iter().filter_map(|joint| require_constant(rest, &[*joint]).err()));
        reasons.extend(unlike_springs(rest));
        if matches!(axes, Ok(1..) | Err(Unsupported::ManyToolAxes { .. })) {
            reasons.extend(not_covered_leaning(rest));
        }
        if alone.is_ok() {
            let needed = needed_condition(rest, extent(rest).radius.0);
            reasons.extend(needed.map(|needed| Unsupported::Conditioning { needed }));
            let bytes = axes.as_ref().map_or(0, |axes| bytes(rest, *axes));
            reasons.extend((bytes > memory).then_some(Unsupported::TooLarge { bytes, max: memory }));
        }
        match (alone, axes) {
            (Ok(alone), Ok(axes)) if reasons.is_empty() => {
                Ok(Self { pieces: pieces(problem), problem: alone.into_owned(), leans: axes > 0 })
            }
            _ => Err(reasons),
        }
    }
}

/// Size of empty tables, for a path of so many tool axes, zero where the tool is upright. bytes
fn bytes(problem: &Problem, axes: usize) -> u64 {
    let extent = extent(problem);
    if axes > 0 {
        return leaning::bytes(extent, axes);
    }
    ComplianceTable::bytes(extent, STEPS)
        .saturating_mul(problem.scored_robots().len() as u64)
        .saturating_add(CoarseBounds::bytes(extent, STEPS, &points_of(problem)))
}

/// The number of tool axes of a path, where the tool is not upright at every point; zero where it is.
fn tool_axes(problem: &Problem) -> Result<usize, Unsupported> {
    match Upright::of(problem) {
        Ok(_) => Ok(0),
        Err(Unsupported::TiltedTool { .. } | Unsupported::UpsideDown { .. }) => {
            let axes = axes_of(problem).len();
            let max = leaning::MOST_AXES;
            if axes > max { Err(Unsupported::ManyToolAxes { axes, max }) } else { Ok(axes) }
        }
        Err(reason) => Err(reason),
    }
}

/// What bounds do not cover of a problem whose tool leans.
fn not_covered_leaning(problem: &Problem) -> Vec<Unsupported> {
    let robots = problem.scored_robots();
    let beyond = [
        ("moments on the tool", has_moments(problem)),
        ("several stiffness sets (criterion.robots)", robots.len() > 1),
        (
            "springs normal to the axes, base, mount and tip",
            robots.iter().any(|robot| yields_elsewhere(robot, &problem.spindle)),
        ),
    ];
    beyond.into_iter().filter(|(_, is_beyond)| *is_beyond).map(|(what, _)| Unsupported::Leaning { what }).collect()
}

fn has_moments(problem: &Problem) -> bool {
    problem.task.wrenches().any(|wrench| wrench.moment.norm() > 0.0)
}

/// What yields beside the joints about their axes without turning with the arm, the tool or the part, or under more
/// than forces.
fn unlike_springs(problem: &Problem) -> Vec<Unsupported> {
    let robots = problem.scored_robots();
    let is_any = |yields: &dyn Fn(&Robot) -> bool| robots.iter().any(yields);
    let beside = |what| Unsupported::YieldsBeside { what };
    let all = [
        (
            beside("base and pedestal that are not alike in every direction about axis 1 ([base_compliance])"),
            is_any(&|robot| !is_base_alike(robot)),
        ),
        (Unsupported::UnlikeFlips, is_any(&|robot| !robot.flips_yield_alike())),
        (
            beside("springs normal to the axes, base or mount under moments on the tool"),
            has_moments(problem) && is_any(&|robot| yields_elsewhere(robot, &problem.spindle)),
        ),
    ];
    all.into_iter().filter(|(_, is_so)| *is_so).map(|(reason, _)| reason).collect()
}

/// The same problem without external axes: rails, and turntables about the vertical, that stay at one place for the
/// whole path shift and turn the workpiece against the robot, so that each place is another cell. The cell holds all of
/// these, and more: every position of the axes with every x, y, z and yaw, and around a turntable the box of what it
/// goes through.
///
/// # Errors
/// [`Unsupported::OtherAxes`] for other axes.
pub(super) fn without_axes(problem: &Problem) -> Result<Cow<'_, Problem>, Unsupported> {
    let axes = &problem.external_axes;
    if axes.is_empty() {
        return Ok(Cow::Borrowed(problem));
    }
    let is_covered = |axis: &ExternalAxis| {
        let is_still = match axis.axis_use {
            AxisUse::Fixed => true,
            AxisUse::Indexed => problem.task.segments().len() == 1,
            AxisUse::Continuous => false,
        };
        is_still && (axis.kind == AxisKind::Rail || is_vertical(&axis.direction))
    };
    if !axes.iter().all(is_covered) {
        return Err(Unsupported::OtherAxes);
    }
    let cell = cell_moved(problem, |_| true);
    let alone = problem.changed(|parts| {
        (parts.external_axes, parts.scene, parts.cell) = (Vec::new(), None, cell);
        parts.setup = Setup { positions: Default::default(), ..parts.setup.clone() };
    });
    alone.map(Cow::Owned).map_err(|_| Unsupported::OtherAxes)
}

/// A cell that holds all places to which some of the external axes bring those of the cell of a problem.
pub(super) fn cell_moved(problem: &Problem, by: impl Fn(&ExternalAxis) -> bool) -> Cell {
    moving(problem)
        .filter(|(axis, _)| by(axis))
        .fold(problem.cell, |cell, (axis, sign)| moved(cell, axis, sign, Interval { min: axis.min, max: axis.max }))
}

/// The external axes in the order in which they move the workpiece against the robot, with the sign of their motion.
///
/// What is carried by several axes is moved by the last one first; a robot that moves one way is a workpiece that moves
/// the other way, and there the first axis moves it first.
fn moving(problem: &Problem) -> impl Iterator<Item = (&ExternalAxis, f64)> {
    let carrying = |what: Carried| problem.external_axes.iter().filter(move |axis| axis.carries == what);
    let workpiece = carrying(Carried::Workpiece).rev().map(|axis| (axis, 1.0));
    workpiece.chain(carrying(Carried::Robot).map(|axis| (axis, -1.0)))
}

/// Cells that together hold all places to which the external axes bring those of the cell of a problem: turntables in
/// arcs, each with its own yaws. One cell where these would be too many.
fn pieces(problem: &Problem) -> Vec<Cell> {
    let arcs = |axis: &ExternalAxis| match axis.kind {
        AxisKind::Rail => 1,
        AxisKind::Turntable => ((axis.max - axis.min) / ARC).ceil().clamp(1.0, MOST_PIECES as f64) as usize,
    };
    if moving(problem).map(|(axis, _)| arcs(axis)).fold(1, usize::saturating_mul) > MOST_PIECES {
        return vec![cell_moved(problem, |_| true)];
    }
    moving(problem).fold(vec![problem.cell], |cells, (axis, sign)| {
        let (count, width) = (arcs(axis), axis.max - axis.min);
        let at = |k: usize| axis.min + width * k as f64 / count as f64;
        let arc = |k: usize| Interval { min: at(k), max: at(k + 1) };
        cells.iter().flat_map(|cell| (0..count).map(move |k| moved(*cell, axis, sign, arc(k)))).collect()
    })
}

/// Arcs of turntables are no longer than this (rad), and pieces of a cell no more.
const ARC: f64 = 5.0 * PI / 180.0;
const MOST_PIECES: usize = 400;

/// A cell that holds all places to which a range of positions of an axis brings those of a cell, moving it by `sign`
/// times these.
fn moved(cell: Cell, axis: &ExternalAxis, sign: f64, range: Interval) -> Cell {
    let Cell { mut position, mut yaw } = cell;
    if axis.kind == AxisKind::Rail {
        let ends: [Vector3<f64>; 2] = [range.min, range.max].map(|at| axis.direction * (sign * at));
        for (k, place) in position.iter_mut().enumerate() {
            let (a, b) = (ends[0][k], ends[1][k]);
            *place = Interval { min: place.min + a.min(b), max: place.max + a.max(b) };
        }
        return Cell { position, yaw };
    }
    let sign = sign * axis.direction.z.signum();
    let (a, b) = (sign * range.min, sign * range.max);
    let turn = Interval { min: a.min(b), max: a.max(b) };
    // At each angle the corners are the farthest.
    let [x, y, _] = position;
    let corners = [(x.min, y.min), (x.min, y.max), (x.max, y.min), (x.max, y.max)];
    let around = corners.map(|(x, y)| {
        let (x, y) = (x - axis.point.x, y - axis.point.y);
        let (radius, azimuth) = (libm::hypot(x, y), libm::atan2(y, x));
        [0.0, FRAC_PI_2].map(|from| farthest(radius, azimuth + turn.min - from, azimuth + turn.max - from))
    });
    for (k, middle) in [axis.point.x, axis.point.y].into_iter().enumerate() {
        let ends = around.map(|corner| corner[k]);
        let min = ends.iter().map(|range| range.min).fold(f64::INFINITY, f64::min);
        let max = ends.iter().map(|range| range.max).fold(f64::NEG_INFINITY, f64::max);
        position[k] = Interval { min: middle + min - ROUNDING, max: middle + max + ROUNDING };
    }
    yaw = Interval { min: yaw.min + turn.min, max: yaw.max + turn.max };
    if yaw.width() >= TAU {
        yaw = Interval { min: -PI, max: PI };
    }
    Cell { position, yaw }
}

/// A cell about a turntable is larger than computed by this. m
const ROUNDING: f64 = 1e-12;

/// The least and the largest of `radius` times the cosine of angles from `from` to `to` (rad).
pub(super) fn farthest(radius: f64, from: f64, to: f64) -> Interval {
    let has = |angle: f64| angle + TAU * ((from - angle) / TAU).ceil() <= to;
    let [a, b] = [from, to].map(|angle| radius * libm::cos(angle));
    Interval { min: if has(PI) { -radius } else { a.min(b) }, max: if has(0.0) { radius } else { a.max(b) } }
}
