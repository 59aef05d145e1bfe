//! Critical depths of cut along the plans of a placement.

use stead_placement::outcome::{Plan, PlanPoint};
use stead_placement::problem::{Placement, Problem};
use stead_simulation::chatter::{Chatter, Station};
use stead_simulation::survey::{Depths, SurveyError};

/// How deep may be cut along two plans before the cut chatters.
#[derive(Debug, Clone, PartialEq)]
pub struct PathStability {
    /// What is to be cut.
    pub chatter: Chatter,
    /// Along both plans, point by point.
    pub plans: [Vec<Depths>; 2],
}

impl PathStability {
    /// Critical depths at every point of two plans, each at its placement.
    ///
    /// # Errors
    /// [`SurveyError`] for a robot that says too little of its masses, or a cut without width.
    pub fn along(problem: &Problem, chatter: &Chatter, plans: [(&Placement, &Plan); 2]) -> Result<Self, SurveyError> {
        let along = |(placement, plan): (&Placement, &Plan)| {
            let feeds = problem.feeds(placement);
            let station = |point: &PlanPoint| Station { joints: point.joints, feed: feeds[point.point] };
            let stations: Vec<Station> = plan.points.iter().map(station).collect();
            chatter.along(&problem.robot, &problem.spindle, &stations)
        };
        let [first, second] = plans;
        Ok(Self { chatter: chatter.clone(), plans: [along(first)?, along(second)?] })
    }
}
