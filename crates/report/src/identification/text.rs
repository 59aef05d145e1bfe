//! The table for people.

use super::json::{URAD, is_full, key};
use crate::columns::table;
use crate::units::fixed;
use stead_calibration::identification::outcome::Estimate;
use stead_calibration::identification::{FitModel, Identified, RowResult};
use stead_model::robot::Compliance;
use stead_runs::IdentifyRun;

/// Compliances with their 95 % intervals, the parameters of the robot file, how well they explain and predict the
/// readings, outliers, and warnings.
pub fn identify_text(run: &IdentifyRun, found: &Identified) -> String {
    let sheet = &run.problem.sheet;
    let (name, readings) = (found.robot.name(), sheet.readings.len());
    let (points, configurations) = (sheet.points.len(), sheet.configurations.len());
    let mut text = format!("{name}: {readings} readings of {points} points in {configurations} configurations\n\n");
    text += &compliances(found);
    if is_full(found) {
        text += "\nin the robot file, urad/(N m)\n";
        text += &table(["joint", "about z", "about x", "about y"], spring_rows(found), &[0]);
    }
    if found.varying.is_some() {
        text += "\n";
        text += &arm(found);
    }
    let how = if found.is_noise_estimated { "estimated from the residuals" } else { "as stated" };
    text += &format!(
        "\nresidual {} mm rms; noise of one reading {} mm, {how}\npredicting a configuration from the others: {} mm rms",
        fixed(found.residual_rms * 1e3, 4),
        fixed(found.noise * 1e3, 4),
        fixed(found.prediction.rms * 1e3, 4)
    );
    if let Some((index, rms)) = found.prediction.worst {
        text += &format!(", at worst {} mm ({})", fixed(rms * 1e3, 4), sheet.configurations[index].name);
    }
    text += "\n";
    text += &format!("unloaded readings fit the joint angles to {} mm rms\n", fixed(found.setup.residual_rms * 1e3, 4));
    for row in found.outliers() {
        text += &outlier(run, row);
    }
    for warning in &found.warnings {
        text += &format!("warning: {warning}\n");
    }
    text
}

/// Value, standard deviation, that in per cent, and the interval.
pub(super) fn cells<P>(estimate: &Estimate<P>, factor: f64) -> [String; 4] {
    // Two digits of the standard deviation, and as many decimals of everything else.
    let deviation = estimate.deviation * factor;
    let exponent = if deviation > 0.0 { libm::floor(libm::log10(deviation)) } else { -6.0 };
    let decimals = (1.0 - exponent).clamp(0.0, 12.0) as usize;
    let [low, high] = estimate.interval.map(|end| fixed(end * factor, decimals));
    let value = estimate.value * factor;
    let percent = fixed(100.0 * (deviation / value).abs(), 2);
    [fixed(value, decimals), fixed(deviation, decimals), percent, format!("{low} .. {high}")]
}

fn compliances(found: &Identified) -> String {
    let first = if is_full(found) { "spring" } else { "joint" };
    let rows = found.compliances.iter().map(|estimate| {
        let angle = estimate.angle.map_or_else(|| "-".to_owned(), |angle| fixed(angle.to_degrees(), 2));
        let name = match found.model {
            FitModel::Axes => (found.joint(estimate.parameter) + 1).to_string(),
            FitModel::Full => found.name(estimate.parameter, None),
        };
        [name, angle].into_iter().chain(cells(estimate, URAD)).collect()
    });
    table([first, "at deg", "urad/(N m)", "std", "%", "95 % interval"], rows, &[0])
}

/// The springs of the robot file, a joint a row.
pub(super) fn spring_rows(found: &Identified) -> impl Iterator<Item = Vec<String>> {
    found.robot.joints().iter().enumerate().map(|(joint, row)| {
        let about_z = match row.compliance {
            Compliance::Constant(value) => fixed(value * URAD, 4),
            _ => "by its law".to_owned(),
        };
        let normal = found.robot.stated_normal_springs().map_or([0.0; 2], |all| all[joint].compliance);
        [vec![(joint + 1).to_string(), about_z], normal.map(|value| fixed(value * URAD, 4)).to_vec()].concat()
    })
}

fn arm(found: &Identified) -> String {
    let rows = found.arm.iter().map(|estimate| {
        let (name, factor) = key(&estimate.parameter);
        std::iter::once(name).chain(cells(estimate, factor)).collect()
    });
    table(["in the robot file", "value", "std", "%", "95 % interval"], rows, &[0])
}

fn outlier(run: &IdentifyRun, row: &RowResult) -> String {
    let sheet = &run.problem.sheet;
    format!(
        "outlier left out: line {}, configuration {}, point {}: {} mm from the model\n",
        row.line,
        sheet.configurations[row.configuration].name,
        sheet.points[row.point],
        fixed((row.measured - row.predicted).norm() * 1e3, 3)
    )
}
