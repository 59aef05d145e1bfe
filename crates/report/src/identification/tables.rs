//! The CSV files of an identification.

use super::super::output::ReportError;
use super::{URAD, key, rounded, unit};
use crate::csv_file::table;
use crate::units::{Unit, fixed};
use stead_calibration::identification::Identified;
use stead_format::IdentifyRun;

/// Significant digits of estimates.
const DIGITS: usize = 9;

fn number(value: f64) -> String {
    rounded(value, DIGITS).to_string()
}

/// `compliances.csv`: first every compliance (one for each distinct angle of the joint beside a compensator), then the
/// parameters of the robot file, each with its standard deviation and 95 % interval.
pub(super) fn compliances(found: &Identified) -> Result<Vec<u8>, ReportError> {
    let header = "parameter,unit,angle_deg,value,std,low,high";
    let seen = found.compliances.iter().map(|estimate| {
        let joint = found.joint(estimate.parameter);
        let angle = estimate.angle.map_or_else(String::new, |angle| Unit::ANGLE_DEG.text(angle));
        let mut row = vec![format!("seen.joints[{}].compliance", joint + 1), "urad/(N m)".to_owned(), angle];
        row.extend(
            [estimate.value, estimate.deviation, estimate.interval[0], estimate.interval[1]]
                .map(|value| number(value * URAD)),
        );
        row
    });
    let arm = found.arm.iter().map(|estimate| {
        let (name, factor) = key(&estimate.parameter);
        let mut row = vec![name, unit(estimate.parameter.quantity).to_owned(), String::new()];
        row.extend(
            [estimate.value, estimate.deviation, estimate.interval[0], estimate.interval[1]]
                .map(|value| number(value * factor)),
        );
        row
    });
    table("the table of compliances", header.split(','), seen.chain(arm))
}

/// `residuals.csv`: every reading, its deflection read and by the identified arm (base frame), and whether it was left out.
pub(super) fn residuals(run: &IdentifyRun, found: &Identified) -> Result<Vec<u8>, ReportError> {
    let header = "\
        line,configuration,point,measured_x_mm,measured_y_mm,measured_z_mm,predicted_x_mm,predicted_y_mm,\
         predicted_z_mm,residual_x_mm,residual_y_mm,residual_z_mm,studentised,outlier";
    let sheet = &run.problem.sheet;
    let rows = found.rows.iter().map(|row| {
        let mut fields = vec![
            row.line.to_string(),
            sheet.configurations[row.configuration].name.clone(),
            sheet.points[row.point].clone(),
        ];
        for vector in [row.measured, row.predicted, row.measured - row.predicted] {
            fields.extend(vector.iter().map(|value| Unit::DEFLECTION_MM.text(*value)));
        }
        fields.push(fixed(row.studentised, 4));
        fields.push(row.is_outlier.to_string());
        fields
    });
    table("the table of residuals", header.split(','), rows)
}
