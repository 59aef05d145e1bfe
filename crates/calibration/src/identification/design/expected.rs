//! The standard deviations that an identification from a set will report, predicted by its own normal equations.

use super::super::law::{ArmParameter, Law, Quantity};
use super::super::model::{Layout, Noise, ObservationModel, Parameter};
use super::super::normal_equations::{NormalEquations, Unidentifiable};
use super::super::setup::Setup;
use super::super::sheet::{LoadCase, Sheet};
use super::super::spring::scaled_inverse;
use super::super::synthetic::{MeasuringCell, sheet};
use super::parameters::{InformationMatrix, MAX_PARAMETERS, Parameters};
use super::request::Request;
use nalgebra::{DMatrix, SVector, Vector6};
use serde::Serialize;
use stead_model::robot::{Compliance, Pose};

/// A compliance and its expected standard deviation. rad/(N m)
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpectedCompliance {
    /// The joint, from 0.
    pub joint: usize,
    /// The angle to which it belongs, where the joint has several compliances. rad
    pub angle: Option<f64>,
    /// The compliance of the arm as far as it is known.
    pub value: f64,
    /// Standard deviation on its own, as `fit` reports it; nothing where the plan has no configuration at this angle.
    pub deviation: Option<f64>,
    /// Standard deviation by the law of the joint, over all its angles; the same as on its own for joints without one.
    pub by_law: f64,
    /// That from the best of the random sets.
    pub best_random: Option<f64>,
    /// The median of that over the random sets.
    pub median_random: Option<f64>,
}

impl ExpectedCompliance {
    /// The smallest standard deviation that the plan gives, as a share of the compliance.
    pub fn share(&self) -> f64 {
        self.by_law / self.value
    }
}

/// A parameter of a compensator or of the joint beside it, and its expected standard deviation. SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpectedParameter {
    /// Which parameter.
    pub parameter: ArmParameter,
    /// As the starting robot has it.
    pub value: f64,
    /// Standard deviation.
    pub deviation: f64,
}

/// A sheet of configurations with what the starting arm would show, base and tracker frame being the same.
pub fn sheet_of(request: &Request, load_cases: &[LoadCase]) -> Sheet {
    let cell = MeasuringCell {
        tracker_from_base: Pose::identity(),
        load_point: request.load_point,
        points: request.points.clone(),
        is_full_pose: false,
    };
    sheet(&request.robot, &cell, load_cases, || 0.0, || 0.0)
}

/// The normal equations that `fit` will have for a sheet, in equations of unit variance, and its parameters.
pub fn normal_of(request: &Request, sheet: &Sheet) -> (Layout, NormalEquations) {
    let setup = Setup { tracker_from_base: Pose::identity(), points: request.points.clone(), residual_rms: 0.0 };
    let noise = Noise { position: request.noise, orientation: 1.0 };
    let Request { robot, load_point, hold, .. } = request;
    let equations = ObservationModel { robot, sheet, setup: &setup, load_point, noise, hold: *hold }.linear();
    let layout = Layout::new(sheet, request.varying.map(|(joint, _)| joint), request.angle_tolerance);
    let normal = NormalEquations::new(sheet, &layout, &equations, &vec![1.0; equations.len()]);
    (layout, normal)
}

/// The compliances that an identification will report from a sheet, each by itself, with their standard deviations; and
/// the unidentifiable combinations.
pub fn seen(
    layout: &Layout,
    normal: &NormalEquations,
    hold: [bool; 6],
) -> (Vec<(Parameter, f64)>, Vec<Unidentifiable>) {
    let (free, unidentifiable) = normal.identifiable(hold);
    let held = vec![0.0; layout.angles.len()];
    let Some(solution) = normal.solve(&free, (&Vector6::zeros(), &held)) else { return (vec![], unidentifiable) };
    let deviation = |parameter: Parameter| {
        let joint = layout.joint(parameter);
        let group = match parameter {
            Parameter::Joint(_) => None,
            Parameter::Group(group) => Some(group),
        };
        (parameter, libm::sqrt(solution.covariance(layout.varying, group)[(joint, joint)]))
    };
    (
        layout.parameters().into_iter().filter(|parameter| free.contains(*parameter)).map(deviation).collect(),
        unidentifiable,
    )
}

