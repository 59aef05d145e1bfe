//! Deflection over lead and tilt at a path point: for every lean the best angle about the tool axis.

use crate::case::Case;
use crate::path_subset::PathSubset;
use stead_model::task::lean::Lean;
use stead_numerics::message::Warning;
use stead_numerics::monitor::Monitor;
use stead_planning::feasibility::{MapCell, MapReason, deflection_rows};
use stead_problem::problem::Problem;
use stead_problem::setup::Setup;

/// Deflection over lead and tilt at the point of a plan that deflects most, of those at which the tool may lean.
#[derive(Debug, Clone, PartialEq)]
pub struct LeanMap {
    /// The path point, from 0.
    pub point: usize,
    /// All leads and tilts of the grid, by lead and then by tilt.
    pub leans: Vec<(Lean, LeanState)>,
}

/// The best state of a lean, or why it has none.
pub type LeanState = Result<(f64, MapCell), LeanReason>;

/// Why a lean has no allowed state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeanReason {
    /// The largest lean, the ridge or the distance between passes does not allow it.
    Lean,
    /// What most angles about the tool axis break, the nearest posture of each.
    State(MapReason),
}

impl LeanReason {
    /// A short code, as tables state it.
    pub fn code(self) -> String {
        match self {
            Self::Lean => "lean".to_owned(),
            Self::State(reason) => reason.kind.code(),
        }
    }
}

impl LeanMap {
    /// Of a case of a problem, where the tool may lean; the caller's stop leaves it out, which is then the warning.
    pub(crate) fn new(problem: &Problem, case: &Case, monitor: &Monitor) -> (Option<Self>, Option<Warning>) {
        let map = Self::made(problem, case, monitor);
        let is_left_out = map.is_none() && problem.lean.is_some() && monitor.should_stop();
        (map, is_left_out.then(|| Warning::left_out("the map over lead and tilt is")))
    }

    /// None where the tool may not lean, or where the caller stops it.
    fn made(problem: &Problem, case: &Case, monitor: &Monitor) -> Option<Self> {
        let space = problem.lean.as_deref()?;
        let upright = problem.in_setup(&Setup { leans: [].into(), ..case.setup.clone() });
        let scored = case.plan.points.iter().filter(|at| !space.ranges[at.point].is_none());
        let point = scored.max_by(|a, b| a.score.total_cmp(&b.score))?.point;
        // With as few others as there are segments: none is without a point.
        let mut kept: Vec<usize> = upright.task.segments().iter().map(|span| span.start).chain([point]).collect();
        kept.sort_unstable();
        kept.dedup();
        let place = kept.iter().position(|kept| *kept == point)?;
        let few = PathSubset::of_points(kept).of(&upright);
        let state = |lean: Lean| -> Option<LeanState> {
            if !space.allows(upright.task.path(), point, &lean) {
                return Some(Err(LeanReason::Lean));
            }
            let leans = (0..few.task.points().len()).map(|at| if at == place { lean } else { Lean::NONE }).collect();
            let set_up = few.in_setup(&Setup { leans, ..few.setup.clone() });
            let rows = deflection_rows(&set_up, &case.placement, &[place], || monitor.should_stop())?;
            let cells = rows.first()?.iter().enumerate();
            let allowed = cells.clone().filter_map(|(k, cell)| Some((k, cell.ok()?)));
            let best = allowed.min_by(|a, b| a.1.score.total_cmp(&b.1.score));
            let count =
                |reason: &MapReason| cells.clone().filter(|(_, cell)| cell.err().as_ref() == Some(reason)).count();
            match best {
                Some((k, cell)) => Some(Ok((set_up.redundancy.beta(k), cell))),
                None => {
                    let reasons = cells.clone().filter_map(|(_, cell)| cell.err());
                    // Of equally many the first.
                    let most = reasons.rev().max_by_key(count)?;
                    Some(Err(LeanReason::State(most)))
                }
            }
        };
        let leans = space.grid(point, space.half_counts()).into_iter();
        Some(Self { point, leans: leans.map(|lean| Some((lean, state(lean)?))).collect::<Option<_>>()? })
    }
}
