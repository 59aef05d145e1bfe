//! Everything that yields: each thing is a spring at a place, which answers force and moment there by displacement and
//! turn there, and carries the tool along.

use crate::arm::Arm;
use crate::cell::{Cell, Stand};
use crate::values::{list, plain, section, vector};
use nalgebra::{Isometry3, Matrix3, Matrix6, Translation3, Vector3, Vector6};
use toml::{Table, Value};

/// The matrices of a run, in SI units.
#[derive(Debug, Clone, Default)]
pub(crate) struct Beside {
    /// Where the base yields, in its frame, and how.
    pub base: Option<(Vector3<f64>, Matrix6<f64>)>,
    /// In the frame of the flange.
    pub mount: Option<Matrix6<f64>>,
    /// In the frame of the tool.
    pub tip: Option<Matrix3<f64>>,
    /// Of the part, alike at all points, in its frame.
    pub part: Option<Matrix3<f64>>,
}

/// Words of the columns of a plan for what yields.
pub(crate) const ORIGINS: [&str; 6] = ["axes", "normal", "base", "mount", "tip", "part"];

fn numbers(value: Option<&Value>, count: usize) -> Option<Vec<f64>> {
    let rows = value?.as_array()?;
    let all: Vec<f64> = rows.iter().filter_map(Value::as_array).flatten().filter_map(plain).collect();
    (all.len() == count * count).then(|| all.into_iter().map(|micro| micro * 1e-6).collect())
}

impl Beside {
    pub(crate) fn read(run: &Table) -> Self {
        let six = |value| numbers(value, 6).map(|all| Matrix6::from_row_slice(&all));
        let three = |value| numbers(value, 3).map(|all| Matrix3::from_row_slice(&all));
        let spindle = section(run, "spindle");
        let base = section(run, "base_compliance").and_then(|table| {
            let point = vector(table, "point_mm").unwrap_or_else(Vector3::zeros) * 1e-3;
            Some((point, six(table.get("matrix"))?))
        });
        Self {
            base,
            mount: six(spindle.and_then(|table| table.get("mount_matrix"))),
            tip: three(spindle.and_then(|table| table.get("tip_um_per_n"))),
            part: three(section(run, "part_compliance").and_then(|table| table.get("um_per_n"))),
        }
    }
}

/// Springs of a row about x and y of its frame (rad/(N m)), and where they are on z (m).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Normal {
    pub about: [f64; 2],
    pub bearing: f64,
}

/// The springs normal to the axis that a row states.
pub(crate) fn normal(row: &Table) -> Option<Normal> {
    let pair = |key: &str| {
        let one = row.get(key).and_then(plain).map(|value| [value, value]);
        one.or_else(|| list(row, key).and_then(|both| both.try_into().ok()))
    };
    let soft = pair("orthogonal_compliance_urad_per_nm").map(|both| both.map(|value| value * 1e-6));
    let stiff = || pair("orthogonal_stiffness_mnm_per_rad").map(|both| both.map(|value| 1.0 / (value * 1e6)));
    let bearing = row.get("bearing_mm").and_then(plain).unwrap_or(0.0) * 1e-3;
    soft.or_else(stiff).map(|about| Normal { about, bearing })
}

/// What a spring does to the tool: it is at the origin of `place` and answers in the directions of it.
fn spring(
    place: &Isometry3<f64>,
    matrix: &Matrix6<f64>,
    at: &Vector3<f64>,
    force: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> Vector3<f64> {
    let arm = at - place.translation.vector;
    let [f, m] = [*force, moment + arm.cross(force)].map(|v| place.rotation.inverse() * v);
    let answer = matrix * Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z);
    let [shift, turn] = [0, 3].map(|k| place.rotation * Vector3::new(answer[k], answer[k + 1], answer[k + 2]));
    shift + turn.cross(&arm)
}

/// An arm under a load at its tool centre point.
pub(crate) struct Loading<'a> {
    pub stand: &'a Stand,
    pub joints: &'a [f64; 6],
    /// How the part yields at this point.
    pub part: Option<Matrix3<f64>>,
}

impl Loading<'_> {
    /// What each of [`ORIGINS`] adds to the displacement of the tool against the part. m
    pub(crate) fn by_origin(
        &self,
        cell: &Cell,
        arm: &Arm,
        force: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> [Vector3<f64>; 6] {
        let frames = &self.stand.frames;
        let at = self.stand.tool.translation.vector;
        let of = |place: &Isometry3<f64>, matrix: &Matrix6<f64>| spring(place, matrix, &at, force, moment);
        let turned = |frame: &Isometry3<f64>, matrix: &Matrix3<f64>| {
            frame.rotation * (matrix * (frame.rotation.inverse() * force))
        };
        let mut normal = Vector3::zeros();
        for (j, springs) in arm.normal.iter().flatten().enumerate() {
            let place = frames[j + 1] * Translation3::new(0.0, 0.0, springs.bearing);
            let about = Vector6::new(0.0, 0.0, 0.0, springs.about[0], springs.about[1], 0.0);
            normal += of(&place, &Matrix6::from_diagonal(&about));
        }
        let none = Vector3::zeros();
        let beside = &cell.beside;
        [
            arm.deflection(frames, self.joints, &at, force, moment),
            normal,
            beside.base.as_ref().map_or(none, |(point, matrix)| of(&(frames[0] * Translation3::from(*point)), matrix)),
            beside.mount.as_ref().map_or(none, |matrix| of(&frames[6], matrix)),
            beside.tip.as_ref().map_or(none, |matrix| turned(&self.stand.tool, matrix)),
            self.part.as_ref().map_or(none, |matrix| turned(&self.stand.part, matrix)),
        ]
    }

    /// The displacement of the tool against the part. m
    pub(crate) fn moved(&self, cell: &Cell, arm: &Arm, force: &Vector3<f64>, moment: &Vector3<f64>) -> Vector3<f64> {
        self.by_origin(cell, arm, force, moment).iter().sum()
    }
}

impl Cell {
    /// Whether more yields than the joints about their axes.
    pub(crate) fn yields_beside(&self) -> bool {
        let Beside { base, mount, tip, part } = &self.beside;
        let is_beside = base.is_some() || mount.is_some() || tip.is_some() || part.is_some();
        self.arm.normal.is_some() || is_beside || self.points.iter().any(|point| point.part.is_some())
    }
}
