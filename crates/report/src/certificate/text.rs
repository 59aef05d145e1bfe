//! The certificate in sentences.

use crate::names;
use crate::units::{Unit, fixed, lines_of};
use stead_certify::{Certificate, Proof};
use stead_problem::sense::Sense;

/// Widest line.
const WIDTH: usize = 110;

/// What is known of both placements, what that assumes, and what is not known and why. Lines are at most 110 characters
/// wide and end with a line break.
pub fn certificate_text(certificate: &Certificate) -> String {
    let mut text = String::new();
    for (side, name) in [(&certificate.best, "best"), (&certificate.worst, "worst")] {
        let paragraph = match side {
            Ok(proof) => stated(proof),
            Err(reason) => format!("No certificate for the {name} placement: {reason}."),
        };
        text.extend(lines_of(&paragraph, WIDTH).into_iter().map(|line| line + "\n"));
    }
    text
}

fn stated(proof: &Proof) -> String {
    let bound = fixed(proof.bound_mm(), Unit::DEFLECTION_MM.decimals);
    let value = Unit::DEFLECTION_MM.text(proof.bound.value);
    let (gap, figure) = (proof.gap_words(), &proof.figure);
    if !proof.is_of_use() {
        let name = names::sense(proof.sense);
        return format!("Certificate, {name} placement: it ended before there was any bound of use; nothing is known.");
    }
    let claim = match proof.sense {
        Sense::Min => format!(
            "{} Certificate, best placement: with any posture scheme and redundancy plan it is at least {bound} mm; yours \
             has {value} mm.",
            proof.sentence().unwrap_or_default()
        ),
        Sense::Max => {
            let found = Unit::DEFLECTION_MM.text(proof.found);
            let compared = match proof.bound.met {
                None => format!("yours has {value} mm so: none is worse by more than {gap} %"),
                Some(place) => format!(
                    "yours has {found} mm so, and one at x = {}, y = {}, z = {} mm, yaw = {} deg, met on the way, {value} mm: \
                     none is worse than that by more than {gap} %",
                    fixed(place.x * 1e3, 1),
                    fixed(place.y * 1e3, 1),
                    fixed(place.z * 1e3, 1),
                    fixed(place.yaw.to_degrees(), 1)
                ),
            };
            format!(
                "Certificate, worst placement, with the limits named below dropped: no feasible placement {} has \
                 under its best redundancy plan a {figure} above {bound} mm; {compared}. With these limits kept \
                 this is no bound: worse ones are possible then.",
                proof.scope
            )
        }
    };
    format!("{claim} Relaxed: {}. Certified up to rounding.", proof.relaxed_words().join("; "))
}
