//! Critical depths of cut along the plans of a placement.

use stead_numerics::monitor::Monitor;
use stead_placement::outcome::{Plan, PlanPoint};
use stead_problem::problem::{Placement, Problem};
use stead_problem::setup::Setup;
use stead_simulation::path_stability::{PathConfiguration, PathStabilityAnalysis};
use stead_simulation::stability_analysis::{CutStability, StabilityError};

/// Points analysed between two questions whether to go on.
const CHUNK: usize = 32;

/// How deep may be cut along plans before the cut chatters.
#[derive(Debug, Clone, PartialEq)]
pub struct PathStability {
    /// What is to be cut.
    pub analysis: PathStabilityAnalysis,
    /// Along each plan, point by point.
    pub plans: Vec<Vec<CutStability>>,
}

impl PathStability {
    /// Critical depths at every point of plans, each at its placement in its setup; `None` once the caller asks to
    /// stop.
    ///
    /// # Errors
    /// [`StabilityError`] for a robot that says too little of its masses, or a cut without width.
    pub fn along(
        problem: &Problem,
        analysis: &PathStabilityAnalysis,
        plans: &[(&Setup, &Placement, &Plan)],
        monitor: &Monitor,
    ) -> Result<Option<Self>, StabilityError> {
        let along = |(setup, placement, plan): &(&Setup, &Placement, &Plan)| -> Result<_, StabilityError> {
            let feeds = problem.in_setup(setup).feeds(placement);
            let configuration =
                |point: &PlanPoint| PathConfiguration { joints: point.joints, feed: feeds[point.point] };
            let configurations: Vec<_> = plan.points.iter().map(configuration).collect();
            let mut depths = Vec::with_capacity(configurations.len());
            for some in configurations.chunks(CHUNK) {
                if monitor.should_stop() {
                    return Ok(None);
                }
                depths.extend(analysis.along(&problem.robot, &problem.spindle, some)?);
            }
            Ok(Some(depths))
        };
        let plans = plans.iter().map(along).collect::<Result<Option<Vec<_>>, _>>()?;
        Ok(plans.map(|plans| Self { analysis: analysis.clone(), plans }))
    }
}
