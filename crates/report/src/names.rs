//! Names of things as files and pictures state them.

use stead_model::robot::Posture;
use stead_placement::outcome::Blocked;
use stead_placement::sense::Sense;

/// `best` or `worst`.
pub(super) fn sense(sense: Sense) -> &'static str {
    match sense {
        Sense::Min => "best",
        Sense::Max => "worst",
    }
}

/// Why a state is not allowed, as the maps' CSV files state it.
pub(super) fn reason(blocked: Blocked) -> String {
    match blocked {
        Blocked::Reach => "reach".to_owned(),
        Blocked::JointLimit(joint) => format!("joint_{joint}"),
        Blocked::Conditioning => "conditioning".to_owned(),
        Blocked::Deflection => "deflection".to_owned(),
    }
}

/// Why a state is not allowed, for a legend.
pub(super) fn reason_in_legend(blocked: Blocked) -> String {
    match blocked {
        Blocked::Reach => "out of reach".to_owned(),
        Blocked::JointLimit(joint) => format!("limit of joint {joint}"),
        Blocked::Conditioning => "near a singularity".to_owned(),
        Blocked::Deflection => "deflection above its limit".to_owned(),
    }
}

/// A posture scheme: the numbers with blanks between.
pub(super) fn postures(scheme: &[Posture]) -> String {
    scheme.iter().map(Posture::to_string).collect::<Vec<_>>().join(" ")
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

/// The name of a compliance in messages: of a joint (from 0), and, where it has several, at an angle (rad).
pub fn compliance_name(joint: usize, angle: Option<f64>) -> String {
    let number = joint + 1;
    angle.map_or_else(|| format!("k_{number}"), |angle| format!("k_{number} at {:.2} deg", angle.to_degrees()))
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
