//! Status and turn: the two numbers by which KUKA's controllers tell the postures of a pose apart, and Fanuc's CONFIG.
//!
//! S and T are those that Beckhoff describes for its CNC (TF5200, "Status & Turn"), CONFIG that of poses published by
//! ONE Robotics (2013): the guide's page `export` has both sources.

use stead_model::robot::{Posture, PostureWord, PostureWords};

/// S of a KUKA pose: bit 0 the wrist centre behind axis 1 ("overhead"), bit 1 the forearm beyond the stretched arm (A3
/// above the A3 at which wrist centre, axis 3 and axis 2 are in line), bit 2 A5 below zero. By the geometry of the arm,
/// which the bits of a posture state: `sign_3` is 1 where A3 counts in the direction of the row. Bit 3 is not used; bit
/// 4 marks poses taught by an absolutely accurate robot.
pub(super) fn status(posture: Posture, sign_3: f64, a5: f64) -> u8 {
    u8::from(posture.is_back()) + 2 * u8::from(is_beyond(posture, sign_3)) + 4 * u8::from(a5 < 0.0)
}

/// Whether the controller's third axis is beyond where wrist centre, axis 3 and axis 2 are in line, in its own
/// direction.
fn is_beyond(posture: Posture, sign_3: f64) -> bool {
    posture.is_delta_negative() != (sign_3 > 0.0)
}

/// T of a KUKA pose: bit i - 1 is set where A_i is below zero.
pub(super) fn turn(angles: &[f64; 6]) -> u8 {
    angles.iter().rev().fold(0, |bits, angle| 2 * bits + u8::from(*angle < 0.0))
}

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
