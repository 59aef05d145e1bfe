//! The end mill: teeth, helix, unequal pitch, runout, cutting coefficients.

use std::f64::consts::{FRAC_PI_2, TAU};

/// One tooth of a cutter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tooth {
    /// How far it follows the tooth before it; the first follows the last of the turn before. rad
    pub pitch: f64,
    /// Radius of its edge, runout included. m
    pub radius: f64,
}

/// Coefficients of the cutting force: force = coefficient x chip thickness x slice height (UMONS paper, eq. 13). Pa
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// K_t, against the motion of the tooth.
    pub tangential: f64,
    /// K_r, from the edge to the cutter's axis.
    pub radial: f64,
    /// K_a, on the tool along its axis from the work to the spindle.
    pub axial: f64,
}

/// An end mill with straight sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Cutter {
    teeth: Vec<Tooth>,
    helix: f64,
    flute: f64,
    coefficients: Coefficients,
}

/// Why numbers make no cutter.
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
    /// A coefficient that is no number, or a tangential one that is not above 0.
    #[error("cutting coefficients must be finite and K_t above 0, but one is {coefficient} Pa")]
    Coefficient {
        /// The coefficient. Pa
        coefficient: f64,
    },
}

impl Cutter {
    /// A cutter of teeth in the order in which they pass, with a helix angle (rad; above 0: higher parts of a tooth lag) and
    /// flutes of a length (m).
    ///
    /// # Errors
    /// [`CutterError`] for whatever makes no cutter.
    pub fn new(teeth: Vec<Tooth>, helix: f64, flute: f64, coefficients: Coefficients) -> Result<Self, CutterError> {
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
        if !is_length(flute) {
            return Err(CutterError::Flute { flute });
        }
        let Coefficients { tangential, radial, axial } = coefficients;
        if !is_length(tangential) {
            return Err(CutterError::Coefficient { coefficient: tangential });
        }
        match [tangential, radial, axial].into_iter().find(|coefficient| !coefficient.is_finite()) {
            Some(coefficient) => Err(CutterError::Coefficient { coefficient }),
            None => Ok(Self { teeth, helix, flute, coefficients }),
        }
    }

    /// The teeth, in the order in which they pass.
    pub fn teeth(&self) -> &[Tooth] {
        &self.teeth
    }

    /// Helix angle. rad
    pub fn helix(&self) -> f64 {
        self.helix
    }

    /// Length of the flutes. m
    pub fn flute(&self) -> f64 {
        self.flute
    }

    /// What the force is to the chip.
    pub fn coefficients(&self) -> Coefficients {
        self.coefficients
    }

    /// The mean radius of the teeth. m
    pub fn radius(&self) -> f64 {
        self.teeth.iter().map(|tooth| tooth.radius).sum::<f64>() / self.teeth.len() as f64
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
