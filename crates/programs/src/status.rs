//! CONFIG, by which Fanuc's controllers tell the postures of a pose apart: that of poses published by ONE Robotics
//! (2013), as the guide's page `export` has it.

use stead_model::robot::{PostureWord, PostureWords};

/// The CONFIG text of a Fanuc position: wrist (N no flip, F flip), forearm (U up, D down), arm (T toward, B backward),
/// and the turns of axes 1, 4 and 6. Forearm and arm are the words of the posture; the wrist is not: J5 counts upwards,
/// and with the tool down from the level forearm (J5 below zero) CONFIG has no flip.
pub(super) fn fanuc_config(words: PostureWords, angles: &[f64; 6]) -> String {
    let wrist = if angles[4] > 0.0 { 'F' } else { 'N' };
    let forearm = if words.has(PostureWord::ElbowUp) { 'U' } else { 'D' };
    let arm = if words.has(PostureWord::Back) { 'B' } else { 'T' };
    let turns = [0, 3, 5].map(|j| ((angles[j].to_degrees() + 180.0) / 360.0).floor() as i32);
    format!("{wrist} {forearm} {arm}, {}, {}, {}", turns[0], turns[1], turns[2])
}
