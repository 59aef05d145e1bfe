//! Where workpiece and robot stand at each path point, for the view: needed where the part is turned or external axes move.

use super::data::Placed;
use super::packed::singles;
use serde_json::{Value, json};
use stead_model::robot::Pose;
use stead_placement::problem::Problem;

/// For each plan the frame of the problem's task in the frame that plans are stated in, point by point: twelve singles by columns, the
/// last in mm. Null where the placement alone says it.
pub(super) fn part_frames(problem: &Problem, plans: &[Placed<'_>]) -> Value {
    if problem.external_axes.is_empty() && problem.orientations.is_empty() {
        return Value::Null;
    }
    let turned = problem.orientation().map(|orientation| orientation.rotation);
    let of = |(placement, setup): &Placed<'_>| {
        let case = problem.in_setup(setup);
        let frames = (0..problem.task.points().len()).map(|point| {
            let mut pose = case.base_from_part(point, placement);
            if let Some(turned) = turned {
                pose.rotation *= turned.transpose();
            }
            pose
        });
        json!(frames_text(frames))
    };
    plans.iter().map(of).collect()
}

/// For each plan where the axes that carry the robot have brought it, likewise; null where there are none.
pub(super) fn carriage_frames(problem: &Problem, plans: &[Placed<'_>]) -> Value {
    if problem.external_axes.is_empty() {
        return Value::Null;
    }
    let of = |(_, setup): &Placed<'_>| {
        let case = problem.in_setup(setup);
        json!(frames_text((0..problem.task.points().len()).map(|point| case.cell_from_carriage(point))))
    };
    plans.iter().map(of).collect()
}

fn frames_text(frames: impl Iterator<Item = Pose<f64>>) -> String {
    let numbers = |pose: Pose<f64>| {
        let mut all = [0.0; 12];
        all[..9].copy_from_slice(pose.rotation.as_slice());
        for (to, metres) in all[9..].iter_mut().zip(pose.translation.iter()) {
            *to = metres * 1e3;
        }
        all
    };
    singles(frames.flat_map(numbers))
}
