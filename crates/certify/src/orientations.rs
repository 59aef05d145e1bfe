//! Several orientations of the part: a bound for each, of which the least holds for all.

use super::branch_and_bound::{Bound, Status};
use super::segments;
use std::sync::Arc;
use std::time::Instant;
use stead_numerics::monitor::Monitor;
use stead_problem::problem::Problem;
use stead_problem::settings::CertificateSettings;
use stead_problem::setup::Orientation;
use stead_problem::symmetry::Unsupported;

/// The open boxes of a part of a problem that is bounded by itself: of one orientation of the part, and of one segment.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
pub struct OpenIn {
    /// The name of the orientation, where there are several.
    pub orientation: Option<String>,
    /// The number of the segment, from 1, where segments are bounded one by one.
    pub segment: Option<usize>,
    /// How many boxes are open in it.
    pub boxes: usize,
}

/// The same problem in each orientation of the part alone, in their order, with that orientation.
///
/// # Errors
/// [`Unsupported::Orientations`] where one is none of the problem.
pub(super) fn alone(problem: &Problem) -> Result<Vec<(&Orientation, Problem)>, Unsupported> {
    let one = |number: usize| {
        let orientation = &problem.orientations[number];
        let changed = problem.changed(|parts| {
            parts.task = (*orientation.task).clone();
            parts.orientations = Arc::from([orientation.clone()]);
            parts.setup.orientation = 0;
        });
        changed.map(|changed| (orientation, changed)).map_err(|_| Unsupported::Orientations)
    };
    (0..problem.orientations.len()).map(one).collect()
}

/// Whether the part may lie in more than one orientation.
pub(super) fn are_several(problem: &Problem) -> bool {
    problem.orientations.len() > 1
}

/// A bound from below ([`super::best()`]) that holds in every orientation of the part, and the open boxes of each part
/// that is bounded by itself, in the order of those of the bound. The time that is left is shared evenly by the
/// orientations that are left.
///
/// # Errors
/// Why an orientation cannot be certified.
pub(super) fn best_in_all(
    problem: &Problem,
    value: f64,
    settings: &CertificateSettings,
    monitor: &Monitor,
) -> Result<(Bound, Vec<OpenIn>), Unsupported> {
    if !are_several(problem) {
        return segments::best(problem, value, settings, monitor);
    }
    let mut found: Option<Bound> = None;
    let mut open_in = Vec::new();
    let count = problem.orientations.len();
    for (number, (orientation, one)) in alone(problem)?.into_iter().enumerate() {
        let (bound, parts) = segments::best(&one, value, settings, &sharing(monitor, count - number))?;
        let name = &orientation.name;
        open_in.extend(parts.into_iter().map(|part| OpenIn { orientation: Some(name.clone()), ..part }));
        found = Some(match found {
            None => bound,
            Some(other) => joined(other, bound),
        });
    }
    found.map(|bound| (bound, open_in)).ok_or(Unsupported::Orientations)
}

/// A monitor with its share of the time that is left, by so many parts.
pub(super) fn sharing(monitor: &Monitor, parts: usize) -> Monitor {
    let share = |deadline: Instant| {
        let now = Instant::now();
        now + deadline.saturating_duration_since(now) / parts as u32
    };
    monitor.clone().with_deadline(monitor.deadline().map(share))
}

