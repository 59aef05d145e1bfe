//! The CSV file of expected errors.

use super::super::super::output::ReportError;
use super::super::json::{URAD, key, rounded, unit};
use super::super::tables::seen_name;
use crate::csv_file::rows_or;
use crate::figure::AngleDeg;
use schemars::JsonSchema;
use serde::Serialize;
use stead_calibration::identification::FitModel;
use stead_calibration::identification::design::Design;

/// Significant digits of expected errors.
const DIGITS: usize = 6;

fn number(value: f64) -> f64 {
    rounded(value, DIGITS)
}

/// The expected error of a compliance or of a number of the compensator, with six significant digits.
#[derive(Debug, Clone, PartialEq, Default, Serialize, JsonSchema)]
pub struct ExpectedRow {
    /// The compliance, or a key of the robot file.
    parameter: String,
    /// Its unit.
    unit: &'static str,
    /// The angle that it is at, of a joint beside a compensator.
    angle_deg: Option<AngleDeg>,
    /// Its value.
    value: f64,
    /// Standard deviation that `fit` will report for it alone.
    std: Option<f64>,
    /// Standard deviation by the law of its joint over all angles.
    std_by_law: Option<f64>,
    /// The least of random sets of configurations.
    std_by_law_best_random: Option<f64>,
    /// Their median.
    std_by_law_median_random: Option<f64>,
}

/// `expected.csv`: an [`ExpectedRow`] for every compliance, then for the numbers of the compensator.
pub(super) fn expected(model: FitModel, plan: &Design) -> Result<Vec<u8>, ReportError> {
    let urad = |value: f64| number(value * URAD);
    let bars = plan.compliances.iter().map(|bar| ExpectedRow {
        parameter: seen_name(model, &plan.gauge, bar.spring()).trim_start_matches("seen.").to_owned(),
        unit: "urad/(N m)",
        angle_deg: bar.angle.map(Into::into),
        value: urad(bar.value),
        std: bar.deviation.map(urad),
        std_by_law: Some(urad(bar.by_law)),
        std_by_law_best_random: bar.best_random.map(urad),
        std_by_law_median_random: bar.median_random.map(urad),
    });
    let spring = plan.compensator.iter().map(|bar| {
        let (parameter, factor) = key(&bar.parameter);
        let deviation = Some(number(bar.deviation * factor));
        ExpectedRow {
            parameter,
            unit: unit(bar.parameter.quantity),
            value: number(bar.value * factor),
            std: deviation,
            std_by_law: deviation,
            ..ExpectedRow::default()
        }
    });
    rows_or("the table of expected errors", &ExpectedRow::default(), bars.chain(spring))
}
