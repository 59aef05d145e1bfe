//! What `stead identify plan --json` prints, and `plan.json`: the same document.

use super::super::{URAD, key, rounded};
use crate::document::{Document, joined};
use crate::units::Unit;
use serde_json::{Value, json};
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
        let lever = Unit::PLACE_MM.number(hardly.lever);
        let share = digits(hardly.share * 100.0);
        joined(compliance(hardly.joint, hardly.angle), json!({ "std_percent": share, "lever_mm": lever }))
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
    value.is_finite().then(|| rounded(value, DIGITS)).into()
}

fn length(value: f64) -> Value {
    digits(value * 1e3)
}

fn compliance(joint: usize, angle: Option<f64>) -> Value {
    let angle = angle.map(|angle| json!({ "angle_deg": Unit::ANGLE_DEG.number(angle) }));
    joined(json!({ "joint": joint + 1 }), angle.unwrap_or_default())
}

fn bar(bar: &ExpectedCompliance) -> Value {
    let urad = |value: Option<f64>| value.map(|value| digits(value * URAD));
    let errors = json!({
        "urad_per_nm": urad(Some(bar.value)),
        "std_urad_per_nm": urad(bar.deviation),
        "std_percent": bar.deviation.map(|deviation| digits(100.0 * deviation / bar.value)),
        "by_law_std_urad_per_nm": urad(Some(bar.by_law)),
        "best_random_std_urad_per_nm": urad(bar.best_random),
        "median_random_std_urad_per_nm": urad(bar.median_random),
    });
    joined(compliance(bar.joint, bar.angle), errors)
}

fn unobservable(unobservable: &Unobservable) -> Value {
    let compliances = unobservable.compliances.iter().map(|(joint, angle)| compliance(*joint, *angle));
    json!({ "compliances": compliances.collect::<Value>(), "reason": unobservable.reason })
}
