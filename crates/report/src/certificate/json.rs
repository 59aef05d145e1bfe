//! `certificate.json`.

use crate::document::{Document, placement};
use crate::units::Unit;
use serde_json::{Value, json};
use stead_format::input::InputFile;
use stead_placement::certify::{Certificate, NoProof, Proof};

/// What `stead place --json` prints under `certificate`: the content of `certificate.json`, and how long it took.
pub fn certificate_json(certificate: &Certificate, inputs: &[InputFile]) -> Value {
    let mut document = certificate_content(certificate, inputs);
    document["wall_s"] = json!(Unit::TIME_S.number(certificate.wall));
    document
}

/// The content of `certificate.json`: the same in every run, unless a time limit or the user ended it. `best` and `worst` are null where
/// nothing is known; `best_reason` and `worst_reason` say why, or why a bound is farther off than was asked for.
pub(super) fn certificate_content(certificate: &Certificate, inputs: &[InputFile]) -> Value {
    let [best, worst] = [&certificate.best, &certificate.worst];
    let nodes: usize = [best, worst].into_iter().flatten().map(|proof| proof.bound.nodes).sum();
    let reason = |side: &Result<Proof, NoProof>| match side {
        Ok(proof) => proof.shortfall(&certificate.settings),
        Err(reason) => Some(reason.to_string()),
    };
    Document::new(inputs).warnings(&certificate.warnings).with(json!({
        "gap_percent_asked": Unit::PLAIN.number(certificate.settings.gap * 100.0),
        "time_limit_s": certificate.settings.time_limit,
        "memory_gb": certificate.settings.memory as f64 / 1e9,
        "best": best.as_ref().map_or(Value::Null, side),
        "best_reason": reason(best),
        "worst": worst.as_ref().map_or(Value::Null, side),
        "worst_reason": reason(worst),
        "nodes": nodes,
    }))
}

fn side(proof: &Proof) -> Value {
    json!({
        "placement": placement(&proof.placement),
        "found_mm": Unit::DEFLECTION_MM.number(proof.found),
        "value_mm": Unit::DEFLECTION_MM.number(proof.bound.value),
        "bound_mm": proof.bound_mm(),
        "gap_percent": proof.gap_percent(),
        "with_beta_rate": proof.bound.with_rate,
        "limits_relaxed": proof.relaxed_words(),
        "status": proof.bound.status,
        "open_boxes": proof.bound.open.len(),
        "nodes": proof.bound.nodes,
    })
}
