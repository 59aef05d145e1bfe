//! The end mill: teeth with unequal pitch and runout, helix, sense of rotation, cutting coefficients.

use super::coefficients::Coefficients;
use super::rotation::Rotation;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Pitches that differ by less are equal. rad
const SAME_PITCH: f64 = 1e-9;
/// Likewise radii. m
const SAME_RADIUS: f64 = 1e-9;

/// One tooth of a cutter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Tooth {
    /// How far it follows the tooth before it; the first follows the last of the turn before. rad
    pub pitch: f64,
    /// Radius of its edge, runout included. m
    pub radius: f64,
}

/// An end mill with straight sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cutter {
    teeth: Vec<Tooth>,
    helix: f64,
    flute_length: Option<f64>,
    rotation: Rotation,
    coefficients: Coefficients,
}

/// Why numbers do not describe a cutter.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CutterError {
    /// No tooth.
    #[error("a cutter needs at least one tooth")]
    Toothless,
    /// Pitches that do not make a turn: their sum, or the one that is not above 0. rad
    #[error("the pitches of all teeth must be above 0 and make one turn, 360 deg, but make {} deg", .0.to_degrees())]
    Pitch(f64),
    /// An edge without a radius. m
    #[error("the radius of every tooth must be a finite number above 0, but one is {0} m")]
    Radius(f64),
    /// A helix that cannot be ground. rad
    #[error("the helix angle must be between -90 and 90 deg, but is {} deg", .0.to_degrees())]
    Helix(f64),
    /// No cutting length. m
    #[error("the length of the flutes must be a finite number above 0, but is {0} m")]
    Flute(f64),
    /// A coefficient that is not finite. Pa or N/m
    #[error("cutting coefficients must be finite numbers, but one is {0}")]
    Coefficient(f64),
}

impl Cutter {
    /// A cutter of teeth in the order in which they pass, with a helix angle (rad; positive: higher parts of a tooth
    /// lag behind its tip), flutes of a length (m), where known, a sense of rotation, and cutting coefficients.
    ///
    /// # Errors
    /// [`CutterError`] for the first number that is out of range.
    pub fn new(
        teeth: Vec<Tooth>,
        helix: f64,
        flute_length: Option<f64>,
        rotation: Rotation,
        coefficients: Coefficients,
    ) -> Result<Self, CutterError> {
        if teeth.is_empty() {
            return Err(CutterError::Toothless);
        }
        if let Some(tooth) = teeth.iter().find(|tooth| !is_length(tooth.pitch)) {
            return Err(CutterError::Pitch(tooth.pitch));
        }
        let sum: f64 = teeth.iter().map(|tooth| tooth.pitch).sum();
        let is_a_turn = (sum - TAU).abs() < 1e-9;
        if !is_a_turn {
            return Err(CutterError::Pitch(sum));
        }
        if let Some(tooth) = teeth.iter().find(|tooth| !is_length(tooth.radius)) {
            return Err(CutterError::Radius(tooth.radius));
        }
        let is_below_a_quarter = helix.abs() < FRAC_PI_2;
        if !is_below_a_quarter {
            return Err(CutterError::Helix(helix));
        }
        if let Some(flute) = flute_length.filter(|flute| !is_length(*flute)) {
            return Err(CutterError::Flute(flute));
        }
        match coefficients.parts().into_iter().find(|coefficient| !coefficient.is_finite()) {
            Some(coefficient) => Err(CutterError::Coefficient(coefficient)),
            None => Ok(Self { teeth, helix, flute_length, rotation, coefficients }),
        }
    }

    /// A cutter of equal teeth at equal pitches: how many, and its radius (m); otherwise as [`Cutter::new`].
    ///
    /// # Errors
    /// [`CutterError`] for the first number that is out of range.
    pub fn even(
        teeth: usize,
        radius: f64,
        helix: f64,
        rotation: Rotation,
        coefficients: Coefficients,
    ) -> Result<Self, CutterError> {
        let tooth = Tooth { pitch: TAU / teeth as f64, radius };
        Self::new(vec![tooth; teeth], helix, None, rotation, coefficients)
    }

    /// The teeth, in the order in which they pass.
    pub fn teeth(&self) -> &[Tooth] {
        &self.teeth
    }

    /// Helix angle. rad
    #[cfg(any(test, feature = "testing"))]
    pub fn helix(&self) -> f64 {
        self.helix
    }

