//! Values of TOML files, angles in rad and lengths in m.

use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use toml::{Table, Value};

/// What could be read, or a sentence.
pub(crate) type Answer<T> = Result<T, String>;

/// The number that a value is, whole or not.
pub(crate) fn plain(value: &Value) -> Option<f64> {
    match value {
        Value::Float(number) => Some(*number),
        Value::Integer(number) => Some(*number as f64),
        _ => None,
    }
}

pub(crate) fn number(table: &Table, key: &str) -> Option<f64> {
    plain(table.get(key)?)
}

pub(crate) fn required(table: &Table, key: &str) -> Answer<f64> {
    number(table, key).ok_or_else(|| format!("no number {key}"))
}

pub(crate) fn text<'a>(table: &'a Table, key: &str) -> Option<&'a str> {
    table.get(key)?.as_str()
}

pub(crate) fn list(table: &Table, key: &str) -> Option<Vec<f64>> {
    table.get(key)?.as_array()?.iter().map(plain).collect()
}

pub(crate) fn vector(table: &Table, key: &str) -> Option<Vector3<f64>> {
    let entries = list(table, key)?;
    (entries.len() == 3).then(|| Vector3::new(entries[0], entries[1], entries[2]))
}

pub(crate) fn texts(table: &Table, key: &str) -> Option<Vec<String>> {
    table.get(key)?.as_array()?.iter().map(|entry| Some(entry.as_str()?.to_owned())).collect()
}

pub(crate) fn section<'a>(table: &'a Table, key: &str) -> Option<&'a Table> {
    table.get(key)?.as_table()
}

pub(crate) fn sections<'a>(table: &'a Table, key: &str) -> Vec<&'a Table> {
    table
        .get(key)
        .and_then(Value::as_array)
        .map_or_else(Vec::new, |all| all.iter().filter_map(Value::as_table).collect())
}

/// A range `[min, max]` in a unit of so many m or rad.
pub(crate) fn range(table: &Table, key: &str, unit: f64) -> Option<[f64; 2]> {
    let ends = list(table, key)?;
    (ends.len() == 2).then(|| [ends[0] * unit, ends[1] * unit])
}

/// The rotation that a table states, none where it states none.
pub(crate) fn rotation(table: &Table) -> Answer<Rotation3<f64>> {
    let rad = |key| vector(table, key).map(|angles| angles.map(f64::to_radians));
    if let Some(angles) = rad("abc_deg") {
        return Ok(Rotation3::from_euler_angles(angles.z, angles.y, angles.x));
    }
    if let Some(angles) = rad("wpr_deg").or_else(|| rad("rpy_deg")) {
        return Ok(Rotation3::from_euler_angles(angles.x, angles.y, angles.z));
    }
    if let Some(q) = list(table, "quaternion_wxyz").filter(|q| q.len() == 4) {
        return Ok(UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3])).to_rotation_matrix());
    }
    let Some(rows) = table.get("rotation").and_then(Value::as_array) else { return Ok(Rotation3::identity()) };
    let entries: Vec<f64> = rows.iter().filter_map(Value::as_array).flatten().filter_map(plain).collect();
    if entries.len() != 9 {
        return Err("a rotation has three rows of three numbers".to_owned());
    }
    Ok(orthonormal(&Matrix3::from_row_slice(&entries)))
}

/// The rotation nearest to a matrix with printed digits.
pub(crate) fn orthonormal(matrix: &Matrix3<f64>) -> Rotation3<f64> {
    let svd = matrix.svd(true, true);
    match (svd.u, svd.v_t) {
        (Some(u), Some(v_t)) => Rotation3::from_matrix_unchecked(u * v_t),
        _ => Rotation3::identity(),
    }
}

/// The pose of `xyz_mm` and a rotation.
pub(crate) fn pose(table: &Table) -> Answer<Isometry3<f64>> {
    let place = vector(table, "xyz_mm").unwrap_or_else(Vector3::zeros) * 1e-3;
    Ok(placed(&rotation(table)?, &place))
}

pub(crate) fn placed(rotation: &Rotation3<f64>, place: &Vector3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(*place), UnitQuaternion::from_rotation_matrix(rotation))
}

/// The angle by which one pose has to turn to become another. rad
pub(crate) fn angle_between(a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let turn = (a.rotation.inverse() * b.rotation).to_rotation_matrix().into_inner();
    let sine =
        Vector3::new(turn[(2, 1)] - turn[(1, 2)], turn[(0, 2)] - turn[(2, 0)], turn[(1, 0)] - turn[(0, 1)]).norm();
    sine.atan2(turn.trace() - 1.0)
}
