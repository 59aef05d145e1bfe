//! External axes that stay at one place along the path, as a larger cell.

use nalgebra::Vector3;
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use stead_model::external_axis::{AxisKind, AxisUse, Carried, ExternalAxis};
use stead_problem::problem::{Cell, Interval, Problem};
use stead_problem::setup::Setup;
use stead_problem::symmetry::{Unsupported, is_vertical};

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
    // What is carried by several axes is moved by the last one first; a robot that moves one way is a workpiece that
    // moves the other way, and there the first axis moves it first.
    let carrying = |what: Carried| axes.iter().filter(move |axis| axis.carries == what);
    let workpiece = carrying(Carried::Workpiece).rev().map(|axis| (axis, 1.0));
    let robot = carrying(Carried::Robot).map(|axis| (axis, -1.0));
    let cell = workpiece.chain(robot).fold(problem.cell, |cell, (axis, sign)| moved(cell, axis, sign));
    let alone = problem.changed(|parts| {
        (parts.external_axes, parts.scene, parts.cell) = (Vec::new(), None, cell);
        parts.setup = Setup { positions: Default::default(), ..parts.setup.clone() };
    });
    alone.map(Cow::Owned).map_err(|_| Unsupported::OtherAxes)
}

/// A cell that holds all places to which an axis brings those of a cell, moving it by `sign` times its positions.
fn moved(cell: Cell, axis: &ExternalAxis, sign: f64) -> Cell {
    let Cell { mut position, mut yaw } = cell;
    if axis.kind == AxisKind::Rail {
        let ends: [Vector3<f64>; 2] = [axis.min, axis.max].map(|at| axis.direction * (sign * at));
        for (k, range) in position.iter_mut().enumerate() {
            let (a, b) = (ends[0][k], ends[1][k]);
            *range = Interval { min: range.min + a.min(b), max: range.max + a.max(b) };
        }
        return Cell { position, yaw };
    }
    let sign = sign * axis.direction.z.signum();
    let (a, b) = (sign * axis.min, sign * axis.max);
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
fn farthest(radius: f64, from: f64, to: f64) -> Interval {
    let has = |angle: f64| angle + TAU * ((from - angle) / TAU).ceil() <= to;
    let [a, b] = [from, to].map(|angle| radius * libm::cos(angle));
    Interval { min: if has(PI) { -radius } else { a.min(b) }, max: if has(0.0) { radius } else { a.max(b) } }
}
