//! The sense in which a cutter turns, and where a tooth is and moves at an angle of the turn.

use nalgebra::{Vector3, vector};
use serde::Serialize;

/// Sense of rotation of the cutter, seen from the spindle along the tool axis down to the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Rotation {
    /// As an ordinary right-hand cutter turns.
    Clockwise,
    /// As a left-hand cutter turns.
    Counterclockwise,
}

impl Rotation {
    /// Sign of the angular velocity about the tool axis: +1 counterclockwise, -1 clockwise.
    pub fn sign(self) -> f64 {
        match self {
            Self::Clockwise => -1.0,
            Self::Counterclockwise => 1.0,
        }
    }

    /// Unit vectors of a tooth at angle phi (see [`Engagement`](super::Engagement)) along feed, left of the feed, and
    /// tool axis: from the cutter's axis out to the tooth, and along its motion, the derivative of the first after phi.
    pub fn tooth(self, phi: f64) -> [Vector3<f64>; 2] {
        let (sine, cosine) = libm::sincos(phi);
        [vector![sine, -self.sign() * cosine, 0.0], vector![cosine, self.sign() * sine, 0.0]]
    }
}
