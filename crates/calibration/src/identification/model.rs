//! The observation model: deflections that are linear in the joint compliances (Klimchik et al. 2017, eq. 15, 16, 20, 23).
//!
//! A wrench acts at the load point, the deflection is read at a reference point: the column of joint j is
//! `J_j(reference) (J_j(load)^T w)`, with the Jacobian at two points. Where a compensator stands beside a joint, that joint
//! has one compliance for each distinct angle: a [`Layout`] says which configurations share one.

use super::deflected::{Deflected, torque};
use super::setup::Setup;
use super::sheet::{Configuration, Reading, Sheet};
use nalgebra::{Matrix3x6, Matrix6, Vector3, Vector6};
use serde::Serialize;
use stead_model::robot::{Frames, Robot};

/// Which compliances are sought.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Layout {
    /// The joint (from 0) with one compliance for each distinct angle, if there is one.
    pub varying: Option<usize>,
    /// Its distinct angles: means over the configurations that share one, ascending. rad
    pub angles: Vec<f64>,
    /// For each configuration the place of its angle among `angles`.
    pub group_of: Vec<usize>,
}

/// One of the compliances sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Parameter {
    /// Of a joint (from 0), the same in all configurations.
    Joint(usize),
    /// Of the varying joint, at one of its distinct angles (from 0).
    Group(usize),
}

impl Layout {
    /// The layout for a sheet; angles of the varying joint within `tolerance` (rad) of the smallest of their group are one.
    pub fn new(sheet: &Sheet, varying: Option<usize>, tolerance: f64) -> Self {
        let Some(joint) = varying else {
            return Self { varying, angles: vec![], group_of: vec![] };
        };
        let angle = |index: usize| sheet.configurations[index].theta[joint];
        let mut order: Vec<usize> = (0..sheet.configurations.len()).collect();
        order.sort_by(|a, b| angle(*a).total_cmp(&angle(*b)));
        let mut group_of = vec![0; order.len()];
        let mut angles = Vec::new();
        for group in grouped(&order, angle, tolerance) {
            for index in group {
                group_of[*index] = angles.len();
            }
            angles.push(group.iter().map(|index| angle(*index)).sum::<f64>() / group.len() as f64);
        }
        Self { varying, angles, group_of }
    }

    /// The group of a configuration, where a joint varies.
    pub fn group(&self, configuration: usize) -> Option<usize> {
        self.varying.map(|_| self.group_of[configuration])
    }

    /// All parameters: the joints in order, the varying one as its groups.
    pub fn parameters(&self) -> Vec<Parameter> {
        let groups = || (0..self.angles.len()).map(Parameter::Group);
        (0..6)
            .flat_map(|joint| {
                let is_varying = self.varying == Some(joint);
                let alone = (!is_varying).then_some(Parameter::Joint(joint));
                alone.into_iter().chain(groups().filter(move |_| is_varying))
            })
            .collect()
    }

    /// The joint of a parameter, from 0.
    pub fn joint(&self, parameter: Parameter) -> usize {
        match parameter {
            Parameter::Joint(joint) => joint,
            Parameter::Group(_) => self.varying.unwrap_or_default(),
        }
    }

    /// The name of a parameter in messages.
    pub fn name(&self, parameter: Parameter) -> String {
        compliance_name(self.joint(parameter), self.angle(parameter))
    }

    /// The angle of a parameter of the varying joint. rad
    pub fn angle(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::Joint(_) => None,
            Parameter::Group(group) => self.angles.get(group).copied(),
        }
    }
}

/// The name of a compliance in messages: of a joint (from 0), and, where it has several, at an angle (rad).
pub fn compliance_name(joint: usize, angle: Option<f64>) -> String {
    let number = joint + 1;
    angle.map_or_else(|| format!("k_{number}"), |angle| format!("k_{number} at {:.2} deg", angle.to_degrees()))
}

/// Runs of sorted items that lie within a tolerance of their first.
fn grouped(order: &[usize], value: impl Fn(usize) -> f64, tolerance: f64) -> Vec<&[usize]> {
    let mut groups = Vec::new();
    let mut start = 0;
    for end in 1..=order.len() {
        if end == order.len() || value(order[end]) - value(order[start]) > tolerance {
            groups.push(&order[start..end]);
            start = end;
        }
    }
    groups
}

