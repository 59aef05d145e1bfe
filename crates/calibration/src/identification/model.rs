//! The observation model: the readings of a sheet as equations linear in the joint compliances (Klimchik et al. 2017,
//! eq. 20, 23).
//!
//! Where a compensator stands beside a joint, that joint has one compliance for each distinct angle: a [`Layout`] says
//! which configurations share one.

use super::deflected::Deflected;
use super::setup::Setup;
use super::sheet::{Configuration, Reading, Sheet};
use super::springs::{FitModel, column, compliances_of, spring};
use nalgebra::{SMatrix, SVector, Vector3, Vector6};
use serde::Serialize;
use stead_model::robot::{About, Robot, Spring};

/// Which compliances are sought.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Layout {
    /// About which axes the joints have springs.
    pub model: FitModel,
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
    /// Of a joint (from 0) about its axis, the same in all configurations.
    Joint(usize),
    /// Of a joint about a direction normal to its axis, the same in all configurations.
    Normal(Spring),
    /// Of the varying joint, at one of its distinct angles (from 0).
    Group(usize),
}

impl Layout {
    /// The layout for a sheet; angles of the varying joint within `tolerance` (rad) of the smallest of their group are
    /// one.
    pub fn new(sheet: &Sheet, model: FitModel, varying: Option<usize>, tolerance: f64) -> Self {
        let Some(joint) = varying else {
            return Self { model, varying, angles: vec![], group_of: vec![] };
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
        Self { model, varying, angles, group_of }
    }

    /// The group of a configuration, where a joint varies.
    pub fn group(&self, configuration: usize) -> Option<usize> {
        self.varying.map(|_| self.group_of[configuration])
    }

    /// All parameters: the joints about their axes in order, the varying one as its groups; then the springs normal to
    /// the axes, where there are any.
    pub fn parameters(&self) -> Vec<Parameter> {
        let groups = || (0..self.angles.len()).map(Parameter::Group);
        let about_axes = (0..6).flat_map(|joint| {
            let is_varying = self.varying == Some(joint);
            let alone = (!is_varying).then_some(Parameter::Joint(joint));
            alone.into_iter().chain(groups().filter(move |_| is_varying))
        });
        about_axes.chain((6..self.model.columns()).map(|column| Parameter::Normal(spring(column)))).collect()
    }

    /// The spring of a parameter.
    pub fn spring(&self, parameter: Parameter) -> Spring {
        parameter.spring(self.varying)
    }

    /// The column of a parameter in the equations: see [`super::springs`].
    pub fn column(&self, parameter: Parameter) -> usize {
        column(self.spring(parameter))
    }

    /// The name of a parameter in messages.
    pub fn name(&self, parameter: Parameter) -> String {
        self.model.name(self.spring(parameter), self.angle(parameter))
    }

    /// The angle of a parameter of the varying joint. rad
    pub fn angle(&self, parameter: Parameter) -> Option<f64> {
        match parameter {
            Parameter::Joint(_) | Parameter::Normal(_) => None,
            Parameter::Group(group) => self.angles.get(group).copied(),
        }
    }
}

impl Parameter {
    /// The parameter of a column that does not vary with the angle of its joint.
    pub fn of_column(number: usize) -> Self {
        match spring(number) {
            Spring { joint, about: About::Z } => Self::Joint(joint),
            normal => Self::Normal(normal),
        }
    }

    /// The spring, where this joint (from 0) is the one with several compliances.
    pub fn spring(self, varying: Option<usize>) -> Spring {
        match self {
            Self::Joint(joint) => Spring { joint, about: About::Z },
            Self::Normal(spring) => spring,
            Self::Group(_) => Spring { joint: varying.unwrap_or_default(), about: About::Z },
        }
    }
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

/// What the rows of a reading are divided by, so that all have the same variance (Klimchik et al. 2017, eta in eq. 17).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Standard deviation of one coordinate of one reading. m
    pub position: f64,
    /// Standard deviation of one component of one orientation. rad
    pub orientation: f64,
}

impl Noise {
    /// What deflections (per m) and rotations (per rad) are multiplied by to have unit variance: they are differences
    /// of two readings, so that their variance is twice that of one.
    pub fn weights(&self) -> (f64, f64) {
        let weight = |deviation: f64| 1.0 / (libm::sqrt(2.0) * deviation);
        (weight(self.position), weight(self.orientation))
    }
}

/// One reading as equations of unit variance: `deflection = design * compliances + error`. Rows 3 to 5 are zero in
/// sheets without orientations. Springs are columns in the order of [`super::springs`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation<const N: usize> {
    /// Design matrix: columns are the springs, those of held springs zero.
    pub design: SMatrix<f64, 6, N>,
    /// Deflection read, less what is known of it.
    pub deflection: Vector6<f64>,
    /// What the compliances that are sought do not change: the deflection by the held springs, with the compliances of
    /// the starting arm at the angles of the configuration, and what is not linear in the others.
    pub known: Vector6<f64>,
}

