//! Frames, angles and forward kinematics of the reader of programs, in mm. It shares none of them with the writer, nor
//! with the kinematics that plans are made by.

use stead_model::external_axis::{AxisKind, Carried, ExternalAxis};
use stead_model::robot::{Controller, Joint};

/// Three rows of three.
pub(super) type Matrix = [[f64; 3]; 3];

/// A frame in another: the columns of `turn` are its axes there, `origin` (mm) is where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub turn: Matrix,
    pub origin: [f64; 3],
}

pub(super) const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| (0..3).map(|j| a[i][j] * b[j][k]).sum()))
}

fn transposed(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| a[k][i]))
}

pub(super) fn applied(a: &Matrix, v: &[f64; 3]) -> [f64; 3] {
    a.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

impl Frame {
    /// Only moved.
    pub fn shift(origin: [f64; 3]) -> Self {
        Self { turn: IDENTITY, origin }
    }

    /// Only turned.
    pub fn turned(turn: Matrix) -> Self {
        Self { turn, origin: [0.0; 3] }
    }

    /// A frame that is given in this one, in what this one is given in.
    pub fn of(&self, inner: &Self) -> Self {
        let moved = applied(&self.turn, &inner.origin);
        Self {
            turn: product(&self.turn, &inner.turn),
            origin: std::array::from_fn(|axis| moved[axis] + self.origin[axis]),
        }
    }

    /// The outer frame in this one.
    pub fn inverted(&self) -> Self {
        let turn = transposed(&self.turn);
        Self { turn, origin: applied(&turn, &self.origin).map(|v| -v) }
    }
}

/// Turns about one axis, angle in rad.
pub(super) fn about_x(angle: f64) -> Matrix {
    let (s, c) = libm::sincos(angle);
    [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
}

fn about_y(angle: f64) -> Matrix {
    let (s, c) = libm::sincos(angle);
    [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
}

pub(super) fn about_z(angle: f64) -> Matrix {
    let (s, c) = libm::sincos(angle);
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

/// First about x, then about the outer y, then about the outer z, in deg: KUKA's C, B, A; Fanuc's W, P, R.
pub(super) fn turned_xyz(x: f64, y: f64, z: f64) -> Matrix {
    let [x, y, z] = [x, y, z].map(f64::to_radians);
    product(&about_z(z), &product(&about_y(y), &about_x(x)))
}

/// The turn of a quaternion, by what it does to each unit vector: `q e q*`. Nothing where its length is not 1 within
/// 1e-5.
pub(super) fn turned_by_quaternion(q: [f64; 4]) -> Option<Matrix> {
    let norm = libm::sqrt(q.iter().map(|part| part * part).sum());
    if (norm - 1.0).abs() > 1e-5 {
        return None;
    }
    let q = q.map(|part| part / norm);
    let times = |a: [f64; 4], b: [f64; 4]| {
        [
            a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
            a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
            a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
        ]
    };
    let conjugate = [q[0], -q[1], -q[2], -q[3]];
    let columns: [[f64; 3]; 3] = std::array::from_fn(|axis| {
        let mut unit = [0.0; 4];
        unit[axis + 1] = 1.0;
        let [_, x, y, z] = times(times(q, unit), conjugate);
        [x, y, z]
    });
    Some(transposed(&columns))
}

/// The flange in the base frame, for angles of the rows in rad: turn about x by alpha, shift along it by a, turn about
/// z by theta, shift along it by d, six times.
pub(super) fn flange(rows: &[Joint; 6], theta: &[f64; 6]) -> Frame {
    rows.iter().zip(theta).fold(Frame::turned(IDENTITY), |frame, (row, theta)| {
        let twist = Frame { turn: about_x(row.alpha), origin: [row.a * 1e3, 0.0, 0.0] };
        let turn = Frame { turn: about_z(*theta), origin: [0.0, 0.0, row.d * 1e3] };
        frame.of(&twist).of(&turn)
    })
}

/// Where an external axis brings what it carries, at a position in mm or deg.
fn carried(axis: &ExternalAxis, position: f64) -> Frame {
    let direction: [f64; 3] = axis.direction.into();
    if axis.kind == AxisKind::Rail {
        return Frame::shift(direction.map(|part| part * position));
    }
    let (s, c) = libm::sincos(position.to_radians() / 2.0);
    let turn = turned_by_quaternion([c, s * direction[0], s * direction[1], s * direction[2]]).unwrap_or(IDENTITY);
    let point = <[f64; 3]>::from(axis.point).map(|m| m * 1e3);
    Frame::shift(point).of(&Frame::turned(turn)).of(&Frame::shift(point.map(|mm| -mm)))
}

/// What external axes at positions in mm and deg do to the robot, or to the workpiece.
fn moved(axes: &[ExternalAxis], positions: &[Option<f64>; 6], what: Carried) -> Frame {
    let own = axes.iter().zip(positions).filter(|(axis, _)| axis.carries == what);
    own.fold(Frame::turned(IDENTITY), |frame, (axis, position)| frame.of(&carried(axis, position.unwrap_or(0.0))))
}

/// The workpiece as the robot sees it with external axes at positions in mm and deg: what carries the robot moves it
/// the other way.
pub(super) fn seen(axes: &[ExternalAxis], positions: &[Option<f64>; 6]) -> Frame {
    floor_seen(axes, positions).of(&moved(axes, positions, Carried::Workpiece))
}

/// What stands on the floor, as the robot sees it.
pub(super) fn floor_seen(axes: &[ExternalAxis], positions: &[Option<f64>; 6]) -> Frame {
    moved(axes, positions, Carried::Robot).inverted()
}

/// The table of the axes that carry the workpiece, with all of them at zero, for a robot root in the same frame: the
/// origin on the last axis, z along it, x as near to x of the root as z allows, or to y of the root where z is less
/// than about 25 deg from its x.
pub(super) fn table(axes: &[ExternalAxis], root: &Frame) -> Option<Frame> {
    let axis = axes.iter().rev().find(|axis| axis.carries == Carried::Workpiece)?;
    let z: [f64; 3] = axis.direction.into();
    let column = |k: usize| root.turn.map(|row| row[k]);
    let dot = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let near = if dot(&z, &column(0)).abs() > 0.9 { column(1) } else { column(0) };
    let y = cross(&z, &near);
    let size = length(&y);
    let y = y.map(|part| part / size);
    let x = cross(&y, &z);
    let turn = std::array::from_fn(|row| [x[row], y[row], z[row]]);
    Some(Frame { turn, origin: <[f64; 3]>::from(axis.point).map(|m| m * 1e3) })
}

/// The angles of the rows (rad) for those of a controller (deg). Where axis 3 is counted against the horizontal, its
/// row turns back by what that of axis 2 turns, the other way where it points against that.
pub(super) fn of_rows(rows: &[Joint; 6], controller: &Controller, degrees: &[f64; 6]) -> [f64; 6] {
    let shown = |axis: usize| degrees[axis].to_radians() * controller.sign[axis];
    let back = if libm::cos(rows[2].alpha) < 0.0 { shown(1) } else { -shown(1) };
    std::array::from_fn(|axis| {
        let level = if axis == 2 && controller.is_level() { back } else { 0.0 };
        shown(axis) + level + controller.offset[axis]
    })
}

/// How far two frames are from each other: mm, and deg.
pub(super) fn apart(a: &Frame, b: &Frame) -> (f64, f64) {
    let shift: [f64; 3] = std::array::from_fn(|axis| a.origin[axis] - b.origin[axis]);
    let between = product(&transposed(&a.turn), &b.turn);
    let twist = [between[2][1] - between[1][2], between[0][2] - between[2][0], between[1][0] - between[0][1]];
    let sine = length(&twist) / 2.0;
    let cosine = (between[0][0] + between[1][1] + between[2][2] - 1.0) / 2.0;
    (length(&shift), libm::atan2(sine, cosine).to_degrees())
}

pub(super) fn length(v: &[f64; 3]) -> f64 {
    libm::sqrt(v.iter().map(|part| part * part).sum())
}

pub(super) fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
