//! `certificate.json`.

use crate::document::{Document, PlacementFigures};
use crate::figure::{DeflectionMm, Plain, TimeS};
use serde_json::Value;
use stead_certify::{Certificate, NoProof, Proof, Status};
use stead_disk::input::InputFile;

records! {
    /// What is proved of the best and of the worst placement.
    pub struct CertificateFigures of (certificate: &Certificate, wall_s: Option<TimeS>) {
        let [best, worst] = [&certificate.best, &certificate.worst];
        let reason = |side: &Result<Proof, NoProof>| match side {
            Ok(proof) => proof.shortfall(&certificate.settings),
            Err(reason) => Some(reason.to_string()),
        };
    } with {
        /// The gap that was requested. %
        gap_percent_asked: Plain = Plain(certificate.settings.gap * 100.0),
        /// Time after which the search for a proof ends. s
        time_limit_s: Option<f64> = certificate.settings.time_limit,
        /// Memory that it may use. GB
        memory_gb: f64 = certificate.settings.memory as f64 / 1e9,
        /// What is proved of the best placement in one sentence; null where that is nothing of use.
        sentence: Option<String> = best.as_ref().ok().and_then(Proof::sentence),
        /// The proof of the best placement; null where nothing is known.
        best: Option<ProofFigures> = best.as_ref().ok().map(Into::into),
        /// Why there is none, or why the bound is farther off than requested.
        best_reason: Option<String> = reason(best),
        /// The proof of the worst placement.
        worst: Option<ProofFigures> = worst.as_ref().ok().map(Into::into),
        /// Why there is none, or why the bound is farther off than requested.
        worst_reason: Option<String> = reason(worst),
        /// Boxes of placements examined.
        nodes: usize = [best, worst].into_iter().flatten().map(|proof| proof.bound.nodes).sum(),
        /// Time on the clock.
        wall_s?: TimeS = wall_s,
    }

    /// What is proved of a placement.
    pub struct ProofFigures from proof: &Proof {
        /// The placement that it is compared with.
        placement: PlacementFigures = (&proof.placement).into(),
        /// Figure that is minimised, of the placement found, with the same constraints relaxed.
        found_mm: DeflectionMm = proof.found.into(),
        /// Figure that the bound is compared with.
        value_mm: DeflectionMm = proof.bound.value.into(),
        /// No placement is better, or worse, than this. mm
        bound_mm: f64 = proof.bound_mm(),
        /// Difference of value and bound. %
        gap_percent: f64 = proof.gap_percent(),
        /// Whether the rate of beta is kept.
        with_beta_rate: bool = proof.bound.with_rate,
        /// Limits that the bound does not keep.
        limits_relaxed: Vec<String> = proof.relaxed_words(),
        /// How the search for the proof ended.
        #[schemars(with = "String")] status: Status = proof.bound.status,
        /// Boxes that may hold a placement better, or worse, by more than the gap.
        open_boxes: usize = proof.bound.open.len(),
        /// Boxes examined.
        nodes: usize = proof.bound.nodes,
    }
}

/// What `stead place --json` prints under `certificate`: the content of `certificate.json`, and how long it took.
pub fn certificate_json(certificate: &Certificate, inputs: &[InputFile]) -> Value {
    document(certificate, inputs, Some(certificate.wall.into()))
}

/// The content of `certificate.json`: the same in every run, unless a time limit or the user ended it.
pub(super) fn certificate_content(certificate: &Certificate, inputs: &[InputFile]) -> Value {
    document(certificate, inputs, None)
}

fn document(certificate: &Certificate, inputs: &[InputFile], wall_s: Option<TimeS>) -> Value {
    Document::new(inputs).warnings(&certificate.warnings).with(CertificateFigures::of(certificate, wall_s))
}