    /// Length of the flutes, where known. m
    pub fn flute_length(&self) -> Option<f64> {
        self.flute_length
    }

    /// Sense of rotation.
    pub fn rotation(&self) -> Rotation {
        self.rotation
    }

    /// Force over chip thickness and depth of cut.
    pub fn coefficients(&self) -> Coefficients {
        self.coefficients
    }

    /// The mean radius of the teeth. m
    pub fn radius(&self) -> f64 {
        self.teeth.iter().map(|tooth| tooth.radius).sum::<f64>() / self.teeth.len() as f64
    }

    /// Twice the mean radius. m
    pub fn diameter(&self) -> f64 {
        2.0 * self.radius()
    }

    /// The largest radius of a tooth. m
    pub fn largest_radius(&self) -> f64 {
        self.teeth.iter().fold(0.0, |largest, tooth| tooth.radius.max(largest))
    }

    /// The smallest radius of a tooth. m
    pub fn smallest_radius(&self) -> f64 {
        self.teeth.iter().fold(f64::INFINITY, |smallest, tooth| tooth.radius.min(smallest))
    }

    /// Whether the edges of the teeth differ in their radii.
    pub fn has_runout(&self) -> bool {
        self.largest_radius() - self.smallest_radius() > SAME_RADIUS
    }

    /// How often in a turn the pitches of the teeth repeat: as often as there are teeth, where they are equal.
    pub fn repeats(&self) -> usize {
        self.repeats_by(|a, b| (a.pitch - b.pitch).abs() < SAME_PITCH)
    }

    /// How often in a turn the teeth repeat in pitch and radius: after this part of a turn a cut without chatter is the
    /// same again.
    pub fn repeats_with_runout(&self) -> usize {
        self.repeats_by(|a, b| (a.pitch - b.pitch).abs() < SAME_PITCH && (a.radius - b.radius).abs() < SAME_RADIUS)
    }

    fn repeats_by(&self, are_alike: impl Fn(&Tooth, &Tooth) -> bool) -> usize {
        let count = self.teeth.len();
        let is_period = |period: &usize| {
            count.is_multiple_of(*period)
                && (0..count).all(|k| are_alike(&self.teeth[k], &self.teeth[(k + period) % count]))
        };
        (1..=count).find(is_period).map_or(1, |period| count / period)
    }

    /// How far each tooth passes after the first one. rad
    pub fn offsets(&self) -> Vec<f64> {
        let followers = self.teeth.iter().skip(1).scan(0.0, |sum, tooth| {
            *sum += tooth.pitch;
            Some(*sum)
        });
        std::iter::once(0.0).chain(followers).collect()
    }

    /// How far a height (m) of a tooth lags behind its tip, at the mean radius. rad
    pub fn lag(&self, height: f64) -> f64 {
        height * libm::tan(self.helix) / self.radius()
    }
}

/// Whether a number is finite and above 0.
fn is_length(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn teeth_repeat_with_their_pitches_and_with_their_radii() {
        for (pitches_deg, runout_um, has_runout, by_pitch, by_both) in [
            (&[180.0, 180.0][..], &[0.0, 0.0][..], false, 2, 2),
            (&[180.0, 180.0], &[7.0, 7.0], false, 2, 2),
            (&[180.0, 180.0], &[7.0, 0.0], true, 2, 1),
            (&[170.0, 190.0], &[0.0, 0.0], false, 1, 1),
            (&[85.0, 95.0, 85.0, 95.0], &[0.0; 4], false, 2, 2),
            (&[90.0; 4], &[5.0, 0.0, 5.0, 0.0], true, 4, 2),
            (&[85.0, 95.0, 85.0, 95.0], &[5.0, 5.0, 0.0, 0.0], true, 2, 1),
            (&[360.0], &[3.0], false, 1, 1),
        ] {
            let tooth =
                |(pitch, runout): (&f64, &f64)| Tooth { pitch: f64::to_radians(*pitch), radius: 5e-3 + runout * 1e-6 };
            let teeth = pitches_deg.iter().zip(runout_um).map(tooth).collect();
            let cutter = Cutter::new(teeth, 0.0, None, Rotation::Clockwise, Coefficients::new(1e9, 0.0, 0.0)).unwrap();
            let found = (cutter.has_runout(), cutter.repeats(), cutter.repeats_with_runout());
            assert_eq!(found, (has_runout, by_pitch, by_both), "{pitches_deg:?} {runout_um:?}");
        }
    }
}
