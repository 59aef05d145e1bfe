//! The cut of a simulated pass: its cross section and length, the spindle speed, and the discretisation in slices and steps.

use std::f64::consts::TAU;
use stead_model::cutting::{Cut, Cutter, Side};

/// A straight pass along a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassCut {
    /// Direction, width and depth.
    pub section: Cut,
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
    /// A tangential coefficient that is not above 0: nothing would hold the chip back.
    #[error("the tangential coefficient K_t must be above 0, but is {tangential} Pa")]
    Coefficient {
        /// The coefficient. Pa
        tangential: f64,
    },
    /// Edge forces, which chips of simulated passes do not have.
    #[error("the simulated force has no edge forces, but the cutter has")]
    EdgeForces,
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

impl PassCut {
    /// Checks the cut against the cutter.
    ///
    /// # Errors
    /// [`CutError`] if it is too wide, too deep, or too coarse.
    pub fn check(&self, cutter: &Cutter) -> Result<(), CutError> {
        let (width, diameter) = (self.section.radial_depth, cutter.diameter());
        if !(width > 0.0 && width <= diameter) {
            return Err(CutError::Width { width, diameter });
        }
        let (depth, flute) = (self.section.axial_depth, cutter.flute_length().unwrap_or(f64::INFINITY));
        if !(depth > 0.0 && depth <= flute) {
            return Err(CutError::Depth { depth, flute });
        }
        let tangential = cutter.coefficients().tangential;
        if tangential <= 0.0 {
            return Err(CutError::Coefficient { tangential });
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

    /// The side of the feed on which the wall stands.
    pub fn wall(&self, cutter: &Cutter) -> Side {
        self.section.direction.wall(cutter.rotation())
    }

    /// The length of a step. s
    pub fn step(&self) -> f64 {
        TAU / self.spindle_speed / self.steps_per_turn as f64
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
    use crate::milling::MaterialRemoval;
    use std::f64::consts::{FRAC_PI_2, PI};
    use stead_model::cutting::{Coefficients, CutterError, MillingDirection, Rotation, Tooth};

    const RADIUS: f64 = 5e-3;
    const K: Coefficients = Coefficients::new(6e8, 2e8, 0.0);

    #[test]
    fn what_cannot_be_cut_is_refused() {
        let teeth = [170.0_f64, 190.0].map(|pitch| Tooth { pitch: pitch.to_radians(), radius: RADIUS });
        let cutter = Cutter::new(teeth.to_vec(), 0.5, Some(0.02), Rotation::Clockwise, K).unwrap();
        let good = PassCut {
            section: Cut { direction: MillingDirection::Climb, radial_depth: 4e-3, axial_depth: 1.6e-3 },
            length: 0.09,
            spindle_speed: 2e3,
            slices: 32,
            steps_per_turn: 90,
        };
        assert_eq!(good.check(&cutter), Ok(()));
        let refused = |change: &dyn Fn(&mut PassCut)| {
            let mut cut = good;
            change(&mut cut);
            cut.check(&cutter).unwrap_err()
        };
        for value in [0.0, -1.0, 10.001e-3, f64::NAN] {
            assert!(matches!(refused(&|cut| cut.section.radial_depth = value), CutError::Width { .. }));
        }
        for value in [0.0, 20.001e-3, f64::NAN] {
            assert!(matches!(refused(&|cut| cut.section.axial_depth = value), CutError::Depth { .. }));
        }
        for value in [0.0, f64::INFINITY, f64::NAN] {
            assert!(matches!(refused(&|cut| cut.length = value), CutError::Positive { .. }));
            assert!(matches!(refused(&|cut| cut.spindle_speed = value), CutError::Positive { .. }));
        }
        assert_eq!(refused(&|cut| cut.slices = 0), CutError::Slices);
        assert!(matches!(refused(&|cut| cut.steps_per_turn = 12), CutError::Steps { min: 13, .. }));
        let make = |pitch: f64, radius: f64, helix, flute, coefficients| {
            let teeth = vec![Tooth { pitch, radius: RADIUS }, Tooth { pitch: PI, radius }];
            Cutter::new(teeth, helix, Some(flute), Rotation::Clockwise, coefficients)
        };
        assert!(make(PI, 1e-3, 0.5, 0.01, K).is_ok());
        assert!(matches!(Cutter::new(vec![], 0.0, None, Rotation::Clockwise, K), Err(CutterError::Toothless)));
        for pitch in [3.0, 0.0, f64::NAN] {
            assert!(matches!(make(pitch, 1e-3, 0.5, 0.01, K), Err(CutterError::Pitch { .. })));
        }
        for radius in [0.0, f64::INFINITY, f64::NAN] {
            assert!(matches!(make(PI, radius, 0.5, 0.01, K), Err(CutterError::Radius { .. })));
        }
        assert!(matches!(make(PI, 1e-3, FRAC_PI_2, 0.01, K), Err(CutterError::Helix { .. })));
        assert!(matches!(make(PI, 1e-3, 0.0, 0.0, K), Err(CutterError::Flute { .. })));
        for tangential in [f64::NAN, f64::INFINITY] {
            let coefficients = Coefficients { tangential, ..K };
            assert!(matches!(make(PI, 1e-3, 0.0, 0.01, coefficients), Err(CutterError::Coefficient { .. })));
        }
        for tangential in [0.0, -1.0] {
            let pulled = make(PI, RADIUS, 0.5, 0.02, Coefficients { tangential, ..K }).unwrap();
            assert_eq!(good.check(&pulled), Err(CutError::Coefficient { tangential }));
        }
        let edged = make(PI, RADIUS, 0.5, 0.02, Coefficients { radial_edge: 1e3, ..K }).unwrap();
        assert_eq!(good.check(&edged), Ok(()));
        assert_eq!(MaterialRemoval::new(&edged, &good).unwrap_err(), CutError::EdgeForces);
    }
}
