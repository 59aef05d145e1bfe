//! The standard deviations that an identification from a set will report, predicted by its own normal equations.

use super::super::gauge::Gauge;
use super::super::law::{ArmParameter, Law, Quantity};
use super::super::model::{Layout, Noise, ObservationModel, Parameter};
use super::super::normal_equations::{NormalEquations, Unidentifiable};
use super::super::setup::Setup;
use super::super::sheet::{LoadCase, Sheet};
use super::super::springs::{spring, stated_normal};
use super::super::synthetic::{MeasuringCell, sheet};
use super::parameters::{InformationMatrix, Parameters};
use super::request::Request;
use nalgebra::SVector;
use serde::Serialize;
use stead_model::robot::{About, Compliance, Pose, Robot, Spring};

/// A compliance and its expected standard deviation. rad/(N m)
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExpectedCompliance {
    /// The joint, from 0.
    pub joint: usize,
    /// About which axis of the frame of its row.
    pub about: About,
    /// The angle to which it belongs, where the joint has several compliances. rad
    pub angle: Option<f64>,
    /// The compliance of the arm as far as it is known; of springs that cannot be told apart their sum.
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
        (self.by_law / self.value).abs()
    }

    /// The spring.
    pub fn spring(&self) -> Spring {
        Spring { joint: self.joint, about: self.about }
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
pub fn normal_of<const N: usize>(request: &Request, sheet: &Sheet) -> (Layout, NormalEquations<N>) {
    let setup = Setup { tracker_from_base: Pose::identity(), points: request.points.clone(), residual_rms: 0.0 };
    let noise = Noise { position: request.noise, orientation: 1.0 };
    let Request { robot, load_point, .. } = request;
    let hold = request.held();
    let equations = ObservationModel { robot, sheet, setup: &setup, load_point, noise, hold }.linear();
    let layout = Layout::new(sheet, request.model, request.varying.map(|(joint, _)| joint), request.angle_tolerance);
    let normal = NormalEquations::new(sheet, &layout, &equations, &vec![1.0; equations.len()]);
    (layout, normal)
}

/// The compliances that an identification will report from a sheet, each by itself, with their standard deviations; and
/// the unidentifiable combinations.
pub fn seen<const N: usize>(
    layout: &Layout,
    normal: &NormalEquations<N>,
    hold: [bool; N],
) -> (Vec<(Parameter, f64)>, Vec<Unidentifiable>) {
    let (free, unidentifiable) = normal.identifiable(hold);
    let held = vec![0.0; layout.angles.len()];
    let Some(solution) = normal.solve(&free, (&SVector::zeros(), &held)) else { return (vec![], unidentifiable) };
    let deviation = |parameter: Parameter| {
        let column = layout.column(parameter);
        let group = match parameter {
            Parameter::Joint(_) | Parameter::Normal(_) => None,
            Parameter::Group(group) => Some(group),
        };
        (parameter, libm::sqrt(solution.covariance(layout.varying, group)[(column, column)]))
    };
    (
        layout.parameters().into_iter().filter(|parameter| free.contains(*parameter)).map(deviation).collect(),
        unidentifiable,
    )
}

/// Standard deviation of something with these derivatives by the numbers of the arm.
pub fn deviation<const P: usize>(covariance: &InformationMatrix<P>, derivatives: &SVector<f64, P>) -> f64 {
    libm::sqrt((covariance * derivatives).dot(derivatives).max(0.0))
}

/// The springs by their columns and, where one varies, its angles: every compliance that a plan has an error bar for.
pub fn identifiable_compliances<const P: usize>(request: &Request, free: &[bool; P]) -> Vec<(usize, Option<f64>)> {
    let entry = |column: usize| match request.varying {
        Some((varying, _)) if varying == column => request.levels.iter().map(|angle| (column, Some(*angle))).collect(),
        _ => vec![(column, None)],
    };
    (0..P - 2).filter(|column| free[*column]).flat_map(entry).collect()
}

/// The numbers of the compensator and of the joint beside it, where the starting robot has them.
pub fn expected_compensator<const P: usize>(
    request: &Request,
    covariance: &InformationMatrix<P>,
) -> Vec<ExpectedParameter> {
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
        bar(Quantity::SpringStiffness, spring, [(P - 2, 1.0), (P - 1, 0.0)]),
        bar(Quantity::FreeLength, length, [(P - 2, -length / spring), (P - 1, 1.0 / spring)]),
    ]
}

/// The covariances by which the compliance of a joint at an angle is judged.
pub(super) struct Covariances<const P: usize> {
    pub plan: InformationMatrix<P>,
    /// Of the random sets that identify all.
    pub random: Vec<InformationMatrix<P>>,
    pub best_random: Option<InformationMatrix<P>>,
}

/// The expected standard deviations of all compliances, but for those on their own.
pub(super) fn expected_compliances<const P: usize>(
    request: &Request,
    parameters: &Parameters<'_>,
    gauge: &Gauge,
    free: &[bool; P],
    by: &Covariances<P>,
) -> Vec<ExpectedCompliance> {
    let bar = |(column, angle): (usize, Option<f64>)| {
        let at = angle.unwrap_or_default();
        let row = parameters.row(column, at);
        let Spring { joint, about } = spring(column);
        let mut spread: Vec<f64> = by.random.iter().map(|covariance| deviation(covariance, &row)).collect();
        spread.sort_by(f64::total_cmp);
        ExpectedCompliance {
            joint,
            about,
            angle,
            value: known(&request.robot, gauge, spring(column), at),
            deviation: None,
            by_law: deviation(&by.plan, &row),
            best_random: by.best_random.as_ref().map(|covariance| deviation(covariance, &row)),
            median_random: spread.get(spread.len() / 2).copied(),
        }
    };
    identifiable_compliances(request, free).into_iter().map(bar).collect()
}

/// What is told under the name of a spring, as far as it is known: its compliance with that of those that are told only
/// together with it. rad/(N m)
fn known(robot: &Robot, gauge: &Gauge, of: Spring, angle: f64) -> f64 {
    let compliance = |spring: Spring| match spring.about {
        About::Z => robot.joints()[spring.joint].compliance_at(angle),
        _ => stated_normal(robot, spring),
    };
    gauge.others(of).into_iter().fold(compliance(of), |sum, (other, share)| sum + share * compliance(other))
}
