//! The end mill: teeth with unequal pitch and runout, helix, sense of rotation, cutting coefficients.

use super::coefficients::Coefficients;
use super::rotation::Rotation;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, TAU};

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
    /// Pitches that do not make a turn.
    #[error("the pitches of all teeth must be above 0 and make one turn, 360 deg, but make {} deg", .sum.to_degrees())]
    Pitch {
        /// Their sum, or the one that is not above 0. rad
        sum: f64,
    },
    /// An edge without a radius.
    #[error("the radius of every tooth must be a finite number above 0, but one is {radius} m")]
    Radius {
        /// The radius. m
        radius: f64,
    },
    /// A helix that cannot be ground.
    #[error("the helix angle must be between -90 and 90 deg, but is {} deg", .helix.to_degrees())]
    Helix {
        /// The angle. rad
        helix: f64,
    },
    /// No cutting length.
    #[error("the length of the flutes must be a finite number above 0, but is {flute} m")]
    Flute {
        /// The length. m
        flute: f64,
    },
    /// A coefficient that is not finite.
    #[error("cutting coefficients must be finite numbers, but one is {coefficient}")]
    Coefficient {
        /// The coefficient. Pa or N/m
        coefficient: f64,
    },
}

impl Cutter {
    /// A cutter of teeth in the order in which they pass, with a helix angle (rad; positive: higher parts of a tooth lag behind
    /// its tip), flutes of a length (m), where known, a sense of rotation, and cutting coefficients.
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
            return Err(CutterError::Pitch { sum: tooth.pitch });
        }
        let sum: f64 = teeth.iter().map(|tooth| tooth.pitch).sum();
        let is_a_turn = (sum - TAU).abs() < 1e-9;
        if !is_a_turn {
            return Err(CutterError::Pitch { sum });
        }
        if let Some(tooth) = teeth.iter().find(|tooth| !is_length(tooth.radius)) {
            return Err(CutterError::Radius { radius: tooth.radius });
        }
        let is_below_a_quarter = helix.abs() < FRAC_PI_2;
        if !is_below_a_quarter {
            return Err(CutterError::Helix { helix });
        }
        if let Some(flute) = flute_length.filter(|flute| !is_length(*flute)) {
            return Err(CutterError::Flute { flute });
        }
        match coefficients.parts().into_iter().find(|coefficient| !coefficient.is_finite()) {
            Some(coefficient) => Err(CutterError::Coefficient { coefficient }),
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
