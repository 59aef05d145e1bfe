//! Force and moment of a milling tool over the engagement and over a turn (Klimchik 2017, Fig. 4).

use super::engagement::{Arc, Engagement, Integrals};
use super::force::CuttingForce;
use crate::task::Wrench;
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// The wrench at an angle, in the frame of [this room](crate::cutting).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sample {
    /// The angle phi as of [`Engagement`]. rad
    pub phi: f64,
    /// What the work does to the tool.
    pub wrench: Wrench,
}

/// The wrench of a milling tool: its mean, how the mean grows as the tool moves into the work, and how it goes over a
/// turn.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceHistory {
    /// Where a tooth cuts.
    pub engagement: Engagement,
    /// The mean over a turn.
    pub mean: Wrench,
    /// Means of cuts whose teeth are in the work from 0 to phi, with phi from 0 to pi in steps of a degree. The mean of
    /// any cut is what these gain over its arcs.
    pub entering: Vec<Sample>,
    /// The wrench of all teeth while the first is at phi, with phi from 0 to a full turn in steps of half a degree.
    pub turn: Vec<Sample>,
}

/// Steps of the means, over half a turn.
const ENTERING_STEPS: u32 = 180;
/// Steps of a turn.
const TURN_STEPS: u32 = 720;

impl ForceHistory {
    /// The forces in an engagement.
    pub fn new(force: &CuttingForce<'_>, engagement: &Engagement) -> Self {
        let angles = |steps: u32, end: f64| (0..=steps).map(move |k| end * (f64::from(k) / f64::from(steps)));
        let entering = |phi| Sample { phi, wrench: force.mean_over(Integrals::over(Arc { entry: 0.0, exit: phi })) };
        let turning = |phi| Sample { phi, wrench: force.instantaneous_wrench(engagement, phi) };
        Self {
            engagement: engagement.clone(),
            mean: force.mean_wrench(engagement),
            entering: angles(ENTERING_STEPS, PI).map(entering).collect(),
            turn: angles(TURN_STEPS, TAU).map(turning).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::published;
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn means_grow_from_nothing_to_the_slot_and_gain_any_cut_over_its_arcs() {
        let tool = published();
        let force_history = ForceHistory::new(&tool.force(&tool.cutter()), &Engagement::open_slot(0.5, 1.0).unwrap());
        assert_eq!(force_history.entering[0], Sample { phi: 0.0, wrench: Wrench::default() });
        assert_eq!(force_history.entering[180].phi, PI);
        assert_eq!(force_history.entering[180].wrench, tool.mean_wrench(&Engagement::slot()));
        // The arcs of this cut are 0 to 60 and 120 to 180 deg.
        let force = |deg: usize| force_history.entering[deg].wrench.force;
        assert!((force(60) + force(180) - force(120) - force_history.mean.force).norm() < 1e-12);
    }

    #[test]
    fn a_turn_repeats_itself_from_tooth_to_tooth_and_has_the_mean() {
        let force_history = ForceHistory::new(&published().force(&published().cutter()), &Engagement::slot());
        let turn = &force_history.turn;
        assert_eq!((turn.len(), turn[720].phi), (721, TAU));
        let close = |a: &Sample, b: &Sample| (a.wrench.force - b.wrench.force).norm() < 1e-9;
        assert!((0..=480).all(|k| close(&turn[k], &turn[k + 240])));
        let sum: Vector3<f64> = turn[..720].iter().map(|sample| sample.wrench.force).sum();
        assert!((sum / 720.0 - force_history.mean.force).norm() < 0.02, "{sum}");
    }
}
