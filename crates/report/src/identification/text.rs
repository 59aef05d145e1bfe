//! The table for people.

use super::{URAD, key};
use crate::columns::aligned;
use crate::units::fixed;
use stead_calibration::identification::law::Quantity;
use stead_calibration::identification::model::{Layout, Parameter};
use stead_calibration::identification::outcome::Estimate;
use stead_calibration::identification::{Identified, RowResult};
use stead_format::IdentifyRun;

/// Compliances as seen with their 95 % intervals, the numbers of the robot file, how well they explain and predict the readings,
/// outliers by name, and what else there is to know.
pub fn identify_text(run: &IdentifyRun, found: &Identified) -> String {
    let sheet = &run.problem.sheet;
    let mut text = format!(
        "{}: {} readings of {} points in {} configurations\n\n",
        found.robot.name(),
        sheet.readings.len(),
        sheet.points.len(),
        sheet.configurations.len()
    );
    text += &aligned(&seen_rows(found), &[0]);
    if found.varying.is_some() {
        text += "\n";
        text += &aligned(&arm_rows(found), &[0]);
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
    for note in notes(run, found) {
        text += &format!("note: {note}\n");
    }
    text
}

fn cells<P>(estimate: &Estimate<P>, factor: f64) -> [String; 4] {
    // Two digits of the standard deviation, and as many decimals of everything else.
    let deviation = estimate.deviation * factor;
    let exponent = if deviation > 0.0 { libm::floor(libm::log10(deviation)) } else { -6.0 };
    let decimals = (1.0 - exponent).clamp(0.0, 12.0) as usize;
    let [low, high] = estimate.interval.map(|end| fixed(end * factor, decimals));
    let value = estimate.value * factor;
    let percent = fixed(100.0 * (deviation / value).abs(), 2);
    [fixed(value, decimals), fixed(deviation, decimals), percent, format!("{low} .. {high}")]
}

fn seen_rows(found: &Identified) -> Vec<Vec<String>> {
    let header = ["joint", "at deg", "urad/(N m)", "std", "%", "95 % interval"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for estimate in &found.compliances {
        let angle = estimate.angle.map_or_else(|| "-".to_owned(), |angle| fixed(angle.to_degrees(), 2));
        let mut row = vec![(joint_of(found, estimate.parameter) + 1).to_string(), angle];
        row.extend(cells(estimate, URAD));
        rows.push(row);
    }
    rows
}

fn arm_rows(found: &Identified) -> Vec<Vec<String>> {
    let header = ["in the robot file", "value", "std", "%", "95 % interval"];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for estimate in &found.arm {
        let (name, factor) = key(&estimate.parameter);
        let mut row = vec![name];
        row.extend(cells(estimate, factor));
        rows.push(row);
    }
    rows
}

fn joint_of(found: &Identified, parameter: Parameter) -> usize {
    match parameter {
        Parameter::Joint(joint) => joint,
        Parameter::Group(_) => found.varying.unwrap_or_default(),
    }
}

fn outlier(run: &IdentifyRun, row: &RowResult) -> String {
    let sheet = &run.problem.sheet;
    format!(
        "outlier left out: line {}, configuration {}, point {}: {} mm beside the model\n",
        row.line,
        sheet.configurations[row.configuration].name,
        sheet.points[row.point],
        fixed((row.measured - row.predicted).norm() * 1e3, 3)
    )
}

/// Distances below this are rounding. m
const ROUNDING: f64 = 1e-9;
/// Estimates worth less than this many standard deviations are hardly seen.
const HARDLY: f64 = 5.0;

/// Unloaded readings that are farther off than this share of the flange's spread leave levers in doubt that matter.
const MISFIT: f64 = 2e-3;
/// Likewise reference points with a larger standard deviation.
const LOOSE: f64 = 1e-3;
/// A reading so many times as far off as the others is not like them.
const FAR: f64 = 6.0;

/// What is to be known about base transform and reference points.
fn setup_notes(run: &IdentifyRun, found: &Identified) -> Vec<String> {
    let mut notes = Vec::new();
    let (off, fit) = (found.setup.residual_rms, &found.setup_fit);
    let (line, distance) = fit.worst;
    if off > MISFIT * fit.flange_rms || distance > FAR * fit.others_rms.max(ROUNDING) {
        notes.push(format!(
            "line {line}: the unloaded reading is {} mm away from where the joint angles put it (all: {} mm rms); levers may \
             be wrong by as much",
            fixed(distance * 1e3, 3),
            fixed(off * 1e3, 3)
        ));
    }
    for (name, deviation) in run.problem.sheet.points.iter().zip(&fit.point_deviations) {
        if *deviation > LOOSE * fit.flange_rms {
            notes.push(format!(
                "the place of point {name} on the flange is only known to {} mm (standard deviation), which the intervals \
                 do not count: turn the flange every way",
                fixed(deviation * 1e3, 2)
            ));
        }
    }
    notes
}

/// Compliances so many times those of the robot file, up or down, in the middle: rather a unit than an arm.
const SCALE: f64 = 5.0;

/// Whether all compliances are off by a common factor.
fn scale_note(run: &IdentifyRun, found: &Identified) -> Option<String> {
    let start = run.problem.robot.joints();
    let ratio =
        |e: &Estimate<Parameter>| e.value / start[joint_of(found, e.parameter)].compliance_at(e.angle.unwrap_or(0.0));
    let mut ratios: Vec<f64> = found.compliances.iter().map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let middle = *ratios.get(ratios.len() / 2)?;
    (!(1.0 / SCALE..=SCALE).contains(&middle)).then(|| {
        format!(
            "the compliances are {} times those of the robot file (median): are forces in N and places in mm?",
            super::rounded(middle, 3)
        )
    })
}

/// What the user should know about the result though nothing failed.
pub(super) fn notes(run: &IdentifyRun, found: &Identified) -> Vec<String> {
    let mut notes = Vec::new();
    let layout = Layout::new(&run.problem.sheet, found.varying, run.problem.angle_tolerance);
    for parameter in &found.held {
        let joint = joint_of(found, *parameter) + 1;
        notes.push(match layout.angle(*parameter) {
            None => format!(
                "the compliance of joint {joint} is not seen: it keeps the value of the robot file, which intervals and \
                 covariance take for exact"
            ),
            Some(angle) => format!(
                "nothing is seen of joint {joint} at {} deg: its compliance there follows from its other angles",
                fixed(angle.to_degrees(), 2)
            ),
        });
    }
    notes.extend(setup_notes(run, found));
    notes.extend(scale_note(run, found));
    for estimate in found.arm.iter().filter(|estimate| estimate.value < HARDLY * estimate.deviation) {
        let joint = estimate.parameter.joint + 1;
        let advice = match estimate.parameter.quantity {
            Quantity::Compliance => "load the arm so that this joint turns".to_owned(),
            _ => format!("take more angles of joint {joint}, wider apart"),
        };
        notes.push(format!("{} is hardly seen: {advice}", key(&estimate.parameter).0));
    }
    let ratio = libm::sqrt(found.variance_ratio);
    if !found.is_noise_estimated && !(0.8..1.25).contains(&ratio) {
        notes.push(format!("the residuals are {} times what noise_mm lets expect", fixed(ratio, 2)));
    }
    if found.law_probability.is_some_and(|probability| probability < 0.01) {
        let number = found.varying.unwrap_or_default() + 1;
        notes.push(format!(
            "the compliances of joint {number} at its distinct angles do not follow the law in the robot file"
        ));
    }
    if !found.are_outliers_searched {
        notes.push("too few readings to look for outliers".to_owned());
    }
    let (outliers, readings) = (found.outliers().count(), run.problem.sheet.readings.len());
    if outliers * 5 > readings {
        notes.push(format!("{outliers} of {readings} readings are outliers: the model does not fit the sheet"));
    }
    notes
}
