//! What `stead identify plan --json` prints, and `plan.json`: the same document.

use super::super::{URAD, key, rounded};
use crate::document::Document;
use crate::units::Unit;
use serde_json::{Map, Value, json};
use stead_calibration::identification::design::Design;
use stead_calibration::identification::design::expected::ExpectedCompliance;
use stead_calibration::identification::design::unobservable::Unobservable;
use stead_format::PlanRun;

/// Significant digits of expected errors.
const DIGITS: usize = 9;

/// The document: configurations in the order of measuring, expected errors beside those of random sets, warnings.
pub fn plan_json(run: &PlanRun, plan: &Design) -> Value {
    let (request, errors, rejected) = (&run.request, &plan.errors, &plan.rejected);
    let configurations = plan.sheet.configurations.iter().map(|configuration| {
        let force: Vec<f64> = configuration.force.iter().map(|part| Unit::FORCE_N.number(*part)).collect();
        json!({
            "configuration": configuration.name,
            "joints_deg": configuration.theta.map(|angle| Unit::ANGLE_DEG.number(angle)),
            "force_n": force,
        })
    });
    let spring = plan.compensator.iter().map(|bar| {
        let (name, factor) = key(&bar.parameter);
        json!({ "parameter": name, "value": digits(bar.value * factor), "std": digits(bar.deviation * factor) })
    });
    let hardly = plan.weakly_observed.iter().map(|hardly| {
        let mut value = compliance(hardly.joint, hardly.angle);
        value.insert("std_percent".to_owned(), digits(hardly.share * 100.0));
        value.insert("lever_mm".to_owned(), json!(Unit::PLACE_MM.number(hardly.lever)));
        Value::Object(value)
    });
    Document::new(&run.inputs).notes(run.notes.iter().chain(&plan.notes)).warnings(&plan.warnings).with(json!({
        "robot": request.robot.name(),
        "seed": request.seed,
        "load_n": Unit::FORCE_N.number(request.load),
        "noise_mm": request.noise * 1e3,
        "points": request.points.len(),
        "configurations": configurations.collect::<Vec<_>>(),
        "compliances": plan.compliances.iter().map(bar).collect::<Vec<_>>(),
        "compensator": spring.collect::<Vec<_>>(),
        "deflection": {
            "tests": plan.tests.len(),
            "rms_mm": length(plan.deflection),
            "error_mm": length(errors.planned),
            "best_random_error_mm": length(errors.best_random),
            "median_random_error_mm": length(errors.median_random),
            "random_sets": errors.random_sets,
            "random_sets_that_do_not_tell_all": errors.unidentifiable_sets,
        },
        "candidates": {
            "allowed": plan.candidates,
            "drawn": plan.draws,
            "outside_volume": rejected.volume,
            "too_near_base": rejected.radius,
            "deflected_too_far": rejected.deflection,
        },
        "travel_deg": Unit::ANGLE_DEG.number(plan.travel),
        "unseen": plan.unobservable.iter().map(unobservable).collect::<Vec<_>>(),
        "hardly_seen": hardly.collect::<Vec<_>>(),
    }))
}

/// Null where there is no finite number.
fn digits(value: f64) -> Value {
    if value.is_finite() { json!(rounded(value, DIGITS)) } else { Value::Null }
}

fn length(value: f64) -> Value {
    digits(value * 1e3)
}

fn compliance(joint: usize, angle: Option<f64>) -> Map<String, Value> {
    let mut map = Map::from_iter([("joint".to_owned(), json!(joint + 1))]);
    if let Some(angle) = angle {
        map.insert("angle_deg".to_owned(), json!(Unit::ANGLE_DEG.number(angle)));
    }
    map
}

fn bar(bar: &ExpectedCompliance) -> Value {
    let mut map = compliance(bar.joint, bar.angle);
    let urad = |value: Option<f64>| value.map_or(Value::Null, |value| digits(value * URAD));
    map.insert("urad_per_nm".to_owned(), urad(Some(bar.value)));
    map.insert("std_urad_per_nm".to_owned(), urad(bar.deviation));
    map.insert(
        "std_percent".to_owned(),
        bar.deviation.map_or(Value::Null, |deviation| digits(100.0 * deviation / bar.value)),
    );
    map.insert("by_law_std_urad_per_nm".to_owned(), urad(Some(bar.by_law)));
    map.insert("best_random_std_urad_per_nm".to_owned(), urad(bar.best_random));
    map.insert("median_random_std_urad_per_nm".to_owned(), urad(bar.median_random));
    Value::Object(map)
}

fn unobservable(unobservable: &Unobservable) -> Value {
    let compliances: Vec<Value> =
        unobservable.compliances.iter().map(|(joint, angle)| Value::Object(compliance(*joint, *angle))).collect();
    json!({ "compliances": compliances, "reason": unobservable.reason })
}
