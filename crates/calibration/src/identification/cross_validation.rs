//! How well the arm's numbers predict a configuration that was left out.
//!
//! For least squares the residuals of a configuration without which the estimate was made are `(I - H)^-1 e`, with its
//! ordinary residuals e and its block H of the hat matrix, so that nothing is estimated again.

use super::law::ArmFit;
use super::model::{Layout, Observation};
use super::sheet::Sheet;
use nalgebra::{DMatrix, DVector, SVector};
use serde::Serialize;

/// The error of predicted deflections, each from all other configurations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// Root of the mean square of a component, for equations of unit variance; over all configurations that the others
    /// predict.
    pub rms: f64,
    /// The worst configuration and its root mean square.
    pub worst: Option<(usize, f64)>,
    /// Configurations without which a number of the arm would be lost.
    pub unpredicted: Vec<usize>,
}

/// The compliances of a configuration by the arm's numbers. rad/(N m)
pub fn compliances<const N: usize>(layout: &Layout, arm: &ArmFit<N>, configuration: usize) -> SVector<f64, N> {
    let mut compliances = arm.joints;
    if let (Some(joint), Some(group)) = (layout.varying, layout.group(configuration)) {
        compliances[joint] = arm.groups[group].0;
    }
    compliances
}

/// Derivatives of those by the arm's numbers, one row for each.
fn derivatives<const N: usize>(layout: &Layout, arm: &ArmFit<N>, configuration: usize) -> DMatrix<f64> {
    let mut derivatives = DMatrix::zeros(N, arm.parameters.len());
    let group = layout.group(configuration);
    for (index, parameter) in arm.parameters.iter().enumerate() {
        let column = parameter.column();
        derivatives[(column, index)] = match group {
            Some(group) if layout.varying == Some(column) => arm.groups[group].1[index],
            _ => 1.0,
        };
    }
    derivatives
}

/// Leaves out each configuration in turn; readings for which `kept` does not hold are no part of it.
pub fn leave_one_out<const N: usize>(
    sheet: &Sheet,
    layout: &Layout,
    observations: &[Observation<N>],
    kept: &[bool],
    arm: &ArmFit<N>,
) -> Prediction {
    /// Below this, a diagonal element of the factor of I - H means that nothing is left to predict with.
    const NOTHING: f64 = 1e-5;
    let mut prediction = Prediction { rms: 0.0, worst: None, unpredicted: vec![] };
    let (mut sum, mut count) = (0.0, 0_usize);
    for (index, configuration) in sheet.configurations.iter().enumerate() {
        let own: Vec<usize> = configuration.readings.clone().filter(|reading| kept[*reading]).collect();
        if own.is_empty() {
            continue;
        }
        let compliances = compliances(layout, arm, index);
        let derivatives = derivatives(layout, arm, index);
        let mut design = DMatrix::zeros(6 * own.len(), arm.parameters.len());
        let mut residual = DVector::zeros(6 * own.len());
        for (slot, reading) in own.iter().enumerate() {
            let observation = &observations[*reading];
            design.rows_mut(6 * slot, 6).copy_from(&(observation.design * &derivatives));
            residual.rows_mut(6 * slot, 6).copy_from(&(observation.deflection - observation.design * compliances));
        }
        let hat = &design * &arm.covariance * design.transpose();
        let rest = DMatrix::identity(hat.nrows(), hat.ncols()) - hat;
        let Some(factor) = rest.cholesky().filter(|factor| factor.l().diagonal().min() > NOTHING) else {
            prediction.unpredicted.push(index);
            continue;
        };
        let square = factor.solve(&residual).norm_squared();
        let rows = own.len() * sheet.rows_per_reading();
        let rms = libm::sqrt(square / rows as f64);
        if prediction.worst.is_none_or(|(_, worst)| rms > worst) {
            prediction.worst = Some((index, rms));
        }
        sum += square;
        count += rows;
    }
    prediction.rms = libm::sqrt(sum / count.max(1) as f64);
    prediction
}
