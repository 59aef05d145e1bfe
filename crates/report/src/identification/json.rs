//! What `stead identify fit --json` prints, and `report.json`: the same document.

use super::{URAD, key, rounded};
use crate::document::Document;
use crate::units::Unit;
use serde_json::{Map, Value, json};
use stead_calibration::identification::law::Quantity;
use stead_calibration::identification::model::Parameter;
use stead_calibration::identification::outcome::Estimate;
use stead_calibration::identification::{Held, Identified, RowResult};
use stead_format::IdentifyRun;
use stead_model::robot::Compliance;

/// Significant digits of estimates.
const DIGITS: usize = 12;

/// The document: compliances, compensator, arm with covariance, residuals, outliers, prediction error.
pub fn identify_json(run: &IdentifyRun, found: &Identified) -> Value {
    let sheet = &run.problem.sheet;
    let worst = found
        .prediction
        .worst
        .map(|(index, rms)| json!({ "configuration": sheet.configurations[index].name, "rms_mm": millimetres(rms) }));
    let unpredicted: Vec<&str> =
        found.prediction.unpredicted.iter().map(|index| sheet.configurations[*index].name.as_str()).collect();
    Document::new(&run.inputs).notes(&run.notes).warnings(&found.warnings).with(json!({
        "robot": found.robot.name(),
        "configurations": sheet.configurations.len(),
        "readings": sheet.readings.len(),
        "compliances": found.compliances.iter().map(|estimate| compliance(found, estimate)).collect::<Vec<_>>(),
        "compensator": compensator(found),
        "arm": found.arm.iter().map(|estimate| {
            let (name, factor) = key(&estimate.parameter);
            let mut map = Map::from_iter([("parameter".to_owned(), json!(name))]);
            map.extend(numbers(estimate, factor, ["value", "std", "low", "high"]));
            Value::Object(map)
        }).collect::<Vec<_>>(),
        "held": held(found),
        "noise_mm": millimetres(found.noise),
        "noise_estimated": found.is_noise_estimated,
        "noise_ratio": rounded(libm::sqrt(found.variance_ratio), 6),
        "degrees_of_freedom": found.degrees_of_freedom,
        "residual_rms_mm": millimetres(found.residual_rms),
        "outliers": found.outliers().map(|row| outlier(run, row)).collect::<Vec<_>>(),
        "outliers_searched": found.are_outliers_searched,
        "law_probability": found.law_probability.map(|probability| rounded(probability, 6)),
        "leave_one_out": {
            "rms_mm": millimetres(found.prediction.rms),
            "worst": worst,
            "unpredicted": unpredicted,
        },
        "setup": setup(run, found),
    }))
}

/// Lengths, with the digits of any deflection and more where they are tiny.
fn millimetres(length: f64) -> f64 {
    rounded(length * 1e3, DIGITS)
}

/// The joints that keep the compliance of the robot file: not those of which one angle alone is unidentifiable.
fn held(found: &Identified) -> Vec<usize> {
    let joint = |held: &Held| match held.parameter {
        Parameter::Joint(joint) => Some(joint + 1),
        Parameter::Group(_) => None,
    };
    found.held.iter().filter_map(joint).collect()
}

fn numbers<P>(estimate: &Estimate<P>, factor: f64, names: [&str; 4]) -> [(String, Value); 4] {
    let [low, high] = estimate.interval;
    let values = [estimate.value, estimate.deviation, low, high];
    std::array::from_fn(|k| (names[k].to_owned(), json!(rounded(values[k] * factor, DIGITS))))
}

fn compliance(found: &Identified, estimate: &Estimate<Parameter>) -> Value {
    let joint = found.joint(estimate.parameter);
    let mut map = Map::from_iter([("joint".to_owned(), json!(joint + 1))]);
    if let Some(angle) = estimate.angle {
        let angle = json!(Unit::ANGLE_DEG.number(angle));
        if joint == 1 {
            map.insert("q2_deg".to_owned(), angle.clone());
        }
        map.insert("angle_deg".to_owned(), angle);
    }
    map.extend(numbers(estimate, URAD, ["urad_per_nm", "std_urad_per_nm", "low_urad_per_nm", "high_urad_per_nm"]));
    Value::Object(map)
}

fn compensator(found: &Identified) -> Value {
    let Some(joint) = found.varying else { return Value::Null };
    let Compliance::Compensated { alone, compensator } = found.robot.joints()[joint].compliance else {
        return Value::Null;
    };
    let deviation = |quantity: Quantity, factor: f64| {
        let estimate = found.arm.iter().find(|e| e.parameter.joint == joint && e.parameter.quantity == quantity);
        estimate.map(|estimate| rounded(estimate.deviation * factor, DIGITS))
    };
    json!({
        "joint": joint + 1,
        "compliance_urad_per_nm": rounded(alone * URAD, DIGITS),
        "std_compliance_urad_per_nm": deviation(Quantity::Compliance, URAD),
        "stiffness_mnm_per_rad": rounded(1e-6 / alone, DIGITS),
        "spring_stiffness_n_per_mm": rounded(compensator.spring_stiffness / 1e3, DIGITS),
        "std_spring_stiffness_n_per_mm": deviation(Quantity::SpringStiffness, 1e-3),
        "free_length_mm": rounded(compensator.free_length * 1e3, DIGITS),
        "std_free_length_mm": deviation(Quantity::FreeLength, 1e3),
        "a_mm": rounded(compensator.a * 1e3, DIGITS),
        "l_mm": rounded(compensator.l * 1e3, DIGITS),
        "alpha_deg": rounded(compensator.alpha.to_degrees(), DIGITS),
    })
}

fn outlier(run: &IdentifyRun, row: &RowResult) -> Value {
    let sheet = &run.problem.sheet;
    json!({
        "line": row.line,
        "configuration": sheet.configurations[row.configuration].name,
        "point": sheet.points[row.point],
        "residual_mm": millimetres((row.measured - row.predicted).norm()),
        "studentised": rounded(row.studentised, 6),
    })
}

fn setup(run: &IdentifyRun, found: &Identified) -> Value {
    let triple = |v: &nalgebra::Vector3<f64>| json!([v.x, v.y, v.z].map(|v| Unit::PLACE_MM.number(v)));
    let base = &found.setup.tracker_from_base;
    let rotation: Vec<Value> =
        base.rotation.row_iter().map(|row| row.iter().map(|v| rounded(*v, DIGITS)).collect()).collect();
    let points = run.problem.sheet.points.iter().zip(&found.setup.points).zip(&found.setup_fit.point_deviations);
    let (line, distance) = found.setup_fit.worst;
    json!({
        "tracker_from_base": { "xyz_mm": triple(&base.translation), "rotation": rotation },
        "points": points
            .map(|((name, place), std)| json!({ "point": name, "flange_mm": triple(place), "std_mm": millimetres(*std) }))
            .collect::<Vec<_>>(),
        "residual_rms_mm": millimetres(found.setup.residual_rms),
        "worst": { "line": line, "mm": millimetres(distance) },
    })
}