/// The observation matrix of one point in one configuration: deflection per joint compliance, in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Displacement of the point. m per rad/(N m)
    pub linear: Matrix3x6<f64>,
    /// Rotation of the flange. rad per rad/(N m)
    pub angular: Matrix3x6<f64>,
}

impl Response {
    /// For the arm's joint frames, the place read and the place of the load (m, base frame), and the wrench there.
    pub fn new(
        frames: &Frames<f64>,
        read: &Vector3<f64>,
        load: &Vector3<f64>,
        force: &Vector3<f64>,
        moment: &Vector3<f64>,
    ) -> Self {
        let mut response = Self { linear: Matrix3x6::zeros(), angular: Matrix3x6::zeros() };
        for joint in 0..6 {
            let torque = torque(frames, joint, load, force, moment);
            let (velocity, axis) = frames.twist(joint, read);
            response.linear.set_column(joint, &(velocity * torque));
            response.angular.set_column(joint, &(axis * torque));
        }
        response
    }

    /// Of a configuration of a sheet, for a point given in the flange frame.
    pub fn of(robot: &Robot, configuration: &Configuration, load_point: &Vector3<f64>, point: &Vector3<f64>) -> Self {
        let frames = Frames::new(robot, &configuration.theta);
        let [read, load] = [point, load_point].map(|place| frames.base_from_flange.point(place));
        Self::new(&frames, &read, &load, &configuration.force, &configuration.moment)
    }
}

/// What the rows of a reading are divided by, so that all have the same variance (Klimchik et al. 2017, eta in eq. 17).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of one coordinate of one reading. m
    pub position: f64,
    /// Standard deviation of one component of one orientation. rad
    pub orientation: f64,
}

impl Noise {
    /// What deflections (per m) and rotations (per rad) are multiplied by to have unit variance: they are differences of two
    /// readings, so that their variance is twice that of one.
    pub fn weights(&self) -> (f64, f64) {
        let weight = |deviation: f64| 1.0 / (libm::sqrt(2.0) * deviation);
        (weight(self.position), weight(self.orientation))
    }
}

/// One reading as equations of unit variance: `deflection = design * compliances + error`. Rows 3 to 5 are zero in sheets
/// without orientations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Design matrix: columns are the six joints, those of held joints zero.
    pub design: Matrix6<f64>,
    /// Deflection read, less what is known of it.
    pub deflection: Vector6<f64>,
    /// What the compliances that are sought do not change: the deflection by the held joints, with the compliances of the starting arm at
    /// the angles of the configuration, and what is not linear in the others.
    pub known: Vector6<f64>,
}

/// The equations of all readings for small deflections, linear in the load, with those joints held at the compliances of `robot`
/// for which `hold` says so.
pub fn observations(
    robot: &Robot,
    sheet: &Sheet,
    setup: &Setup,
    load_point: &Vector3<f64>,
    noise: &Noise,
    hold: [bool; 6],
) -> Vec<Observation> {
    let equations = Equations { setup, noise, hold };
    let none = Vector6::zeros();
    let deflected = |configuration| {
        Deflected::linear(robot, with_held(robot, hold, configuration, none), configuration, load_point)
    };
    sheet.configurations.iter().flat_map(|c| equations.of(sheet, c, &deflected(c))).collect()
}

/// The equations of all readings linearised about the arm as it rests with these compliances (rad/(N m)), a function of the
/// configuration (from 0); and the configurations in which it would give way, whose equations are those for small deflections.
pub fn observations_about(
    robot: &Robot,
    sheet: &Sheet,
    setup: &Setup,
    load_point: &Vector3<f64>,
    noise: &Noise,
    hold: [bool; 6],
    compliances: impl Fn(usize) -> Vector6<f64>,
) -> (Vec<Observation>, Vec<usize>) {
    let equations = Equations { setup, noise, hold };
    let mut observations = Vec::with_capacity(sheet.readings.len());
    let mut given_way = Vec::new();
    for (index, configuration) in sheet.configurations.iter().enumerate() {
        let about = with_held(robot, hold, configuration, compliances(index));
        let deflected = Deflected::at_rest(robot, about, configuration, load_point).unwrap_or_else(|_| {
            given_way.push(index);
            Deflected::linear(robot, about, configuration, load_point)
        });
        observations.extend(equations.of(sheet, configuration, &deflected));
    }
    (observations, given_way)
}

