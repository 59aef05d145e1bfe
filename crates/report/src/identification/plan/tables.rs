//! The CSV file of expected errors.

use super::super::super::output::ReportError;
use super::super::{URAD, key, rounded, unit};
use crate::csv_file::table;
use crate::units::Unit;
use stead_calibration::identification::design::Design;

/// Significant digits of expected errors.
const DIGITS: usize = 6;

fn number(value: f64) -> String {
    rounded(value, DIGITS).to_string()
}

/// `expected.csv`: every compliance with the standard deviation that `fit` will report for it alone (`std`), that by the law of
/// its joint over all angles (`std_by_law`), and the same from random sets; then the numbers of the compensator.
pub(super) fn expected(plan: &Design) -> Result<Vec<u8>, ReportError> {
    let header = "parameter,unit,angle_deg,value,std,std_by_law,std_by_law_best_random,std_by_law_median_random";
    let text = |value: Option<f64>| value.map_or_else(String::new, |value| number(value * URAD));
    let bars = plan.compliances.iter().map(|bar| {
        vec![
            format!("joints[{}].compliance", bar.joint + 1),
            "urad/(N m)".to_owned(),
            bar.angle.map_or_else(String::new, |angle| Unit::ANGLE_DEG.text(angle)),
            number(bar.value * URAD),
            text(bar.deviation),
            text(Some(bar.by_law)),
            text(bar.best_random),
            text(bar.median_random),
        ]
    });
    let spring = plan.compensator.iter().map(|bar| {
        let (name, factor) = key(&bar.parameter);
        let unit = unit(bar.parameter.quantity).to_owned();
        let (value, deviation) = (number(bar.value * factor), number(bar.deviation * factor));
        vec![name, unit, String::new(), value, deviation.clone(), deviation, String::new(), String::new()]
    });
    table("the table of expected errors", header.split(','), bars.chain(spring))
}