/// What the equations of a sheet are made of.
#[derive(Debug, Clone, Copy)]
pub struct ObservationModel<'a, const N: usize> {
    /// The starting arm.
    pub robot: &'a Robot,
    /// The readings.
    pub sheet: &'a Sheet,
    /// Where the tracker and the reference points are.
    pub setup: &'a Setup,
    /// Where the wrench acts, in the flange frame. m
    pub load_point: &'a Vector3<f64>,
    /// What the equations are divided by.
    pub noise: Noise,
    /// Which springs are held at the compliances of the starting arm.
    pub hold: [bool; N],
}

impl<const N: usize> ObservationModel<'_, N> {
    /// The equations of all readings for small deflections, linear in the load.
    pub fn linear(&self) -> Vec<Observation<N>> {
        let deflected = |configuration| {
            let held = self.with_held(configuration, SVector::zeros());
            Deflected::linear(self.robot, held, configuration, self.load_point)
        };
        self.sheet.configurations.iter().flat_map(|c| self.equations(c, &deflected(c))).collect()
    }

    /// The equations of all readings linearised about the arm as it rests with these compliances (rad/(N m)), a
    /// function of the configuration (from 0); and the configurations in which it would give way, whose equations are
    /// those for small deflections.
    pub fn about(&self, compliances: impl Fn(usize) -> SVector<f64, N>) -> (Vec<Observation<N>>, Vec<usize>) {
        let mut observations = Vec::with_capacity(self.sheet.readings.len());
        let mut given_way = Vec::new();
        for (index, configuration) in self.sheet.configurations.iter().enumerate() {
            let about = self.with_held(configuration, compliances(index));
            let deflected =
                Deflected::at_rest(self.robot, about, configuration, self.load_point).unwrap_or_else(|_| {
                    given_way.push(index);
                    Deflected::linear(self.robot, about, configuration, self.load_point)
                });
            observations.extend(self.equations(configuration, &deflected));
        }
        (observations, given_way)
    }

    /// Compliances with those of held springs in their places. rad/(N m)
    fn with_held(&self, configuration: &Configuration, mut compliances: SVector<f64, N>) -> SVector<f64, N> {
        let own = compliances_of::<N>(self.robot, &configuration.theta);
        for column in (0..N).filter(|column| self.hold[*column]) {
            compliances[column] = own[column];
        }
        compliances
    }

    /// The equations of the readings in a configuration.
    fn equations(&self, configuration: &Configuration, deflected: &Deflected<'_, N>) -> Vec<Observation<N>> {
        let base_from_tracker = self.setup.tracker_from_base.rotation.transpose();
        let (linear, angular) = self.noise.weights();
        let observation = |reading: &Reading| {
            let place = &self.setup.points[reading.point];
            let (response, moved) = (deflected.response(place), deflected.displacement(place));
            let (mut design, mut read, mut known) = (SMatrix::<f64, 6, N>::zeros(), Vector6::zeros(), Vector6::zeros());
            let mut set = |rows: usize, response: SMatrix<f64, 3, N>, found: Vector3<f64>, predicted: Vector3<f64>| {
                design.fixed_rows_mut::<3>(rows).copy_from(&response);
                read.fixed_rows_mut::<3>(rows).copy_from(&found);
                known.fixed_rows_mut::<3>(rows).copy_from(&predicted);
            };
            let found = base_from_tracker * (reading.loaded - reading.unloaded);
            set(0, response.linear * linear, found * linear, moved.linear * linear);
            if let Some(turn) = &reading.turn {
                set(3, response.angular * angular, base_from_tracker * turn * angular, moved.angular * angular);
            }
            (0..N).filter(|column| self.hold[*column]).for_each(|column| design.fill_column(column, 0.0));
            known -= design * deflected.compliances();
            Observation { design, deflection: read - known, known }
        };
        self.sheet.readings[configuration.readings.clone()].iter().map(observation).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let layout = Layout::new(&sheet, FitModel::Axes, Some(1), 1.5e-3);
        assert_eq!(layout.group_of, [1, 0, 1, 0, 2, 3]);
        assert!((layout.angles[1] - 0.5005).abs() < 1e-15);
        assert_eq!(layout.parameters().len(), 9);
        assert_eq!(layout.parameters()[1], Parameter::Group(0));
        assert_eq!(Layout::new(&sheet, FitModel::Axes, None, 1e-3).parameters().len(), 6);
    }
}
