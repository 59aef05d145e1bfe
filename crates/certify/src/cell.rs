//! The cell and the task as seen along axis 1: radius, height, yaw less azimuth. For a hanging arm y and z change sign.

use super::load::Load;
use super::region::{Point, Region};
use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};
use stead_model::robot::angles::wrap;
use stead_model::task::PathPoint;
use stead_problem::problem::{Cell, Problem};

/// The extent of tables: where path points of placements of the cell can be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    /// Radius, from and to. m
    pub radius: (f64, f64),
    /// Height, from and to. m
    pub height: (f64, f64),
}

/// Which way up the arm stands: +1, or -1 upside down.
pub(super) fn side(problem: &Problem) -> f64 {
    problem.robot.geometry().base_from_root[(2, 2)].signum()
}

/// A vector of the frame of the workpiece, seen along axis 1.
pub(super) fn seen(v: &Vector3<f64>, side: f64) -> Vector3<f64> {
    Vector3::new(v.x, v.y * side, v.z * side)
}

/// Axes this near to each other (sine) are one: printed digits.
pub(super) const SAME: f64 = 1e-9;

/// The tool axes of a path, in the frame of the workpiece about axis 1.
pub(super) fn axes_of(problem: &Problem) -> Vec<Vector3<f64>> {
    let mut axes: Vec<Vector3<f64>> = Vec::new();
    for point in problem.task.points() {
        let axis = seen(&point.axis, side(problem));
        if axes.iter().all(|other| (other - axis).norm() > SAME) {
            axes.push(axis);
        }
    }
    axes
}

/// Path points, what acts on them and what is scored.
pub(super) fn points_of(problem: &Problem) -> Vec<Point> {
    let side = side(problem);
    let one = |(number, p): (usize, &PathPoint)| {
        let (x, y) = (p.position.x, p.position.y * side);
        let along = p.workpiece_from_point().column(0).into_owned();
        let feed = libm::atan2(along.y * side, along.x);
        Point {
            distance: libm::hypot(x, y),
            direction: libm::atan2(y, x),
            height: p.position.z * side,
            feed,
            load: Load::new(problem, number, feed, side),
        }
    };
    problem.task.points().iter().enumerate().map(one).collect()
}

/// The corners of the cell about axis 1, x and y. m
pub(super) fn corners(cell: &Cell, problem: &Problem) -> [[f64; 2]; 2] {
    let root = problem.robot.geometry().root_in_base;
    let [x, y, _] = cell.position;
    [[x.min - root.x, x.max - root.x], [y.min - root.y, y.max - root.y]]
}

/// All placements of the cell as radius, height and yaw less azimuth.
pub(super) fn whole(problem: &Problem) -> Region {
    let side = side(problem);
    let [[x0, x1], [y0, y1]] = corners(&problem.cell, problem);
    let gap = |a: f64, b: f64| if a > 0.0 { a } else { (-b).max(0.0) };
    let near = libm::hypot(gap(x0, x1), gap(y0, y1));
    let far = libm::hypot(x0.abs().max(x1.abs()), y0.abs().max(y1.abs()));
    let z = problem.cell.position[2];
    let root = problem.robot.geometry().root_in_base.z;
    let (a, b) = ((z.min - root) * side, (z.max - root) * side);
    Region { middle: [(near + far) / 2.0, (a + b) / 2.0, 0.0], half: [(far - near) / 2.0, (a - b).abs() / 2.0, PI] }
}

/// Where path points of placements of the cell can be.
pub(super) fn extent(problem: &Problem) -> Extent {
    let region = whole(problem);
    let points = points_of(problem);
    let max_distance = points.iter().map(|p| p.distance).fold(0.0, f64::max);
    let low = points.iter().map(|p| p.height).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p.height).fold(f64::NEG_INFINITY, f64::max);
    let [(near, far), (bottom, top)] =
        [0, 1].map(|k| (region.middle[k] - region.half[k], region.middle[k] + region.half[k]));
    Extent { radius: ((near - max_distance).max(NEAREST), far + max_distance), height: (bottom + low, top + high) }
}

/// How much nearer to axis 1 path points of placements of the cell may come than where something is known of them, if
/// they may. m
pub(super) fn too_near(problem: &Problem) -> Option<f64> {
    let region = whole(problem);
    let farthest = points_of(problem).iter().map(|p| p.distance).fold(0.0, f64::max);
    let missing = NEAREST - (region.middle[0] - region.half[0] - farthest);
    (missing > 0.0).then_some(missing)
}

/// Nearer to axis 1 nothing is known of a path point. m
pub(super) const NEAREST: f64 = 0.05;

/// Which radii and yaws less azimuth a cell allows, or the pieces that it is made of.
#[derive(Debug, Clone)]
pub(super) struct Yaws(pub(super) Vec<CellPiece>);

/// One of them.
#[derive(Debug, Clone, Copy)]
pub(super) struct CellPiece {
    /// From and to. m
    radius: [f64; 2],
    /// Middle and half width of the range of yaw less azimuth, where it is not the whole turn. rad
    pub range: Option<(f64, f64)>,
}

/// What a piece is larger than computed by. m, rad
const LARGER: f64 = 1e-9;

impl Yaws {
    /// Of the cell of a problem.
    pub fn new(problem: &Problem) -> Self {
        Self::of(&[problem.cell], problem)
    }

    /// Of several cells, of which a placement is in any.
    pub fn of(cells: &[Cell], problem: &Problem) -> Self {
        let one = |cell: &Cell| {
            let Region { middle, half } = whole(&problem.in_cell(*cell));
            let radius = [middle[0] - half[0] - LARGER, middle[0] + half[0] + LARGER];
            CellPiece { radius, range: range(cell, problem) }
        };
        Self(cells.iter().map(one).collect())
    }

    /// Whether some placement of a box is in the cell, as far as its radius and yaw tell.
    pub fn allow(&self, region: &Region) -> bool {
        let ([radius, _, turn], [half, _, half_turn]) = (region.middle, region.half);
        self.0.iter().any(|piece| {
            let [near, far] = piece.radius;
            let is_near = radius - half <= far && radius + half >= near;
            is_near && piece.range.is_none_or(|(middle, half)| wrap(turn - middle).abs() <= half + half_turn)
        })
    }
}

/// Middle and half width of the range of yaw less azimuth of a cell, where it is not the whole turn. rad
fn range(cell: &Cell, problem: &Problem) -> Option<(f64, f64)> {
    let [[x0, x1], [y0, y1]] = corners(cell, problem);
    let around = x0 <= 0.0 && x1 >= 0.0 && y0 <= 0.0 && y1 >= 0.0;
    if cell.is_yaw_free() || around {
        return None;
    }
    // Azimuths of the four corners about that of the middle: less than half a turn apart in all.
    let middle = libm::atan2(y0 + y1, x0 + x1);
    let off = |x: f64, y: f64| wrap(libm::atan2(y, x) - middle);
    let all = [off(x0, y0), off(x0, y1), off(x1, y0), off(x1, y1)];
    let (low, high) =
        (all.iter().copied().fold(f64::INFINITY, f64::min), all.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    let (from, to) = (cell.yaw.min - middle - high, cell.yaw.max - middle - low);
    (to - from < TAU).then_some((side(problem) * (from + to) / 2.0, (to - from) / 2.0 + LARGER))
}
