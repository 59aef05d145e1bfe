//! Critical depths along a tool path: a stiff placement may chatter all the same.

use super::arm::Variant;
use super::stability_analysis::{CutStability, StabilityError, cut_stability, linear_of};
use nalgebra::Vector3;
use rayon::prelude::*;
use stead_model::cutting::{CutFrame, Cutter, PassCut};
use stead_model::robot::{Robot, Spindle};

/// The cut along a tool path, and how stability is analysed.
#[derive(Debug, Clone, PartialEq)]
pub struct PathStabilityAnalysis {
    /// How much of the arm is modelled.
    pub variant: Variant,
    /// Factor on all damping.
    pub damping_scale: f64,
    /// The cutter.
    pub cutter: Cutter,
    /// The cut, the same at every path point.
    pub cut: PassCut,
    /// Largest depth of cut that is examined. m
    pub max_depth: f64,
}

/// The arm at a path point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathConfiguration {
    /// Joint angles. rad
    pub joints: [f64; 6],
    /// Direction of the feed in the base frame.
    pub feed: Vector3<f64>,
}

impl PathStabilityAnalysis {
    /// Critical depths and the verdict at every configuration, in their order.
    ///
    /// # Errors
    /// [`StabilityError`] for a robot that says too little, or a cut without width.
    pub fn along(
        &self,
        robot: &Robot,
        spindle: &Spindle,
        configurations: &[PathConfiguration],
    ) -> Result<Vec<CutStability>, StabilityError> {
        let at = |configuration: &PathConfiguration| {
            let linear = linear_of(robot, spindle, self.variant, self.damping_scale, &configuration.joints)?;
            let tool = robot.forward(&configuration.joints).then(&spindle.flange_from_tool);
            let frame = CutFrame::new(configuration.feed, -tool.rotation.column(2), self.cut.wall(&self.cutter));
            Ok(cut_stability(&linear.plant(&frame)?, &self.cutter, &self.cut, self.max_depth)?)
        };
        configurations.par_iter().map(at).collect()
    }
}

/// The smallest critical depth (m) by semi-discretisation, and which configuration has it; none where all are stable.
pub fn smallest(depths: &[CutStability]) -> Option<(usize, f64)> {
    let found = depths.iter().enumerate().filter_map(|(k, depths)| Some((k, depths.semi_discretisation?)));
    found.min_by(|a, b| a.1.total_cmp(&b.1))
}
