//! Critical depths of cut along the plans of a placement.

use stead_placement::outcome::{Plan, PlanPoint};
use stead_placement::problem::{Placement, Problem};
use stead_simulation::path_stability::{PathConfiguration, PathStabilityAnalysis};
use stead_simulation::stability_analysis::{CutStability, StabilityError};

/// How deep may be cut along two plans before the cut chatters.
#[derive(Debug, Clone, PartialEq)]
pub struct PathStability {
    /// What is to be cut.
    pub analysis: PathStabilityAnalysis,
    /// Along both plans, point by point.
    pub plans: [Vec<CutStability>; 2],
}

impl PathStability {
    /// Critical depths at every point of two plans, each at its placement.
    ///
    /// # Errors
    /// [`StabilityError`] for a robot that says too little of its masses, or a cut without width.
    pub fn along(
        problem: &Problem,
        analysis: &PathStabilityAnalysis,
        plans: [(&Placement, &Plan); 2],
    ) -> Result<Self, StabilityError> {
        let along = |(placement, plan): (&Placement, &Plan)| {
            let feeds = problem.feeds(placement);
            let configuration =
                |point: &PlanPoint| PathConfiguration { joints: point.joints, feed: feeds[point.point] };
            let configurations: Vec<_> = plan.points.iter().map(configuration).collect();
            analysis.along(&problem.robot, &problem.spindle, &configurations)
        };
        let [first, second] = plans;
        Ok(Self { analysis: analysis.clone(), plans: [along(first)?, along(second)?] })
    }
}