/// Compliances with those of held joints in their places. rad/(N m)
fn with_held(
    robot: &Robot,
    hold: [bool; 6],
    configuration: &Configuration,
    mut compliances: Vector6<f64>,
) -> Vector6<f64> {
    for joint in (0..6).filter(|joint| hold[*joint]) {
        compliances[joint] = robot.joints()[joint].compliance_at(configuration.theta[joint]);
    }
    compliances
}

/// What the equations of all readings have in common.
struct Equations<'a> {
    setup: &'a Setup,
    noise: &'a Noise,
    hold: [bool; 6],
}

impl Equations<'_> {
    /// The equations of the readings in a configuration.
    fn of(&self, sheet: &Sheet, configuration: &Configuration, deflected: &Deflected<'_>) -> Vec<Observation> {
        let base_from_tracker = self.setup.tracker_from_base.rotation.transpose();
        let (linear, angular) = self.noise.weights();
        let observation = |reading: &Reading| {
            let place = &self.setup.points[reading.point];
            let (response, moved) = (deflected.response(place), deflected.displacement(place));
            let (mut design, mut read, mut known) = (Matrix6::zeros(), Vector6::zeros(), Vector6::zeros());
            let mut set = |rows: usize, response: Matrix3x6<f64>, found: Vector3<f64>, predicted: Vector3<f64>| {
                design.fixed_rows_mut::<3>(rows).copy_from(&response);
                read.fixed_rows_mut::<3>(rows).copy_from(&found);
                known.fixed_rows_mut::<3>(rows).copy_from(&predicted);
            };
            let found = base_from_tracker * (reading.loaded - reading.unloaded);
            set(0, response.linear * linear, found * linear, moved.linear * linear);
            if let Some(turn) = &reading.turn {
                set(3, response.angular * angular, base_from_tracker * turn * angular, moved.angular * angular);
            }
            (0..6).filter(|joint| self.hold[*joint]).for_each(|joint| design.fill_column(joint, 0.0));
            known -= design * deflected.compliances();
            Observation { design, deflection: read - known, known }
        };
        sheet.readings[configuration.readings.clone()].iter().map(observation).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use stead_model::robot::testing::odd_arms;
    use stead_model::stiffness::displacement;

    proptest! {
        #[test]
        fn deflection_at_the_load_point_is_that_of_the_stiffness_room_and_the_rest_follows_as_a_rigid_body(
            theta in prop::array::uniform6(-3.0..3.0_f64), wrench in prop::array::uniform6(-500.0..500.0_f64), arm in 0..32_usize
        ) {
            let robot = &odd_arms()[arm];
            let frames = Frames::new(robot, &theta);
            let [load, read] = [Vector3::new(0.1, -0.3, 0.2), Vector3::new(0.4, 0.1, -0.2)].map(|p| frames.base_from_flange.point(&p));
            let (force, moment) = (Vector3::new(wrench[0], wrench[1], wrench[2]), Vector3::new(wrench[3], wrench[4], wrench[5]));
            let compliances = [1e-6, 2e-6, 3e-6, 4e-6, 5e-6, 6e-6];
            let moved = displacement(&frames, &load, &compliances, &force, &moment);
            let response = Response::new(&frames, &read, &load, &force, &moment);
            let linear = response.linear * Vector6::from(compliances);
            let angular = response.angular * Vector6::from(compliances);
            prop_assert!((angular - moved.angular).norm() < 1e-14);
            prop_assert!((linear - (moved.linear + moved.angular.cross(&(read - load)))).norm() < 1e-14);
        }
    }

    #[test]
    fn angles_within_the_tolerance_share_a_compliance() {
        let configuration = |angle: f64| Configuration {
            name: String::new(),
            theta: [0.0, angle, 0.0, 0.0, 0.0, 0.0],
            force: Vector3::x(),
            moment: Vector3::zeros(),
            readings: 0..0,
        };
        let configurations = [0.5, 0.1, 0.501, 0.1005, 0.502, 0.9].map(configuration).to_vec();
        let sheet = Sheet { points: vec![], configurations, readings: vec![] };
        let layout = Layout::new(&sheet, Some(1), 1.5e-3);
        assert_eq!(layout.group_of, [1, 0, 1, 0, 2, 3]);
        assert!((layout.angles[1] - 0.5005).abs() < 1e-15);
        assert_eq!(layout.parameters().len(), 9);
        assert_eq!(layout.parameters()[1], Parameter::Group(0));
        assert_eq!(Layout::new(&sheet, None, 1e-3).parameters().len(), 6);
    }
}
