//! What the part stands on, as far as the shapes around a robot show it.

use nalgebra::Vector3;
use std::path::Path;
use stead_cell::{Attachment, Shape, Zone};
use stead_disk::input::InputError;
use stead_format::surroundings::read_surroundings;

/// A level surface in the cell frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ground {
    /// The shape or zone that it is of.
    pub name: String,
    /// Its height. m
    pub height: f64,
    /// Whether the robot stands on it too, or it is below the cell: a part does not lie on it.
    pub is_floor: bool,
}

/// A surface narrower than this is no table. m
const NARROWEST: f64 = 0.2;
/// A surface higher than this share of the reach is no table.
const HIGHEST: f64 = 0.5;
/// The normal of a zone below a floor points downwards. cos
const DOWN: f64 = -0.999;

/// What a part in a cell (ranges of x, y and z in the cell frame, m) would stand on by a file of surroundings, beside a
/// robot that stands there: the highest table in the cell, else the highest floor.
///
/// # Errors
/// [`InputError`] for what is wrong in the file.
pub(super) fn ground(
    file: &Path,
    cell: [[f64; 2]; 3],
    robot: &Vector3<f64>,
    reach: f64,
) -> Result<Option<Ground>, InputError> {
    let Some(around) = read_surroundings(file)? else { return Ok(None) };
    let standing = around.shapes().iter().filter(|shape| shape.attached == Attachment::Base);
    let mut found: Vec<Ground> = standing.filter_map(|shape| surface(shape, cell, robot, reach)).collect();
    found.extend(around.zones().iter().filter_map(|zone| match &zone.zone {
        Zone::HalfSpace { point, normal } if normal.z < DOWN => {
            Some(Ground { name: zone.name.clone(), height: point.z, is_floor: true })
        }
        _ => None,
    }));
    // A table is above its floor.
    Ok(found.into_iter().max_by(|a, b| b.is_floor.cmp(&a.is_floor).then(a.height.total_cmp(&b.height))))
}

/// The upper side of a shape, where the cell is above it.
fn surface(shape: &Shape, cell: [[f64; 2]; 3], robot: &Vector3<f64>, reach: f64) -> Option<Ground> {
    let ends = shape.solid.extent();
    let corners = (0..8).map(|corner| {
        let end = |axis: usize| ends[(corner >> axis) & 1][axis];
        shape.pose.rotation * Vector3::new(end(0), end(1), end(2)) + shape.pose.translation
    });
    let (low, high) = corners
        .fold((Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY)), |(low, high), corner| {
            (low.inf(&corner), high.sup(&corner))
        });
    let common = |axis: usize| cell[axis][1].min(high[axis]) - cell[axis][0].max(low[axis]);
    let is_below_cell = (0..2).all(|axis| common(axis) >= NARROWEST);
    let is_below_robot = (0..2).all(|axis| low[axis] <= robot[axis] && high[axis] >= robot[axis]);
    (is_below_cell && high.z < robot.z + HIGHEST * reach).then(|| Ground {
        name: shape.name.clone(),
        height: high.z,
        is_floor: is_below_robot,
    })
}
