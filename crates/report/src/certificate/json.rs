//! `certificate.json`.

use super::{Certificate, Ended, Proof};
use crate::document::{Document, placement};
use crate::units::Unit;
use serde_json::{Value, json};

/// The content of `certificate.json`, and what `stead place --json` prints under `certificate`. `best` and `worst` are null
/// where nothing is known, `best_reason` and `worst_reason` say why. Only `wall_s` differs from run to run, unless a time
/// limit or the user ended it.
pub fn certificate_json(certificate: &Certificate) -> Value {
    let [best, worst] = [&certificate.best, &certificate.worst];
    let nodes: usize = [best, worst].into_iter().flatten().map(|proof| proof.bound.nodes).sum();
    Document::new(&certificate.inputs).with(json!({
        "gap_percent_asked": Unit::PLAIN.number(certificate.settings.gap * 100.0),
        "time_limit_s": certificate.settings.time_limit,
        "best": best.as_ref().map_or(Value::Null, side),
        "best_reason": best.as_ref().err(),
        "worst": worst.as_ref().map_or(Value::Null, side),
        "worst_reason": worst.as_ref().err(),
        "nodes": nodes,
        "wall_s": Unit::TIME_S.number(certificate.wall),
    }))
}

fn side(proof: &Proof) -> Value {
    json!({
        "placement": placement(&proof.placement),
        "value_mm": Unit::DEFLECTION_MM.number(proof.bound.value),
        "bound_mm": proof.bound_mm(),
        "gap_percent": proof.gap_percent(),
        "with_beta_rate": proof.bound.with_rate,
        "limits_relaxed": proof.relaxed,
        "status": status(proof.end),
        "open_boxes": proof.bound.open.len(),
        "nodes": proof.bound.nodes,
    })
}

/// One word for how it ended.
fn status(end: Ended) -> &'static str {
    match end {
        Ended::Reached => "reached",
        Ended::Exhausted => "exhausted",
        Ended::TimeLimit => "time_limit",
        Ended::Interrupted => "interrupted",
    }
}
