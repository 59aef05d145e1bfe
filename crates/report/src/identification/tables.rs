//! The CSV files of an identification.

use super::super::output::ReportError;
use super::json::{URAD, key, numbers, rounded, unit};
use crate::csv_file::rows_or;
use crate::figure::{AngleDeg, DeflectionMm, Studentised, some};
use nalgebra::Vector3;
use stead_calibration::identification::gauge::Gauge;
use stead_calibration::identification::outcome::RowResult;
use stead_calibration::identification::springs::key_name;
use stead_calibration::identification::{FitModel, Identified};
use stead_model::robot::Spring;
use stead_runs::IdentifyRun;

/// Significant digits of estimates.
const DIGITS: usize = 9;

records! {
    /// An estimate, with nine significant digits.
    #[derive(Default)]
    pub struct EstimateRow of (parameter: String, unit: &'static str, angle: Option<f64>, numbers: [f64; 4]) {
        /// A compliance that was seen, or a key of the robot file.
        parameter: String = parameter,
        /// Its unit.
        unit: &'static str = unit,
        /// The angle that it is at, of a joint beside a compensator.
        angle_deg: Option<AngleDeg> = some(angle),
        /// The estimate.
        value: f64 = numbers[0],
        /// Its standard deviation.
        std: f64 = numbers[1],
        /// Lower end of its 95 % interval.
        low: f64 = numbers[2],
        /// Upper end of its 95 % interval.
        high: f64 = numbers[3],
    }
}

/// `compliances.csv`: an [`EstimateRow`] first for every compliance (one for each distinct angle of the joint beside a
/// compensator), then for the parameters of the robot file.
pub(super) fn compliances(found: &Identified) -> Result<Vec<u8>, ReportError> {
    let seen = found.compliances.iter().map(|estimate| {
        let name = seen_name(found.model, &found.gauge, found.spring(estimate.parameter));
        EstimateRow::of(name, "urad/(N m)", estimate.angle, numbers(estimate, URAD, DIGITS))
    });
    let arm = found.arm.iter().map(|estimate| {
        let (name, factor) = key(&estimate.parameter);
        EstimateRow::of(name, unit(estimate.parameter.quantity), None, numbers(estimate, factor, DIGITS))
    });
    rows_or("the table of compliances", &EstimateRow::default(), seen.chain(arm))
}

/// The name of a compliance that was seen: `seen.joints[3].compliance`; among springs about three directions
/// `seen.joints[3].x`, with those that are told only together with it, `seen.joints[5].z + joints[4].y`.
pub(super) fn seen_name(model: FitModel, gauge: &Gauge, spring: Spring) -> String {
    if model == FitModel::Axes {
        return format!("seen.joints[{}].compliance", spring.joint + 1);
    }
    let other = |(other, share): (Spring, f64)| match share {
        1.0 => format!(" + {}", key_name(other)),
        -1.0 => format!(" - {}", key_name(other)),
        share => format!(" + {} {}", rounded(share, DIGITS), key_name(other)),
    };
    let others: String = gauge.others(spring).into_iter().map(other).collect();
    format!("seen.{}{others}", key_name(spring))
}

records! {
    /// A reading: its deflection read and by the identified arm, in the base frame.
    #[derive(Default)]
    pub struct ResidualRow of (row: &RowResult, run: &IdentifyRun) {
        /// Its line in the sheet.
        line: usize = row.line,
        /// Its configuration.
        configuration: String = run.problem.sheet.configurations[row.configuration].name.clone(),
        /// Its reference point.
        point: String = run.problem.sheet.points[row.point].clone(),
        /// The deflection read.
        measured: Deflection = row.measured.into(),
        /// That of the identified arm.
        predicted: Deflection = row.predicted.into(),
        /// The difference.
        residual: Deflection = (row.measured - row.predicted).into(),
        /// The studentised residual.
        studentised: Studentised = row.studentised.into(),
        /// Whether it was left out.
        outlier: bool = row.is_outlier,
    }

    /// A deflection in a row.
    #[derive(Copy, Default)]
    struct Deflection from deflection: Vector3<f64> {
        /// x.
        x_mm: DeflectionMm = deflection.x.into(),
        /// y.
        y_mm: DeflectionMm = deflection.y.into(),
        /// z.
        z_mm: DeflectionMm = deflection.z.into(),
    }
}

/// `residuals.csv`: a [`ResidualRow`] for every reading.
pub(super) fn residuals(run: &IdentifyRun, found: &Identified) -> Result<Vec<u8>, ReportError> {
    let readings = found.rows.iter().map(|row| ResidualRow::of(row, run));
    rows_or("the table of residuals", &ResidualRow::default(), readings)
}