/// Covariance of the free numbers of the arm, zero elsewhere; nothing where they are not told.
pub fn covariance(information: &InformationMatrix, free: &[bool; MAX_PARAMETERS]) -> Option<InformationMatrix> {
    let free: Vec<usize> = (0..MAX_PARAMETERS).filter(|k| free[*k]).collect();
    let inverse = scaled_inverse(&DMatrix::from_fn(free.len(), free.len(), |i, j| information[(free[i], free[j])]))?;
    let mut covariance = InformationMatrix::zeros();
    for (i, a) in free.iter().enumerate() {
        for (j, b) in free.iter().enumerate() {
            covariance[(*a, *b)] = inverse[(i, j)];
        }
    }
    Some(covariance)
}

/// Standard deviation of something with these derivatives by the numbers of the arm.
pub fn deviation(covariance: &InformationMatrix, derivatives: &SVector<f64, MAX_PARAMETERS>) -> f64 {
    libm::sqrt((covariance * derivatives).dot(derivatives).max(0.0))
}

/// The joints and, where one varies, its angles: every compliance that a plan has an error bar for.
pub fn identifiable_compliances(request: &Request, free: &[bool; MAX_PARAMETERS]) -> Vec<(usize, Option<f64>)> {
    let entry = |joint: usize| match request.varying {
        Some((varying, _)) if varying == joint => request.levels.iter().map(|angle| (joint, Some(*angle))).collect(),
        _ => vec![(joint, None)],
    };
    (0..6).filter(|joint| free[*joint]).flat_map(entry).collect()
}

/// The numbers of the compensator and of the joint beside it, where the starting robot has them.
pub fn expected_compensator(request: &Request, covariance: &InformationMatrix) -> Vec<ExpectedParameter> {
    let Some((joint, Law::Spring(_))) = request.varying else { return vec![] };
    let Compliance::Compensated { alone, compensator } = request.robot.joints()[joint].compliance else {
        return vec![];
    };
    let (spring, length) = (compensator.spring_stiffness, compensator.free_length);
    let bar = |quantity: Quantity, value: f64, derivatives: [(usize, f64); 2]| {
        let mut row = SVector::zeros();
        derivatives.iter().for_each(|(number, slope)| row[*number] += slope);
        ExpectedParameter { parameter: ArmParameter { joint, quantity }, value, deviation: deviation(covariance, &row) }
    };
    vec![
        bar(Quantity::Compliance, alone, [(joint, -alone * alone), (joint, 0.0)]),
        bar(Quantity::SpringStiffness, spring, [(6, 1.0), (7, 0.0)]),
        bar(Quantity::FreeLength, length, [(6, -length / spring), (7, 1.0 / spring)]),
    ]
}

/// The covariances by which the compliance of a joint at an angle is judged.
pub(super) fn expected_compliances(
    request: &Request,
    parameters: &Parameters<'_>,
    free: &[bool; MAX_PARAMETERS],
    plan: &InformationMatrix,
    random: &[InformationMatrix],
    best_random: Option<&InformationMatrix>,
) -> Vec<ExpectedCompliance> {
    let bar = |(joint, angle): (usize, Option<f64>)| {
        let at = angle.unwrap_or_default();
        let row = parameters.row(joint, at);
        let mut spread: Vec<f64> = random.iter().map(|covariance| deviation(covariance, &row)).collect();
        spread.sort_by(f64::total_cmp);
        ExpectedCompliance {
            joint,
            angle,
            value: request.robot.joints()[joint].compliance_at(at),
            deviation: None,
            by_law: deviation(plan, &row),
            best_random: best_random.map(|covariance| deviation(covariance, &row)),
            median_random: spread.get(spread.len() / 2).copied(),
        }
    };
    identifiable_compliances(request, free).into_iter().map(bar).collect()
}
