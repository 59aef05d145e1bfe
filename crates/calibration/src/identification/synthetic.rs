//! Sheets that an arm of known compliances would give: for examples and for tests of the identification.

use super::deflected::Deflected;
use super::sheet::{Configuration, LoadCase, Reading, Sheet};
use super::springs::{AXES, FULL, compliances_of};
use nalgebra::Vector3;
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
/// with all springs that deflections of it count ([`Robot::normal_springs`]), and with `position_error` (m) added to
/// every coordinate and `orientation_error` (rad) to every component of a turn. Configurations are called c1, c2, ...
/// and points p1, p2, ...; line numbers are those of a file with one line of header.
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
        let moved = if robot.normal_springs().is_some() {
            displacements::<FULL>(robot, cell, &configuration)
        } else {
            displacements::<AXES>(robot, cell, &configuration)
        };
        for (point, (there, Displacement { linear, angular })) in moved.into_iter().enumerate() {
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

/// Where the reference points are without the load (m), and how far it moves them.
fn displacements<const N: usize>(
    robot: &Robot,
    cell: &MeasuringCell,
    configuration: &Configuration,
) -> Vec<(Vector3<f64>, Displacement<f64>)> {
    let compliances = compliances_of::<N>(robot, &configuration.theta);
    let deflected = Deflected::at_rest(robot, compliances, configuration, &cell.load_point)
        .unwrap_or_else(|_| Deflected::linear(robot, compliances, configuration, &cell.load_point));
    cell.points.iter().map(|place| (deflected.unloaded(place), deflected.displacement(place))).collect()
}
