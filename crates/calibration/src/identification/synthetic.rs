//! Sheets that an arm of known compliances would give: for examples and for tests of the identification.

use super::model::Response;
use super::sheet::{Configuration, LoadCase, Reading, Sheet};
use nalgebra::{Vector3, Vector6};
use stead_model::robot::{Pose, Robot};
use stead_numerics::rotation::{rotation_from_vector, rotation_vector};

/// The measuring cell.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuringCell {
    /// The robot base in the tracker's frame.
    pub tracker_from_base: Pose<f64>,
    /// Where the wrench acts, in the flange frame. m
    pub load_point: Vector3<f64>,
    /// Reference points in the flange frame. m
    pub points: Vec<Vector3<f64>>,
    /// Whether orientations are read too.
    pub is_full_pose: bool,
}

/// What the tracker would read, with `position_error` (m) added to every coordinate and `orientation_error` (rad) to every
/// component of a turn. Configurations are called c1, c2, ... and points p1, p2, ...; line numbers are those of
/// a file with one line of header.
pub fn sheet(
    robot: &Robot,
    cell: &MeasuringCell,
    load_cases: &[LoadCase],
    mut position_error: impl FnMut() -> f64,
    mut orientation_error: impl FnMut() -> f64,
) -> Sheet {
    let mut sheet = Sheet {
        points: (1..=cell.points.len()).map(|number| format!("p{number}")).collect(),
        configurations: Vec::with_capacity(load_cases.len()),
        readings: Vec::with_capacity(load_cases.len() * cell.points.len()),
    };
    for (index, LoadCase { theta, force, moment }) in load_cases.iter().enumerate() {
        let first = sheet.readings.len();
        let configuration = Configuration {
            name: format!("c{}", index + 1),
            theta: *theta,
            force: *force,
            moment: *moment,
            readings: first..first + cell.points.len(),
        };
        let base_from_flange = robot.forward(theta);
        let compliances = Vector6::from(robot.compliances_at(theta));
        for (point, place) in cell.points.iter().enumerate() {
            let response = Response::of(robot, &configuration, &cell.load_point, place);
            let there = base_from_flange.point(place);
            let mut read = |moved: Vector3<f64>| {
                let error = Vector3::from_fn(|_, _| position_error());
                cell.tracker_from_base.point(&(there + moved)) + error
            };
            let (unloaded, loaded) = (read(Vector3::zeros()), read(response.linear * compliances));
            let turn = cell.is_full_pose.then(|| {
                let turned = cell.tracker_from_base.rotation * (response.angular * compliances);
                let mut noisy = || rotation_from_vector(&Vector3::from_fn(|_, _| orientation_error()));
                let (before, after) = (noisy(), noisy());
                rotation_vector(&(after * rotation_from_vector(&turned) * before.transpose()))
            });
            let line = sheet.readings.len() + 2;
            sheet.readings.push(Reading { line, configuration: index, point, unloaded, loaded, turn });
        }
        sheet.configurations.push(configuration);
    }
    sheet
}