/// The bound that holds in two orientations: the lower one, with how that ended that fell short.
fn joined(first: Bound, second: Bound) -> Bound {
    let bound = first.bound.min(second.bound);
    // Where both fell short, the one of the lower bound says why.
    let is_first = match (first.status, second.status) {
        (Status::Reached, Status::Reached) => first.bound <= second.bound,
        (Status::Reached, _) => false,
        (_, Status::Reached) => true,
        _ => first.bound <= second.bound,
    };
    let Bound { status, keeps_open, .. } = *if is_first { &first } else { &second };
    Bound { bound, status, keeps_open, ..first.and(second) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::best::best;
    use crate::certifiable;
    use crate::certificate::certify;
    use nalgebra::{Matrix3, Vector3};
    use stead_model::task::{Task, ToolPath, Wrench};
    use stead_numerics::rotation::rotation_from_vector;
    use stead_problem::constraints::ConstraintKind;
    use stead_problem::problem::{Cell, Interval, Placement};
    use stead_problem::sense::Sense;
    use stead_problem::testing::five_segments;

    /// The five segments near the best placement, as the part lies and turned by an angle (rad) about the vertical.
    fn in_two(angle: f64) -> (Problem, Placement) {
        let mut problem = five_segments();
        let at = Placement::from_mm_deg([0.0284, -1640.0, -214.0], 78.9664);
        let near = |value: f64| Interval { min: value - 1e-3, max: value + 1e-3 };
        problem.cell = Cell { position: [near(at.x), near(at.y), near(at.z)], yaw: near(at.yaw) };
        let rotation = rotation_from_vector(&(Vector3::z() * angle));
        problem.orientations =
            Arc::from([("as it lies", Matrix3::identity()), ("turned", rotation)].map(|(name, rotation)| {
                Orientation { name: name.to_owned(), rotation, task: Arc::new(turned(&problem.task, &rotation)) }
            }));
        (problem, at)
    }

    fn turned(task: &Task, by: &Matrix3<f64>) -> Task {
        let path = task.path();
        let points = (0..path.points().len()).map(|k| {
            let mut point = path.points()[k];
            point.position = by * point.position;
            point.feed = by * point.feed;
            point.axis = by * point.axis;
            (path.segment_of(k) as u32 + 1, point)
        });
        let wrench = |w: &Wrench| Wrench { force: by * w.force, moment: by * w.moment };
        Task::new(ToolPath::new(points).unwrap(), task.wrenches().map(wrench).collect()).unwrap()
    }

    #[test]
    fn the_least_bound_of_the_orientations_holds_and_their_boxes_are_told_by_name() {
        let (problem, at) = in_two(0.3);
        assert_eq!(certifiable(&problem, u64::MAX), Ok(()));
        let (value, settings, silent) = (0.1075e-3, CertificateSettings::new(0.001), Monitor::silent());
        let (both, open_in) = best_in_all(&problem, value, &settings, &silent).unwrap();
        let each: Vec<Bound> = alone(&problem)
            .unwrap()
            .iter()
            .map(|(_, one)| best(one, value, &settings, true, &silent).unwrap())
            .collect();
        assert_eq!(both.bound, each[0].bound.min(each[1].bound));
        assert_eq!(open_in.iter().map(|part| part.boxes).collect::<Vec<_>>(), [each[0].open.len(), each[1].open.len()]);
        assert_eq!(both.open.len(), each[0].open.len() + each[1].open.len());
        assert_ne!(each[0].bound, each[1].bound);
        // In the second orientation the same placements are others.
        let planner = |one: &Problem| {
            let planner = stead_planning::redundancy::Planner::finer(one);
            let plans = planner.plan_fine(&at, Sense::Min, None, &mut planner.workspace()).unwrap();
            one.objective(plans.iter().map(|plan| plan.cost))
        };
        for ((_, one), bound) in alone(&problem).unwrap().iter().zip(&each) {
            assert!(planner(one) >= bound.bound);
        }
        let proof = certify(&problem, &at, value, None, settings, &silent).best.unwrap();
        let named = proof.open_boxes(&problem);
        assert!(named.iter().all(|open| open.orientation.is_some()));
        assert_eq!(named.len(), both.open.len());
    }

    #[test]
    fn limits_that_one_orientation_drops_are_named() {
        let (mut problem, at) = in_two(0.3);
        let settings = CertificateSettings { time_limit: Some(1.0), ..CertificateSettings::new(0.5) };
        let relaxes_rate = |problem: &Problem| {
            let proof = certify(problem, &at, 0.1075e-3, None, settings, &Monitor::silent()).best.unwrap();
            proof.relaxed.contains(&ConstraintKind::BetaRate)
        };
        assert!(!relaxes_rate(&problem));
        // With a tool that leans limits on beta are dropped.
        let mut orientations = problem.orientations.to_vec();
        orientations[1].task = Arc::new(turned(&problem.task, &rotation_from_vector(&(Vector3::x() * 0.2))));
        problem.orientations = orientations.into();
        assert!(relaxes_rate(&problem));
    }

    #[test]
    fn an_orientation_in_which_nothing_can_be_bounded_is_refused_by_name() {
        let (mut problem, _) = in_two(0.3);
        let mut orientations = problem.orientations.to_vec();
        // Five tool axes are more than a bound covers.
        let tilted = |k: usize| turned(&problem.task, &rotation_from_vector(&(Vector3::x() * (0.1 * k as f64))));
        let tasks: Vec<Task> = (1..=5).map(tilted).collect();
        let points = (0..problem.task.points().len())
            .map(|k| (problem.task.path().segment_of(k) as u32 + 1, tasks[k % 5].points()[k]));
        let path = ToolPath::new(points).unwrap();
        orientations[1].task = Arc::new(Task::new(path, problem.task.wrenches().copied().collect()).unwrap());
        problem.orientations = orientations.into();
        let refused = certifiable(&problem, u64::MAX).unwrap_err().to_string();
        assert!(refused.starts_with("in the orientation \"turned\": "), "{refused}");
    }
}
