//! The joint moves between the segments of a case.

use crate::case::Case;
use stead_planning::transfer::Transfer;
use stead_problem::problem::Problem;

/// A move between two segments that is straight in joint space, from one joint pose to another, with the path points at
/// which the external axes are as they are there.
pub(super) type JointMove<'a> = [(&'a [f64; 6], usize); 2];

/// These moves of a case, without the lines along the tool axis.
pub(super) fn joint_moves<'a>(problem: &Problem, case: &'a Case) -> Vec<JointMove<'a>> {
    let spans = problem.task.segments();
    let of = |transfer: &'a Transfer| {
        let way = transfer.way.as_ref()?;
        let (from, to) = (spans.get(transfer.after_segment - 1)?, spans.get(transfer.after_segment)?);
        let at = move |place: usize| (&way.joints[place], if place < way.axes_from { from.end - 1 } else { to.start });
        let places = (1..way.joints.len()).filter(|place| !way.is_along_axis(*place));
        Some(places.map(move |place| [at(place - 1), at(place)]).collect::<Vec<_>>())
    };
    case.cycle.transfers.iter().filter_map(of).flatten().collect()
}
