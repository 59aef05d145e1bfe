//! Moves between segments where a robot file says nothing of them.

/// Limits of the joint moves between segments, for joints whose row of the robot file does not state them, and how the
/// cut is blended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransferSettings {
    /// Time from rest to full speed at full acceleration; the acceleration limit is speed over this. s
    pub acceleration_time: f64,
    /// Time from no to full acceleration at full jerk; the jerk limit is acceleration over this. s
    pub jerk_time: f64,
    /// Distance over which the controller blends changes of the joint speeds along the cut. m
    pub blend: f64,
}

impl Default for TransferSettings {
    /// Assumptions: manufacturers publish speeds, not accelerations, and the blending distance is set by the robot's
    /// program.
    fn default() -> Self {
        Self { acceleration_time: 0.4, jerk_time: 0.1, blend: 5e-3 }
    }
}
