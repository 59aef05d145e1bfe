//! The cut: how wide, how deep, how fast, and by how many slices and steps it is represented.

use super::cutter::Cutter;
use std::f64::consts::TAU;
use stead_model::cutting::MillingDirection;

/// A straight pass along a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Up or down milling.
    pub milling: MillingDirection,
    /// Width of cut a_e; the whole diameter is a slot, with work on both sides of the tool. m
    pub radial_depth: f64,
    /// Depth of cut a_p. m
    pub axial_depth: f64,
    /// Length of the work along the feed. m
    pub length: f64,
    /// Angular speed of the spindle. rad/s
    pub spindle_speed: f64,
    /// Slices along the axis.
    pub slices: usize,
    /// Steps of time a turn.
    pub steps_per_turn: usize,
}

/// Why a cutter cannot do a cut.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum CutError {
    /// A width of cut that is none, or wider than the cutter.
    #[error("the width of cut must be above 0 and not above the cutter diameter of {diameter} m, but is {width} m")]
    Width {
        /// Width of cut. m
        width: f64,
        /// Diameter of the cutter. m
        diameter: f64,
    },
    /// A depth of cut that is none, or deeper than the flutes.
    #[error("the depth of cut must be above 0 and not above the flute length of {flute} m, but is {depth} m")]
    Depth {
        /// Depth of cut. m
        depth: f64,
        /// Length of the flutes. m
        flute: f64,
    },
    /// No work, or no speed.
    #[error("length of the work and spindle speed must be finite numbers above 0, but one is {value}")]
    Positive {
        /// The value. m or rad/s
        value: f64,
    },
    /// No slice.
    #[error("there must be at least one slice")]
    Slices,
    /// Steps that are too coarse to tell teeth apart.
    #[error("there must be at least {min} steps a turn for the smallest pitch of the teeth, but are {steps}")]
    Steps {
        /// Steps a turn.
        steps: usize,
        /// The fewest that would do.
        min: usize,
    },
}

/// Steps between two teeth, at least.
const STEPS_PER_PITCH: f64 = 6.0;

impl Cut {
    /// Checks the cut against the cutter.
    ///
    /// # Errors
    /// [`CutError`] if it is too wide, too deep, or too coarse.
    pub fn check(&self, cutter: &Cutter) -> Result<(), CutError> {
        let (width, diameter) = (self.radial_depth, 2.0 * cutter.radius());
        if !(width > 0.0 && width <= diameter) {
            return Err(CutError::Width { width, diameter });
        }
        let (depth, flute) = (self.axial_depth, cutter.flute());
        if !(depth > 0.0 && depth <= flute) {
            return Err(CutError::Depth { depth, flute });
        }
        for value in [self.length, self.spindle_speed] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(CutError::Positive { value });
            }
        }
        if self.slices == 0 {
            return Err(CutError::Slices);
        }
        let min = min_steps(cutter);
        if self.steps_per_turn < min {
            return Err(CutError::Steps { steps: self.steps_per_turn, min });
        }
        Ok(())
    }

    /// The length of a step. s
    pub fn step(&self) -> f64 {
        TAU / self.spindle_speed / self.steps_per_turn as f64
    }

    /// The sign with which psi changes: down milling ends at the wall, up milling starts there.
    pub fn sense(&self) -> f64 {
        match self.milling {
            MillingDirection::Climb => -1.0,
            MillingDirection::Conventional => 1.0,
        }
    }

    /// Whether the work is on both sides of the tool.
    pub fn is_slot(&self, cutter: &Cutter) -> bool {
        self.radial_depth >= 2.0 * cutter.radius()
    }
}

/// The fewest steps a turn with which earlier teeth can be found between steps already done.
pub fn min_steps(cutter: &Cutter) -> usize {
    let smallest = cutter.teeth().iter().fold(TAU, |smallest, tooth| tooth.pitch.min(smallest));
    (STEPS_PER_PITCH * TAU / smallest - 1e-9).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::milling::{Coefficients, CutterError, Tooth};
    use std::f64::consts::{FRAC_PI_2, PI};

    const RADIUS: f64 = 5e-3;
    const K: Coefficients = Coefficients { tangential: 6e8, radial: 2e8, axial: 0.0 };

    #[test]
    fn what_cannot_be_cut_is_refused() {
        let teeth = [170.0_f64, 190.0].map(|pitch| Tooth { pitch: pitch.to_radians(), radius: RADIUS });
        let cutter = Cutter::new(teeth.to_vec(), 0.5, 0.02, K).unwrap();
        let good = Cut {
            milling: MillingDirection::Climb,
            radial_depth: 4e-3,
            axial_depth: 1.6e-3,
            length: 0.09,
            spindle_speed: 2e3,
            slices: 32,
            steps_per_turn: 90,
        };
        assert_eq!(good.check(&cutter), Ok(()));
        let refused = |change: &dyn Fn(&mut Cut)| {
            let mut cut = good;
            change(&mut cut);
            cut.check(&cutter).unwrap_err()
        };
        for value in [0.0, -1.0, 10.001e-3, f64::NAN] {
            assert!(matches!(refused(&|cut| cut.radial_depth = value), CutError::Width { .. }));
        }
        for value in [0.0, 20.001e-3, f64::NAN] {
            assert!(matches!(refused(&|cut| cut.axial_depth = value), CutError::Depth { .. }));
        }
        for value in [0.0, f64::INFINITY, f64::NAN] {
            assert!(matches!(refused(&|cut| cut.length = value), CutError::Positive { .. }));
            assert!(matches!(refused(&|cut| cut.spindle_speed = value), CutError::Positive { .. }));
        }
        assert_eq!(refused(&|cut| cut.slices = 0), CutError::Slices);
        assert!(matches!(refused(&|cut| cut.steps_per_turn = 12), CutError::Steps { min: 13, .. }));
        let make = |pitch: f64, radius: f64, helix, flute, coefficients| {
            let teeth = vec![Tooth { pitch, radius: RADIUS }, Tooth { pitch: PI, radius }];
            Cutter::new(teeth, helix, flute, coefficients)
        };
        assert!(make(PI, 1e-3, 0.5, 0.01, K).is_ok());
        assert!(matches!(Cutter::new(vec![], 0.0, 1.0, K), Err(CutterError::Toothless)));
        for pitch in [3.0, 0.0, f64::NAN] {
            assert!(matches!(make(pitch, 1e-3, 0.5, 0.01, K), Err(CutterError::Pitch { .. })));
        }
        for radius in [0.0, f64::INFINITY, f64::NAN] {
            assert!(matches!(make(PI, radius, 0.5, 0.01, K), Err(CutterError::Radius { .. })));
        }
        assert!(matches!(make(PI, 1e-3, FRAC_PI_2, 0.01, K), Err(CutterError::Helix { .. })));
        assert!(matches!(make(PI, 1e-3, 0.0, 0.0, K), Err(CutterError::Flute { .. })));
        for tangential in [0.0, f64::NAN, f64::INFINITY] {
            let coefficients = Coefficients { tangential, ..K };
            assert!(matches!(make(PI, 1e-3, 0.0, 0.01, coefficients), Err(CutterError::Coefficient { .. })));
        }
    }
}
