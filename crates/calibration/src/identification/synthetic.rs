//! Sheets that an arm of known compliances would give: for examples and for tests of the identification.

use super::deflected::Deflected;
use super::sheet::{Configuration, LoadCase, Reading, Sheet};
use nalgebra::{Vector3, Vector6};
use stead_model::robot::{Pose, Robot};
use stead_model::stiffness::Displacement;
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

/// What the tracker would read of the arm in its exact static equilibrium (where it gives way, deflected linearly),
/// with `position_error` (m) added to every coordinate and `orientation_error` (rad) to every component of a turn.
/// Configurations are called c1, c2, ... and points p1, p2, ...; line numbers are those of a file with one line of
/// header.
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
        let compliances = Vector6::from(robot.compliances_at(theta));
        let deflected = Deflected::at_rest(robot, compliances, &configuration, &cell.load_point)
            .unwrap_or_else(|_| Deflected::linear(robot, compliances, &configuration, &cell.load_point));
        for (point, place) in cell.points.iter().enumerate() {
            let Displacement { linear, angular } = deflected.displacement(place);
            let there = deflected.unloaded(place);
            let mut read = |moved: Vector3<f64>| {
                let error = Vector3::from_fn(|_, _| position_error());
                cell.tracker_from_base.point(&(there + moved)) + error
            };
            let (unloaded, loaded) = (read(Vector3::zeros()), read(linear));
            let turn = cell.is_full_pose.then(|| {
                let turned = cell.tracker_from_base.rotation * angular;
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
