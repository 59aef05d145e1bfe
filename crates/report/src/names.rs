//! Names of things as files and pictures state them.

use std::collections::BTreeMap;
use stead_model::robot::{Posture, PostureWords};
use stead_placement::outcome::{Plan, RefinementStatus};
use stead_problem::constraints::{ConstraintKind, describe};
use stead_problem::limit::{ActiveBound, Limit};
use stead_problem::problem::Problem;
use stead_problem::sense::Sense;

/// `best` or `worst`.
pub(super) fn sense(sense: Sense) -> &'static str {
    match sense {
        Sense::Min => "best",
        Sense::Max => "worst",
    }
}

/// The constraint that a state breaks, for a legend.
pub(super) fn constraint_in_legend(kind: ConstraintKind) -> String {
    match kind {
        ConstraintKind::Reach => "out of reach".to_owned(),
        ConstraintKind::JointLimit(joint) => format!("limit of joint {joint}"),
        ConstraintKind::AxesSum => "limit of axes 2+3".to_owned(),
        ConstraintKind::Conditioning => "near a singularity".to_owned(),
        ConstraintKind::MaxDeflection => "deflection above its limit".to_owned(),
        other => describe(&[other]).concat(),
    }
}

/// How the rounds of a refinement ended, one after the other.
pub(super) fn statuses(rounds: &[RefinementStatus]) -> String {
    rounds.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// A posture scheme: the numbers with blanks between.
pub(super) fn postures(scheme: &[Posture]) -> String {
    scheme.iter().map(Posture::to_string).collect::<Vec<_>>().join(" ")
}

/// The words of a posture in a cell of a table: without commas, so that no cell needs quotes.
pub(super) fn posture_cell(words: PostureWords) -> String {
    words.to_string().replace(", ", "; ")
}

/// Each posture of some plans once, by its number, with its words.
pub(super) fn posture_words<'a>(plans: impl Iterator<Item = &'a Plan>) -> BTreeMap<Posture, PostureWords> {
    plans.flat_map(|plan| plan.postures.iter().copied().zip(plan.posture_words.iter().copied())).collect()
}

/// The same in lines under a table.
pub(super) fn posture_lines<'a>(plans: impl Iterator<Item = &'a Plan>) -> Vec<String> {
    posture_words(plans).iter().map(|(posture, words)| format!("posture {posture}: {words}")).collect()
}

/// A posture scheme in at most `width` characters: in full, else repeated postures counted as `3x12`, else how many
/// segments there are.
pub(super) fn postures_within(scheme: &[Posture], width: usize) -> String {
    let full = postures(scheme);
    if full.len() <= width {
        return full;
    }
    let runs = scheme.chunk_by(|a, b| a == b).map(|run| format!("{}x{}", run[0], run.len()));
    let counted = runs.collect::<Vec<_>>().join(" ");
    if counted.len() <= width { counted } else { format!("{} segments", scheme.len()) }
}

/// A bound that holds an optimum: its limit, and of a distance that two have to keep which these are.
pub fn bound(bound: &ActiveBound) -> String {
    let [limit, _] = bound.side.limit.names();
    match &bound.names {
        Some([a, b]) => format!("{limit} of {a} and {b}"),
        None => limit,
    }
}

/// Which of its ends holds.
pub(super) fn side(bound: &ActiveBound) -> &'static str {
    if bound.side.is_upper { "upper" } else { "lower" }
}

/// What moving a bound gains, with its unit.
pub fn gain(bound: &ActiveBound) -> (f64, &'static str) {
    match bound.side.limit {
        Limit::CellX
        | Limit::CellY
        | Limit::CellZ
        | Limit::MaxDeflection
        | Limit::BaseDistance
        | Limit::Clearance(_)
        | Limit::KeepOut(_)
        | Limit::Scallop
        | Limit::StepOver
        | Limit::ContactTolerance => (bound.gain, "mm per mm"),
        Limit::CellYaw | Limit::Joint(_) | Limit::AxesSum | Limit::Lead | Limit::Tilt | Limit::MaxLean => {
            (bound.gain * 1e3 * 1_f64.to_radians(), "mm per deg")
        }
        // One degree per millimetre is a thousand per metre.
        Limit::BetaRate | Limit::SpindleTurn => (bound.gain * 1e6 * 1_f64.to_radians(), "mm per deg/mm"),
        Limit::JointStep(_) | Limit::SpindleSpeed => (bound.gain * 1e3 * 1_f64.to_radians(), "mm per deg/s"),
        Limit::Conditioning => (bound.gain * 1e3 * 0.01, "mm per 0.01"),
    }
}

/// The frame in which placements are: that of the cell, of a mounted robot, else the base frame of the rows.
pub fn place_frame(problem: &Problem) -> &'static str {
    if problem.robot.is_mounted() { "cell" } else { "base" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_schemes_are_counted() {
        let [three, four] = [Posture::ALL[2], Posture::ALL[3]];
        assert_eq!(postures_within(&[three, three, four], 8), "3 3 4");
        let long = [[three; 12].as_slice(), &[four; 18]].concat();
        assert_eq!(postures_within(&long, 12), "3x12 4x18");
        let mixed: Vec<_> = (0..40).map(|k| Posture::ALL[k % 8]).collect();
        assert_eq!(postures_within(&mixed, 12), "40 segments");
    }
}
