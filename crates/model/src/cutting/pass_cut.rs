//! The cut of a simulated pass: its cross section and length, the spindle speed, and the discretisation in slices and
//! steps.

use super::{Cut, Cutter, Side};
use std::f64::consts::TAU;

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
    /// A tangential coefficient that is not above 0: nothing would hold the chip back. Pa
    #[error("the tangential coefficient K_t must be above 0, but is {0} Pa")]
    Coefficient(f64),
    /// Edge forces, which chips of simulated passes do not have.
    #[error("the simulated force has no edge forces, but the cutter has")]
    EdgeForces,
    /// No work, or no speed. m or rad/s
    #[error("length of the work and spindle speed must be finite numbers above 0, but one is {0}")]
    Positive(f64),
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
            return Err(CutError::Coefficient(tangential));
        }
        for value in [self.length, self.spindle_speed] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(CutError::Positive(value));
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
