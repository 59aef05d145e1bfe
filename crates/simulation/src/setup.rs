//! An arm on a straight pass: what a simulation and a stability analysis have in common.

use super::arm::{AnyArm, Missing, Variant};
use super::motion::Motion;
use stead_model::plausibility;
use stead_model::robot::{Robot, Spindle};
use stead_numerics::message::{Note, Warning};

/// An arm, how much of it is modelled, and the pass that it makes.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// The arm, with masses.
    pub robot: Robot,
    /// The spindle on its flange.
    pub spindle: Spindle,
    /// How much is modelled.
    pub variant: Variant,
    /// Factor on all damping.
    pub damping_scale: f64,
    /// The commanded motion.
    pub motion: Motion,
}

impl Setup {
    /// What looks like a wrong unit or sign though it is possible, in sentences.
    pub fn notes(&self) -> Vec<Note> {
        let spindle = [plausibility::spindle(&self.spindle), plausibility::static_alone(&self.spindle)];
        let spindle = spindle.into_iter().flatten().chain(plausibility::carried(&self.spindle)).map(Note::may_be_wrong);
        plausibility::arm(&self.robot).into_iter().chain(spindle).collect()
    }

    /// What makes the result another than that of the arm as its file states it.
    pub fn warnings(&self) -> Vec<Warning> {
        self.variant.left_out(&self.robot).into_iter().collect()
    }

    /// Chain and drives, their stiffnesses taken at the start of the pass.
    ///
    /// # Errors
    /// [`Missing`] when the robot says too little for the variant.
    pub fn arm(&self) -> Result<AnyArm, Missing> {
        let start = self.motion.motors(0.0).0;
        let mut arm = AnyArm::new(&self.robot, &self.spindle, self.variant, &start)?;
        match &mut arm {
            AnyArm::Six(arm) => arm.drive.damping *= self.damping_scale,
            AnyArm::Eighteen(arm) => arm.drive.damping *= self.damping_scale,
        }
        Ok(arm)
    }
}
