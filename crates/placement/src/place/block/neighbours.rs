//! The placements beside one, each with leans planned anew for it.
//!
//! Where this gains nothing, no placement before or behind along x, y, z and yaw is better with the best leans near the
//! ones known.

use crate::place::improver::{Improver, MOST_REFINED};
use crate::place::job::Planned;
use crate::place::thinned::{Thinned, spread};
use crate::refine::neighbours;
use rayon::prelude::*;
use stead_planning::redundancy::motion::{MotionGrid, MotionPlanner};
use stead_problem::lean::MOST_PLANNED_POINTS;
use stead_problem::problem::Placement;
use stead_problem::setup::Setup;

/// Distances (in scaled variables), and by how much the first steps of lead and tilt are divided for them.
const POLLS: [(f64, f64); 3] = [(0.15, 1.0), (0.03, 2.0), (0.006, 8.0)];

/// The best neighbour of the first distance that has a better one; of those planned before a stop.
pub(in crate::place) fn best(job: &Improver<'_>, known: &Planned) -> Option<Planned> {
    let space = job.space?;
    if job.problem.cell.pinned().is_some() || job.problem.task.points().len() > MOST_REFINED {
        return None;
    }
    let upright = job.problem.in_setup(&Setup { leans: [].into(), ..known.setup.clone() });
    let on = Thinned::to_at_most(&upright, MOST_PLANNED_POINTS);
    let leans = on.leans_of(&known.setup);
    POLLS.into_iter().find_map(|(distance, part)| {
        let grid = MotionGrid::near_leans(on.problem(), &leans, space.steps.map(|step| step / part), 1);
        let problems = grid.problems();
        let planner = MotionPlanner::new(&grid, &problems);
        let at = |placement: &Placement| {
            let path = (!job.monitor.should_stop()).then(|| planner.path(placement))??;
            let leans = spread(space, &on, &path.motion.leans)?.into();
            Planned::at(job.problem, Setup { leans, ..known.setup.clone() }, placement)
        };
        let around = neighbours(job.problem, &known.solution.placement, distance);
        let tried: Vec<Option<Planned>> = around.par_iter().map(at).collect();
        tried.into_iter().flatten().fold(None, |best: Option<Planned>, near| {
            let limit = best.as_ref().unwrap_or(known).solution.objective;
            if near.solution.objective < limit { Some(near) } else { best }
        })
    })
}
